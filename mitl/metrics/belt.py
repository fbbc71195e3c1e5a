"""The way of a conveyor belt from the recording of a device that lies on it, and a tool's path beside the moving belt.

Invariant: the belt runs along one straight line, whose direction the recording itself tells.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mitl.metrics.deviation import window_means
from mitl.paths import FloatArray, PosePath

_SMOOTHED = 0.02
"""Seconds over which the belt's way is averaged: its drive takes longer to change the speed by what would be seen."""
_LEAST_WAY = 0.02
"""A belt that moves less than this (m) does not tell its direction."""


@dataclass(frozen=True, eq=False)
class BeltWay:
    """How far a belt had gone: time (N,) s, way (N,) m from where it stood at first, direction (3,) in the frame of the points."""

    time: FloatArray
    way: FloatArray
    direction: FloatArray

    def at(self, time: FloatArray) -> FloatArray:
        """Gives the ways (K,) in m at times (K,) s, held at both ends of the recording."""
        return np.interp(time, self.time, self.way)


def belt_way(time: FloatArray, points: FloatArray, standing_until: float) -> BeltWay:
    """Gives the way of a belt from places (N, 3) m of a device on it at times (N,) s; up to `standing_until` s it stands.

    Raises ValueError where the recording has no standstill, or no way to tell the direction from.
    """
    still = time <= standing_until
    if not still.any():
        raise ValueError(
            f"expected the belt to stand at first, up to {standing_until:.2f} s; the recording begins at {time.min(initial=np.inf):.2f} s"
        )
    moved = points - points[still].mean(axis=0)
    direction = np.linalg.svd(moved, full_matrices=False)[2][0]
    way = moved @ direction
    if np.abs(way).max() < _LEAST_WAY:
        raise ValueError(f"expected the belt to move by {1e3 * _LEAST_WAY:g} mm at least, it moved by {1e3 * np.abs(way).max():.1f} mm")
    sign = float(np.sign(way[np.argmax(np.abs(way))]))
    return BeltWay(time, window_means(time, sign * way[:, None], _SMOOTHED)[:, 0], sign * direction)


def beside_belt(path: PosePath, belt: BeltWay, direction: FloatArray) -> PosePath:
    """Gives a tool's path less the belt's way at the same times. direction: (3,) of the belt in the frame of the path."""
    return replace(path, position=path.position - belt.at(path.time)[:, None] * direction)
