"""What the page plots of a case on one time axis: a recording to packed columns, run by run.

Time 0 of a run is where the order was given, the oracle's clock; the check's own series are on it already. Positions are X_OT in mm.
Invariant: of every column that is drawn the extremes are kept, however few points are left.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mitl.engine.case_recording import RecordedRun, runs_of
from mitl.engine.record import CaseRecord, CheckRecord
from mitl.metrics.path import nearest_distance
from mitl.metrics.speed import velocity
from mitl.paths import FloatArray, PosePath
from mitl.recording.records import LogMessage, Recording, Series
from mitl.report.columns import packed
from mitl.report.data import MOST_TEXT, events_of, finite, moves_of, positions_at, signals_of
from mitl.report.decimation import keep_extremes, with_gaps

MOST_RUNS = 8
"""Runs of a case that are drawn; the recording has all of them."""
_SMOOTHING = 0.1
"""Seconds over which a tracker's positions are fitted to show a speed; shorter windows show its noise."""


@dataclass(frozen=True)
class Timeline:
    """data: JSON values for the page. runs: how many the recording holds. alt: the same in words, for those who do not see it.

    placed: whether a run tells where its work object is, so that it can be replayed beside the robot.
    """

    data: dict[str, Any]
    runs: int
    alt: str
    placed: bool


def timeline_of(case: CaseRecord, recording: Recording, points: int) -> Timeline | None:
    """Gives what is to be drawn with about so many points a run, None where the recording has nothing to draw."""
    runs = runs_of(recording)
    shown = [run for run in runs if run.tool is not None or run.oracle is not None][:MOST_RUNS]
    checks = _with_series(case.checks, recording)
    if not shown and not checks:
        return None
    per_run = max(60, points // max(1, len(shown)))
    mine = _shared_out(checks, shown)
    drawn = [
        _run(case, run, [(check, recording.series[check.series or ""]) for check in own], recording.log, per_run)
        for run, own in zip(shown or [RecordedRun("", None, None, None)], mine, strict=True)
    ]
    alt = " ".join(_alt(run, own) for run, own in zip(shown, mine, strict=False)) or _words(checks)
    return Timeline({"runs": drawn}, len(runs), alt, any(run.X_BO is not None for run in shown))


def _with_series(checks: Sequence[CheckRecord], recording: Recording) -> list[CheckRecord]:
    found = [(check, recording.series.get(check.series or "")) for check in checks]
    return [check for check, series in found if series is not None and len(series.time) and np.isfinite(series.values).any()]


def _shared_out(checks: list[CheckRecord], runs: list[RecordedRun]) -> list[list[CheckRecord]]:
    """Gives each run its checks: those whose topic names it, the longest name first; what names none goes to the first."""
    own: list[list[CheckRecord]] = [[] for _ in runs] or [[]]
    for check in checks:
        named = [number for number, run in enumerate(runs) if run.name and f"-{run.name}" in f"-{(check.series or '').rpartition('/')[2]}"]
        own[max(named, key=lambda number: len(runs[number].name)) if named else 0].append(check)
    return own


def _run(
    case: CaseRecord, run: RecordedRun, checks: list[tuple[CheckRecord, Series]], log: Sequence[LogMessage], points: int
) -> dict[str, Any]:
    limit = min((check.limit for check in case.checks if check.unit == "mm" and not (check.at_least or check.warning)), default=None)
    return {
        "name": run.name,
        "path": _path(run, points),
        "limit": limit,
        "checks": [_check(check, series, points) for check, series in checks],
        "moves": moves_of(run),
        "signals": signals_of(run),
        "events": events_of(run, log),
    }


def _path(run: RecordedRun, points: int) -> dict[str, Any] | None:
    """Gives measured and expected positions, speeds and their distance at the same times; None where there is neither."""
    tool = None if run.tool is None else finite(run.tool.shifted(-run.shift))
    oracle = None if run.oracle is None else finite(run.oracle.shifted(-run.shift))
    lead = tool if tool is not None else oracle
    if lead is None:
        return None
    gap = np.full((len(lead), 3), np.nan)
    measured = gap if tool is None else 1e3 * tool.position
    expected = gap if oracle is None else 1e3 * positions_at(oracle, lead.time)
    distance = 1e3 * nearest_distance(oracle.position, tool.position) if tool is not None and oracle is not None else gap[:, 0]
    speeds = [_speed(tool, lead.time, _SMOOTHING), _speed(oracle, lead.time, 0.0)]
    table = np.column_stack([measured, expected, distance, *speeds])
    time, table = with_gaps(lead.time, table)
    columns = ("mx", "my", "mz", "ox", "oy", "oz", "d", "sm", "so")
    telling = [6, 7, 8] if tool is not None and oracle is not None else [0, 1, 2, 7] if tool is not None else [3, 4, 5, 8]
    chosen = keep_extremes(table[:, telling], max(points, 24))
    return {"t": packed(time[chosen]), **{name: packed(column) for name, column in zip(columns, table[chosen].T, strict=True)}}


def _speed(path: PosePath | None, time: FloatArray, window: float) -> FloatArray:
    """Gives the speed in mm/s at times (N,), nan where there is no path."""
    if path is None:
        return np.full(len(time), np.nan)
    speed = 1e3 * np.linalg.norm(velocity(path, window), axis=1)
    return np.asarray(np.interp(time, path.time, speed, left=0.0, right=0.0))


def _check(check: CheckRecord, series: Series, points: int) -> dict[str, Any]:
    time, rows = with_gaps(series.time, series.values[:, :1])
    chosen = keep_extremes(rows, max(points // 2, 24))
    return {
        "name": check.name[:MOST_TEXT],
        "unit": check.unit[:40],
        "limit": check.limit,
        "guard": check.guard * (check.uncertainty or 0.0),
        "atLeast": check.at_least,
        "outcome": check.outcome.value,
        "t": packed(time[chosen]),
        "v": packed(rows[chosen, 0]),
    }


def _alt(run: RecordedRun, checks: list[CheckRecord]) -> str:
    name = f"Run {run.name}: " if run.name else ""
    return f"{name}{_extent('oracle', run.oracle)}{_extent('recorded', run.tool)}{_words(checks)}"


def _words(checks: list[CheckRecord]) -> str:
    found = [f"{check.name} {'no number' if check.value is None else f'{check.value:.3g}'} {check.unit}".strip() for check in checks]
    return f"judged over time: {', '.join(found)}." if found else ""


def _extent(name: str, path: PosePath | None) -> str:
    path = None if path is None else finite(path)
    if path is None:
        return ""
    low, high = 1e3 * path.position.min(axis=0), 1e3 * path.position.max(axis=0)
    spans = ", ".join(f"{axis} {a:.0f} to {b:.0f}" for axis, a, b in zip("xyz", low, high, strict=True))
    return f"{name} {spans} mm; "
