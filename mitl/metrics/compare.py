"""Two paths compared: the numbers of `mitl compare`, after the alignment asked for."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.metrics.deviation import summarise
from mitl.metrics.orientation import angle_between
from mitl.metrics.path import interpolate
from mitl.metrics.speed import speed
from mitl.paths import FloatArray, PosePath


class Align(Enum):
    """What is fitted before comparing; each includes the ones before it.

    NONE: nothing. TIME: the clocks' offset. RIGID: also rotation and translation. SIMILARITY: also one scale.
    """

    NONE = "none"
    TIME = "time"
    RIGID = "rigid"
    SIMILARITY = "similarity"


@dataclass(frozen=True)
class Comparison:
    """Numbers of a comparison; names and units as `mitl compare` prints them. scale: by which measured positions were multiplied.

    time_offset_s: what was added to measured times. samples: measured samples compared.
    """

    position_rmse_m: float
    position_mean_m: float
    position_max_m: float
    position_p95_m: float
    rotation_rmse_deg: float
    time_offset_s: float
    scale: float
    speed_rmse_m_s: float
    samples: int


def compare(reference: PosePath, measured: PosePath, align: Align = Align.NONE, time_offset: float = 0.0) -> Comparison:
    """Gives the differences of the valid measured samples from the reference, interpolated at their times.

    time_offset: s, added to measured times unless align is NONE (`calibration.time_offset` finds it).
    Raises ValueError where the two have fewer than one, or for an alignment three, samples' time in common.
    """
    offset = 0.0 if align is Align.NONE else time_offset
    reference = reference.only_valid()
    measured = measured.only_valid().shifted(offset)
    if len(reference):
        measured = measured.between(reference.time[0], reference.time[-1])
    needed = 3 if align in {Align.RIGID, Align.SIMILARITY} else 1
    if len(reference) == 0 or len(measured) < needed:
        raise ValueError(
            f"the paths have {len(measured) if len(reference) else 0} valid samples in common time, expected at least {needed}"
        )
    there = interpolate(reference, measured.time)
    position, quaternion, scale = measured.position, measured.quaternion_wxyz, 1.0
    if align in {Align.RIGID, Align.SIMILARITY}:
        R, p, scale = umeyama(there.position, measured.position, with_scale=align is Align.SIMILARITY)
        position = scale * position @ R.T + p
        quaternion = _turned(R, quaternion)
    distance = summarise(position - there.position)
    angle = angle_between(there.quaternion_wxyz, quaternion)
    speeds = np.zeros(1)
    if len(measured) > 1:
        # the reference's speed comes from its own samples: interpolated positions would cut the corners of its motion
        expected = np.interp(measured.time, reference.time, speed(reference, 0.0)) if len(reference) > 1 else 0.0
        speeds = scale * speed(measured, 0.0) - expected
    return Comparison(
        position_rmse_m=distance.rms,
        position_mean_m=distance.mean,
        position_max_m=distance.max,
        position_p95_m=distance.p95,
        rotation_rmse_deg=float(np.rad2deg(np.sqrt(np.mean(angle**2)))),
        time_offset_s=offset,
        scale=scale,
        speed_rmse_m_s=float(np.sqrt(np.mean(speeds**2))),
        samples=len(measured),
    )


def umeyama(target: FloatArray, source: FloatArray, *, with_scale: bool) -> tuple[FloatArray, FloatArray, float]:
    """Gives R (3, 3), p (3,) and s for which s R source + p is nearest to target, both (N, 3), in least squares.

    Source: S. Umeyama, "Least-squares estimation of transformation parameters between two point patterns", IEEE PAMI 13(4), 1991.
    """
    target_mean, source_mean = target.mean(axis=0), source.mean(axis=0)
    centred = source - source_mean
    left, stretch, right = np.linalg.svd((target - target_mean).T @ centred)
    sign = np.array([1.0, 1.0, 1.0 if np.linalg.det(left) * np.linalg.det(right) > 0.0 else -1.0])
    R = left @ np.diag(sign) @ right
    square = float(np.sum(centred**2))
    scale = float(np.sum(stretch * sign)) / square if with_scale and square > 0.0 else 1.0
    return R, target_mean - scale * R @ source_mean, scale


def _turned(R: FloatArray, quaternion_wxyz: FloatArray) -> FloatArray:
    """Gives the orientations (N, 4) turned by the rotation matrix R (3, 3)."""
    w, x, y, z = Rotation.from_matrix(R).as_quat(scalar_first=True)
    left = np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]])
    return np.asarray(quaternion_wxyz @ left.T)
