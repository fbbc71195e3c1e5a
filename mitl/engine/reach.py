"""What a rig cannot tell: where a check's guard band is wider than its limit, which deviations pass unseen, and what would see them."""

from __future__ import annotations

from math import ceil, inf, sqrt

from mitl.engine.record import CaseRecord, CheckRecord
from mitl.outcome import Outcome

ORACLE = "oracle"
"""Name of the budget's term that no tracker makes smaller: the robot model's own bound."""
CLASSES = ((7.0, "a marker camera system"), (20.0, "a laser tracker"))
"""How many times as quiet as a Vive a class of trackers is, per axis, and its name, from the coarsest on.

ASSUMPTION A-336: a Vive's noise is .17 mm (facts/tracker.md, preset thesis), that of marker cameras .025 mm (Merriaux et al., Sensors 17
(2017) 1591: Vicon), that of laser trackers .008 mm (ISO 10360-10 data of a tracker at 2 m: half of 15 um + 6 um/m, as its maker says is
typical); and every term of a budget but the oracle's falls in that proportion, because noise, calibration and drift all do.
"""


def blind(check: CheckRecord) -> bool:
    """Gives whether no value at all could have passed: the guard band is wider than the limit."""
    return check.outcome is Outcome.INCONCLUSIVE and check.uncertainty is not None and check.guard * check.uncertainty > abs(check.limit)


def unseen(case: CaseRecord) -> str:
    """Gives in a sentence what the blind checks of a case cannot see and which class of tracker could; empty where none is blind."""
    checks = [check for check in case.checks if blind(check) and not check.warning]
    if not checks:
        return ""
    worst = max(checks, key=_times)
    unit = f" {worst.unit}" if worst.unit else ""
    faults = f" of {', '.join(case.catches)}" if case.catches else ""
    share = f"{len(checks)} of {len(case.checks)} checks"
    return (
        f"this rig cannot see what stays small{faults}: in {share} the guard band is wider than the limit "
        f"({worst.name}: told for certain only beyond {seen_beyond(worst):.3g}{unit}); {_remedy(worst)}"
    )


def seen_beyond(check: CheckRecord) -> float:
    """Gives the deviation from which on a check is FAIL for certain, in its unit; infinite where its uncertainty is unknown."""
    return inf if check.uncertainty is None else abs(check.limit) + 2.0 * check.guard * check.uncertainty


def _times(check: CheckRecord) -> float:
    """Gives how many times as quiet a tracker must be for a perfect value to pass; infinite where none could be quiet enough."""
    model = sqrt(sum(term.value**2 for term in check.budget if term.name == ORACLE))
    rest = sqrt(sum(term.value**2 for term in check.budget if term.name != ORACLE))
    left = (abs(check.limit) / check.guard) ** 2 - model**2
    return rest / sqrt(left) if left > 0.0 else inf


def _remedy(check: CheckRecord) -> str:
    if not any(term.name != ORACLE and term.value > 0.0 for term in check.budget):
        return "its budget does not say what of u is the tracker's"
    times = _times(check)
    if times == inf:
        return "no tracker could, because the oracle itself is not known well enough: fit the robot's model to its log (mitl fit-motion)"
    name = next((name for best, name in CLASSES if times <= best), None)
    if name is None:
        return f"a tracker {ceil(times)} times as quiet could, which not even {CLASSES[-1][1]} is"
    return f"a tracker {times:.1f} times as quiet could, as {name} is beside a Vive"
