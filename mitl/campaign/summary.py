"""What a campaign tells: rates with exact bounds.

Invariant: a rate is never told without its Clopper-Pearson bounds; ERROR counts as not detected, and as a false alarm.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from scipy.stats import beta

from mitl.campaign.trial import TrialResult

CONFIDENCE = 0.95
WANTED = 0.95
"""Rate of detection that counts as found."""


@dataclass(frozen=True)
class Rate:
    """hits of count, with two-sided 95 % bounds after Clopper and Pearson."""

    hits: int
    count: int

    @property
    def value(self) -> float:
        """Gives the rate; not a number without trials."""
        return self.hits / self.count if self.count else float("nan")

    @property
    def low(self) -> float:
        """Gives the lower bound."""
        return float(beta.ppf((1 - CONFIDENCE) / 2, self.hits, self.count - self.hits + 1)) if self.hits else 0.0

    @property
    def high(self) -> float:
        """Gives the upper bound."""
        return float(beta.ppf((1 + CONFIDENCE) / 2, self.hits + 1, self.count - self.hits)) if self.hits < self.count else 1.0


@dataclass(frozen=True)
class Detection:
    """How often a case failed with a fault of a size; case None: at least one of the cases that name it."""

    fault: str
    size: float
    case: str | None
    rate: Rate


@dataclass(frozen=True)
class FalseAlarm:
    """How often a case failed, or could not be judged, on a sound controller; open: how often it was inconclusive."""

    case: str
    rate: Rate
    open: Rate


def detections(results: Iterable[TrialResult]) -> list[Detection]:
    """Gives the rates of detection, by fault, size and case, the rate of any case last."""
    counts: dict[tuple[str, float], dict[str | None, list[int]]] = {}
    for result in results:
        if result.fault is None:
            continue
        name, _, size = result.fault.partition("=")
        here = counts.setdefault((name, float(size)), {})
        seen: dict[str | None, bool] = {case: outcome == "fail" for case, outcome in result.outcomes.items()}
        seen[None] = any(seen.values())
        for case, hit in seen.items():
            pair = here.setdefault(case, [0, 0])
            pair[0] += hit
            pair[1] += 1
    return [
        Detection(fault, size, case, Rate(*here[case]))
        for (fault, size), here in sorted(counts.items())
        for case in [*sorted(name for name in here if name is not None), None]
    ]


def false_alarms(results: Iterable[TrialResult]) -> list[FalseAlarm]:
    """Gives how often each case failed on a sound controller."""
    outcomes: dict[str, list[str]] = {}
    for result in results:
        if result.fault is None:
            for case, outcome in result.outcomes.items():
                outcomes.setdefault(case, []).append(outcome)
    return [
        FalseAlarm(
            case,
            Rate(sum(outcome in {"fail", "error"} for outcome in found), len(found)),
            Rate(sum(outcome == "inconclusive" for outcome in found), len(found)),
        )
        for case, found in sorted(outcomes.items())
    ]


def smallest_found(found: Sequence[Detection]) -> dict[str, float | None]:
    """Gives for every fault the smallest size from which on, in size, at least one case failed in 95 of 100; None if there is none."""
    smallest: dict[str, float | None] = {}
    for fault in dict.fromkeys(one.fault for one in found):
        sizes = sorted((abs(one.size), one.rate.value) for one in found if one.fault == fault and one.case is None)
        best = None
        for size, rate in reversed(sizes):
            if rate < WANTED:
                break
            best = size
        smallest[fault] = best
    return smallest
