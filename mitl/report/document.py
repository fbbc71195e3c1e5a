"""report.html: one self-contained page, a pure function of a run's folder."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from urllib.parse import quote

from jinja2 import Environment, PackageLoader, StrictUndefined

from mitl.calibration.result import Calibration
from mitl.calibration.store import load_calibration
from mitl.engine.results import read_run
from mitl.errors import UsageError
from mitl.outcome import Outcome
from mitl.report import assets
from mitl.report.cases import SYMBOL, CaseView, case_view
from mitl.report.data import json_in_page
from mitl.report.replay import replay_page, write_page
from mitl.report.since import read_since
from mitl.report.takes import takes_of_run

FILE_NAME = "report.html"
REPLAY_NAME = "replay.html"
_ORDER = (Outcome.FAIL, Outcome.ERROR, Outcome.INCONCLUSIVE, Outcome.PASS, Outcome.SKIPPED)
_SCRIPTS = ("vendor/uplot.min.js", "vendor/zdog.min.js", "templates/plots.js", "templates/space.js", "templates/page.js")
_MOST_POINTS, _LEAST_POINTS, _ALL_POINTS = 1500, 250, 70_000
"""Points drawn of a case, and of all together, so that the page of a long run stays small."""
_MOST_OPEN = 3


def write_report(folder: Path) -> Path:
    """Makes the report of a run's folder, the replay that it links to, and gives its path. Raises UsageError where there is no run."""
    target = folder / FILE_NAME
    run = read_run(folder)
    takes = takes_of_run(run, folder)
    if takes:
        points = max(_LEAST_POINTS, min(_MOST_POINTS, _ALL_POINTS // len(takes)))
        write_page(folder / REPLAY_NAME, replay_page(takes, points=points, back=FILE_NAME))
    write_page(target, render(folder))
    return target


def render(folder: Path) -> str:
    """Gives the page's text."""
    run = read_run(folder)
    points = max(_LEAST_POINTS, min(_MOST_POINTS, _ALL_POINTS // max(1, len(run.cases))))
    views = [case_view(case, number, folder, points) for number, case in enumerate(run.cases)]
    counts = Counter(case.outcome for case in run.cases)
    programs = list(dict.fromkeys((case.program or "program", case.source) for case in run.cases if case.source is not None))
    environment = Environment(
        loader=PackageLoader("mitl.report"), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters.update(number=_number, share=_share, times=_times, duration=_duration, href=quote, data=json_in_page)
    return environment.get_template("report.html").render(
        run=run,
        cases=views,
        counts=[(outcome, counts[outcome]) for outcome in _ORDER if counts[outcome]],
        to_look_at=[view for outcome in _ORDER[:3] for view in _worst_first(views) if view.case.outcome is outcome],
        open=_open(views),
        symbol=SYMBOL,
        replay=REPLAY_NAME,
        since=read_since(folder),
        programs=programs,
        program_of={
            view.anchor: programs.index((view.case.program or "program", view.case.source))
            for view in views
            if view.case.source is not None
        },
        calibration=_calibration(folder),
        style=assets.style("vendor/uplot.min.css", "templates/theme.css", "templates/style.css"),
        scripts=assets.script(*_SCRIPTS),
        policy=assets.policy(*_SCRIPTS),
    )


def _open(views: list[CaseView]) -> set[str]:
    """Gives the anchors of the cases that stand open at first: what needs a look, or else the first that has something to show."""
    to_look_at = [view.anchor for outcome in _ORDER[:3] for view in _worst_first(views) if view.case.outcome is outcome]
    return set((to_look_at or [view.anchor for view in views if view.timeline is not None][:1])[:_MOST_OPEN])


def _worst_first(views: list[CaseView]) -> list[CaseView]:
    return sorted(views, key=lambda view: -(view.worst or 0.0))


def _calibration(folder: Path) -> Calibration | None:
    try:
        return load_calibration(folder / "calibration.toml")
    except UsageError:
        return None


def _number(value: float | None, digits: int = 4) -> str:
    """Gives a number for people: so many significant digits, a true minus sign, a dash for none."""
    if value is None:
        return "—"
    whole = 10.0**digits <= abs(value) < 1e7
    return (f"{value:.0f}" if whole else f"{value:.{digits}g}").replace("-", "−")


def _share(value: float | None) -> str:
    """Gives a share in per cent, or as a multiple where per cent would be hard to read."""
    return "—" if value is None else f"{100.0 * value:.0f} %" if value < 10.0 else _times(value)


def _times(value: float | None) -> str:
    return "" if value is None else f"× {value:.3g}" if value < 1000.0 else "× > 1000"


def _duration(seconds: float) -> str:
    minutes, rest = divmod(seconds, 60.0)
    if minutes < 1.0:
        return f"{rest:.1f} s"
    hours, minutes = divmod(int(minutes), 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {rest:.0f} s"
