"""Outputs, interrupts and procedures at places of a path: the Trigg and the Move..DO, ..AO, ..GO, ..Sync instructions.

Invariant: `triggdata` holds a `Trigger`; what happens where on the path is the controller's.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rapid_interp.effects import (
    Action,
    CheckSignal,
    FollowSpeed,
    Motion,
    RaiseInterrupt,
    RampOutput,
    SetOutput,
    SourceLine,
    Trigger,
    TriggerMove,
)
from rapid_interp.library.motion import move_c, move_j, move_l
from rapid_interp.library.signals import signal_name
from rapid_interp.library.table import Effects, LibraryRoutine
from rapid_interp.meaning.types import RapidType, Value
from rapid_interp.running.values import Fault, Reference, error_number

if TYPE_CHECKING:
    from rapid_interp.running.task import Stepper

_RELATIONS = {-1.0: "LT", -2.0: "LTEQ", 0.0: "EQ", 3.0: "NOTEQ", 1.0: "GT", 2.0: "GTEQ"}
Mover = Callable[..., Effects]


# ---------------------------------------------------------------- trigger data


def _output(digital: Value, group: Value, analog: Value, value: float) -> Action:
    for signal in (digital, group, analog):
        if signal is not None:
            return SetOutput(signal_name(signal), float(bool(value)) if signal is digital else value)
    raise Fault("one of \\DOp, \\GOp and \\AOp is needed", "RAPID-R313")


def placed(action: Action, distance: float, from_start: bool, in_seconds: bool, lag: float = 0.0) -> Trigger:
    """Gives the trigger of an action at a distance in mm, or s with `in_seconds`."""
    if distance < 0:
        raise Fault(f"the distance of a trigger cannot be negative, found {distance:g}", "RAPID-R313")
    if in_seconds:
        return Trigger(action=action, seconds=distance, lag=lag)
    return Trigger(action=action, distance_mm=distance, from_start=from_start, lag=lag)


def _trigg_io(
    data: Reference, distance: float, start: bool, in_seconds: bool, digital: Value, group: Value, analog: Value, value: float,
    delay: float | None,
) -> None:  # fmt: skip
    data.put(placed(_output(digital, group, analog, value), distance, start, in_seconds, -(delay or 0.0)))


def _trigg_equip(
    data: Reference, distance: float, start: bool, lag: float, digital: Value, group: Value, analog: Value, value: float, *_: Value
) -> None:
    """ASSUMPTION A-46: a positive EquipLag fires earlier."""
    data.put(placed(_output(digital, group, analog, value), distance, start, False, lag))


def _connected(task: Stepper, interrupt: Reference) -> int:
    found = int(interrupt.get())
    if found not in task.interrupts.traps:
        raise Fault("the interrupt is not connected to a trap", "RAPID-R341", number=error_number("ERR_UNKINO"))
    return found


def _trigg_int(task: Stepper, data: Reference, distance: float, start: bool, in_seconds: bool, interrupt: Reference) -> None:
    data.put(placed(RaiseInterrupt(_connected(task, interrupt)), distance, start, in_seconds))


def _trigg_speed(data: Reference, distance: float, start: bool, lag: float, analog: Value, scale: float, *_: Value) -> None:
    data.put(placed(FollowSpeed(signal_name(analog), scale, lag), distance, start, False))


def _trigg_ramp(
    data: Reference, distance: float, start: bool, lag: float, analog: Value, value: float, ramp: float, in_seconds: bool
) -> None:
    data.put(placed(RampOutput(signal_name(analog), value, ramp, in_seconds), distance, start, False, lag))


def _trigg_check(
    task: Stepper, data: Reference, distance: float, start: bool, in_seconds: bool, signal: Value, relation: float, value: float,
    stops: bool, interrupt: Reference,
) -> None:  # fmt: skip
    condition = _RELATIONS.get(relation)
    if condition is None:
        raise Fault(f"{relation:g} is no relation: use EQ, NOTEQ, LT, LTEQ, GT or GTEQ", "RAPID-R313")
    action = CheckSignal(signal_name(signal), condition, value, _connected(task, interrupt), stops)
    data.put(placed(action, distance, start, in_seconds))


# ---------------------------------------------------------------- moves with triggers


def listed(given: tuple[tuple[RapidType, Value] | None, ...]) -> tuple[Trigger, ...]:
    """Gives the triggers of trigger data and of arrays of them."""
    found: list[Trigger] = []
    for typed in given:
        if typed is None:
            continue
        for trigger in typed[1] if isinstance(typed[1], tuple) else (typed[1],):
            if isinstance(trigger, Trigger):
                found.append(trigger)
            elif isinstance(typed[1], tuple) and trigger is None:
                continue  # the rest of an array that is not filled
            else:
                raise Fault("the trigger has not been defined by TriggIO or its kind", "RAPID-R313")
    return tuple(found)


def with_triggers(at: SourceLine, moves: Effects, triggers: tuple[Trigger, ...]) -> Effects:
    """Yields the move that a mover makes, with triggers."""
    move: Motion = next(moves)  # type: ignore[assignment] # a mover yields one motion
    yield TriggerMove(at, move, triggers)


def _trigg_move(mover: Mover, targets: int) -> Mover:
    def run(at: SourceLine, conc: bool, *given: Value) -> Effects:
        points, (ident, speed, duration), rest = given[:targets], given[targets : targets + 3], given[targets + 3 :]
        triggers, (zone, inpos, tool, wobj, corrected, load) = rest[:8], rest[8:]
        corr = () if mover is move_j else (corrected,)
        moves = mover(at, conc, *points, ident, speed, None, duration, zone, None, inpos, tool, wobj, *corr, load)
        return with_triggers(at, moves, listed(triggers))

    return run


def _move_and(mover: Mover, targets: int, action: Callable[[Value, float], Action]) -> Mover:
    def run(at: SourceLine, *given: Value) -> Effects:
        points, (ident, speed, duration, zone, tool, wobj, signal, value, load) = given[:targets], given[targets:]
        corr = () if mover is move_j else (False,)
        moves = mover(at, False, *points, ident, speed, None, duration, zone, None, None, tool, wobj, *corr, load)
        return with_triggers(at, moves, (Trigger(action=action(signal, value)),))

    return run


def called_from_path(task: Stepper, at: SourceLine, name: str) -> int:
    """Gives the interrupt number that calls a procedure from the path."""
    procedure = task.find(name, at.module)
    if procedure is None or procedure.kind != "PROC" or any(not parameter.optional for parameter in procedure.parameters):
        message = f"no procedure {name!r} without arguments"
        raise Fault(message, "RAPID-R351", number=error_number("ERR_REFUNKPRC"))
    return task.interrupts.call_once(procedure)


def _move_sync(mover: Mover, targets: int) -> Callable[..., Effects]:
    def run(task: Stepper, at: SourceLine, *given: Value) -> Effects:
        points, (ident, speed, duration, zone, tool, wobj, name, load) = given[:targets], given[targets:]
        interrupt = called_from_path(task, at, name)
        corr = () if mover is move_j else (False,)
        moves = mover(at, False, *points, ident, speed, None, duration, zone, None, None, tool, wobj, *corr, load)
        return with_triggers(at, moves, (Trigger(action=RaiseInterrupt(interrupt)),))

    return run


def digital(signal: Value, value: float) -> Action:
    """Gives the action that sets a digital output."""
    return SetOutput(signal_name(signal), float(bool(value)))


def number(signal: Value, value: float) -> Action:
    """Gives the action that sets an analog or group output."""
    return SetOutput(signal_name(signal), value)


def _copy(source: Value, target: Reference) -> None:
    target.put(source)


def _reset(data: Reference) -> None:
    data.put(None)


def _moves() -> tuple[LibraryRoutine, ...]:
    found: list[LibraryRoutine] = []
    more = " ".join(rf"\triggdata T{place}" for place in range(2, 9)).replace("triggdata", "anytype")
    for letter, mover in (("L", move_l), ("J", move_j), ("C", move_c)):
        points = "robtarget CirPoint, robtarget ToPoint" if letter == "C" else "robtarget ToPoint"
        targets = 2 if letter == "C" else 1
        head = rf"{points} \identno ID, speeddata Speed \num T"
        found.append(
            LibraryRoutine(
                rf"PROC Trigg{letter}(\switch Conc, {head}, anytype Trigg_1 {more}, zonedata Zone \stoppointdata Inpos, tooldata Tool"
                r" \wobjdata WObj \switch Corr \loaddata TLoad)",
                _trigg_move(mover, targets),
                True,
            )
        )
        common = rf"{head}, zonedata Zone, tooldata Tool \wobjdata WObj"
        for kind, action in (("DO", digital), ("AO", number), ("GO", number)):
            found.append(
                LibraryRoutine(
                    rf"PROC Move{letter}{kind}({common}, signal{kind.lower()} Signal, num Value \loaddata TLoad)",
                    _move_and(mover, targets, action),
                    True,
                )
            )
        found.append(
            LibraryRoutine(
                rf"PROC Move{letter}Sync({common}, string ProcName \loaddata TLoad)", _move_sync(mover, targets), True, task=True
            )
        )
    return tuple(found)


_WHERE = r"num Distance \switch Start | switch Time"
_SIGNALS = r"\signaldo DOp | signalgo GOp | signalao AOp"
ROUTINES = (
    LibraryRoutine(rf"PROC TriggIO(INOUT triggdata TriggData, {_WHERE} {_SIGNALS}, num SetValue \num DODelay)", _trigg_io),
    LibraryRoutine(
        rf"PROC TriggEquip(INOUT triggdata TriggData, num Distance \switch Start, num EquipLag {_SIGNALS}, num SetValue"
        r" \INOUT bool Inhib \INOUT num InhibSetValue \triggmode Mode)",
        _trigg_equip,
    ),
    LibraryRoutine(rf"PROC TriggInt(INOUT triggdata TriggData, {_WHERE}, INOUT intnum Interrupt)", _trigg_int, task=True),
    LibraryRoutine(
        r"PROC TriggSpeed(INOUT triggdata TriggData, num Distance \switch Start, num ScaleLag, signalao AOp, num ScaleValue \num DipLag"
        r" \signaldo ErrDO \INOUT bool Inhib \INOUT num InhibSetValue \triggmode Mode)",
        _trigg_speed,
    ),
    LibraryRoutine(
        r"PROC TriggRampAO(INOUT triggdata TriggData, num Distance \switch Start, num EquipLag, signalao AOutput, num SetValue,"
        r" num RampLength \switch Time)",
        _trigg_ramp,
    ),
    LibraryRoutine(
        rf"PROC TriggCheckIO(INOUT triggdata TriggData, {_WHERE}, signalxx Signal, num Relation, num CheckValue \switch StopMove,"
        " INOUT intnum Interrupt)",
        _trigg_check,
        task=True,
    ),
    LibraryRoutine("PROC TriggDataCopy(triggdata Source, INOUT triggdata Target)", _copy),
    LibraryRoutine("PROC TriggDataReset(INOUT triggdata TriggData)", _reset),
    LibraryRoutine("FUNC bool TriggDataValid(triggdata TriggData)", lambda data: isinstance(data, Trigger)),
    *_moves(),
)
