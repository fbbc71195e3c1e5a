"""Arm: forward and closed-form inverse kinematics of a six-axis arm, and ABB's axis configurations.

Invariant: joint vectors are continuous over a batch; an angle is never changed by a full turn without need.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from py_opw_kinematics import KinematicModel, Robot
from scipy.spatial.transform import RigidTransform, Rotation

from mitl.motion.closed_form import ClosedForm
from mitl.motion.robot_model import RobotModel
from mitl.paths import FloatArray

_TURN = 2 * np.pi
_QUARTER = np.pi / 2
CONFIGURATION_TOLERANCE = np.pi / 2
"""How far outside its programmed quarter turn axis 1, 4 or 6 may end. ASSUMPTION A-01."""


WRIST_WINDOW = 0.02
"""Angle in rad of axis 5 within which a path may lead straight through the wrist's singularity."""
STRAIGHT_THROUGH = 5e-4
"""Turn in rad of axis 4 over the window up to which it counts as straight: the tool then turns from its path by at most 5e-6 rad."""
_MOST_NEWTON_STEPS = 30
_AT_THE_TIP = 1e-11
"""Distance in m that counts as none."""
_FLAT = 1e-9
"""Determinant in m^3 of the tip's Jacobian of axes 1 to 3, below which the arm is stretched out or stands over axis 1."""
_LARGEST_NEWTON_STEP = 0.3


@dataclass(frozen=True)
class Configuration:
    """ABB's axis configuration: quarter turns of axes 1, 4 and 6, and the index 0..7 of the inverse kinematics solution."""

    cf1: int
    cf4: int
    cf6: int
    cfx: int

    def __str__(self) -> str:
        return f"[{self.cf1},{self.cf4},{self.cf6},{self.cfx}]"


class Arm:
    """Kinematics of one arm; joints in rad, poses as scipy transforms X_BF of flange F in base B."""

    def __init__(self, model: RobotModel) -> None:
        opw = model.opw
        self.model = model
        o1, o2, o3, o4, o5, o6 = opw.offsets.tolist()
        f1, f2, f3, f4, f5, f6 = (opw.signs < 0).tolist()
        lengths = (opw.a1, opw.a2, opw.b, opw.c1, opw.c2, opw.c3, opw.c4)
        self._closed_form = ClosedForm(opw)
        self._robot = Robot(KinematicModel(*lengths, offsets=(o1, o2, o3, o4, o5, o6), flip_axes=(f1, f2, f3, f4, f5, f6)), degrees=False)

    def flange(self, q: FloatArray) -> RigidTransform:
        """Gives X_BF for joints (6,) or (N, 6)."""
        between = self.model.between_links(q)
        return self._robot.forward(tuple(between)) if q.ndim == 1 else self._robot.batch_forward(between)

    def flange_places(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gives positions (N, 3) m and rotations (N, 3, 3) of the flange for joints (N, 6): `flange` without transform objects."""
        return self._closed_form.flange(self.model.between_links(q))

    def joints(self, X_BF: RigidTransform, near: FloatArray) -> FloatArray:
        """Gives joints (N, 6) that follow N poses without a jump, beginning near `near` (6,); rows are NaN where out of reach."""
        return self.joints_of_flange(X_BF.translation, X_BF.rotation.as_matrix(), near)

    def joints_of_tip(self, position: FloatArray, R_BT: FloatArray, X_FT: RigidTransform, near: FloatArray) -> FloatArray:
        """Gives `joints` for positions (N, 3) and rotations (N, 3, 3) of the tip of a tool X_FT."""
        X = X_FT.as_matrix()
        R_BF = R_BT @ X[:3, :3].T
        return self.joints_of_flange(position - R_BF @ X[:3, 3], R_BF, near)

    def joints_of_flange(self, position: FloatArray, R_BF: FloatArray, near: FloatArray) -> FloatArray:
        """Gives `joints` for positions (N, 3) and rotations (N, 3, 3) of the flange."""
        between = self.model.between_links(near)
        along = self._closed_form.joints(position, R_BF, between, WRIST_WINDOW) if len(position) else None
        if along is not None:
            return self.model.from_links(along)
        X_BF = RigidTransform.from_components(position, Rotation.from_matrix(R_BF))
        raw: FloatArray = self.model.from_links(np.asarray(self._robot.batch_inverse(X_BF, tuple(between))))
        chained = np.vstack([near, raw])
        steps = np.diff(chained, axis=0)
        turns = np.round(np.nan_to_num(steps) / _TURN)
        followed = raw - _TURN * np.cumsum(turns, axis=0)
        return through_wrist(np.vstack([near, followed]))[1:] if np.any(np.abs(followed[:, 4]) < WRIST_WINDOW) else followed

    def joints_with_wrist(self, position: FloatArray, wrist: FloatArray, X_FT: RigidTransform, near: FloatArray) -> FloatArray:
        """Gives joints (N, 6) that bring the tool's tip to positions (N, 3) m with axes 4 to 6 (N, 3) given.

        near (N, 3): axes 1 to 3 from which Newton's method begins; rows are NaN where it finds none.
        """
        q = np.concatenate([near, wrist], axis=1)
        steps = 1e-6 * np.eye(6)[:3]
        with np.errstate(invalid="ignore", divide="ignore"):
            for _ in range(_MOST_NEWTON_STEPS):
                miss = position - (self.flange(q) * X_FT).translation
                if np.nanmax(np.linalg.norm(miss, axis=1), initial=0.0) < _AT_THE_TIP:
                    break
                sides = [((self.flange(q + h) * X_FT).translation - (self.flange(q - h) * X_FT).translation) / 2e-6 for h in steps]
                slope = np.stack(sides, axis=2)
                determinant = np.abs(np.linalg.det(slope))
                slope[determinant < _FLAT] = np.nan
                step = np.linalg.solve(slope, miss[:, :, None])[:, :, 0]
                largest = np.abs(step).max(axis=1, keepdims=True)
                q[:, :3] += step * np.minimum(1.0, _LARGEST_NEWTON_STEP / np.maximum(largest, 1e-12))
        q[~(np.linalg.norm(position - (self.flange(q) * X_FT).translation, axis=1) < 10 * _AT_THE_TIP)] = np.nan
        return q

    def solutions(self, X_BF: RigidTransform) -> FloatArray:
        """Gives up to eight joint vectors (K, 6) for one pose, each axis within +-pi; K = 0 if out of reach."""
        found = self.model.from_links(np.array(self._robot.inverse(X_BF), dtype=np.float64).reshape(-1, 6))
        return (found + np.pi) % _TURN - np.pi

    def solution_index(self, q: FloatArray) -> int:
        """Gives cfx 0..7 of joints (6,): wrist behind axis 1 (4), wrist behind the lower arm (2), axis 5 negative (1)."""
        opw, (_, lean, bend, *_) = self.model.opw, self.model.between_links(q)
        forearm = lean + bend
        wrist_x = opw.c3 * np.cos(forearm) - opw.a2 * np.sin(forearm)
        wrist_z = -opw.c3 * np.sin(forearm) - opw.a2 * np.cos(forearm)
        behind_axis_1 = opw.a1 + opw.c2 * np.sin(lean) + wrist_x < 0
        behind_lower_arm = wrist_x * np.cos(lean) - wrist_z * np.sin(lean) < 0
        return 4 * int(behind_axis_1) + 2 * int(behind_lower_arm) + int(q[4] < 0)

    def configuration(self, q: FloatArray) -> Configuration:
        """Gives the configuration of joints (6,)."""
        cf1, cf4, cf6 = (int(np.floor(q[axis] / _QUARTER + 1e-9)) for axis in (0, 3, 5))
        return Configuration(cf1, cf4, cf6, self.solution_index(q))

    def within_limits(self, q: FloatArray, slack: float = 1e-9) -> bool:
        """Gives whether joints (6,) or (N, 6) keep the axis limits to within `slack` rad."""
        return bool((q >= self.model.lower - slack).all() and (q <= self.model.upper + slack).all())

    def turned_near(self, q: FloatArray, near: FloatArray) -> FloatArray:
        """Gives q (6,) with every axis turned by full turns as near to `near` as its limits allow; ranges reach beyond half a turn."""
        best = q.copy()
        for axis in range(len(q)):
            turns = q[axis] + _TURN * np.arange(-3, 4)
            allowed = turns[(turns >= self.model.lower[axis] - 1e-9) & (turns <= self.model.upper[axis] + 1e-9)]
            if len(allowed):
                best[axis] = allowed[np.argmin(np.abs(allowed - near[axis]))]
        return best

    def nearest(self, X_BF: RigidTransform, near: FloatArray) -> FloatArray | None:
        r"""Gives the joints (6,) for one pose within the limits and nearest to `near`; None if there are none.

        Main axes that are folded as at `near` go first, however far: ConfJ \Off changes only the wrist (`facts/rapid.md`).
        """
        candidates = [self.turned_near(q, near) for q in self.solutions(X_BF)]
        within = [q for q in candidates if self.within_limits(q)]
        folded = self.solution_index(near) // 2
        allowed = [q for q in within if self.solution_index(q) // 2 == folded] or within
        return min(allowed, key=lambda q: float(np.sum(np.abs(q - near))), default=None)

    def configured(self, X_BF: RigidTransform, wanted: Configuration) -> FloatArray | None:
        """Gives the joints (6,) for one pose in the wanted configuration, within the limits; None if there are none."""
        middle = np.zeros(6)
        for axis, quarter in ((0, wanted.cf1), (3, wanted.cf4), (5, wanted.cf6)):
            middle[axis] = (quarter + 0.5) * _QUARTER
        candidates = [self.turned_near(q, middle) for q in self.solutions(X_BF) if self.solution_index(q) == wanted.cfx % 8]
        allowed = [q for q in candidates if self.within_limits(q) and self.matches(q, wanted)]
        return min(allowed, key=lambda q: float(np.sum(np.abs(q - middle))), default=None)

    def matches(self, q: FloatArray, wanted: Configuration) -> bool:
        """Gives whether joints (6,) are in the wanted configuration, to within CONFIGURATION_TOLERANCE."""
        if self.solution_index(q) != wanted.cfx % 8:
            return False
        for axis, quarter in ((0, wanted.cf1), (3, wanted.cf4), (5, wanted.cf6)):
            low, high = quarter * _QUARTER, (quarter + 1) * _QUARTER
            if not low - CONFIGURATION_TOLERANCE - 1e-6 <= q[axis] <= high + CONFIGURATION_TOLERANCE + 1e-6:
                return False
        return True


def through_wrist(q: FloatArray) -> FloatArray:
    """Gives joints (N, 6) with axes 4 and 6 led evenly through axis 5 = 0, where a path crosses that straight.

    A path in the arm's own plane does; but rounding puts it a hair aside, and then the wrist would have to turn over in no time.
    """
    led = q.copy()
    inside = np.abs(q[:, 4]) < WRIST_WINDOW
    edges = np.flatnonzero(np.diff(inside.astype(np.int8)))
    for before, last in zip(edges[~inside[edges]], edges[inside[edges]][int(inside[0]) :], strict=False):
        after, run = last + 1, slice(before + 1, last + 1)
        half_turns = np.round((led[after, 3] - led[before, 3]) / np.pi)
        other = half_turns % 2 == 1  # the wrist's other solution goes on from the one before
        turned = led[after, 3] - half_turns * np.pi - led[before, 3]
        if abs(turned) >= STRAIGHT_THROUGH or (led[before, 4] * led[after, 4] < 0) == other:
            continue
        led[after:, 3] -= half_turns * np.pi
        led[after:, 5] += half_turns * np.pi
        if other:
            led[after:, 4] *= -1
        size = np.abs(led[run, 4])
        closest = int(np.argmin(size))
        signs = np.where(np.arange(len(size)) < closest, 1.0, -1.0) * np.sign(led[before, 4])
        axis_5 = signs * size
        beside = np.concatenate([[led[before, 4]], axis_5, [led[after, 4]]])[[closest, closest + 2]]
        axis_5[closest] = np.copysign(size[closest], beside.sum())  # the closest may lie on either side of 0
        share = np.clip((axis_5 - led[before, 4]) / (led[after, 4] - led[before, 4]), 0.0, 1.0)
        axis_4 = led[before, 3] + share * (led[after, 3] - led[before, 3])
        sum_4_6 = _TURN * np.round((led[before, 3] + led[before, 5] - led[run, 3] - led[run, 5]) / _TURN) + led[run, 3] + led[run, 5]
        led[run, 3], led[run, 4], led[run, 5] = axis_4, axis_5, sum_4_6 - axis_4
    return led
