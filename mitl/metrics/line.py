"""Deviation of points from a straight line between two points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mitl.metrics.deviation import Summary, summarise
from mitl.paths import FloatArray


@dataclass(frozen=True, eq=False)
class LineDeviation:
    """Deviation of N points from the segment start..end, in m.

    across: (N, 3) vectors from the line (unbounded) to the points. sideways, upwards: (N,) signed parts of `across`: horizontal and
    vertical seen along the line (any two directions where the line is vertical). along: (N,) distance from start, growing to end.
    beyond: (N,) how far past an end, negative before start, zero between. distance: (N,) from the segment.
    """

    across: FloatArray
    sideways: FloatArray
    upwards: FloatArray
    along: FloatArray
    beyond: FloatArray
    distance: FloatArray

    def summary(self) -> Summary:
        """Gives the plain numbers of the distance from the unbounded line."""
        return summarise(self.across)


def line_deviation(position: FloatArray, start: FloatArray, end: FloatArray) -> LineDeviation:
    """Gives the deviation of points (N, 3) from the segment between two points (3,). Raises ValueError where these coincide."""
    length = float(np.linalg.norm(end - start))
    if length < 1e-9:
        raise ValueError(f"a line needs two different points, got {start} twice")
    direction = (end - start) / length
    from_start = position - start
    along = from_start @ direction
    across = from_start - along[:, None] * direction
    vertical = np.array([0.0, 0.0, 1.0]) if abs(direction[2]) < 0.9 else np.array([0.0, 1.0, 0.0])
    sideways = np.cross(vertical, direction)
    sideways /= np.linalg.norm(sideways)
    upwards = np.cross(direction, sideways)
    beyond = np.minimum(along, 0.0) + np.maximum(along - length, 0.0)
    distance = np.hypot(np.linalg.norm(across, axis=1), beyond)
    return LineDeviation(across, across @ sideways, across @ upwards, along, beyond, distance)
