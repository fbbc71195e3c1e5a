"""What calibration solves for, what it predicts, and the derivative of both.

Invariant: a step is small and taken from a fixed start, rotations on the right: R = R_start exp(step).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.calibration.distortion import Distortion, distortion_matrix
from mitl.paths import FloatArray


@dataclass(frozen=True, eq=False)
class Unknowns:
    """The unknowns of a calibration as rotations and vectors. R_LB, R_FM: (3, 3). p_LB, p_FM: (3,) m. scale, skew: (3,)."""

    R_LB: FloatArray
    p_LB: FloatArray
    R_FM: FloatArray
    p_FM: FloatArray
    scale: FloatArray
    skew: FloatArray

    def stepped(self, step: FloatArray, distortion: Distortion) -> Unknowns:
        """Gives the unknowns after a step (12 + k,): rotation and position of LB, of FM, then k distortion numbers.

        Rotations step by a rotation vector in rad on the right: R exp(step).
        """
        turn = Rotation.from_rotvec(np.stack([step[0:3], step[6:9]])).as_matrix()
        scale, skew = self.scale, self.skew
        match distortion:
            case Distortion.RIGID:
                pass
            case Distortion.SCALE:
                scale = scale + step[12]
            case Distortion.AFFINE:
                scale, skew = scale + step[12:15], skew + step[15:18]
        return Unknowns(self.R_LB @ turn[0], self.p_LB + step[3:6], self.R_FM @ turn[1], self.p_FM + step[9:12], scale, skew)

    def predict(self, R_BF: FloatArray, p_BF: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gives what the tracker would report for flange poses: rotations (N, 3, 3) and positions (N, 3) of M in L."""
        p_BM = p_BF + R_BF @ self.p_FM
        p_LM = self.p_LB + p_BM @ self.R_LB.T
        return self.R_LB @ R_BF @ self.R_FM, p_LM @ distortion_matrix(self.scale, self.skew).T

    def flange(self, R_LM: FloatArray, p_LM: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gives the flange poses in B that tracker reports mean: rotations (N, 3, 3) and positions (N, 3)."""
        p_true = np.linalg.solve(distortion_matrix(self.scale, self.skew), p_LM.T).T
        R_BF = self.R_LB.T @ R_LM @ self.R_FM.T
        return R_BF, (p_true - self.p_LB) @ self.R_LB - R_BF @ self.p_FM

    def derivative(
        self, R_BF: FloatArray, p_BF: FloatArray, R_LM: FloatArray, step: FloatArray, distortion: Distortion
    ) -> tuple[FloatArray, FloatArray]:
        """Gives how residuals change with the step by which these unknowns were reached: (N, 3, 12 + k) of positions and of turns.

        The residuals are measured minus predicted position, and the rotation vector from predicted to measured orientation R_LM.
        """
        n, size = len(p_BF), 12 + distortion.unknowns
        A = distortion_matrix(self.scale, self.skew)
        first, second = right_jacobian(step[0:3]), right_jacobian(step[6:9])
        p_BM = p_BF + R_BF @ self.p_FM
        p_LM = self.p_LB + p_BM @ self.R_LB.T  # true, not distorted
        position = np.zeros((n, 3, size))
        position[:, :, 0:3] = -A @ self.R_LB @ _cross_matrix(p_BM) @ first
        position[:, :, 3:6] = A
        position[:, :, 9:12] = A @ self.R_LB @ R_BF
        match distortion:
            case Distortion.RIGID:
                pass
            case Distortion.SCALE:
                position[:, :, 12] = p_LM
            case Distortion.AFFINE:
                for column, (row, axis) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)), start=12):
                    position[:, row, column] = p_LM[:, axis]
        predicted = self.R_LB @ R_BF @ self.R_FM
        turn = Rotation.from_matrix(np.swapaxes(predicted, 1, 2) @ R_LM, assume_valid=True).as_rotvec()
        # the left Jacobian is the right one of the opposite vector
        inverse = np.linalg.inv(right_jacobian(-turn))
        turns = np.zeros((n, 3, size))
        turns[:, :, 0:3] = inverse @ np.swapaxes(R_BF @ self.R_FM, 1, 2) @ first
        turns[:, :, 6:9] = inverse @ second
        return -position, -turns


def right_jacobian(rotation_vector: FloatArray) -> FloatArray:
    """Gives J (..., 3, 3) with exp(v + dv) = exp(v) exp(J dv) for rotation vectors v (..., 3) below pi.

    Source: J. Solà et al., "A micro Lie theory for state estimation in robotics", 2018, equation 143.
    """
    angle = np.linalg.norm(rotation_vector, axis=-1)[..., None, None]
    safe = np.where(angle < 1e-4, 1.0, angle)
    first = np.where(angle < 1e-4, 0.5 - angle**2 / 24.0, (1.0 - np.cos(safe)) / safe**2)
    second = np.where(angle < 1e-4, 1.0 / 6.0 - angle**2 / 120.0, (safe - np.sin(safe)) / safe**3)
    cross = _cross_matrix(rotation_vector)
    return np.asarray(np.eye(3) - first * cross + second * (cross @ cross))


def _cross_matrix(vector: FloatArray) -> FloatArray:
    """Gives [v] (..., 3, 3) with [v] u = v x u."""
    x, y, z = np.moveaxis(vector, -1, 0)
    zero = np.zeros_like(x)
    rows = [np.stack(row, axis=-1) for row in ((zero, -z, y), (z, zero, -x), (-y, x, zero))]
    return np.stack(rows, axis=-2)
