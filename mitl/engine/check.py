"""`check`: the only way to a verdict. It judges a value by its limit with a guard band, records the result, and lets the case go on."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NoReturn

import numpy as np

from mitl.engine.record import BudgetTerm, CheckRecord
from mitl.engine.recorder import CaseRecorder
from mitl.metrics.decision import GUARD, decide
from mitl.metrics.uncertainty import Budget
from mitl.outcome import Outcome
from mitl.paths import FloatArray
from mitl.recording.records import Series

PER_SI = {"m": 1.0, "mm": 1e3, "rad": 1.0, "deg": math.degrees(1.0), "s": 1.0, "ms": 1e3, "m/s": 1.0, "mm/s": 1e3, "%": 100.0, "": 1.0}
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
        A value that is not finite is ERROR, an infinite uncertainty INCONCLUSIVE. Raises ValueError where limit or uncertainty make no
        sense.
        """
        if any(done.name == name for done in self._recorder.checks):
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
        value, limit, uncertainty = float(value), float(limit), float(uncertainty)
        finite = math.isfinite(value)
        outcome = _decide(value, limit, uncertainty, at_least=at_least) if finite else Outcome.ERROR
        topic = None
        if over_time is not None:
            time, values = (np.asarray(part, dtype=np.float64) for part in over_time)
            topic = self._recorder.add_series(name, Series(time, values[:, None], (f"{name} {unit}".strip(),)))
        self._recorder.checks.append(
            CheckRecord(
                name,
                value if finite else None,
                unit,
                limit,
                uncertainty if math.isfinite(uncertainty) else None,
                outcome,
                at_least=at_least,
                warning=warning,
                series=topic,
                budget=terms,
            )
        )
        if not finite:
            self.message("error", f"{name}: the value is {value}, which is no measurement")
        elif warning and outcome is Outcome.FAIL:
            self.message("warning", f"{name}: {value:.4g} {unit} is out of {limit:.4g} {unit}")
        return outcome

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


def _decide(value: float, limit: float, uncertainty: float, *, at_least: bool) -> Outcome:
    """Gives the guard-banded decision; at_least turns the same guard band round."""
    if not at_least:
        return decide(value, limit, uncertainty).outcome
    guard = GUARD * uncertainty
    if value - guard >= limit:
        return Outcome.PASS
    return Outcome.FAIL if value + guard < limit else Outcome.INCONCLUSIVE
