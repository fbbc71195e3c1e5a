"""The error bound of every sample of an oracle: what the tool does there and how fast, and what the model is worth at that.

Invariant: a sample's speed is the greatest within `AROUND`, because an arm that brakes still errs as the fast one it was.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.ndimage import maximum_filter1d

from mitl.motion.accuracy import Kind, ModelAccuracy
from mitl.motion.kinematics import Arm
from mitl.motion.record import TICK, ExecutedMove, MotionRecord, View
from mitl.paths import BoolArray, FloatArray, IndexArray
from mitl.protocols import OracleBounds
from rapid_interp import effects

AROUND = 0.2
"""Seconds before and after a sample whose speeds count for it, some two of the widest filters of an arm. ASSUMPTION A-270."""
_STANDS = 1e-7
"""Way in rad of a joint from tick to tick that still counts as standing."""


def bounds_at(record: MotionRecord, arm: Arm, accuracy: ModelAccuracy, times: FloatArray) -> OracleBounds:
    """Gives the bounds at times (N,) s of what the arm does."""
    last = max(record.end, float(times[-1]) if len(times) else 0.0)
    ticks: FloatArray = TICK * np.arange(math.ceil(last / TICK) + 2, dtype=np.float64)
    kinds, speed = doing(record, arm, ticks)
    at = np.clip(np.rint(times / TICK).astype(np.intp), 0, len(ticks) - 1)
    found = accuracy.bounds(tuple(kinds[index] for index in at), speed[at])
    return OracleBounds(found.path, found.turn, found.time)


def doing(record: MotionRecord, arm: Arm, ticks: FloatArray) -> tuple[list[Kind], FloatArray]:
    """Gives what the tool does at ticks (N,) s, and its speed (N,) m/s, the greatest around."""
    joints = record.joints(ticks, View.TOOL)
    width = 2 * round(AROUND / TICK) + 1
    moving: BoolArray = np.asarray(np.abs(np.gradient(joints, axis=0)).max(axis=1) > _STANDS)
    near: BoolArray = maximum_filter1d(moving.astype(np.int8), width) > 0
    if not record.moves:
        return [Kind.STILL] * len(ticks), np.zeros(len(ticks))
    move = record.move_at(ticks)
    speed = _speeds(record, arm, joints, move)
    corner = _in_corner(record.moves, ticks, speed, record.half_filter)
    of_move = [_kind(executed) for executed in record.moves]
    kinds = [
        Kind.STILL if not goes else Kind.CORNER if cut else of_move[index]
        for goes, cut, index in zip(near.tolist(), corner.tolist(), move.tolist(), strict=True)
    ]
    return kinds, np.asarray(maximum_filter1d(speed, width))


def _kind(executed: ExecutedMove) -> Kind:
    match executed.move.effect:
        case effects.MoveL():
            return Kind.LINE
        case effects.MoveC():
            return Kind.ARC
        case effects.MoveJ() | effects.MoveAbsJ():
            return Kind.JOINT


def _speeds(record: MotionRecord, arm: Arm, joints: FloatArray, move: IndexArray) -> FloatArray:
    """Gives the speeds (N,) m/s of the active TCP at ticks; a change of tool is no motion."""
    X_BF = arm.flange(joints)
    speed = np.zeros(len(joints))
    active = record.tool_indices()[move]
    for tool in np.unique(active):
        position = (X_BF * record.moves[tool].move.leg.X_FT).translation
        here = active == tool
        speed[here] = np.linalg.norm(np.gradient(position, TICK, axis=0), axis=1)[here]
    return speed


def _in_corner(moves: Sequence[ExecutedMove], ticks: FloatArray, speed: FloatArray, half_filter: float) -> BoolArray:
    """Gives at which ticks (N,) the tool is within a zone's radius of its middle, or within the filters' reach of that."""
    way = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * TICK)])
    inside: BoolArray = np.zeros(len(ticks), dtype=bool)
    for executed in moves:
        radius = executed.move.zone.radius
        if executed.move.fine or radius <= 0:
            continue
        middle = float(np.interp(executed.ends, ticks, way))
        inside |= np.abs(way - middle) <= radius + speed * half_filter
    return inside
