"""Which of many possible poses a calibration should be measured at: those that together tell the most about its unknowns.

Invariant: the choice depends on the candidates alone; the same candidates give the same choice.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.calibration.distortion import Distortion
from mitl.calibration.solve import POSITION_SIGMA, ROTATION_SIGMA
from mitl.calibration.unknowns import Unknowns
from mitl.paths import FloatArray

_WEAK = 1e-6
"""What is known of every unknown before the first pose, as information: next to nothing, so that the first choices are defined."""


def most_telling(flange: FloatArray, count: int) -> list[int]:
    """Gives the numbers of `count` of the candidate poses X_BF (N, 7), chosen one by one for the largest gain in information.

    Information is the determinant of J'J over all unknowns of the richest model, three scales and three skews included (D-optimal
    design). Where the tracker's base stands and how its body sits on the flange hardly matter; they are taken as 2 m away, 80 mm off.
    Raises ValueError for fewer candidates than poses wanted.
    """
    if len(flange) < count:
        raise ValueError(f"expected at least {count} candidates, got {len(flange)}")
    information = np.eye(12 + Distortion.AFFINE.unknowns) * _WEAK
    rows = _rows(flange)
    chosen: list[int] = []
    for _ in range(count):
        known = np.linalg.inv(information)
        gain = np.linalg.slogdet(np.eye(6) + rows @ known @ np.swapaxes(rows, 1, 2))[1]
        gain[chosen] = -np.inf
        best = int(np.argmax(gain))
        chosen.append(best)
        information = information + rows[best].T @ rows[best]
    return chosen


def _rows(flange: FloatArray) -> FloatArray:
    """Gives how each pose's six whitened residuals change with the unknowns: (N, 6, 18)."""
    R_BF = Rotation.from_quat(flange[:, 3:], scalar_first=True).as_matrix()
    centre = flange[:, :3].mean(axis=0)
    here = Unknowns(np.eye(3), np.array([2.0, 0.0, 0.0]) - centre, np.eye(3), np.array([0.0, 0.0, 0.08]), np.ones(3), np.zeros(3))
    step = np.zeros(12 + Distortion.AFFINE.unknowns)
    position, turn = here.derivative(R_BF, flange[:, :3], R_BF, step, Distortion.AFFINE)
    return np.concatenate([position / POSITION_SIGMA, turn / ROTATION_SIGMA], axis=1)
