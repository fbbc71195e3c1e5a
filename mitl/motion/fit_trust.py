"""How far a fit's uncertainties can be trusted: what is left unexplained beside the log's own noise, and what that widens.

Least squares tells how well parameters are known if the model is right. Invariant: where held-out moves are explained worse than the
fitted ones, or much worse than the noise, uncertainties grow.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb, radians, sqrt

import numpy as np

from mitl.paths import FloatArray

CORRELATED = 0.1
"""Time in s over which a log's residuals count as one: a model's errors are smooth. ASSUMPTION A-275."""
TRUSTED = 3.0
"""Times the noise up to which held-out residuals are those of the log and not of the model. ASSUMPTION A-262."""
LEAST_NOISE = radians(1e-3)
"""What a log of joints in rad is taken to be uncertain by at least: its resolution. ASSUMPTION A-262."""
_QUIETEST = 0.2
_QUIETEST_OF_NORMAL = 0.2533
"""Below it lies a share _QUIETEST of the absolute values of a standard normal distribution."""
_DIFFERENCES = 5
"""Differences taken of a log: a filtered motion's are far below its noise's, at rest and under way."""
_OF_DIFFERENCES = sqrt(comb(2 * _DIFFERENCES, _DIFFERENCES))


@dataclass(frozen=True)
class Misfit:
    """Root mean squares in rad: the logs' noise, what is left on the moves fitted to and on those held out; moves and s fitted to."""

    noise: float
    fitted: float
    held_out: float
    moves: int
    seconds: float

    @property
    def ratio(self) -> float:
        """Gives how many times the noise is left on the moves held out."""
        return self.held_out / max(self.noise, LEAST_NOISE)

    @property
    def trusted(self) -> bool:
        """Gives whether what is left is the log's noise, so that the uncertainties mean what they say."""
        return self.ratio <= TRUSTED

    @property
    def widening(self) -> float:
        """Gives the factor on uncertainties that were told by the residuals of the moves fitted to, CORRELATED s by CORRELATED s.

        Held-out moves say how large the model's errors are where it was not fitted to (the root of a reduced chi squared). Where these
        errors are the model's and not noise, those of a move are alike all along it, and count as one.
        """
        scale = max(self.held_out / self.fitted, 1.0) if self.fitted > 0 else 1.0
        alike = 1.0 if self.trusted or self.moves == 0 else sqrt(max(self.seconds / (CORRELATED * self.moves), 1.0))
        return float(scale * alike)


def noise_of(joints: FloatArray) -> float:
    """Gives the noise in rad of evenly sampled joints (N, 6), by high differences where they are smallest: at rest or even speed."""
    if len(joints) <= 2 * _DIFFERENCES:
        return 0.0
    differences = np.abs(np.diff(joints, _DIFFERENCES, axis=0))
    axes = np.quantile(differences, _QUIETEST, axis=0) / (_QUIETEST_OF_NORMAL * _OF_DIFFERENCES)
    return float(np.sqrt(np.mean(axes**2)))
