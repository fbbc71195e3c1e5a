"""ClosedForm: an arm's forward kinematics, and one solution of its inverse kinematics where a path stays well within it, for many poses.

Brandstoetter, Angerer, Hofbaur, "An analytical solution of the inverse kinematics problem of industrial serial manipulators with an
ortho-parallel basis and a spherical wrist" (2014). The library `py-opw-kinematics` computes all eight solutions of one pose after the
other; on a path, where the solution is known, arrays are thirty times as quick. Invariant: an answer is the library's; where that is not
certain, there is none.
"""

from __future__ import annotations

import math

import numpy as np

from mitl.motion.robot_model import OpwParameters
from mitl.paths import FloatArray

_TURN = 2 * np.pi
_LARGEST_STEP = 0.3
"""Turn in rad of a joint from pose to pose beyond which another solution might be nearer."""
_STRETCHED = 2e-3
"""How near to 1 the cosine of the elbow's angle may be: 3.6 deg from stretched or folded, where two solutions meet."""
_OVER_AXIS_1 = 1e-2
"""How near the wrist may come to axis 1, in m: there two solutions meet too."""


class ClosedForm:
    """Inverse kinematics of one arm along paths."""

    def __init__(self, opw: OpwParameters) -> None:
        self._opw = opw
        self._forearm = float(np.hypot(opw.a2, opw.c3))
        self._elbow = float(np.arctan2(opw.a2, opw.c3))

    def flange(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gives the flange's positions (N, 3) in m and rotations (N, 3, 3) for joints (N, 6) in rad."""
        opw = self._opw
        q1, q2, q3, q4, q5, q6 = (q * opw.signs - opw.offsets).T
        forearm = q2 + q3
        (s1, s2, s23, s4, s5, s6), (c1, c2, c23, c4, c5, c6) = (turn(np.stack([q1, q2, forearm, q4, q5, q6])) for turn in (np.sin, np.cos))
        out = opw.a1 + opw.c2 * s2 + opw.c3 * s23 + opw.a2 * c23
        up = opw.c1 + opw.c2 * c2 + opw.c3 * c23 - opw.a2 * s23
        zero = np.zeros_like(q1)
        forearm_axes = np.stack([c23 * c1, -s1, s23 * c1, c23 * s1, c1, s23 * s1, -s23, zero, c23], axis=1).reshape(-1, 3, 3)
        across = [c4 * c5 * c6 - s4 * s6, -c4 * c5 * s6 - s4 * c6, c4 * s5]
        aside = [s4 * c5 * c6 + c4 * s6, c4 * c6 - s4 * c5 * s6, s4 * s5]
        wrist = np.stack([*across, *aside, -s5 * c6, s5 * s6, c5], axis=1).reshape(-1, 3, 3)
        R_BF = forearm_axes @ wrist
        centre = np.stack([out * c1 - opw.b * s1, out * s1 + opw.b * c1, up], axis=1)
        return centre + opw.c4 * R_BF[:, :, 2], R_BF

    def joints(self, position: FloatArray, R_BF: FloatArray, near: FloatArray, wrist: float) -> FloatArray | None:
        """Gives joints (N, 6) in rad of flange positions (N, 3) m and rotations (N, 3, 3), each within half a turn of the one before.

        near (6,): joints from which they go on. wrist: how near to 0, in rad, axis 5 may come. None where it comes nearer or another
        solution might meet this one, a pose is out of reach or joints jump.
        """
        opw = self._opw
        _, lean, bend, _, tilt, _ = (near * opw.signs - opw.offsets).tolist()
        behind = opw.a1 + opw.c2 * math.sin(lean) + self._forearm * math.sin(lean + bend + self._elbow) < 0
        side, bent, flip = -1.0 if behind else 1.0, math.copysign(1.0, math.sin(bend + self._elbow)), math.copysign(1.0, tilt)
        centre = position - opw.c4 * R_BF[:, :, 2]
        x, y, z = centre[:, 0], centre[:, 1], centre[:, 2] - opw.c1
        ahead_squared = x * x + y * y - opw.b**2
        if not ahead_squared.min() > _OVER_AXIS_1**2:
            return None
        ahead = np.sqrt(ahead_squared)
        turned = np.arctan2(y, x)
        q1 = turned + np.arctan2(opw.b, ahead) - np.pi if behind else turned - np.arctan2(opw.b, ahead)
        out = side * ahead - opw.a1
        reach_squared = out * out + z * z
        reach = np.sqrt(reach_squared)
        k = self._forearm
        at_shoulder = (reach_squared + opw.c2**2 - k * k) / (2 * reach * opw.c2)
        at_elbow = (reach_squared - opw.c2**2 - k * k) / (2 * opw.c2 * k)
        if not np.abs(at_elbow).max() < 1 - _STRETCHED:
            return None
        q2 = np.arctan2(out, z) - bent * np.arccos(at_shoulder)
        q3 = bent * np.arccos(at_elbow) - self._elbow
        s1, c1, s23, c23 = np.sin(q1), np.cos(q1), np.sin(q2 + q3), np.cos(q2 + q3)
        # the rows of R that the forearm's axes make of the flange's: along it, across it in the arm's plane, out of the plane
        radial = c1[:, None] * R_BF[:, 0] + s1[:, None] * R_BF[:, 1]
        along = s23[:, None] * radial + c23[:, None] * R_BF[:, 2]
        across = c23[:, None] * radial - s23[:, None] * R_BF[:, 2]
        aside = c1[:, None] * R_BF[:, 1] - s1[:, None] * R_BF[:, 0]
        q4 = np.arctan2(flip * aside[:, 2], flip * across[:, 2])
        q5 = flip * np.arctan2(np.hypot(aside[:, 2], across[:, 2]), along[:, 2])
        q6 = np.arctan2(flip * along[:, 1], -flip * along[:, 0])
        found = (np.stack([q1, q2, q3, q4, q5, q6], axis=1) + opw.offsets) * opw.signs
        if np.abs(q5).min() < wrist:
            return None
        chained = np.vstack([near, found])
        steps = np.diff(chained, axis=0)
        turns = np.round(steps / _TURN)
        if np.abs(steps - _TURN * turns).max() > _LARGEST_STEP:
            return None
        return np.asarray(found - _TURN * np.cumsum(turns, axis=0))
