"""Drift of pose accuracy dAP and of repeatability dRP over a long time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mitl.metrics.iso9283.repeatability import rp
from mitl.paths import FloatArray


def pose_drift(batches: Sequence[FloatArray]) -> tuple[float, float]:
    """Gives dAP and dRP in m of batches of points (n, 3): the largest distance of a batch's mean from the first one's, change of its RP.

    Raises ValueError for fewer than two batches.
    """
    if len(batches) < 2:
        raise ValueError(f"a drift needs at least two batches, got {len(batches)}")
    means = np.array([points.mean(axis=0) for points in batches])
    spreads = np.array([rp(points) for points in batches])
    return float(np.linalg.norm(means - means[0], axis=1).max()), float(np.abs(spreads - spreads[0]).max())
