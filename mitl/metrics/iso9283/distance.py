"""Distance accuracy AD and repeatability RD between two poses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mitl.paths import FloatArray


@dataclass(frozen=True)
class Distance:
    """accuracy: AD, mean attained minus commanded distance, m. repeatability: RD, three times the spread. random: standard error of AD."""

    accuracy: float
    repeatability: float
    random: float


def distance(first: FloatArray, second: FloatArray, commanded: float) -> Distance:
    """Gives AD and RD of points (n, 3) and (n, 3) attained cycle by cycle, `commanded` m apart. Raises ValueError for fewer than two."""
    if len(first) != len(second) or len(first) < 2:
        raise ValueError(f"a distance needs two points in every one of two or more cycles, got {len(first)} and {len(second)}")
    found = np.linalg.norm(second - first, axis=1)
    spread = float(np.std(found, ddof=1))
    return Distance(float(found.mean()) - commanded, 3.0 * spread, spread / np.sqrt(len(found)))
