"""Date and time, tasks, and what a program asks about itself and its controller.

Invariant: the date comes from the controller; a program started twice with the same replies does the same twice.
"""

from __future__ import annotations

from collections.abc import Callable
from datetime import date
from typing import TYPE_CHECKING

from rapid_interp.effects import ReadDate, SourceLine, StopProgram, Wait, WaitForTasks
from rapid_interp.library.table import Effects, LibraryRoutine, text_told
from rapid_interp.meaning.predefined import VMAX_MM_S
from rapid_interp.meaning.types import DNUM, NUM, RapidType, Value
from rapid_interp.running.values import Fault, Reference

if TYPE_CHECKING:
    from rapid_interp.running.task import Stepper

POLL_S = 0.01
"""ASSUMPTION A-48: WaitTestAndSet looks every 10 ms."""
FIRST_BOOKED, MOST_BOOKED = 1.0, 90
"""ASSUMPTION A-49: BookErrNo gives the numbers from 1 on, which no predefined error has."""
_AUTO, _CYCLE = 1.0, 1.0


def _now(at: SourceLine) -> Effects:
    text = text_told((yield ReadDate(at)), "date")
    if len(text) != len("2000-01-31 23:59:59"):
        raise Fault(f"the controller told the date {text!r}, expected YYYY-MM-DD HH:MM:SS", "RAPID-R320")
    return text


def _cdate(at: SourceLine) -> Effects:
    return (yield from _now(at))[:10]


def _ctime(at: SourceLine) -> Effects:
    return (yield from _now(at))[11:]


def _get_time(at: SourceLine, week_day: bool, hour: bool, minute: bool, _second: bool) -> Effects:
    r"""ASSUMPTION A-80: `\WDay` is 1 on Monday to 7 on Sunday."""
    text = yield from _now(at)
    try:
        if week_day:
            return float(date.fromisoformat(text[:10]).isoweekday())
        return float(text[11:13] if hour else text[14:16] if minute else text[17:19])
    except ValueError as problem:
        raise Fault(f"the controller told the date {text!r}, expected YYYY-MM-DD HH:MM:SS", "RAPID-R320") from problem


def _wait_sync(at: SourceLine, in_position: bool, meeting: Value, tasks: Value, time_out: float | None) -> Effects:
    if not meeting:
        raise Fault("the meeting of WaitSyncTask has no name", "RAPID-R342")
    yield WaitForTasks(at, str(meeting), tuple(task[0] for task in tasks), in_position, time_out)


def _test_and_set(flag: Reference) -> bool:
    if flag.get():
        return False
    flag.put(True)
    return True


def _wait_test_and_set(at: SourceLine, flag: Reference) -> Effects:
    while not _test_and_set(flag):
        yield Wait(at, POLL_S)


def _book(task: Stepper, number: Reference) -> None:
    if task.booked_errors >= MOST_BOOKED:
        raise Fault(f"more than {MOST_BOOKED} error numbers are booked", "RAPID-R343")
    number.put(FIRST_BOOKED + task.booked_errors)
    task.booked_errors += 1


def _rand(task: Stepper) -> float:
    """0 to 32767, the same row in every run. ASSUMPTION A-81: the controller's own row is not known."""
    task.random_state = (task.random_state * 1103515245 + 12345) % 2**31
    return float(task.random_state >> 16)


def _type_name(typed: tuple[RapidType, Value]) -> str:
    return "num" if typed[0] is NUM else "dnum" if typed[0] is DNUM else typed[0].name.partition("{")[0]


def _stop(at: SourceLine, *_: Value) -> Effects:
    yield StopProgram(at, at_once=True)


def _always(value: Value) -> Callable[..., Value]:
    return lambda *_: value


ROUTINES = (
    LibraryRoutine("FUNC string CDate()", _cdate, True),
    LibraryRoutine("FUNC string CTime()", _ctime, True),
    LibraryRoutine(r"FUNC num GetTime(\switch WDay | switch Hour | switch Min | switch Sec)", _get_time, True),
    LibraryRoutine(r"PROC WaitSyncTask(\switch InPos, syncident SyncID, tasks TaskList{*} \num TimeOut)", _wait_sync, True),
    LibraryRoutine("FUNC bool TestAndSet(INOUT bool Object)", _test_and_set),
    LibraryRoutine("PROC WaitTestAndSet(INOUT bool Object)", _wait_test_and_set, True),
    LibraryRoutine("PROC BookErrNo(INOUT errnum ErrorName)", _book, task=True),
    LibraryRoutine("PROC Break()", _stop, True),
    LibraryRoutine(r"PROC SystemStopAction(\switch Stop | switch StopBlock | switch Halt)", _stop, True),
    LibraryRoutine(r"FUNC string GetTaskName(\INOUT num TaskNo \INOUT num MecTaskNo)", lambda task, *_: task.name, task=True),
    LibraryRoutine("FUNC num OpMode()", _always(_AUTO)),
    LibraryRoutine(r"FUNC num RunMode(\switch Main)", _always(_CYCLE)),
    LibraryRoutine("FUNC bool RobOS()", _always(True)),
    LibraryRoutine("FUNC string RobName()", _always("ROB_1")),
    LibraryRoutine("FUNC bool TaskRunMec()", _always(True)),
    LibraryRoutine("FUNC bool TaskRunRob()", _always(True)),
    LibraryRoutine("FUNC bool NonMotionMode()", _always(False)),
    LibraryRoutine("FUNC num MaxRobSpeed()", _always(VMAX_MM_S)),
    LibraryRoutine("FUNC num Rand()", _rand, task=True),
    LibraryRoutine("FUNC string Type(anytype Data)", _type_name),
)
