"""Follows a Cartesian leg with the joints, from its start to its end, in steps fine enough to see singularities.

Invariant: the joints along a leg are one solution of the inverse kinematics, without a jump; where that cannot be, the move is refused.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mitl.motion.kinematics import STRAIGHT_THROUGH, Arm
from mitl.motion.legs import CartesianLeg
from mitl.motion.orientation import HeldWrist
from mitl.motion.refusals import beyond, place, refusal
from mitl.paths import BoolArray, FloatArray
from rapid_interp import effects

_TRACKING_STEP = 0.02
_FEWEST_STEPS = 8
_LARGEST_JUMP = 0.6
"""A joint that turns more than this (rad) over one tracking step has met a singularity or changed its solution."""
_COARSE_STEP, _FINE_STEP = 1e-3, 1e-5
"""Steps in m to which a track is refined: where axis 5 comes near 0, and where the joints then run unevenly."""
_UNEVEN = 0.05
"""Change of a joint's step in rad from one step to the next that calls for finer ones."""
_UNEVEN_THROUGH = 2 * STRAIGHT_THROUGH
"""The same for axis 4 beside a step in which axis 5 goes through 0."""
_MOST_HALVINGS = 12
_FARTHEST = 50.0
"""No arm's way is this long (m); a longer one is refused before it is followed step by step."""


def followed(arm: Arm, effect: effects.Motion, leg: CartesianLeg) -> CartesianLeg:
    """Gives the leg with its joints followed to its end. Raises MotionError where that is impossible."""
    if not leg.length <= _FARTHEST:
        raise refusal(effect, f"out of reach: the way is {leg.length:.3g} m long")
    steps = max(_FEWEST_STEPS, int(np.ceil(leg.length / _TRACKING_STEP)))
    if leg.held_wrist is not None:
        return _by_wrist(arm, effect, leg, leg.held_wrist, np.linspace(0, leg.length, steps + 1))
    leg = _tracked(arm, effect, leg, np.linspace(0, leg.length, steps + 1))
    for _ in range(_MOST_HALVINGS):
        close = _near_singularity(leg.marks, leg.track)
        if not close.any():
            break
        halves = 0.5 * (leg.marks[:-1] + leg.marks[1:])[close]
        leg = _tracked(arm, effect, leg, np.sort(np.concatenate([leg.marks, halves])))
    jumps = np.abs(np.diff(leg.track, axis=0))
    if jumps.max() > _LARGEST_JUMP:
        step, axis = np.unravel_index(int(np.argmax(jumps)), jumps.shape)
        near = place(leg.position(leg.marks[[step + 1]])[0])
        raise refusal(effect, f"singularity: axis {axis + 1} would turn {np.degrees(jumps.max()):.0f} deg at once near {near}")
    through = np.diff(np.signbit(leg.track[:, 4]))
    if through.any() and (through := through & _uneven(leg.marks, leg.track)).any():
        near = place(leg.position(leg.marks[[int(np.argmax(through))]])[0])
        raise refusal(effect, f"singularity: axes 4 and 6 would turn over at once near {near}, where axis 5 goes through 0")
    if not arm.within_limits(leg.track[1:]):
        for row in leg.track[1:]:
            refuse_beyond_limits(arm, effect, row)
    return leg


def _by_wrist(arm: Arm, effect: effects.Motion, leg: CartesianLeg, wrist: HeldWrist, marks: FloatArray) -> CartesianLeg:
    """Gives the leg with its joints, where the wrist's axes are interpolated and only the tip is told its place."""
    position, angles = leg.position(marks), wrist.angles(leg.share(marks))
    track = leg.q_start[None]
    for index in range(1, len(marks)):
        q = arm.joints_with_wrist(position[[index]], angles[[index]], leg.X_FT, track[-1:, :3])
        if np.isnan(q).any():
            raise refusal(effect, f"out of reach at {place(position[index])} (SingArea \\Wrist)")
        refuse_beyond_limits(arm, effect, q[0])
        track = np.vstack([track, q])
    return replace(leg, marks=marks, track=track)


def _tracked(arm: Arm, effect: effects.Motion, leg: CartesianLeg, marks: FloatArray) -> CartesianLeg:
    position = leg.position(marks[1:])
    q = arm.joints_of_tip(position, leg.matrices(marks[1:]), leg.X_FT, leg.q_start)
    lost = np.isnan(q).any(axis=1)
    if lost.any():
        raise refusal(effect, f"out of reach at {place(position[int(np.argmax(lost))])}")
    return replace(leg, marks=marks, track=np.vstack([leg.q_start, q]))


def refuse_beyond_limits(arm: Arm, effect: effects.Motion, q: FloatArray) -> None:
    """Raises MotionError where joints (6,) rad lie beyond an axis limit."""
    if not arm.within_limits(q):
        raise refusal(effect, beyond(arm.model, q))


def _near_singularity(marks: FloatArray, track: FloatArray) -> BoolArray:
    """Gives which of a track's K - 1 steps are too long to see what the joints do in them.

    First axis 5 decides, which a long step may carry through 0 where the wrist really turns over; then how evenly the joints run.
    """
    step = np.diff(track, axis=0)
    largest = np.abs(step).max()
    if 2 * largest < _UNEVEN and np.abs(track[:, 4]).min() > largest:
        return np.zeros(len(step), dtype=bool)  # as nearly everywhere
    width = np.diff(marks)
    wrist = np.abs(step[:, 4])
    wrist[1:] = np.maximum(wrist[1:], np.abs(step[:-1, 4]))
    wrist[:-1] = np.maximum(wrist[:-1], np.abs(step[1:, 4]))
    axis_5 = np.abs(track[:, 4])
    near = (np.minimum(axis_5[:-1], axis_5[1:]) < wrist) & (width > _COARSE_STEP)
    return np.asarray(near | (_uneven(marks, track) & (width > _FINE_STEP)))


def _uneven(marks: FloatArray, track: FloatArray) -> BoolArray:
    """Gives in which of a track's K - 1 steps the joints run unevenly; where axis 5 goes through 0, axis 4 has to lie still."""
    step, width = np.diff(track, axis=0), np.diff(marks)
    rate = step / np.maximum(width, 1e-12)[:, None]
    change = np.abs(np.diff(rate, axis=0)).max(axis=1) * np.minimum(width[1:], width[:-1])
    through = np.diff(np.signbit(track[:, 4])) & (np.abs(step[:, 4]) > 0)
    beside = through[1:] | through[:-1]
    beside[1:] |= through[:-2]
    beside[:-1] |= through[2:]
    change = np.where(beside, np.maximum(change, np.abs(step[1:, 3] - step[:-1, 3]) * _UNEVEN / _UNEVEN_THROUGH), change)
    found = np.zeros(len(step), dtype=bool)
    found[1:] |= change > _UNEVEN
    found[:-1] |= change > _UNEVEN
    return found
