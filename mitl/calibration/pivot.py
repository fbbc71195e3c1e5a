"""Where the tip of a tool is on the tracked body, from poses that turn about the tip: no robot pose takes part.

Invariant: only the tracker's own poses are used, so the result is independent of the registration's X_LB.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.calibration.pose_set import CalibrationError
from mitl.paths import FloatArray

_FEWEST = 4
_LEAST_SPREAD = np.deg2rad(30.0)


@dataclass(frozen=True, eq=False)
class Pivot:
    """The fixed point of a set of poses: p_MT (3,) m in the body, p_LT (3,) m in the tracker's base.

    sigma: 1 sd in m of a component of p_MT, the largest of three. residual: rms distance in m of the tip from its mean place.
    """

    p_MT: FloatArray
    p_LT: FloatArray
    sigma: float
    residual: float


def pivot_point(poses: FloatArray) -> Pivot:
    """Gives the point of the body that stays where it is over poses X_LM (N, 7), by linear least squares of p_LM + R_LM p_MT = p_LT.

    Raises CalibrationError for fewer than four poses or turns of less than 30 deg.
    """
    if len(poses) < _FEWEST:
        raise CalibrationError(f"a tool's tip needs at least {_FEWEST} poses that turn about it, got {len(poses)}")
    R_LM = Rotation.from_quat(poses[:, 3:], scalar_first=True)
    spread = float((R_LM[:1].inv() * R_LM).magnitude().max())
    if spread < _LEAST_SPREAD:
        raise CalibrationError(f"the body must turn by at least 30 deg about the tip, it turns by {np.rad2deg(spread):.0f} deg")
    n = len(poses)
    matrix = np.concatenate([R_LM.as_matrix(), np.repeat(-np.eye(3)[None], n, axis=0)], axis=2).reshape(3 * n, 6)
    wanted = -poses[:, :3].reshape(-1)
    solution = np.linalg.lstsq(matrix, wanted, rcond=None)[0]
    misfit = matrix @ solution - wanted
    variance = float(misfit @ misfit) / (3 * n - 6)
    covariance = variance * np.linalg.inv(matrix.T @ matrix)
    return Pivot(
        p_MT=solution[:3],
        p_LT=solution[3:],
        sigma=float(np.sqrt(np.linalg.eigvalsh(covariance[:3, :3]).max())),
        residual=float(np.sqrt(np.mean(np.sum(misfit.reshape(n, 3) ** 2, axis=1)))),
    )
