"""PosePath: timed poses as arrays, the one currency between trackers, oracles, metrics and reports.

Invariant: time is the first axis and strictly increases; quaternions are unit, scalar first.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.intp]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class PosePath:
    """Poses of one frame in another over time.

    time: (N,) s, strictly increasing, on the clock of whoever recorded it.
    position: (N, 3) m. quaternion_wxyz: (N, 4) unit. valid: (N,) bool, false where the source said the pose is not to be used.
    Raises ValueError where shapes disagree or time does not increase.
    """

    time: FloatArray
    position: FloatArray
    quaternion_wxyz: FloatArray
    valid: BoolArray

    def __post_init__(self) -> None:
        n = len(self.time)
        shapes = (self.time.shape, self.position.shape, self.quaternion_wxyz.shape, self.valid.shape)
        if shapes != ((n,), (n, 3), (n, 4), (n,)):
            raise ValueError(f"expected shapes (N,), (N, 3), (N, 4), (N,), got {shapes}")
        if n > 1 and not np.all(np.diff(self.time) > 0):
            at = int(np.argmin(np.diff(self.time)))
            raise ValueError(f"time must increase strictly; it does not after sample {at} (t = {self.time[at]:.6f} s)")

    def __len__(self) -> int:
        return len(self.time)

    def between(self, start: float, stop: float) -> PosePath:
        """Gives the samples with start <= time <= stop, in s of the path's own clock."""
        chosen = (self.time >= start) & (self.time <= stop)
        return self.select(chosen)

    def select(self, chosen: BoolArray) -> PosePath:
        """Gives the samples where `chosen` (N,) is true."""
        return PosePath(self.time[chosen], self.position[chosen], self.quaternion_wxyz[chosen], self.valid[chosen])

    def only_valid(self) -> PosePath:
        """Gives the samples that the source called valid."""
        return self.select(self.valid)

    def shifted(self, seconds: float) -> PosePath:
        """Gives the same poses with `seconds` added to every time."""
        return replace(self, time=self.time + seconds)
