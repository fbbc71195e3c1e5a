"""Messages to the operator, and stopping.

Invariant: a line has at most 80 characters, as a RAPID string.
"""

from __future__ import annotations

from rapid_interp.effects import SourceLine, StopProgram, Write
from rapid_interp.library.table import Effects, LibraryRoutine
from rapid_interp.meaning.types import BOOL, DNUM, NUM, ORIENT, POS, Value
from rapid_interp.running.format import printed


def _tp_write(at: SourceLine, text: str, num: Value, truth: Value, pos: Value, orient: Value, dnum: Value) -> Effects:
    for kind, value in ((NUM, num), (BOOL, truth), (POS, pos), (ORIENT, orient), (DNUM, dnum)):
        if value is not None:
            text += printed(kind, value)
    yield Write(at, text)


def _tp_erase() -> None:
    """The display is cleared: nothing that an oracle or a test can see."""


def _stop(at: SourceLine, *_: bool) -> Effects:
    yield StopProgram(at)


def _error_write(at: SourceLine, _quiet: bool, header: str, *lines: Value) -> Effects:
    yield Write(at, " ".join(line for line in (header, *lines) if isinstance(line, str)))


def _by_the_compiler() -> None:
    """These change where the task is: `meaning.recovery` compiles them."""


def _error_log(at: SourceLine, number: float, _warning: bool, _info: bool, *lines: str) -> Effects:
    yield Write(at, " ".join([f"{number:g}", *(line for line in lines if line)]))


ROUTINES = (
    LibraryRoutine(
        r"PROC ErrLog(num ErrorID \switch W | switch I, errstr Argument1, errstr Argument2, errstr Argument3, errstr Argument4,"
        " errstr Argument5)",
        _error_log,
        True,
    ),
    LibraryRoutine("PROC ExitCycle()", _by_the_compiler),
    LibraryRoutine("PROC ResetRetryCount()", _by_the_compiler),
    LibraryRoutine("PROC CallByVar(string Name, num Number)", _by_the_compiler),
    LibraryRoutine(r"PROC TPWrite(string String \num Num | bool Bool | pos Pos | orient Orient | dnum Dnum)", _tp_write, True),
    LibraryRoutine("PROC TPErase()", _tp_erase),
    LibraryRoutine(r"PROC TPShow(num Window)", lambda _: None),
    LibraryRoutine(r"PROC Stop(\switch NoRegain | switch AllMoveTasks)", _stop, True),
    LibraryRoutine(
        r"PROC ErrWrite(\switch W | switch I, string Header, string Reason \string RL2 \string RL3 \string RL4)",
        lambda at, w, _i, header, *lines: _error_write(at, w, header, *lines),
        True,
    ),
)
