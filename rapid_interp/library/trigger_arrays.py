"""Triggers told in arrays of signals by name, and joint moves with triggers: TriggLIOs, TriggJIOs, TriggAbsJ, MoveAbsJDO and its kind.

Invariant: as in `triggers`, what happens where on the path is the controller's.
"""

from __future__ import annotations

from collections.abc import Callable

from rapid_interp.effects import Action, RaiseInterrupt, SetOutput, SourceLine, Trigger
from rapid_interp.library.motion import move_absj, move_j, move_l
from rapid_interp.library.table import Effects, LibraryRoutine
from rapid_interp.library.triggers import Mover, called_from_path, digital, listed, number, placed, with_triggers
from rapid_interp.meaning.types import Value
from rapid_interp.running.values import Fault, error_number

MORE = " ".join(rf"\anytype T{place}" for place in range(2, 9))


def _value(text: Value) -> float:
    """A value in digits, as `triggstrgo` has it."""
    try:
        return float(text)
    except ValueError:
        raise Fault(f"{text!r} is no value of a group signal", "RAPID-R313", number=error_number("ERR_ARGVALERR")) from None


def _signals(*arrays: Value) -> tuple[Trigger, ...]:
    """Gives a trigger for each element that is used: used, distance, start, equiplag, signalname, setvalue, xxx."""
    found: list[Trigger] = []
    for used, distance, start, lag, name, value, _ in [element for array in arrays if array is not None for element in array]:
        if used:
            if not name:
                raise Fault("a trigger in use has no name of a signal", "RAPID-R313", number=error_number("ERR_ARGNAME"))
            found.append(placed(SetOutput(name, _value(value)), distance, start, False, lag))
    return tuple(found)


def _with_signals(mover: Mover) -> Mover:
    def run(at: SourceLine, conc: bool, target: Value, ident: Value, speed: Value, duration: Value, *rest: Value) -> Effects:
        arrays, (zone, inpos, tool, wobj, corrected, load) = rest[:3], rest[3:]
        corr = () if mover is move_j else (corrected,)
        moves = mover(at, conc, target, ident, speed, None, duration, zone, None, inpos, tool, wobj, *corr, load)
        return with_triggers(at, moves, _signals(*arrays))

    return run


def _trigg_absj(
    at: SourceLine, conc: bool, target: Value, ident: Value, eoffs: bool, speed: Value, duration: Value, *rest: Value
) -> Effects:
    triggers, (zone, inpos, tool, wobj, load) = rest[:8], rest[8:]
    moves = move_absj(at, conc, target, ident, eoffs, speed, None, duration, zone, None, inpos, tool, wobj, load)
    return with_triggers(at, moves, listed(triggers))


def _absj_and(action: Callable[[Value, float], Action]) -> Mover:
    def run(
        at: SourceLine, target: Value, ident: Value, eoffs: bool, speed: Value, duration: Value, zone: Value, tool: Value, wobj: Value,
        signal: Value, value: float, load: Value,
    ) -> Effects:  # fmt: skip
        moves = move_absj(at, False, target, ident, eoffs, speed, None, duration, zone, None, None, tool, wobj, load)
        return with_triggers(at, moves, (Trigger(action=action(signal, value)),))

    return run


def _absj_sync(
    task: Value, at: SourceLine, target: Value, ident: Value, eoffs: bool, speed: Value, duration: Value, zone: Value, tool: Value,
    wobj: Value, name: str, load: Value,
) -> Effects:  # fmt: skip
    moves = move_absj(at, False, target, ident, eoffs, speed, None, duration, zone, None, None, tool, wobj, load)
    return with_triggers(at, moves, (Trigger(action=RaiseInterrupt(called_from_path(task, at, name))),))


_ARRAYS = r"\triggios TriggData1{*} \triggstrgo TriggData2{*} \triggiosdnum TriggData3{*}"
_ABSJ = r"jointtarget ToJointPos \identno ID \switch NoEOffs, speeddata Speed \num T"
_TOOL = r"zonedata Zone, tooldata Tool \wobjdata WObj"
_HEAD = rf"\switch Conc, robtarget ToPoint \identno ID, speeddata Speed \num T {_ARRAYS}, zonedata Zone \stoppointdata Inpos"
ROUTINES = (
    *(
        LibraryRoutine(
            rf"PROC Trigg{letter}IOs({_HEAD}, tooldata Tool \wobjdata WObj \switch Corr \loaddata TLoad)", _with_signals(mover), True
        )
        for letter, mover in (("L", move_l), ("J", move_j))
    ),
    LibraryRoutine(
        rf"PROC TriggAbsJ(\switch Conc, {_ABSJ}, anytype Trigg_1 {MORE}, zonedata Zone \stoppointdata Inpos, tooldata Tool \wobjdata WObj"
        r" \loaddata TLoad)",
        _trigg_absj,
        True,
    ),
    *(
        LibraryRoutine(
            rf"PROC MoveAbsJ{kind}({_ABSJ}, {_TOOL}, signal{kind.lower()} Signal, num Value \loaddata TLoad)", _absj_and(action), True
        )
        for kind, action in (("DO", digital), ("AO", number), ("GO", number))
    ),
    LibraryRoutine(rf"PROC MoveAbsJSync({_ABSJ}, {_TOOL}, string ProcName \loaddata TLoad)", _absj_sync, True, task=True),
)
