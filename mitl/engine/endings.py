"""How a case ends: what broke it off goes into its record, and its outcome is put into pytest's terms."""

from __future__ import annotations

import traceback
from pathlib import Path

import pytest

from mitl.engine.check import FatalError
from mitl.engine.recorder import CaseRecorder
from mitl.engine.wording import reason
from mitl.errors import MitlError
from mitl.outcome import Outcome

_CRASHED = {"setup": "the case could not be prepared", "call": "the case crashed", "teardown": "the case could not be ended in order"}


def note(recorder: CaseRecorder, file: Path, error: BaseException, phase: str) -> None:
    """Records what ended a phase (setup, call, teardown) of a case before its time; `file` is the case's own, to name its line."""
    where = _where(file, error)
    match error:
        case FatalError():
            pass  # check.fatal has recorded it
        case pytest.skip.Exception():
            recorder.skipped = True
            recorder.say("info", str(error.msg))
            return
        case KeyboardInterrupt() | pytest.exit.Exception() | SystemExit():
            recorder.error("interrupted before its end")
            recorder.stop_now()
        case MitlError():
            recorder.error(str(error))
        case AssertionError():
            recorder.error(f"an assertion of the case does not hold{where}: {error or 'no text'}; verdicts are made with check()")
        case _:
            recorder.error(f"{_CRASHED[phase]}{where}: {type(error).__name__}: {error}")
    recorder.log.append("".join(traceback.format_exception(error)))


def tell_pytest(recorder: CaseRecorder) -> None:
    """Ends a case that ran to its end: FAIL and ERROR fail, INCONCLUSIVE skips."""
    __tracebackhide__ = True
    so_far = recorder.preview()
    if so_far.outcome in {Outcome.FAIL, Outcome.ERROR}:
        pytest.fail(f"{so_far.outcome.value}: {reason(so_far)}", pytrace=False)
    if so_far.outcome is Outcome.INCONCLUSIVE:
        pytest.skip(f"inconclusive: {reason(so_far)}")


def _where(file: Path, error: BaseException) -> str:
    """Gives the line of the case's own file, where the traceback passes through it."""
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(file)]
    return f" at {file.name}:{lines[-1]}" if lines else ""
