"""The trend page: every check over the runs with its limit, what is bad since when, what flickers and why, and the calibration's drift."""

from __future__ import annotations

from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from mitl.history.store import KeptRun, Store
from mitl.history.trend import CAUSES, Flicker, Trend, calibration_drift, flicker_of, trends
from mitl.outcome import Outcome
from mitl.report import assets
from mitl.report.data import json_in_page

_SCRIPTS = ("vendor/uplot.min.js", "templates/plots.js", "templates/trend.js")
_MOST_RUNS = 500


def trend_page(store: Store, like: KeptRun) -> str:
    """Gives the page's text for the runs that are comparable to `like`, of which at most the newest 500 are drawn."""
    runs = [run for run in store.runs() if (run.rig, run.robot, run.faults) == (like.rig, like.robot, like.faults)][-_MOST_RUNS:]
    number = {run.id: index for index, run in enumerate(runs)}
    found = sorted(trends((check for check in store.checks() if check.run.id in number), like), key=_order)
    drift = calibration_drift(runs)
    data = {
        "runs": [[run.id, run.started[:16].replace("T", " "), run.seed, run.outcome.value] for run in runs],
        "trends": [_drawn(trend, number) for trend in found],
        "calibration": [[number[run.id], residual, moved] for run, residual, moved in drift],
    }
    rows = [(trend, flicker_of(trend)) for trend in found]
    environment = Environment(
        loader=PackageLoader("mitl.report"), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    return environment.get_template("trend.html").render(
        like=like,
        runs=runs,
        rows=rows,
        bad=sum(trend.bad_since is not None for trend in found),
        flickering=sum(flicker is not None for _, flicker in rows),
        why=why,
        data=json_in_page(data),
        style=assets.style("vendor/uplot.min.css", "templates/theme.css", "templates/style.css"),
        scripts=assets.script(*_SCRIPTS),
        policy=assets.policy(*_SCRIPTS),
    )


def why(flicker: Flicker) -> str:
    """Gives in words how a check flickers and what causes it."""
    shares = ", ".join(f"{cause} {100 * flicker.causes[cause]:.0f} %" for cause in CAUSES if flicker.causes[cause] >= 0.05)
    edge = f"mean {flicker.distance:.1f} spreads from an edge of the guard band"
    return f"{flicker.changes} changes of outcome, {edge}; spread {flicker.spread:.3g}: {shares or 'none'}"


def _order(trend: Trend) -> tuple[int, str, str]:
    rank = {Outcome.FAIL: 0, Outcome.ERROR: 1, Outcome.INCONCLUSIVE: 2}
    return rank.get(trend.last.outcome, 3), trend.case_id, trend.name


def _drawn(trend: Trend, number: dict[str, int]) -> dict[str, Any]:
    checks = [check for _, check in trend.points]
    return {
        "unit": trend.last.unit,
        "atLeast": trend.last.at_least,
        "x": [number[run.id] for run, _ in trend.points],
        "v": [check.value if check.value is None or check.at_least else abs(check.value) for check in checks],
        "limit": [check.limit for check in checks],
        "guard": [check.guard * (check.uncertainty or 0.0) for check in checks],
    }
