"""The record of a run: frozen, and the one thing that reports, JUnit and exit codes are made from. It judges no value."""

from __future__ import annotations

from dataclasses import dataclass

from mitl.metrics.decision import GUARD
from mitl.outcome import Outcome, worst

SCHEMA = 1


@dataclass(frozen=True)
class BudgetTerm:
    """One term of an uncertainty budget: a standard uncertainty in the unit of its check, and where it comes from."""

    name: str
    value: float
    source: str = ""


@dataclass(frozen=True)
class CheckRecord:
    """One check: |value| against limit with standard uncertainty, all in `unit`.

    value: None where it was not a finite number. uncertainty: None where it is unknown (infinite). at_least: the value must reach the
    limit instead of staying within it. warning: out of limit is worth a warning and does not count towards the case's outcome.
    series: topic of the check's series in the recording. looks: how many times it was measured; value is their mean. guard: factor of the
    guard band by which it was judged. subtest: name of the sub-test that made it, which its name begins with.
    """

    name: str
    value: float | None
    unit: str
    limit: float
    uncertainty: float | None
    outcome: Outcome
    at_least: bool = False
    warning: bool = False
    series: str | None = None
    budget: tuple[BudgetTerm, ...] = ()
    looks: int = 1
    guard: float = GUARD
    subtest: str | None = None

    @property
    def margin(self) -> float | None:
        """What is left to the limit, in the check's unit; negative beyond it."""
        if self.value is None:
            return None
        return self.value - self.limit if self.at_least else self.limit - abs(self.value)

    @property
    def tur(self) -> float | None:
        """Test uncertainty ratio, limit / (2 u); None where the uncertainty is 0 or unknown."""
        return abs(self.limit) / (2.0 * self.uncertainty) if self.uncertainty else None


@dataclass(frozen=True)
class SubtestRecord:
    """One part of a case that is judged by itself: an error in it ends the part, not the case."""

    name: str
    outcome: Outcome


@dataclass(frozen=True)
class Message:
    """Something said during a case: level is info, operator, warning, error or fatal."""

    level: str
    text: str


@dataclass(frozen=True)
class CaseRecord:
    """What one case did and found.

    duration_s: on the rig's clock, so that the same seed gives the same number. recording, log: file names in the run's folder.
    program: file name of the RAPID module; source: its text as it ran.
    """

    id: str
    title: str
    outcome: Outcome
    duration_s: float = 0.0
    checks: tuple[CheckRecord, ...] = ()
    messages: tuple[Message, ...] = ()
    recording: str | None = None
    purpose: str = ""
    requirement: str = ""
    limit_source: str = ""
    catches: tuple[str, ...] = ()
    program: str | None = None
    source: str | None = None
    log: str | None = None
    subtests: tuple[SubtestRecord, ...] = ()


@dataclass(frozen=True)
class RunRecord:
    """One run: which rig, which seed, which versions, which cases in which order.

    started: ISO 8601 with offset. wall_s: how long it took in real time. faults: as given, NAME or NAME=SIZE. interrupted: true as long as
    cases are missing, so that the record of a killed run says so. judged_from: the run whose recordings were judged again, if so.
    health: why the rig's latest health check does not vouch for it, or "".
    """

    rig: str
    robot: str
    seed: int
    cases: tuple[CaseRecord, ...]
    versions: dict[str, str]
    faults: tuple[str, ...] = ()
    started: str = ""
    wall_s: float = 0.0
    interrupted: bool = False
    judged_from: str | None = None
    health: str = ""

    @property
    def outcome(self) -> Outcome:
        """The outcome of the whole; a run that did not finish is at best ERROR, because it judged only a part."""
        return worst([*(case.outcome for case in self.cases), *([Outcome.ERROR] if self.interrupted else [])])
