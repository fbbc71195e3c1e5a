"""From the looks at a value to its verdict: pure, so that a stored run can be judged again by the same rule.

Invariant: of several looks the mean is judged; only the budget's random term falls with their number.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from mitl.engine.record import BudgetTerm, CheckRecord
from mitl.metrics.decision import decide
from mitl.metrics.sequential import guard_factor, worth_repeating
from mitl.outcome import Outcome

RANDOM = "random"
"""Name of the term that repeating averages."""


@dataclass(frozen=True)
class Look:
    """One measurement of a value with its standard uncertainty and the terms that made it, all in the check's unit."""

    value: float
    uncertainty: float
    terms: tuple[BudgetTerm, ...] = ()

    @property
    def random(self) -> float:
        """Gives what of the uncertainty differs from look to look; 0 where the budget does not tell."""
        explained = math.sqrt(sum(term.value**2 for term in self.terms))
        if not math.isclose(explained, self.uncertainty, rel_tol=1e-6):
            return 0.0
        return sum(term.value for term in self.terms if term.name == RANDOM)


@dataclass(frozen=True)
class Question:
    """What is asked of a value: its name, unit and limit, and what becomes of the answer. looks: the most that may be taken."""

    name: str
    unit: str
    limit: float
    at_least: bool = False
    warning: bool = False
    series: str | None = None
    subtest: str | None = None
    looks: int = 1


def judged(question: Question, looks: Sequence[Look]) -> CheckRecord:
    """Gives the verdict on all looks at a value so far; one that is not finite makes it ERROR."""
    value = math.fsum(look.value for look in looks) / len(looks) if all(math.isfinite(look.value) for look in looks) else math.nan
    uncertainty, terms = _combined(looks)
    factor = guard_factor(question.looks)
    finite = math.isfinite(value)
    return CheckRecord(
        name=question.name,
        value=value if finite else None,
        unit=question.unit,
        limit=question.limit,
        uncertainty=uncertainty if math.isfinite(uncertainty) else None,
        outcome=verdict(value, question.limit, uncertainty, at_least=question.at_least, factor=factor) if finite else Outcome.ERROR,
        at_least=question.at_least,
        warning=question.warning,
        series=question.series,
        budget=terms,
        looks=len(looks),
        guard=factor,
        subtest=question.subtest,
    )


def verdict(value: float, limit: float, uncertainty: float, *, at_least: bool, factor: float) -> Outcome:
    """Gives the guard-banded decision on |value| <= limit; at_least turns the same guard band round, for value >= limit."""
    if not at_least:
        return decide(value, limit, uncertainty, factor=factor).outcome
    guard = factor * uncertainty
    if value - guard >= limit:
        return Outcome.PASS
    return Outcome.FAIL if value + guard < limit else Outcome.INCONCLUSIVE


def promising(question: Question, looks: Sequence[Look]) -> bool:
    """Gives whether more looks at a value may still bring a verdict."""
    record = judged(question, looks)
    if record.value is None or record.outcome is not Outcome.INCONCLUSIVE or len(looks) >= question.looks:
        return False
    random = math.sqrt(math.fsum(look.random**2 for look in looks) / len(looks))
    if random == 0.0 or record.uncertainty is None:
        return False
    shared = math.sqrt(max(0.0, record.uncertainty**2 - random**2 / len(looks)))
    return worth_repeating(record.value, question.limit, random=random, shared=shared, looks=question.looks, at_least=question.at_least)


def _combined(looks: Sequence[Look]) -> tuple[float, tuple[BudgetTerm, ...]]:
    """Gives the uncertainty of the mean, and its terms: random by the root of the number of looks, of any other the largest."""
    if len(looks) == 1:
        return looks[0].uncertainty, looks[0].terms
    largest = max(look.uncertainty for look in looks)
    if not all(look.random for look in looks):
        return largest, max(looks, key=lambda look: look.uncertainty).terms
    terms = []
    for term in looks[0].terms:
        same = [other.value for look in looks for other in look.terms if other.name == term.name]
        size = math.sqrt(math.fsum(value**2 for value in same)) / len(looks) if term.name == RANDOM else max(same)
        terms.append(BudgetTerm(term.name, size, term.source))
    return math.sqrt(math.fsum(term.value**2 for term in terms)), tuple(terms)
