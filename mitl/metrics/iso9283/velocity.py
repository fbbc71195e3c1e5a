"""Path velocity accuracy AV, repeatability RV and fluctuation FV."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mitl.paths import FloatArray


@dataclass(frozen=True)
class Velocity:
    """accuracy: AV as a share of the commanded speed. repeatability: RV, a share. fluctuation: FV in m/s. random: standard error of AV."""

    accuracy: float
    repeatability: float
    fluctuation: float
    random: float


def path_velocity(speeds: Sequence[FloatArray], commanded: float) -> Velocity:
    """Gives the criteria of the speeds (N,) in m/s of every pass in the middle half of its path. Raises ValueError for fewer than three.

    Smooth the speeds before: FV is the largest difference of two of them in one pass, noise and all.
    """
    if len(speeds) < 3:
        raise ValueError(f"a path velocity needs at least three passes, got {len(speeds)}")
    means = np.array([values.mean() for values in speeds])
    spread = float(np.std(means, ddof=1)) / commanded
    return Velocity(
        float(means.mean()) / commanded - 1.0,
        3.0 * spread,
        max(float(np.ptp(values)) for values in speeds),
        spread / np.sqrt(len(means)),
    )
