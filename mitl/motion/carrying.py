"""Carries an arm along with conveyor belts: from the motion as planned beside standing work pieces to the motion beside moving ones.

Invariant: where nothing is followed the joints stay exactly as they are.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import RigidTransform

from mitl.motion.kinematics import Arm
from mitl.motion.scheduled import ScheduledChain
from mitl.paths import BoolArray, FloatArray


def shifts(chains: Sequence[ScheduledChain], time: FloatArray) -> FloatArray:
    """Gives by how much (N, 3) in m an arm is carried in its base at times (N,) s. The share of a belt's way is that of the plan."""
    shift = np.zeros((len(time), 3))
    chain_of = np.searchsorted([scheduled.start for scheduled in chains], time, side="right") - 1
    for index in np.unique(chain_of[chain_of >= 0]):
        scheduled = chains[index]
        moves = scheduled.chain.moves
        if all(move.following is None for move in moves):
            continue
        here = np.flatnonzero(chain_of == index)
        ends = scheduled.chain.path.leg_ends()
        s = scheduled.chain.timing.at(np.clip(time[here] - scheduled.start, 0.0, scheduled.chain.timing.duration))[0]
        leg = np.clip(np.searchsorted(ends, s, side="right") - 1, 0, len(moves) - 1)
        for number in np.unique(leg):
            following = moves[number].following
            if following is None:
                continue
            rows = here[leg == number]
            width = float(ends[number + 1] - ends[number])
            done = np.clip((s[leg == number] - ends[number]) / width, 0.0, 1.0) if width > 0 else np.ones(len(rows))
            way = following.shares(done) * following.connection.carried(time[rows])
            shift[rows] = way[:, None] * following.connection.belt.conveyor.direction
    return shift


def displaced(arm: Arm, joints: FloatArray, shift: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Gives joints (N, 6) rad of an arm shifted by (N, 3) m in its base, and which (N,) it cannot reach: there it keeps its former ones."""
    moved = np.any(shift != 0, axis=1)
    lost = np.zeros(len(joints), dtype=bool)
    if not moved.any():
        return joints, lost
    found = joints.copy()
    where = np.flatnonzero(moved)
    near = joints[where[0]]
    for run in np.split(where, np.flatnonzero(np.diff(where) > 1) + 1):
        X_BF = RigidTransform.from_translation(shift[run]) * arm.flange(joints[run])
        found[run] = arm.joints(X_BF, joints[run[0]])
    lost = np.asarray(np.isnan(found).any(axis=1))
    for row in np.flatnonzero(lost):
        found[row] = found[row - 1] if row > 0 else near
    return found, lost
