"""The guard-banded decision: a verdict only where the measurement's uncertainty allows one."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

from mitl.outcome import Outcome

GUARD = 1.65  # one-sided 95 % (facts/tracker.md, "What the bench can and cannot judge")


@dataclass(frozen=True)
class Decision:
    """outcome: PASS, FAIL or INCONCLUSIVE. tur: test uncertainty ratio limit / (2 u); infinite for an exact measurement."""

    outcome: Outcome
    tur: float

    @property
    def indicative_only(self) -> bool:
        """Gives whether the report must say that the verdict is indicative only: TUR below 1."""
        return self.tur < 1.0


def decide(value: float, limit: float, uncertainty: float, *, factor: float = GUARD) -> Decision:
    """Gives the verdict on |value| <= limit for a value with a standard uncertainty, all in one unit.

    PASS if |value| + factor u <= limit, FAIL if |value| - factor u > limit, else INCONCLUSIVE, as is an infinite uncertainty.
    factor: of the guard band; larger where the test may be repeated (metrics.sequential).
    Raises ValueError for a value that is not a number, a negative limit or a negative uncertainty.
    """
    if not isfinite(value):
        raise ValueError(f"a verdict needs a finite value, got {value}")
    if not limit >= 0.0:
        raise ValueError(f"a limit must not be negative, got {limit}")
    if not uncertainty >= 0.0:
        raise ValueError(f"an uncertainty must not be negative, got {uncertainty}")
    tur = limit / (2.0 * uncertainty) if uncertainty > 0.0 else float("inf")
    guard = factor * uncertainty
    if abs(value) + guard <= limit:
        return Decision(Outcome.PASS, tur)
    if abs(value) - guard > limit:
        return Decision(Outcome.FAIL, tur)
    return Decision(Outcome.INCONCLUSIVE, tur)
