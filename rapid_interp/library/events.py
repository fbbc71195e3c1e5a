r"""Errors that a program raises itself, messages of the event log that interrupt it, and what a trap asks about its cause.

Invariant: what is logged is the controller's; the interpreter only knows which interrupt is at work.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rapid_interp import effects as fx
from rapid_interp.effects import SourceLine, Write
from rapid_interp.library.interrupts import ONCE, number_of
from rapid_interp.library.table import Effects, LibraryRoutine
from rapid_interp.meaning.types import Value
from rapid_interp.running.values import Fault, Reference, error_number

if TYPE_CHECKING:
    from rapid_interp.running.task import Stepper

MAX_TEXT = 80


def _raise(task: Stepper, at: SourceLine, name: str, number: float, warns: bool, *texts: Value) -> Effects:
    r"""A warning (`\W`) is only a message; an error goes to the error handler under the name given by BookErrNo or `ERR_...`."""
    message = " ".join([f"{number:g}", *(text for text in texts if text)])
    yield Write(at, message)
    if warns:
        return
    booked = task.modules.find_data(name, at.module)
    value = task.globals[booked.slot] if booked is not None else error_number(name)
    raise Fault(f"{name}: {message}", "RAPID-R380", number=value)


def _raise_to_user(task: Stepper, _continue: bool, _break: bool, number: float | None) -> None:
    value = task.error_number if number is None else number
    raise Fault(f"error {value:g} was raised and not handled", "RAPID-R380", number=value)


def _on_error(
    task: Stepper, at: SourceLine, _once: bool, _safe: bool, domain: float, number: float | None, kind: float, interrupt: Reference
) -> Effects:
    source = fx.EventLogged(int(domain), int(kind), int(number or 0))
    yield fx.Subscribe(at, number_of(task, interrupt), source)


def _trap_data(task: Stepper, data: Reference) -> None:
    if not task.interrupts.in_trap:
        raise Fault("GetTrapData belongs into a trap", "RAPID-R349", number=error_number("ERR_ARGVALERR"))
    data.put(task.interrupts.current)


def _error_data(
    at: SourceLine, data: float, domain: Reference, number: Reference, kind: Reference, title: Value, *texts: Reference | None
) -> Effects:
    if not data:
        raise Fault("the trap data is empty: GetTrapData comes first", "RAPID-R349", number=error_number("ERR_ARGVALERR"))
    event = yield fx.ReadEvent(at, int(data))
    if not isinstance(event, fx.Event):
        raise Fault("the controller told no event for this interrupt", "RAPID-R320")
    domain.put(float(event.domain))
    number.put(float(event.number))
    kind.put(float(event.kind))
    for reference, text in zip((title, *texts), (event.title, *event.texts, *[""] * len(texts)), strict=False):
        if reference is not None:
            reference.put(text[:MAX_TEXT])


def _nothing_to_see(*_: Value) -> None:
    """Changes what a controller logs, supervises or buffers; an ideal robot moves the same."""


_TEXTS = r"errstr Argument1, errstr Argument2, errstr Argument3, errstr Argument4, errstr Argument5"
ROUTINES = (
    LibraryRoutine(rf"PROC ErrRaise(string ErrorName, num ErrorId \switch W, {_TEXTS})", _raise, True, task=True),
    LibraryRoutine(r"PROC RaiseToUser(\switch Continue | switch BreakOff \num ErrorNumber)", _raise_to_user, task=True),
    LibraryRoutine(
        rf"PROC IError({ONCE}, errdomain ErrorDomain \num ErrorId, errtype ErrorType, INOUT intnum Interrupt)", _on_error, True, task=True
    ),
    LibraryRoutine("PROC GetTrapData(INOUT trapdata TrapEvent)", _trap_data, task=True),
    LibraryRoutine(
        r"PROC ReadErrData(trapdata TrapEvent, INOUT errdomain ErrorDomain, INOUT num ErrorId, INOUT errtype ErrorType"
        r" \INOUT string Title \INOUT string Str1 \INOUT string Str2 \INOUT string Str3 \INOUT string Str4 \INOUT string Str5)",
        _error_data,
        True,
    ),
    LibraryRoutine("PROC SkipWarn()", _nothing_to_see),
    LibraryRoutine(r"PROC ProcerrRecovery(\switch SyncOrgMoveInst | switch SyncLastMoveInst \switch ProcSignal)", _nothing_to_see),
    LibraryRoutine("PROC ResetPPMoved()", _nothing_to_see),
    LibraryRoutine("PROC ActEventBuffer()", _nothing_to_see),
    LibraryRoutine("PROC DeactEventBuffer()", _nothing_to_see),
    LibraryRoutine(r"PROC CornerPathWarning(\switch On | switch Off)", _nothing_to_see),
    LibraryRoutine(r"PROC MotionSup(\switch On | switch Off \num TuneValue \mecunit MechUnit \switch NoBackoff)", _nothing_to_see),
    LibraryRoutine("PROC PathResol(num PathSampleTime)", _nothing_to_see),
)
