"""report.html: one self-contained page, a pure function of a run's folder."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from urllib.parse import quote

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from mitl.calibration.result import Calibration
from mitl.calibration.store import load_calibration
from mitl.engine.results import read_run
from mitl.errors import UsageError
from mitl.outcome import Outcome
from mitl.recording.atomic import replacing
from mitl.report.cases import SYMBOL, case_view

FILE_NAME = "report.html"
_ORDER = (Outcome.FAIL, Outcome.ERROR, Outcome.INCONCLUSIVE, Outcome.PASS, Outcome.SKIPPED)


def write_report(folder: Path) -> Path:
    """Makes the report of a run's folder and gives its path. Raises UsageError where the folder holds no run."""
    target = folder / FILE_NAME
    text = render(folder)
    with replacing(target) as beside:
        beside.write_text(text, encoding="utf-8")
    return target


def render(folder: Path) -> str:
    """Gives the page's text."""
    run = read_run(folder)
    views = [case_view(case, number, folder) for number, case in enumerate(run.cases)]
    counts = Counter(case.outcome for case in run.cases)
    environment = Environment(
        loader=PackageLoader("mitl.report"), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters.update(number=_number, percent=_percent, duration=_duration, href=quote)
    return environment.get_template("report.html").render(
        run=run,
        cases=views,
        counts=[(outcome, counts[outcome]) for outcome in _ORDER if counts[outcome]],
        to_look_at=[view for outcome in _ORDER[:3] for view in views if view.case.outcome is outcome],
        symbol=SYMBOL,
        calibration=_calibration(folder),
        style=Markup((Path(__file__).parent / "templates" / "style.css").read_text(encoding="utf-8")),  # noqa: S704 - our own file
    )


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


def _percent(value: float | None) -> str:
    return "—" if value is None else f"{100.0 * value:.0f} %"


def _duration(seconds: float) -> str:
    minutes, rest = divmod(seconds, 60.0)
    if minutes < 1.0:
        return f"{rest:.1f} s"
    hours, minutes = divmod(int(minutes), 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {rest:.0f} s"
