"""A test that may be repeated while it is inconclusive, with error rates fixed beforehand.

Looking several times at growing data and stopping at the first verdict would raise the rate of wrong verdicts. Pocock's constants widen the
guard band, the same at every look, so that the rate over all looks stays 5 % on either side of the limit.
Invariant: repeating averages the random part of the uncertainty alone; what all repeats share stays.
"""

from __future__ import annotations

from math import inf, sqrt

from mitl.metrics.decision import GUARD, decide
from mitl.outcome import Outcome

POCOCK = (GUARD, 1.875, 1.992, 2.067, 2.122, 2.164, 2.197, 2.225, 2.249, 2.270)
"""Guard factors for at most 1, 2, ... 10 looks, one-sided 5 % (Pocock 1977; Jennison and Turnbull 2000, table 2.1, two-sided 10 %).

They are for looks after equal increments of white noise. A shared part makes the looks more alike, so that the rate is lower still.
"""


def guard_factor(looks: int) -> float:
    """Gives the factor of the guard band for a test of at most `looks` looks. Raises ValueError outside 1 to 10."""
    if not 1 <= looks <= len(POCOCK):
        raise ValueError(f"a test may look 1 to {len(POCOCK)} times, not {looks}")
    return POCOCK[looks - 1]


def worth_repeating(value: float, limit: float, *, random: float, shared: float, looks: int, at_least: bool = False) -> bool:
    """Gives whether a verdict is in sight if the value stays as it is until the last of `looks`.

    random: standard uncertainty of a single look; shared: of what repeats do not average; the unit of value and limit. An extra half of
    `random` is granted, by which the mean may still move.
    """
    at_end = sqrt(shared**2 + random**2 / looks)
    if at_end == inf:
        return False
    reach = max(0.0, guard_factor(looks) * at_end - 0.5 * random)
    if at_least:
        return abs(value - limit) >= reach
    return decide(value, limit, reach / GUARD).outcome is not Outcome.INCONCLUSIVE
