"""The difference of two runs: cases that came, went or changed their outcome, and checks whose value moved more than both can explain."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot

from mitl.engine.record import CaseRecord, CheckRecord, RunRecord
from mitl.outcome import Outcome

SIGNIFICANT = 3.0
"""Standard uncertainties of the difference from which on a value counts as moved."""


@dataclass(frozen=True)
class CaseChange:
    """A case in both runs, or in one (the other None)."""

    id: str
    before: Outcome | None
    after: Outcome | None


@dataclass(frozen=True)
class CheckChange:
    """A check in both runs. moved: after minus before, in the check's unit; sigmas: the same in its standard uncertainty (inf: exact)."""

    case_id: str
    before: CheckRecord
    after: CheckRecord
    moved: float
    sigmas: float


@dataclass(frozen=True)
class Difference:
    """What is different. settings: rig, robot, seed, faults and versions as (name, before, after)."""

    settings: tuple[tuple[str, str, str], ...]
    cases: tuple[CaseChange, ...]
    checks: tuple[CheckChange, ...]

    @property
    def worse(self) -> tuple[CaseChange, ...]:
        """Cases that passed before and do not now."""
        return tuple(c for c in self.cases if c.before is Outcome.PASS and c.after not in {Outcome.PASS, None})

    @property
    def better(self) -> tuple[CaseChange, ...]:
        """Cases that pass now and did not before."""
        return tuple(c for c in self.cases if c.after is Outcome.PASS and c.before not in {Outcome.PASS, None})


def difference_of(before: RunRecord, after: RunRecord) -> Difference:
    """Gives what changed from one run to another; checks of one case and name are compared, the farthest moved first."""
    old, new = ({case.id: case for case in run.cases} for run in (before, after))
    cases = [
        CaseChange(name, old[name].outcome if name in old else None, new[name].outcome if name in new else None) for name in {**old, **new}
    ]
    checks = [change for name in old if name in new for change in _checks(old[name], new[name])]
    return Difference(
        tuple(_settings(before, after)),
        tuple(case for case in cases if case.before is not case.after),
        tuple(sorted(checks, key=lambda change: -abs(change.sigmas))),
    )


def _settings(before: RunRecord, after: RunRecord) -> list[tuple[str, str, str]]:
    def facts(run: RunRecord) -> dict[str, str]:
        return {"rig": run.rig, "robot": run.robot, "seed": str(run.seed), "faults": " ".join(run.faults) or "none", **run.versions}

    old, new = facts(before), facts(after)
    return [(name, old.get(name, "—"), new.get(name, "—")) for name in {**old, **new} if old.get(name) != new.get(name)]


def _checks(old: CaseRecord, new: CaseRecord) -> list[CheckChange]:
    former = {check.name: check for check in old.checks}
    found = []
    for check in new.checks:
        known = former.get(check.name)
        if known is None or known.value is None or check.value is None or known.unit != check.unit:
            continue
        moved = check.value - known.value
        sigma = hypot(known.uncertainty or 0.0, check.uncertainty or 0.0)
        sigmas = moved / sigma if sigma > 0.0 else 0.0 if moved == 0.0 else float("inf") if moved > 0.0 else float("-inf")
        if abs(sigmas) >= SIGNIFICANT or known.outcome is not check.outcome:
            found.append(CheckChange(new.id, known, check, moved, sigmas))
    return found
