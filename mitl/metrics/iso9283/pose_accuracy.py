"""Pose accuracy AP: how far the mean of the attained poses is from the commanded one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mitl.metrics.orientation import turn_between
from mitl.paths import FloatArray


@dataclass(frozen=True, eq=False)
class PoseAccuracy:
    """position: AP in m. angle: of the mean turn from commanded to attained, rad. random: standard error of the mean, largest axis, m."""

    position: float
    angle: float
    random: float


def pose_accuracy(attained: FloatArray, commanded: FloatArray) -> PoseAccuracy:
    """Gives AP of attained poses (n, 7) against the commanded pose (7,): x y z in m, qw qx qy qz. Raises ValueError for fewer than two."""
    if len(attained) < 2:
        raise ValueError(f"a pose accuracy needs at least two cycles, got {len(attained)}")
    away = attained[:, :3].mean(axis=0) - commanded[:3]
    turn = turn_between(commanded[3:], attained[:, 3:]).mean(axis=0)
    random = float(np.max(np.std(attained[:, :3], axis=0, ddof=1))) / np.sqrt(len(attained))
    return PoseAccuracy(float(np.linalg.norm(away)), float(np.linalg.norm(turn)), random)
