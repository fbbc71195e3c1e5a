"""What the page shows of each case: worded, scaled and drawn here, so that the template only places it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from mitl.engine.reach import unseen
from mitl.engine.record import BudgetTerm, CaseRecord, CheckRecord
from mitl.engine.wording import reason
from mitl.errors import UsageError
from mitl.outcome import Outcome
from mitl.recording.mcap_reader import read_recording
from mitl.report.timeline import MOST_RUNS, Timeline, timeline_of

_MOST_WORDS = 1000


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
    """A check, its bar, and the share of its limit that it uses."""

    check: CheckRecord
    gauge: Gauge | None
    share: float | None

    @property
    def indicative(self) -> bool:
        """Whether the report must call the verdict indicative only (facts/tracker.md): TUR below 1."""
        return self.check.tur is not None and self.check.tur < 1.0


@dataclass(frozen=True)
class CaseView:
    """A case as the page shows it. anchor: unique on the page. worst: the share of its limit that the worst check uses, or None.

    blind: what the rig cannot see in it, or "".
    """

    case: CaseRecord
    anchor: str
    checks: tuple[CheckView, ...]
    budgets: tuple[BudgetView, ...]
    timeline: Timeline | None
    notes: tuple[str, ...]
    reasons: tuple[str, ...]
    worst: float | None
    blind: str

    @property
    def words(self) -> str:
        """What the page's search looks in, in small letters."""
        case = self.case
        parts = [case.id, case.title, *(check.name for check in case.checks), *(message.text[:200] for message in case.messages[:20])]
        return " ".join(" ".join(parts).lower().split())[:_MOST_WORDS]

    @property
    def decisive(self) -> tuple[CheckView, ...]:
        """The checks that made the case what it is, the worst first."""
        mine = [view for view in self.checks if view.check.outcome is self.case.outcome and not view.check.warning]
        return tuple(sorted(mine, key=lambda view: -(view.share or 0.0)))


def case_view(case: CaseRecord, number: int, folder: Path, points: int) -> CaseView:
    """Gives what the page shows of a case, its plots with about so many points; a recording that is gone or broken is noted and costs
    only the plots.
    """
    timeline: Timeline | None = None
    notes: list[str] = []
    if case.recording is not None:
        try:
            recording = read_recording(folder / case.recording)
        except UsageError as error:
            notes.append(f"No plots: {error}")
        else:
            if recording.damage:
                notes.append(f"The recording is incomplete: {recording.damage}")
            timeline = timeline_of(case, recording, points)
            if timeline is not None and timeline.runs > MOST_RUNS:
                notes.append(f"The recording holds {timeline.runs} runs; the first {MOST_RUNS} are drawn.")
    shares = [share for check in case.checks if not check.warning and (share := share_of(check)) is not None]
    return CaseView(
        case,
        f"case-{number}",
        tuple(CheckView(check, _gauge(check), share_of(check)) for check in case.checks),
        _budgets(case),
        timeline,
        tuple(notes),
        tuple(reason(case).splitlines()),
        max(shares, default=None),
        unseen(case),
    )


def share_of(check: CheckRecord) -> float | None:
    """Gives how much of its limit a check uses, 1 where it is just reached."""
    if check.value is None:
        return None
    used, limit = (check.limit, check.value) if check.at_least else (abs(check.value), check.limit)
    return used / limit if limit > 0.0 else None


def _gauge(check: CheckRecord) -> Gauge | None:
    if check.value is None or check.uncertainty is None:
        return None
    value = check.value if check.at_least else abs(check.value)
    guard = check.guard * check.uncertainty
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


SYMBOL = {Outcome.PASS: "✓", Outcome.FAIL: "✗", Outcome.INCONCLUSIVE: "?", Outcome.ERROR: "!", Outcome.SKIPPED: "–"}
