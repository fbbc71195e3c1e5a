"""Trends: one check over many runs, since when it is bad, and whether it flickers and why.

Invariant: only comparable runs (same rig, robot, faults) make one trend.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from math import sqrt
from statistics import fmean, stdev

from mitl.engine.record import BudgetTerm, CheckRecord
from mitl.history.store import KeptCheck, KeptRun
from mitl.outcome import Outcome

_CAUSE = {
    "random": "tracker",
    "drift": "tracker",
    "scale": "tracker",
    "field": "tracker",
    "jitter": "tracker",
    "registration": "calibration",
    "time": "clock",
    "clock": "clock",
    "latency": "clock",
}
CAUSES = ("tracker", "calibration", "clock", "controller")
_FEWEST = 4
"""Runs below which nothing is said about flickering."""


@dataclass(frozen=True)
class Trend:
    """A check over comparable runs, oldest first."""

    case_id: str
    name: str
    points: tuple[tuple[KeptRun, CheckRecord], ...]

    @property
    def last(self) -> CheckRecord:
        """The check in the newest run."""
        return self.points[-1][1]

    @property
    def bad_since(self) -> KeptRun | None:
        """The first run of the unbroken row of runs, up to the newest, in which it did not pass; None where the newest passed."""
        first = None
        for run, check in reversed(self.points):
            if check.outcome is Outcome.PASS or check.warning:
                break
            first = run
        return first

    @property
    def bad_runs(self) -> int:
        """How many runs that row has."""
        first = self.bad_since
        return 0 if first is None else len(self.points) - [run.id for run, _ in self.points].index(first.id)

    @property
    def values(self) -> list[float]:
        """The values that are numbers."""
        return [check.value for _, check in self.points if check.value is not None]


@dataclass(frozen=True)
class Flicker:
    """How a check's verdict flickers from run to run.

    changes: how often the outcome changed. spread: standard deviation of the values, in the check's unit. distance: how many spreads the
    mean is from the nearest edge of the guard band. causes: share of the spread's variance by cause, 0 to 1, what the budgets explain
    first and the rest to the controller.
    """

    trend: Trend
    changes: int
    spread: float
    distance: float
    causes: dict[str, float]


def trends(checks: Iterable[KeptCheck], like: KeptRun | None = None) -> list[Trend]:
    """Gives the trend of every check, of the runs comparable to `like` or else of each kind of run by itself."""
    grouped: dict[tuple[str, str, str, tuple[str, ...], str], list[tuple[KeptRun, CheckRecord]]] = {}
    for kept in checks:
        run = kept.run
        if like is None or (run.rig, run.robot, run.faults) == (like.rig, like.robot, like.faults):
            grouped.setdefault((run.rig, run.robot, kept.case_id, run.faults, kept.check.name), []).append((run, kept.check))
    return [Trend(key[2], key[4], tuple(points)) for key, points in grouped.items()]


def flicker_of(trend: Trend) -> Flicker | None:
    """Gives how a check flickers, None where it does not or too few runs tell.

    It flickers where its outcome changed back and forth, or where the values' spread reaches an edge of the guard band within two
    standard deviations, so that it will.
    """
    checks = [check for _, check in trend.points if check.value is not None and check.uncertainty is not None]
    turns = [number for number, (a, b) in enumerate(pairwise(checks), start=1) if a.outcome is not b.outcome]
    changes = len(turns)
    if changes == 1:
        checks = checks[turns[0] :]  # one change is a step, which `bad_since` tells; what flickers is what comes after it
    if len(checks) < _FEWEST:
        return None
    values = [check.value if check.at_least else abs(check.value) for check in checks if check.value is not None]
    spread = stdev(values)
    last = checks[-1]
    guard = last.guard * (last.uncertainty or 0.0)
    edges = [last.limit - guard, last.limit + guard]
    gap = min(abs(fmean(values) - edge) for edge in edges)
    distance = gap / spread if spread > 0.0 else float("inf")
    if changes < 2 and distance > 2.0:
        return None
    return Flicker(trend, changes, spread, distance, _causes(checks, spread))


def _causes(checks: list[CheckRecord], spread: float) -> dict[str, float]:
    """Gives the share of each cause: budgets' variances as far as the spread's variance goes, the rest is the controller's."""
    total = spread**2
    if total <= 0.0:
        return dict.fromkeys(CAUSES, 0.0)
    known = dict.fromkeys(CAUSES, 0.0)
    for check in checks:
        for term in check.budget:
            known[cause_of(term)] += term.value**2 / len(checks)
    explained = sum(known.values())
    scale = min(1.0, total / explained) / total if explained > 0.0 else 0.0
    shares = {cause: variance * scale for cause, variance in known.items()}
    shares["controller"] += max(0.0, 1.0 - sum(shares.values()))
    return shares


def cause_of(term: BudgetTerm) -> str:
    """Gives the cause that a term of a budget stands for; what is no tracker, calibration or clock is counted as the controller's."""
    words = term.name.lower().replace("-", " ").split()
    return next((_CAUSE[word] for word in words if word in _CAUSE), "controller")


def calibration_drift(runs: list[KeptRun]) -> list[tuple[KeptRun, float, float]]:
    """Gives for every run with a calibration: held-out rms in mm, and how far the tracker's base moved in mm since the run before."""
    found: list[tuple[KeptRun, float, float]] = []
    before: tuple[float, ...] | None = None
    for run in runs:
        if run.calibration is None:
            continue
        residual, *place = run.calibration[:4]
        moved = 0.0 if before is None else sqrt(sum((a - b) ** 2 for a, b in zip(place, before, strict=True)))
        found.append((run, residual, moved))
        before = tuple(place)
    return found
