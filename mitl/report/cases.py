"""What the page shows of each case: worded, scaled and drawn here, so that the template only places it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from markupsafe import Markup

from mitl.engine.case_recording import RecordedRun, runs_of
from mitl.engine.record import BudgetTerm, CaseRecord, CheckRecord
from mitl.engine.wording import reason
from mitl.errors import UsageError
from mitl.metrics.decision import GUARD
from mitl.metrics.path import nearest_distance
from mitl.outcome import Outcome
from mitl.paths import PosePath
from mitl.recording.mcap_reader import read_recording
from mitl.recording.records import Recording
from mitl.report.plots import Limit, deviation_plot, path_plot

MOST_RUNS = 6
"""Runs of a case whose paths are drawn; the recording has all of them."""


@dataclass(frozen=True)
class Term:
    """A budget term with its share of the variance, 0 to 100."""

    term: BudgetTerm
    share: float


@dataclass(frozen=True)
class Gauge:
    """Where things lie on a check's bar, in per cent of its width: value, its guard band, and the limit."""

    value: float
    low: float
    high: float
    limit: float


@dataclass(frozen=True)
class BudgetView:
    """An uncertainty budget and the checks that share it."""

    names: tuple[str, ...]
    unit: str
    uncertainty: float | None
    terms: tuple[Term, ...]


@dataclass(frozen=True)
class CheckView:
    """A check and its bar."""

    check: CheckRecord
    gauge: Gauge | None

    @property
    def indicative(self) -> bool:
        """Whether the report must call the verdict indicative only (facts/tracker.md): TUR below 1."""
        return self.check.tur is not None and self.check.tur < 1.0


@dataclass(frozen=True)
class Plot:
    """A picture with what stands under it and what it is called for those who do not see it."""

    svg: Markup
    title: str
    alt: str
    legend: tuple[tuple[str, str], ...]
    wide: bool = False


@dataclass(frozen=True)
class CaseView:
    """A case as the page shows it. anchor: unique on the page. worst: the share of its limit that the worst check uses, or None."""

    case: CaseRecord
    anchor: str
    checks: tuple[CheckView, ...]
    budgets: tuple[BudgetView, ...]
    plots: tuple[Plot, ...]
    notes: tuple[str, ...]
    reasons: tuple[str, ...]
    worst: float | None


def case_view(case: CaseRecord, number: int, folder: Path) -> CaseView:
    """Gives what the page shows of a case; a recording that is gone or broken is noted and costs only the plots."""
    plots: list[Plot] = []
    notes: list[str] = []
    if case.recording is not None:
        try:
            recording = read_recording(folder / case.recording)
        except UsageError as error:
            notes.append(f"No plots: {error}")
        else:
            if recording.damage:
                notes.append(f"The recording is incomplete: {recording.damage}")
            runs = runs_of(recording)
            plots = [*_run_plots(case, runs[:MOST_RUNS], number), *_series_plots(case, recording, number)]
            if len(runs) > MOST_RUNS:
                notes.append(f"The recording holds {len(runs)} runs; the first {MOST_RUNS} are drawn.")
    shares = [share for check in case.checks if not check.warning and (share := _share(check)) is not None]
    return CaseView(
        case,
        f"case-{number}",
        tuple(CheckView(check, _gauge(check)) for check in case.checks),
        _budgets(case),
        tuple(plots),
        tuple(notes),
        tuple(reason(case).splitlines()),
        max(shares, default=None),
    )


def _share(check: CheckRecord) -> float | None:
    """Gives how much of its limit a check uses, 1 where it is just reached."""
    if check.value is None:
        return None
    used, limit = (check.limit, check.value) if check.at_least else (abs(check.value), check.limit)
    return used / limit if limit > 0.0 else None


def _gauge(check: CheckRecord) -> Gauge | None:
    if check.value is None or check.uncertainty is None:
        return None
    value = check.value if check.at_least else abs(check.value)
    guard = GUARD * check.uncertainty
    full = 1.08 * max(value + guard, check.limit, 1e-12)
    low, middle, high, limit = (100.0 * min(1.0, max(0.0, x / full)) for x in (value - guard, value, value + guard, check.limit))
    return Gauge(round(middle, 2), round(low, 2), round(high, 2), round(limit, 2))


def _budgets(case: CaseRecord) -> tuple[BudgetView, ...]:
    """Gives the budgets of a case, each once, its terms largest first and without those that are nothing."""
    sharing: dict[tuple[tuple[BudgetTerm, ...], str, float | None], list[str]] = {}
    for check in case.checks:
        if check.budget:
            sharing.setdefault((check.budget, check.unit, check.uncertainty), []).append(check.name)
    views = []
    for (budget, unit, uncertainty), names in sharing.items():
        total = sum(term.value**2 for term in budget)
        ordered = sorted((term for term in budget if term.value > 0.0), key=lambda term: -term.value)
        views.append(BudgetView(tuple(names), unit, uncertainty, tuple(Term(term, 100.0 * term.value**2 / total) for term in ordered)))
    return tuple(views)


def _series_plots(case: CaseRecord, recording: Recording, number: int) -> list[Plot]:
    """Gives a plot for every check that kept what it judged."""
    plots = []
    for index, check in enumerate(case.checks):
        series = recording.series.get(check.series or "")
        if series is None or len(series.time) == 0 or not np.isfinite(series.values).any():
            continue
        guard = GUARD * (check.uncertainty or 0.0)
        svg = deviation_plot(series.time, series.values[:, 0], [Limit(check.limit, guard, check.at_least)], salt=f"{number}s{index}")
        unit = f" in {check.unit}" if check.unit else ""
        largest = float(np.nanmax(np.abs(series.values)))
        alt = f"{check.name}{unit} over time, largest {largest:.3g}, limit {check.limit:.3g}"
        plots.append(Plot(Markup(svg), f"{check.name}{unit}", alt, (("measured", "value"), ("limit", "limit with guard band"))))  # noqa: S704 - made by matplotlib from numbers only
    return plots


def _run_plots(case: CaseRecord, runs: list[RecordedRun], number: int) -> list[Plot]:
    """Gives for every run its path and, where no check kept a series, the distance from the oracle's path."""
    has_series = any(check.series for check in case.checks)
    plots = []
    for index, run in enumerate(runs):
        name = f"Run {run.name}" if len(runs) > 1 else "Path"
        tool, oracle = _millimetres(run.tool), _millimetres(run.oracle)
        if tool is None and oracle is None:
            continue
        legend = [("oracle", "oracle")] * (oracle is not None) + [("measured", "recorded")] * (tool is not None) + [("start", "start")]
        svg = path_plot(oracle, tool, salt=f"{number}p{index}")
        alt = f"{name}: the tool in the work object, two planes. " + _extent("Oracle", oracle) + _extent("Recorded", tool)
        plots.append(Plot(Markup(svg), f"{name}: the tool in the work object", alt.strip(), tuple(legend), wide=True))  # noqa: S704 - made by matplotlib from numbers only
        if has_series or run.tool is None or tool is None or oracle is None:
            continue
        distance = nearest_distance(oracle, tool)
        limits = sorted({check.limit for check in case.checks if check.unit == "mm" and not (check.at_least or check.warning)})
        shown = [Limit(limits[0], 0.0)] if len(limits) == 1 else []
        svg = deviation_plot(run.tool.time, distance, shown, salt=f"{number}d{index}")
        alt = f"{name}: distance from the oracle's path in mm over time, largest {np.max(distance):.3g}"
        with_limit = (("limit", "limit"),) if shown else ()
        plots.append(Plot(Markup(svg), f"{name}: distance from the oracle's path in mm", alt, (("measured", "recorded"), *with_limit)))  # noqa: S704 - made by matplotlib from numbers only
    return plots


def _millimetres(path: PosePath | None) -> np.ndarray[tuple[int, int], np.dtype[np.float64]] | None:
    if path is None:
        return None
    valid = path.only_valid().position * 1e3
    valid = valid[np.isfinite(valid).all(axis=1)]
    return valid if len(valid) else None


def _extent(name: str, points: np.ndarray[tuple[int, int], np.dtype[np.float64]] | None) -> str:
    if points is None:
        return f"{name}: none. "
    low, high = points.min(axis=0), points.max(axis=0)
    spans = ", ".join(f"{axis} {a:.0f} to {b:.0f}" for axis, a, b in zip("xyz", low, high, strict=True))
    return f"{name}: {spans} mm. "


SYMBOL = {Outcome.PASS: "✓", Outcome.FAIL: "✗", Outcome.INCONCLUSIVE: "?", Outcome.ERROR: "!", Outcome.SKIPPED: "–"}
