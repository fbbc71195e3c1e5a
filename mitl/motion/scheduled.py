"""ScheduledChain: a chain of moves with the time at which it begins. A record is a row of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mitl.motion.chain import Chain
from mitl.motion.lag import behind_at
from mitl.paths import FloatArray


@dataclass(frozen=True, eq=False)
class ScheduledChain:
    """A chain that begins at `start` s, the lagged path coordinate `behind` m behind it."""

    start: float
    chain: Chain
    behind: float = 0.0

    @property
    def end(self) -> float:
        """Gives the time in s at which the plan comes to rest."""
        return self.start + self.chain.timing.duration

    @property
    def first(self) -> float:
        """Gives the path coordinate in m at which the chain begins."""
        return float(self.chain.timing.position[0])

    @property
    def last(self) -> float:
        """Gives the path coordinate in m at which the plan comes to rest, or goes on in the next chain."""
        timing = self.chain.timing
        return float(timing.at(np.array([timing.duration]))[0][0])

    def behind_at(self, time: FloatArray, lag: float) -> FloatArray:
        """Gives how far (N,) in m the lagged path coordinate is behind the plan at times (N,) s, from `start` on."""
        return behind_at(self.chain.timing, lag, self.behind, time - self.start)
