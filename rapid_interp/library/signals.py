"""Input and output signals, and waiting for them or for time.

Invariant: the state of a signal is never kept here; it is set and asked for by effects.
"""

from __future__ import annotations

from collections.abc import Callable

from rapid_interp.effects import ReadSignal, SetSignal, SourceLine, Wait
from rapid_interp.library.table import Effects, LibraryRoutine, number_told
from rapid_interp.meaning.types import Value
from rapid_interp.running.values import ABSENT, Fault, error_number

POLL_S = 0.01
"""ASSUMPTION A-31: WaitDI and its kind look at the signal every 10 ms."""


def signal_name(signal: Value) -> str:
    """Gives the name of the signal that a value stands for."""
    if not signal or signal is ABSENT:
        raise Fault("the signal variable is not connected to a signal", "RAPID-R320")
    return str(signal)


def _wait_time(at: SourceLine, in_position: bool, seconds: float) -> Effects:
    if seconds < 0:
        raise Fault(f"WaitTime needs a time of at least 0 s, found {seconds:g}", "RAPID-R321")
    yield Wait(at, seconds, in_position=in_position)


def _set_digital(at: SourceLine, delay: float | None, _sync: bool, signal: Value, value: float) -> Effects:
    yield SetSignal(at, signal_name(signal), float(bool(value)), delay or 0.0)


def _set_group(at: SourceLine, delay: float | None, signal: Value, value: float) -> Effects:
    yield SetSignal(at, signal_name(signal), value, delay or 0.0)


def _set_analog(at: SourceLine, signal: Value, value: float) -> Effects:
    yield SetSignal(at, signal_name(signal), value)


def _set(at: SourceLine, signal: Value) -> Effects:
    yield SetSignal(at, signal_name(signal), 1.0)


def _reset(at: SourceLine, signal: Value) -> Effects:
    yield SetSignal(at, signal_name(signal), 0.0)


def _invert(at: SourceLine, signal: Value) -> Effects:
    value = yield ReadSignal(at, signal_name(signal))
    yield SetSignal(at, signal_name(signal), 0.0 if value else 1.0)


def _pulse(at: SourceLine, high: bool, length: float | None, signal: Value) -> Effects:
    r"""ASSUMPTION A-32: a pulse lasts 0.2 s without `\PLength` and inverts the signal unless `\High`."""
    name = signal_name(signal)
    value = 0.0 if high else (yield ReadSignal(at, name))
    yield SetSignal(at, name, 0.0 if value else 1.0)
    yield SetSignal(at, name, 1.0 if value else 0.0, 0.2 if length is None else length)


def _read(at: SourceLine, signal: Value) -> Effects:
    return number_told((yield ReadSignal(at, signal_name(signal))), "value of the signal")


def _test(at: SourceLine, signal: Value) -> Effects:
    return bool((yield ReadSignal(at, signal_name(signal))))


def _wait_signal(at: SourceLine, signal: Value, value: float, max_time: float | None, flag: Value, *_: Value) -> Effects:
    yield from _wait(at, signal, lambda found: found == value, max_time, flag)


def _wait(at: SourceLine, signal: Value, holds: Callable[[float], bool], max_time: float | None, flag: Value) -> Effects:
    waited = 0.0
    while not holds(number_told((yield ReadSignal(at, signal_name(signal))), "value of the signal")):
        if max_time is not None and waited >= max_time:
            if flag is not None:
                flag.put(True)
                return None
            raise Fault(
                f"{signal_name(signal)} did not get the value within {max_time:g} s", "RAPID-R322", number=error_number("ERR_WAIT_MAXTIME")
            )
        yield Wait(at, POLL_S)
        waited += POLL_S
    if flag is not None:
        flag.put(False)
    return None


def _wait_value(
    at: SourceLine, signal: Value, unequal: bool, less: bool, greater: bool, value: float, max_time: float | None, flag: Value, *_: Value
) -> Effects:
    def holds(found: float) -> bool:
        return found != value if unequal else found < value if less else found > value if greater else found == value

    yield from _wait(at, signal, holds, max_time, flag)


def _by_the_compiler() -> None:
    """WaitUntil evaluates its condition again and again, which an argument cannot be: `meaning.recovery` compiles it."""


_LIMITS = r"\num MaxTime \INOUT bool TimeFlag"
ROUTINES = (
    LibraryRoutine(r"PROC WaitTime(\switch InPos, num Time)", _wait_time, True),
    LibraryRoutine(r"PROC SetDO(\num SDelay \switch Sync, signaldo Signal, num Value)", _set_digital, True),
    LibraryRoutine(r"PROC SetGO(\num SDelay, signalgo Signal, numeric Value)", _set_group, True),
    LibraryRoutine("PROC SetAO(signalao Signal, num Value)", _set_analog, True),
    LibraryRoutine("PROC Set(signaldo Signal)", _set, True),
    LibraryRoutine("PROC Reset(signaldo Signal)", _reset, True),
    LibraryRoutine("PROC InvertDO(signaldo Signal)", _invert, True),
    LibraryRoutine(r"PROC PulseDO(\switch High \num PLength, signaldo Signal)", _pulse, True),
    LibraryRoutine(rf"PROC WaitUntil(\switch InPos, bool Cond {_LIMITS} \num PollRate \switch Visualize)", _by_the_compiler),
    LibraryRoutine(rf"PROC WaitDI(signaldi Signal, num Value {_LIMITS} \switch Visualize)", _wait_signal, True),
    LibraryRoutine(rf"PROC WaitDO(signaldo Signal, num Value {_LIMITS} \switch Visualize)", _wait_signal, True),
    *(
        LibraryRoutine(
            rf"PROC Wait{name}(signal{name.lower()} Signal \switch NOTEQ | switch LT | switch GT, numeric Value {_LIMITS})",
            _wait_value,
            True,
        )
        for name in ("GI", "GO", "AI", "AO")
    ),
    LibraryRoutine("FUNC num DInput(signaldi Signal)", _read, True),
    LibraryRoutine("FUNC num DOutput(signaldo Signal)", _read, True),
    LibraryRoutine("FUNC num GInput(signalgi Signal)", _read, True),
    LibraryRoutine("FUNC num GOutput(signalgo Signal)", _read, True),
    LibraryRoutine("FUNC dnum GInputDnum(signalgi Signal)", _read, True),
    LibraryRoutine("FUNC dnum GOutputDnum(signalgo Signal)", _read, True),
    LibraryRoutine("FUNC num AInput(signalai Signal)", _read, True),
    LibraryRoutine("FUNC num AOutput(signalao Signal)", _read, True),
    LibraryRoutine("FUNC bool TestDI(signaldi Signal)", _test, True),
)
