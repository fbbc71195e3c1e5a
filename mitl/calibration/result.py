"""Calibration: the solved transforms, how well they are known, and paths brought from the tracker's frame into the robot's."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import sqrt

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from mitl.calibration.distortion import Distortion, distortion_matrix
from mitl.calibration.pose_set import CalibrationError
from mitl.paths import FloatArray, PosePath
from mitl.poses import path_of_transforms, transform_of


@dataclass(frozen=True)
class Residuals:
    """Differences of measured from predicted poses M in L. Positions: norm of the difference in m; rotations: its angle in rad.

    For white noise of s per axis the rms of a norm is sqrt(3) s; `position_axis_rms` is the rms per axis.
    """

    position_rms: float
    position_max: float
    rotation_rms: float
    rotation_max: float
    count: int

    @property
    def position_axis_rms(self) -> float:
        """Gives the rms per axis in m."""
        return self.position_rms / sqrt(3.0)

    @property
    def rotation_axis_rms(self) -> float:
        """Gives the rms per axis in rad."""
        return self.rotation_rms / sqrt(3.0)


@dataclass(frozen=True)
class Rejection:
    """A pose that calibration did not use: its index among the poses given, and why."""

    index: int
    reason: str


@dataclass(frozen=True, eq=False)
class Calibration:
    """Where the tracker's base stands and how its body sits on the flange: measured X_LM = A(X_LB X_BF X_FM).

    X_LB, X_FM: (7,). scale: (3,) and skew: (3,) rad, the distortion A of positions in L (`distortion_matrix`).
    covariance: (12 + k, 12 + k) of rotation vector (rad, right-hand step) and position (m) of X_LB, then of X_FM, then of the
    k distortion numbers (one scale, or three scales and three skews).
    training: residuals of the poses it was fitted to. held_out: every used pose, predicted by a fit that had not seen it.
    position_sigma, rotation_sigma: noise of one averaged tracker pose as expected, per axis, m and rad.
    position_noise, rotation_noise: the same as the residuals show it; the covariance rests on these.
    flange_sigma, flange_turn_sigma: per axis, m and rad, what the covariance means for a flange pose, rms over the poses used.
    pose_count: poses used. provenance: free text by key, kept in the file.
    positions_only: the tracker tells no orientation; X_FM's is the identity by definition, and only `points` means something of a path.
    """

    X_LB: FloatArray
    X_FM: FloatArray
    distortion: Distortion
    scale: FloatArray
    skew: FloatArray
    covariance: FloatArray
    training: Residuals
    held_out: Residuals
    position_sigma: float
    rotation_sigma: float
    position_noise: float
    rotation_noise: float
    flange_sigma: float
    flange_turn_sigma: float
    pose_count: int
    rejected: tuple[Rejection, ...] = ()
    positions_only: bool = False
    provenance: dict[str, str] = field(default_factory=dict)

    def flange_path(self, path: PosePath) -> PosePath:
        """Gives the flange's path X_BF from the tracker's path X_LM: A undone, then X_LB^-1 X_LM X_FM^-1. Time and validity stay.

        Samples whose quaternion is zero (lost tracker) come out as invalid with an identity orientation.
        """
        return path_of_transforms(path, self._flange(path)) if _whole(path) else self.flange_path(_repaired(path))

    def tool_path(self, path: PosePath, X_FT: FloatArray, X_BO: FloatArray) -> PosePath:
        """Gives the tool's path X_OT in the work object from the tracker's path X_LM. X_FT: (7,) tooldata. X_BO: (7,) work object."""
        whole = path if _whole(path) else _repaired(path)
        X_OT = transform_of(X_BO).inv() * self._flange(whole) * transform_of(X_FT)
        return path_of_transforms(whole, X_OT)

    def points(self, path: PosePath) -> FloatArray:
        """Gives the places (N, 3) in m in the robot's base of whatever device the tracker's path belongs to: A undone, then X_LB^-1."""
        position = np.linalg.solve(distortion_matrix(self.scale, self.skew), path.position.T).T
        return np.asarray(transform_of(self.X_LB).inv().apply(position))

    def tracker_poses(self, flange: FloatArray) -> FloatArray:
        """Gives the poses X_LM (N, 7) that the tracker would report, noise aside, for flange poses X_BF (N, 7)."""
        X_LM = transform_of(self.X_LB) * transform_of(flange) * transform_of(self.X_FM)
        position = X_LM.translation @ distortion_matrix(self.scale, self.skew).T
        return np.concatenate([position, X_LM.rotation.as_quat(canonical=True, scalar_first=True)], axis=-1)

    def position_uncertainty(self, lever: float = 0.0) -> float:
        """Gives the registration's share of a position's uncertainty: 1 sigma per axis in m, at the flange or `lever` m from it.

        Two parts: what the covariance says, and what the held-out residuals show beyond the expected tracker noise and the
        covariance (a distortion that the model lacks, noise that is not white). Without the second a wrong model would look good
        because many poses were averaged.
        """
        excess = self.held_out.position_axis_rms**2 - self.position_sigma**2 - self.flange_sigma**2
        return float(np.sqrt(self.flange_sigma**2 + max(0.0, excess) + (lever * self.rotation_uncertainty()) ** 2))

    def rotation_uncertainty(self) -> float:
        """Gives the registration's share of an orientation's uncertainty: 1 sigma per axis in rad. Parts as for the position."""
        excess = self.held_out.rotation_axis_rms**2 - self.rotation_sigma**2 - self.flange_turn_sigma**2
        return float(np.sqrt(self.flange_turn_sigma**2 + max(0.0, excess)))

    def _flange(self, path: PosePath) -> RigidTransform:
        if self.positions_only:
            raise CalibrationError("this calibration is of a tracker that tells positions alone: no flange or tool can be told from it")
        position = np.linalg.solve(distortion_matrix(self.scale, self.skew), path.position.T).T
        X_LM = RigidTransform.from_components(position, Rotation.from_quat(path.quaternion_wxyz, scalar_first=True))
        return transform_of(self.X_LB).inv() * X_LM * transform_of(self.X_FM).inv()


def _whole(path: PosePath) -> bool:
    """Gives whether every sample has an orientation."""
    return bool(np.all(np.linalg.norm(path.quaternion_wxyz, axis=1) > 0.5))


def _repaired(path: PosePath) -> PosePath:
    """Gives the path with identity for missing orientations, those samples invalid."""
    missing = ~(np.linalg.norm(path.quaternion_wxyz, axis=1) > 0.5)
    quaternion = np.where(missing[:, None], np.array([1.0, 0.0, 0.0, 0.0]), path.quaternion_wxyz)
    return PosePath(path.time, path.position, quaternion, path.valid & ~missing)
