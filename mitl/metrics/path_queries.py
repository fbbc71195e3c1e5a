"""What one asks of a tracked path: the pose at a time, the closest point, the average, the difference of two paths.

A section is `PosePath.between`, velocities are `metrics.speed.velocity`. Only valid samples are interpolated or averaged.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.metrics.orientation import slerp
from mitl.metrics.path import interpolate
from mitl.metrics.stillness import jitter_diameter
from mitl.paths import FloatArray, PosePath
from mitl.protocols import AveragedPoint


@dataclass(frozen=True, eq=False)
class ClosestPoint:
    """The point of a path that is closest to a position: its time in s, pose (7,) x y z qw qx qy qz, and distance in m."""

    time: float
    pose: FloatArray
    distance: float


def pose_at(path: PosePath, time: float) -> FloatArray:
    """Gives the pose (7,) at a time, between the samples on either side. Raises ValueError outside the path's valid samples."""
    valid = path.only_valid()
    if len(valid) == 0 or not valid.time[0] <= time <= valid.time[-1]:
        span = f"{valid.time[0]:.6g} to {valid.time[-1]:.6g} s" if len(valid) else "no valid sample"
        raise ValueError(f"the path has no pose at {time:.6g} s: it has {span}")
    found = interpolate(valid, np.array([time]))
    return np.concatenate([found.position[0], found.quaternion_wxyz[0]])


def closest_point(path: PosePath, position: FloatArray) -> ClosestPoint:
    """Gives the point on the way from sample to sample that is closest to a position (3,). Raises ValueError without valid samples."""
    valid = path.only_valid()
    if len(valid) == 0:
        raise ValueError("the path has no valid sample")
    if len(valid) == 1:
        pose = np.concatenate([valid.position[0], valid.quaternion_wxyz[0]])
        return ClosestPoint(float(valid.time[0]), pose, float(np.linalg.norm(position - pose[:3])))
    start, step = valid.position[:-1], np.diff(valid.position, axis=0)
    square = np.sum(step**2, axis=1)
    share = np.clip(np.sum((position - start) * step, axis=1) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    distance = np.linalg.norm(start + share[:, None] * step - position, axis=1)
    at = int(np.argmin(distance))
    time = valid.time[at] + share[at] * (valid.time[at + 1] - valid.time[at])
    turned = slerp(valid.quaternion_wxyz[at : at + 1], valid.quaternion_wxyz[at + 1 : at + 2], share[at : at + 1])[0]
    return ClosestPoint(float(time), np.concatenate([start[at] + share[at] * step[at], turned]), float(distance[at]))


def average(path: PosePath) -> AveragedPoint:
    """Gives the average of the valid samples. Raises ValueError where there is none."""
    valid = path.only_valid()
    if len(valid) == 0:
        raise ValueError(f"none of {len(path)} samples is valid: there is nothing to average")
    mean = Rotation.from_quat(valid.quaternion_wxyz, scalar_first=True).mean()
    return AveragedPoint(
        time=0.5 * float(path.time[0] + path.time[-1]),
        position=valid.position.mean(axis=0),
        quaternion_wxyz=mean.as_quat(canonical=True, scalar_first=True),
        jitter=jitter_diameter(valid.position),
        count=len(valid),
    )


def difference(reference: PosePath, measured: PosePath) -> PosePath:
    """Gives, at the valid samples of `measured` within the reference's time, measured minus reference.

    Position (N, 3): difference of positions. Quaternion (N, 4): the turn from reference to measured, in the common frame.
    """
    reference, measured = reference.only_valid(), measured.only_valid()
    if len(reference) == 0:
        return measured.select(np.zeros(len(measured), dtype=np.bool_))
    measured = measured.between(reference.time[0], reference.time[-1])
    if len(measured) == 0:
        return measured
    there = interpolate(reference, measured.time)
    R_measured, R_there = (Rotation.from_quat(path.quaternion_wxyz, scalar_first=True) for path in (measured, there))
    quaternion = (R_measured * R_there.inv()).as_quat(canonical=True, scalar_first=True)
    return PosePath(measured.time, measured.position - there.position, quaternion, measured.valid)
