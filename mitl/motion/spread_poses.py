"""Many poses an arm can take in the volume before it, turned every way: candidates for a calibration.

Invariant: every pose is within the axis limits less a margin, away from the wrist's singularity and above the floor.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from mitl.motion.kinematics import Arm
from mitl.paths import FloatArray

_MARGIN = float(np.radians(10.0))
_FROM_SINGULARITY = float(np.radians(15.0))
_MOST_TILT = float(np.radians(80.0))
# ASSUMPTION A-188: the volume of the tests is a box .6 of the arm's length deep and high and .9 wide, at most 1 m, at the height of the
# shoulder; what the arm carries needs .15 m above the floor and .25 m to the column.
_AHEAD, _ABOVE = 0.62, 0.05
_HALF = np.array([0.3, 0.45, 0.3])
_LARGEST = 0.5
_FLOOR, _COLUMN = 0.15, 0.25


@dataclass(frozen=True, eq=False)
class SpreadPoses:
    """Poses: joints (N, 6) in rad and the flange X_BF (N, 7) that goes with them."""

    joints: FloatArray
    flange: FloatArray


def spread_poses(arm: Arm, home: FloatArray, count: int, seed: int = 1) -> SpreadPoses:
    """Gives up to `count` poses, the same for the same seed; the flange looks ahead and down, tilted by up to 80 deg, and turned.

    home: joints (6,) that the poses are reached from. Those that cannot be taken are left out, so that fewer may come.
    """
    opw = arm.model.opw
    length = opw.c2 + float(np.hypot(opw.c3, opw.a2))
    centre = np.array([opw.a1 + _AHEAD * length, 0.0, opw.c1 + _ABOVE * length])
    random = np.random.default_rng(seed)
    joints: list[FloatArray] = []
    for _ in range(4 * count):
        place = centre + random.uniform(-1.0, 1.0, 3) * np.minimum(_HALF * length, _LARGEST)
        facing = Rotation.from_euler("y", 135.0, degrees=True)
        axis = random.standard_normal(3)
        tilt = Rotation.from_rotvec(axis / np.linalg.norm(axis) * random.uniform(0.0, _MOST_TILT))
        X_BF = RigidTransform.from_components(place, tilt * facing * Rotation.from_rotvec([0.0, 0.0, random.uniform(-np.pi, np.pi)]))
        q = arm.nearest(X_BF, home)
        if q is not None and _comfortable(arm, q, X_BF):
            joints.append(q)
        if len(joints) == count:
            break
    found = np.array(joints).reshape(-1, 6)
    X_BF = arm.flange(found) if len(found) else RigidTransform.from_translation(np.empty((0, 3)))
    return SpreadPoses(found, np.concatenate([X_BF.translation, X_BF.rotation.as_quat(canonical=True, scalar_first=True)], axis=1))


def _comfortable(arm: Arm, q: FloatArray, X_BF: RigidTransform) -> bool:
    model = arm.model
    body = X_BF.apply(np.array([0.0, 0.0, _FLOOR]))
    return bool(
        np.all(q > model.lower + _MARGIN)
        and np.all(q < model.upper - _MARGIN)
        and abs(q[4]) > _FROM_SINGULARITY
        and min(X_BF.translation[2], body[2]) > _FLOOR
        and min(np.hypot(*X_BF.translation[:2]), np.hypot(*body[:2])) > _COLUMN
    )
