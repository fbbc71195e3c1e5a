"""Interrupts: what raises them, and when they wait.

Invariant: the controller is told numbers only; which trap belongs to a number is known to the task alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rapid_interp.effects import AnalogCondition, Elapsed, SignalChange, Source, SourceLine, Subscribe, Unsubscribe
from rapid_interp.library.signals import signal_name
from rapid_interp.library.table import Effects, LibraryRoutine
from rapid_interp.meaning.types import Value
from rapid_interp.running.values import Fault, Reference, error_number

if TYPE_CHECKING:
    from rapid_interp.running.task import Stepper

_EDGE = 2.0


def number_of(task: Stepper, interrupt: Reference) -> int:
    """Gives the number of an interrupt that is connected."""
    number = int(interrupt.get())
    if number not in task.interrupts.traps:
        raise Fault("the interrupt is not connected to a trap", "RAPID-R341", number=error_number("ERR_UNKINO"))
    return number


def _subscribe(task: Stepper, at: SourceLine, source: Source, interrupt: Reference, single: bool) -> Effects:
    yield Subscribe(at, number_of(task, interrupt), source, single)


def _digital(task: Stepper, at: SourceLine, single: bool, safe: bool, signal: Value, value: float, interrupt: Reference) -> Effects:
    change = SignalChange(signal_name(signal), None if value == _EDGE else float(bool(value)))
    yield from _subscribe(task, at, change, interrupt, single or safe)


def _group(task: Stepper, at: SourceLine, single: bool, safe: bool, signal: Value, interrupt: Reference) -> Effects:
    yield from _subscribe(task, at, SignalChange(signal_name(signal), None), interrupt, single or safe)


def _analog(
    task: Stepper, at: SourceLine, single: bool, safe: bool, signal: Value, condition: float, high: float, low: float, delta: float,
    _up: bool, _down: bool, interrupt: Reference,
) -> Effects:  # fmt: skip
    source = AnalogCondition(signal_name(signal), int(condition), high, low, delta)
    yield from _subscribe(task, at, source, interrupt, single or safe)


def _timer(task: Stepper, at: SourceLine, single: bool, safe: bool, seconds: float, interrupt: Reference) -> Effects:
    if seconds <= 0:
        raise Fault(f"ITimer needs a positive time, found {seconds:g}", "RAPID-R321")
    yield from _subscribe(task, at, Elapsed(seconds), interrupt, single or safe)


def _delete(task: Stepper, at: SourceLine, interrupt: Reference, _safe: bool) -> Effects:
    """A number that is not connected is no error: programs delete before they connect."""
    number = int(interrupt.get())
    if number in task.interrupts.traps:
        task.interrupts.delete(number)
        yield Unsubscribe(at, number)


def _sleep(task: Stepper, interrupt: Reference) -> None:
    task.interrupts.asleep.add(number_of(task, interrupt))


def _watch(task: Stepper, interrupt: Reference) -> None:
    task.interrupts.asleep.discard(number_of(task, interrupt))


def _disable(task: Stepper) -> None:
    task.interrupts.disabled = True


def _enable(task: Stepper, _at: SourceLine) -> Effects:
    task.interrupts.disabled = False
    yield from task.traps()


def _on_change(task: Stepper, single: bool, data: Reference, interrupt: Reference) -> None:
    task.interrupts.watch(number_of(task, interrupt), data, single=single)


ONCE = r"\switch Single | switch SingleSafe"
ROUTINES = (
    *(
        LibraryRoutine(
            rf"PROC ISignal{kind}({ONCE}, signal{kind.lower()} Signal, num TriggValue, INOUT intnum Interrupt)", _digital, True, task=True
        )
        for kind in ("DI", "DO")
    ),
    *(
        LibraryRoutine(rf"PROC ISignal{kind}({ONCE}, signal{kind.lower()} Signal, INOUT intnum Interrupt)", _group, True, task=True)
        for kind in ("GI", "GO")
    ),
    *(
        LibraryRoutine(
            rf"PROC ISignal{kind}({ONCE}, signal{kind.lower()} Signal, num Condition, num HighValue, num LowValue, num DeltaValue"
            r" \switch DPos | switch DNeg, INOUT intnum Interrupt)",
            _analog,
            True,
            task=True,
        )
        for kind in ("AI", "AO")
    ),
    LibraryRoutine(rf"PROC ITimer({ONCE}, num Time, INOUT intnum Interrupt)", _timer, True, task=True),
    LibraryRoutine(
        r"PROC IPers(\switch Single, INOUT anydata Name, INOUT intnum Interrupt)",
        lambda task, single, data, interrupt: _on_change(task, single, data[1], interrupt),
        task=True,
    ),
    LibraryRoutine(r"PROC IDelete(INOUT intnum Interrupt \switch Safe)", _delete, True, task=True),
    LibraryRoutine("PROC ISleep(INOUT intnum Interrupt)", _sleep, task=True),
    LibraryRoutine("PROC IWatch(INOUT intnum Interrupt)", _watch, task=True),
    LibraryRoutine("PROC IDisable()", _disable, task=True),
    LibraryRoutine("PROC IEnable()", _enable, True, task=True),
)
