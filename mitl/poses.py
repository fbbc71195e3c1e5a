"""Poses as arrays: the only bridge between (..., 7) arrays `x y z qw qx qy qz` in m and scipy's RigidTransform."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from mitl.paths import FloatArray, PosePath

IDENTITY: FloatArray = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])


def transform_of(pose: FloatArray) -> RigidTransform:
    """Gives the transform X_AB of poses (7,) or (N, 7) `x y z qw qx qy qz`; the quaternion need not be normalised."""
    rotation = Rotation.from_quat(pose[..., 3:7], scalar_first=True)
    return RigidTransform.from_components(pose[..., :3], rotation)


def pose_of(X_AB: RigidTransform) -> FloatArray:
    """Gives the pose (7,) or (N, 7) of a transform, with qw >= 0."""
    quaternion = X_AB.rotation.as_quat(canonical=True, scalar_first=True)
    return np.concatenate([X_AB.translation, quaternion], axis=-1)


def transforms_of_path(path: PosePath) -> RigidTransform:
    """Gives a path's poses as N transforms."""
    return RigidTransform.from_components(path.position, Rotation.from_quat(path.quaternion_wxyz, scalar_first=True))


def path_of_transforms(path: PosePath, X: RigidTransform) -> PosePath:
    """Gives a path with the times and validity of `path` and the N poses `X`."""
    pose = pose_of(X)
    return PosePath(path.time, pose[:, :3], pose[:, 3:], path.valid)
