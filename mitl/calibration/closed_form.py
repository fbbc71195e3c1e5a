"""A start for the joint solution: rotations by singular value decomposition, then scale and translations linearly.

Source: M. Shah, "Solving the robot-world/hand-eye calibration problem using the Kronecker product", J. Mechanisms Robotics 5(3),
2013, extended by an unknown scale (which keeps the second step linear). Invariant: closed form, no iteration, no start needed.
"""

from __future__ import annotations

import numpy as np

from mitl.calibration.distortion import Distortion
from mitl.calibration.unknowns import Unknowns
from mitl.paths import FloatArray

_TRIALS = 60
_SUBSET = 5


def closed_form(R_BF: FloatArray, p_BF: FloatArray, R_LM: FloatArray, p_LM: FloatArray, distortion: Distortion) -> Unknowns:
    """Gives the unknowns from rotations (N, 3, 3) and positions (N, 3); all scales are equal and skews zero."""
    products = np.einsum("nad,nbc->abcd", R_LM, R_BF).reshape(9, 9)  # sum of traces R_LM' R_LB R_BF R_FM is bilinear in R_LB, R_FM
    left, _, right = np.linalg.svd(products)
    R_LB, R_FM = left[:, 0].reshape(3, 3), right[0].reshape(3, 3)
    if np.linalg.det(R_LB) < 0:  # the two share an unknown sign
        R_LB, R_FM = -R_LB, -R_FM
    R_LB, R_FM = _nearest_rotation(R_LB), _nearest_rotation(R_FM)
    n = len(p_BF)
    rotated = p_BF @ R_LB.T
    # p_LM = s p_LB + s R_LB p_BF + R_LB R_BF (s p_FM), linear in s p_LB, s p_FM and s
    columns = [np.broadcast_to(np.eye(3), (n, 3, 3)), R_LB @ R_BF]
    target = p_LM
    if distortion is Distortion.RIGID:
        target = p_LM - rotated
    else:
        columns.append(rotated[:, :, None])
    system = np.concatenate(columns, axis=2).reshape(3 * n, -1)
    solution: FloatArray = np.asarray(np.linalg.lstsq(system, target.reshape(-1), rcond=None)[0], dtype=np.float64)
    scale = float(solution[6]) if distortion is not Distortion.RIGID else 1.0
    if abs(scale) < 1e-3:  # an outlier's doing; the caller compares starts
        scale = 1.0
    return Unknowns(R_LB, solution[:3] / scale, R_FM, solution[3:6] / scale, np.full(3, scale), np.zeros(3))


def robust_start(R_BF: FloatArray, p_BF: FloatArray, R_LM: FloatArray, p_LM: FloatArray, distortion: Distortion) -> Unknowns:
    """Gives the closed form of that small subset of the poses which leaves the least median position error over all of them.

    Linear methods break at the first outlier (facts/tracker.md: 180 mm from two in 20); of 60 subsets of 5, about 10 are free of
    outliers when 30 % of the poses are. The draws are the same for the same number of poses.
    """
    n = len(p_BF)
    draws = np.random.default_rng(n)
    subsets = [np.arange(n)] + [draws.choice(n, size=min(_SUBSET, n), replace=False) for _ in range(_TRIALS)]
    best: Unknowns | None = None
    least = np.inf
    for chosen in subsets:
        start = closed_form(R_BF[chosen], p_BF[chosen], R_LM[chosen], p_LM[chosen], distortion)
        median = float(np.median(np.linalg.norm(start.predict(R_BF, p_BF)[1] - p_LM, axis=1)))
        if best is None or median < least:
            best, least = start, median
    assert best is not None  # noqa: S101 - the first subset always sets it; this is for the type checker
    return best


def _nearest_rotation(matrix: FloatArray) -> FloatArray:
    """Gives the rotation (3, 3) nearest to a matrix in the Frobenius norm."""
    left, _, right = np.linalg.svd(matrix)
    return np.asarray(left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right, dtype=np.float64)
