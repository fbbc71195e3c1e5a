"""Deviation of a measured path from an expected one: at the same time, and in space whatever the time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from mitl.metrics.orientation import slerp, turn_between
from mitl.paths import FloatArray, PosePath

_DENSITY = 2e-3  # m, largest spacing of the points among which the nearest segment is looked for
_MOST_POINTS = 2_000_000


@dataclass(frozen=True, eq=False)
class PathDeviation:
    """Deviation of a measured path from an expected one where their times overlap.

    time: (N,) s. vector: (N, 3) m, measured minus expected at the same time. turn: (N, 3) rad, rotation vector from expected to
    measured orientation. nearest: (N,) m, distance from the expected path as a curve, whatever the time.
    """

    time: FloatArray
    vector: FloatArray
    turn: FloatArray
    nearest: FloatArray

    @property
    def distance(self) -> FloatArray:
        """Gives the distance (N,) in m at the same time."""
        return np.asarray(np.linalg.norm(self.vector, axis=1))

    @property
    def angle(self) -> FloatArray:
        """Gives the angle (N,) in rad at the same time."""
        return np.asarray(np.linalg.norm(self.turn, axis=1))


def path_deviation(expected: PosePath, measured: PosePath) -> PathDeviation:
    """Gives the deviation of the valid measured samples from the expected path; both on one clock, see `calibration.time_offset`.

    Raises ValueError where their times do not overlap.
    """
    measured = measured.only_valid().between(expected.time[0], expected.time[-1]) if len(expected) else measured
    if len(measured) == 0 or len(expected) == 0:
        raise ValueError("the two paths have no time in common")
    there = interpolate(expected, measured.time)
    return PathDeviation(
        measured.time,
        measured.position - there.position,
        turn_between(there.quaternion_wxyz, measured.quaternion_wxyz),
        nearest_distance(expected.position, measured.position),
    )


def interpolate(path: PosePath, time: FloatArray) -> PosePath:
    """Gives the path at the times (N,), which lie within it: positions linearly, orientations by slerp, valid where both sides are."""
    if len(path) == 1:
        last = np.zeros(len(time), dtype=int)
        return PosePath(time, path.position[last], path.quaternion_wxyz[last], path.valid[last])
    after = np.clip(np.searchsorted(path.time, time, side="left"), 1, len(path) - 1)
    before = after - 1
    fraction = (time - path.time[before]) / (path.time[after] - path.time[before])
    position = path.position[before] + fraction[:, None] * (path.position[after] - path.position[before])
    quaternion = slerp(path.quaternion_wxyz[before], path.quaternion_wxyz[after], fraction)
    valid = (path.valid[before] | (fraction == 1.0)) & (path.valid[after] | (fraction == 0.0))
    return PosePath(time, position, quaternion, valid)


def nearest_distance(curve: FloatArray, position: FloatArray) -> FloatArray:
    """Gives the distance (N,) of points (N, 3) from the polyline through `curve` (M, 3).

    The nearest two of points at most 2 mm apart are found first, then the distance from the segments beside them: where the curve closes,
    its first and its last point are equally near, and only one of them has the segment.
    """
    points = _dense(curve)
    if len(points) == 1:
        return np.asarray(np.linalg.norm(position - points[0], axis=1))
    _, nearest = cKDTree(points).query(position, k=2, workers=-1)
    distance = np.full(len(position), np.inf)
    for index in np.asarray(nearest).T:
        for start, end in ((np.maximum(index - 1, 0), index), (index, np.minimum(index + 1, len(points) - 1))):
            distance = np.minimum(distance, _segment_distance(position, points[start], points[end]))
    return distance


def _dense(curve: FloatArray) -> FloatArray:
    """Gives the polyline (K, 3) with points repeated at a standstill left out and long segments divided."""
    step = np.linalg.norm(np.diff(curve, axis=0), axis=1)
    kept = np.concatenate([[True], step > 1e-9]) if len(curve) else np.zeros(0, dtype=np.bool_)
    curve = curve[kept]
    if len(curve) < 2:
        return curve
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))])
    density = max(_DENSITY, along[-1] / _MOST_POINTS)
    parts = np.maximum(1, np.ceil(np.diff(along) / density)).astype(int)
    if parts.max() == 1:
        return curve
    owner = np.repeat(np.arange(len(parts)), parts)
    within = np.arange(len(owner)) - np.repeat(np.cumsum(parts) - parts, parts)
    fraction = within / parts[owner]
    inner = curve[owner] + fraction[:, None] * (curve[owner + 1] - curve[owner])
    return np.concatenate([inner, curve[-1:]])


def _segment_distance(position: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Gives the distance (N,) of each point from its own segment, all (N, 3)."""
    direction = end - start
    square = np.einsum("ij,ij->i", direction, direction)
    fraction = np.einsum("ij,ij->i", position - start, direction) / np.where(square > 0.0, square, 1.0)
    foot = start + np.clip(fraction, 0.0, 1.0)[:, None] * direction
    return np.asarray(np.linalg.norm(position - foot, axis=1))
