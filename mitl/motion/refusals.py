"""What a program is told that cannot move as it says: the instruction's place in RAPID, and the place in space.

Invariant: every refusal names file, module, line and column of one motion instruction.
"""

from __future__ import annotations

import numpy as np

from mitl.errors import MotionError
from mitl.motion.robot_model import RobotModel
from mitl.paths import FloatArray
from rapid_interp import effects


def refusal(effect: effects.Effect, reason: str, instruction: str = "") -> MotionError:
    """Gives the error of an effect that cannot be carried out; `instruction` is its name in RAPID if the effect is called otherwise."""
    at = effect.at
    return MotionError(f"{instruction or type(effect).__name__}: {reason}", module=at.module, line=at.line, file=at.file, column=at.column)


def place(position: FloatArray) -> str:
    """Gives a position (3,) in m of the base frame in words."""
    x, y, z = 1e3 * position
    return f"[{x:.1f}, {y:.1f}, {z:.1f}] mm in the base frame"


def beyond(model: RobotModel, q: FloatArray) -> str:
    """Gives in words which axis of joints (6,) rad is the furthest beyond its limit."""
    axis = int(np.argmax(np.maximum(q - model.upper, model.lower - q)))
    limit = model.upper[axis] if q[axis] > model.upper[axis] else model.lower[axis]
    return f"axis {axis + 1} would be at {np.degrees(q[axis]):.2f} deg, its limit is {np.degrees(limit):g} deg"
