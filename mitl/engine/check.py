"""`check`: the only way to a verdict. It judges a value by its limit with a guard band, records the result, and lets the case go on."""

from __future__ import annotations

import math
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import NoReturn

import numpy as np

from mitl.engine.judging import Look, Question
from mitl.engine.record import BudgetTerm
from mitl.engine.recorder import CaseRecorder
from mitl.errors import MitlError
from mitl.metrics.uncertainty import Budget
from mitl.outcome import Outcome
from mitl.paths import FloatArray
from mitl.recording.records import Series

PER_SI = {
    "m": 1.0,
    "mm": 1e3,
    "rad": 1.0,
    "deg": math.degrees(1.0),
    "s": 1.0,
    "ms": 1e3,
    "m/s": 1.0,
    "mm/s": 1e3,
    "m/s^2": 1.0,
    "%": 100.0,
    "": 1.0,
}
LEVELS = ("info", "warning", "error")


class FatalError(BaseException):
    """Ends the case and the run. No Exception, so that a case cannot swallow it by accident, as with pytest's own outcomes."""


class Check:
    """The fixture `check` of one case."""

    def __init__(self, recorder: CaseRecorder) -> None:
        self._recorder = recorder

    def __call__(
        self,
        name: str,
        *,
        value: float,
        limit: float,
        uncertainty: float | None = None,
        unit: str = "mm",
        at_least: bool = False,
        warning: bool = False,
        budget: Budget | Mapping[str, float] | None = None,
        over_time: tuple[FloatArray, FloatArray] | None = None,
    ) -> Outcome:
        """Judges |value| <= limit (or value >= limit with at_least) and gives the outcome; the case goes on whatever it is.

        value, limit and the standard uncertainty are in `unit`. warning: out of limit is recorded as a warning and fails nothing.
        budget: what made the uncertainty, kept for the report: a metrics Budget in SI, which is converted to `unit` and is the
        uncertainty where none is given, or terms in `unit`. over_time: (time in s, value in `unit`), drawn in the report with the limit.
        In a case that is repeated, the mean of all rounds is judged with the wider guard band of a sequential test (metrics.sequential).
        A value that is not finite is ERROR, an infinite uncertainty INCONCLUSIVE. Raises ValueError where limit or uncertainty make no
        sense.
        """
        if self._recorder.subtest is not None:
            name = f"{self._recorder.subtest}: {name}"
        if name in self._recorder.made:
            raise ValueError(f"check {name!r} was already made in this case; give each check a name of its own")
        if not math.isfinite(limit) or (limit < 0.0 and not at_least):
            raise ValueError(f"check {name!r}: expected a finite limit >= 0, got {limit}")
        terms = _terms(budget, unit)
        if uncertainty is None:
            if not isinstance(budget, Budget):
                raise ValueError(f"check {name!r}: give its uncertainty, or a Budget that it follows from")
            uncertainty = budget.combined * _per_si(unit)
        if not uncertainty >= 0.0:
            raise ValueError(f"check {name!r}: expected an uncertainty >= 0, got {uncertainty}")
        topic = None
        if over_time is not None:
            time, values = (np.asarray(part, dtype=np.float64) for part in over_time)
            topic = self._recorder.add_series(name, Series(time, values[:, None], (f"{name} {unit}".strip(),)))
        question = Question(name, unit, float(limit), at_least, warning, topic, self._recorder.subtest, self._recorder.most_looks)
        record = self._recorder.look(question, Look(float(value), float(uncertainty), terms))
        if record.value is None:
            self.message("error", f"{name}: the value is {value}, which is no measurement")
        elif warning and record.outcome is Outcome.FAIL:
            self.message("warning", f"{name}: {record.value:.4g} {unit} is out of {limit:.4g} {unit}")
        return record.outcome

    @contextmanager
    def subtest(self, name: str) -> Iterator[None]:
        """Judges a part of the case by itself: its checks are named after it, and an error in it ends the part while the case goes on.

        What ends a case on purpose (check.fatal, pytest.skip, an interrupt) passes through. A sub-test in another is
        the outer one's error.
        """
        if self._recorder.subtest is not None:
            raise ValueError(f"sub-test {name!r} lies in {self._recorder.subtest!r}: sub-tests do not nest")
        self._recorder.begin_subtest(name)
        try:
            yield
        except Exception as error:  # noqa: BLE001 - whatever it is, it is recorded as this part's error
            text = str(error) if isinstance(error, MitlError) else f"{type(error).__name__}: {error}"
            self._recorder.subtest_error(f"{name}: {text}", "".join(traceback.format_exception(error)))
        finally:
            self._recorder.end_subtest()

    def operator(self, text: str) -> None:
        """Records what the operator is told. Nobody is waited for: a night run has no operator."""
        self._recorder.say("operator", text)

    def attach(self, name: str, content: bytes) -> None:
        """Keeps a file in the case's recording. Raises ValueError for a name that is taken."""
        if name in self._recorder.attachments:
            raise ValueError(f"attachment {name!r} is there already; give each a name of its own")
        self._recorder.attachments[name] = content

    def message(self, level: str, text: str) -> None:
        """Records a message: info, warning or error. None of them changes the outcome."""
        if level not in LEVELS:
            raise ValueError(f"message level {level!r}: expected one of {', '.join(LEVELS)}; check.fatal ends the run")
        self._recorder.say(level, text)

    def fatal(self, text: str) -> NoReturn:
        """Stops the robot at once, ends the case (ERROR unless something failed already), and lets no other case run."""
        self._recorder.fatal = True
        self._recorder.broken = True
        self._recorder.say("fatal", text)
        self._recorder.stop_now()
        raise FatalError(text)


def _per_si(unit: str) -> float:
    """Gives how many of `unit` make one of the SI unit of its kind."""
    if unit not in PER_SI:
        raise ValueError(
            f"unit {unit!r}: a Budget can be converted to {', '.join(name or 'none' for name in PER_SI)}; give terms in the unit"
        )
    return PER_SI[unit]


def _terms(budget: Budget | Mapping[str, float] | None, unit: str) -> tuple[BudgetTerm, ...]:
    if budget is None:
        return ()
    if isinstance(budget, Budget):
        return tuple(BudgetTerm(term.name, float(term.value) * _per_si(unit), term.source) for term in budget.terms)
    return tuple(BudgetTerm(name, float(size)) for name, size in budget.items())
