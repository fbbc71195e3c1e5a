"""The choice: cases that together find the most in the time there is, by an integer program that HiGHS solves (scipy.optimize.milp).

Invariant: what is chosen fits into the time, and no case that was left out could be added to it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp

from mitl.errors import MitlError
from mitl.outcome import Outcome

TO_LOOK_AT = frozenset({Outcome.FAIL, Outcome.ERROR})
"""Outcomes that make a case urgent. What was inconclusive has been repeated already, and may stay so on this rig."""


@dataclass(frozen=True)
class Offer:
    """A case that may be run. seconds: of the rig's time. finds: fault to the probability that this case finds it.

    urgency: what it is worth beside, in faults found. last: its outcome in the latest run, or None.
    """

    case: str
    seconds: float
    finds: Mapping[str, float] = field(default_factory=dict)
    urgency: float = 0.0
    last: Outcome | None = None


@dataclass(frozen=True)
class Night:
    """A plan. chosen: in the order in which they should run. seconds: of the rig's time, with `before`, the calibration.

    found: fault to the probability that at least one chosen case finds it, of all faults that any case could find.
    """

    budget: float
    before: float
    chosen: tuple[Offer, ...]
    left_out: tuple[Offer, ...]
    found: Mapping[str, float]

    @property
    def seconds(self) -> float:
        """Gives how long the night takes."""
        return self.before + sum(offer.seconds for offer in self.chosen)


def plan(offers: Sequence[Offer], budget: float, *, before: float = 0.0) -> Night:
    """Gives the night. budget: s of the rig's time, of which `before` s go to what comes before the first case.

    Maximised is the expected number of faults found, each counted up to 1, and the urgencies. Where the time does not even reach for one
    case, none is chosen. Raises MitlError where the solver gives up.
    """
    faults = sorted({fault for offer in offers for fault in offer.finds})
    chosen = _solved(offers, faults, budget - before)
    left = [offer for offer in offers if offer not in chosen]
    found = {fault: _found(fault, chosen) for fault in faults}
    return Night(budget, before, tuple(_ordered(chosen)), tuple(sorted(left, key=lambda offer: offer.case)), found)


def _solved(offers: Sequence[Offer], faults: Sequence[str], seconds: float) -> list[Offer]:
    """Variables: whether each case runs (0 or 1), then how far each fault is found (0 to 1), no further than its cases find it together."""
    count = len(offers)
    if not count or seconds <= 0.0:
        return []
    finds = np.array([[offer.finds.get(fault, 0.0) for offer in offers] for fault in faults]).reshape(len(faults), count)
    worth = np.concatenate([[offer.urgency for offer in offers], np.ones(len(faults))])
    time = np.concatenate([[offer.seconds for offer in offers], np.zeros(len(faults))])
    constraints = [LinearConstraint(time, -np.inf, seconds)]
    if faults:
        constraints.append(LinearConstraint(np.hstack([-finds, np.eye(len(faults))]), -np.inf, 0.0))
    whole = np.concatenate([np.ones(count), np.zeros(len(faults))])
    answer = milp(-worth, constraints=constraints, integrality=whole, bounds=Bounds(0.0, 1.0), options={"mip_rel_gap": 0.0})
    if answer.x is None:
        raise MitlError(f"no choice of cases was found: {answer.message}")
    return [offer for offer, runs in zip(offers, answer.x[:count], strict=True) if runs > 0.5]


def _ordered(chosen: Sequence[Offer]) -> list[Offer]:
    """Gives what failed the last time first, then always the case that adds most a second: a night that breaks off has the best."""
    left, done = list(chosen), list[Offer]()
    while left:
        best = max(left, key=lambda offer: (offer.last in TO_LOOK_AT, _added(offer, done) / offer.seconds, offer.case))
        left.remove(best)
        done.append(best)
    return done


def _added(offer: Offer, done: Sequence[Offer]) -> float:
    return offer.urgency + sum(_found(fault, [*done, offer]) - _found(fault, done) for fault in offer.finds)


def _found(fault: str, offers: Sequence[Offer]) -> float:
    """Gives the probability that at least one finds the fault, taken as independent."""
    return 1.0 - float(np.prod([1.0 - offer.finds.get(fault, 0.0) for offer in offers]))
