"""Which distortion the poses justify: the richest that predicts unseen poses significantly better than the next simpler one."""

from __future__ import annotations

import numpy as np

from mitl.calibration.distortion import Distortion
from mitl.calibration.pose_set import CalibrationError, CalibrationPoses
from mitl.calibration.solve import POSITION_SIGMA, ROTATION_SIGMA, calibrate, held_out_score

# ASSUMPTION A-64: the gain must be two standard errors over the poses; a model without need is then taken about once in forty.
_SIGNIFICANT = 2.0


def choose_distortion(
    poses: CalibrationPoses,
    *,
    held_out_every: int = 5,
    position_sigma: float = POSITION_SIGMA,
    rotation_sigma: float = ROTATION_SIGMA,
) -> Distortion:
    """Gives the richest distortion that the held-out residuals justify; arguments as for `calibrate`.

    All models are compared on the poses that the richest possible model keeps. A model that the poses cannot determine is passed
    over. Raises CalibrationError where they do not even determine the rigid one.
    """
    possible: list[Distortion] = []
    kept = poses
    failure: CalibrationError | None = None
    for distortion in (Distortion.AFFINE, Distortion.SCALE, Distortion.RIGID):
        try:
            fit = calibrate(
                poses,
                distortion=distortion,
                held_out_every=held_out_every,
                position_sigma=position_sigma,
                rotation_sigma=rotation_sigma,
            )
        except CalibrationError as error:
            failure = error
            continue
        if not possible:
            used = np.ones(len(poses), dtype=np.bool_)
            used[[rejection.index for rejection in fit.rejected]] = False
            kept = poses.select(used)
        possible.append(distortion)
    if not possible:
        raise failure if failure is not None else CalibrationError("no distortion was tried")
    possible.reverse()
    chosen = possible[0]
    score = held_out_score(kept, chosen, held_out_every, position_sigma, rotation_sigma)
    for richer in possible[1:]:
        richer_score = held_out_score(kept, richer, held_out_every, position_sigma, rotation_sigma)
        gain = score - richer_score
        if np.mean(gain) > _SIGNIFICANT * np.std(gain, ddof=1) / np.sqrt(len(gain)):
            chosen, score = richer, richer_score
    return chosen
