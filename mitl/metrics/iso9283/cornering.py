"""Cornering: round-off error CR and overshoot CO at a sharp corner."""

from __future__ import annotations

import numpy as np

from mitl.metrics.deviation import window_means
from mitl.paths import FloatArray

_SMOOTH = 0.02  # s


def cornering(time: FloatArray, position: FloatArray, corner: FloatArray, before: FloatArray) -> tuple[float, float]:
    """Gives CR and CO in m of a path (N, 3) about `corner` (3,), which it approaches from `before` (3,).

    CR: least distance of the path from the corner. CO: the farthest that the path gets past the corner in the direction of approach,
    0 where it does not.
    """
    smooth = window_means(time, position, _SMOOTH)
    forward = (corner - before) / np.linalg.norm(corner - before)
    return float(np.linalg.norm(smooth - corner, axis=1).min()), max(float(((smooth - corner) @ forward).max()), 0.0)
