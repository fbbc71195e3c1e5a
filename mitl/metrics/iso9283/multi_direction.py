"""Multi-directional pose accuracy variation vAP: how far apart the barycentres from several directions of approach lie."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.distance import pdist

from mitl.paths import FloatArray


def multi_directional(attained: Sequence[FloatArray]) -> tuple[float, float]:
    """Gives vAP in m of the points (n, 3) attained from each direction, and its standard uncertainty from their scatter.

    Raises ValueError for fewer than two directions or two cycles.
    """
    if len(attained) < 2 or min(len(points) for points in attained) < 2:
        raise ValueError("a multi-directional variation needs two directions with two cycles each, at least")
    means = np.array([points.mean(axis=0) for points in attained])
    random = max(float(np.max(np.std(points, axis=0, ddof=1))) / np.sqrt(len(points)) for points in attained)
    return float(pdist(means).max()), float(np.sqrt(2.0)) * random
