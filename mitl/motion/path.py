"""Path: the legs of one chain of moves, joined by corner zones, as functions of one path coordinate s in m.

s is the TCP's arc length wherever the TCP travels more than it turns. Invariant: outside zones the TCP is on its line or circle exactly.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, PPoly
from scipy.spatial.transform import RigidTransform, Rotation

from mitl.motion.coordinate import CornerNodes, chain_nodes, quintic, regular
from mitl.motion.kinematics import Arm
from mitl.motion.legs import CartesianLeg, JointLeg, Leg
from mitl.motion.zones import FLAT, blended, off_corner, orientation_blend, position_blend, position_blend_slope
from mitl.paths import BoolArray, FloatArray

IndexArray = NDArray[np.intp]

_NODES = 33
_SHORTEST_PIECE = 1e-7
_WAY_STEPS = 2000
"""Chords by which the TCP's way on a joint leg is measured; a metre of it bent by a radian is then right to .01 um."""
_STEP = 2e-3
"""Share of a zone's radius over which a leg's tangent and bend in joint space are taken."""


@dataclass(frozen=True)
class Corner:
    """The zone between two legs: radius of the TCP zone and of the orientation zone, m of TCP travel; 0 is no zone."""

    radius: float
    turn_radius: float


@dataclass(frozen=True, eq=False)
class Sample:
    """The path at N coordinates: position (N, 3) m and rotation of the active TCP in the base frame, joints (N, 6) rad, leg index (N,)."""

    position: FloatArray
    rotation: Rotation
    joints: FloatArray
    leg: IndexArray


@dataclass(frozen=True, eq=False)
class Pieces:
    """K pieces of a path: edges (K+1,) in m of s, the leg (K,) each belongs to, and the corner (K,) whose TCP zone it lies in, or -1."""

    edges: FloatArray
    leg: IndexArray
    zone: IndexArray


class Path:
    """Legs and corners in a row. `corners[i]` lies between legs i and i + 1."""

    def __init__(self, arm: Arm, legs: Sequence[Leg], corners: Sequence[Corner]) -> None:
        self.arm = arm
        self.legs = tuple(legs)
        self.corners = tuple(corners)
        self._begins = np.concatenate([[0.0], np.cumsum([leg.length for leg in self.legs])])
        self._into = np.ones(len(self.corners))
        """m of coordinate of the leg before a corner per m of its TCP's way, over the zone; `_out_of`: of the leg behind it."""
        self._out_of = np.ones(len(self.corners))
        zones = [index for index in range(len(self.corners)) if self.corners[index].radius > 0]
        for index in zones:
            a, b, radius = self.legs[index], self.legs[index + 1], self.corners[index].radius
            self._into[index] = (a.length - a.coordinate(a.travel - radius)) / radius
            self._out_of[index] = b.coordinate(radius) / radius
        self._unevenness = np.zeros(len(self.corners))
        if self._begins[-1] < _SHORTEST_PIECE:  # moves to where the arm stands
            self.length = 0.0
            self._g_of_s = self._s_of_g = PPoly(np.array([[1.0], [0.0]]), np.array([0.0, 1.0]))
            return
        nodes = [self._nodes_of_corner(index) for index in zones]
        for index, corner in zip(zones, nodes, strict=True):
            self._unevenness[index] = np.log(corner.after.max() / corner.after.min())
        chained = chain_nodes(nodes, float(self._begins[-1]))
        s = np.concatenate([[0.0], np.cumsum(chained.way)])
        self.length = float(s[-1])
        after, before = 1 / chained.after, 1 / chained.before
        self._g_of_s = quintic(s, chained.g, after, before, -chained.bend_after * after**3, -chained.bend_before * before**3)
        self._s_of_g = quintic(chained.g, s, chained.after, chained.before, chained.bend_after, chained.bend_before)

    def pieces(self) -> Pieces:
        """Gives the path's pieces, within which it is smooth: cut at programmed points, at zones' edges and where zones' blends bend."""
        edges: list[float] = []
        legs: list[int] = []
        zones: list[int] = []
        for index, leg in enumerate(self.legs):
            length = leg.length
            entered, turned_in = self._spans(index - 1, self._out_of) if index > 0 else (0.0, 0.0)
            leaving, turning_out = self._spans(index, self._into) if index < len(self.corners) else (0.0, 0.0)
            left = length - leaving
            bends = entered * FLAT, length - leaving * FLAT  # where the blend's third derivative jumps
            marks = sorted({0.0, *bends, entered, turned_in, length - turning_out, left})
            inside = [mark for mark in marks if 0.0 <= mark < length - _SHORTEST_PIECE]
            kept = [mark for mark, following in itertools.pairwise([*inside, length]) if following - mark > _SHORTEST_PIECE or mark == 0.0]
            for low, high in itertools.pairwise([*kept, length]):
                middle = 0.5 * (low + high)
                edges.append(self._begins[index] + low)
                legs.append(index)
                zones.append(index - 1 if middle < entered else index if middle > left else -1)
        ends = np.array([*edges, self._begins[-1]])
        return Pieces(np.asarray(self._s_of_g(ends)), np.array(legs, dtype=np.intp), np.array(zones, dtype=np.intp))

    def _spans(self, corner: int, stretch: FloatArray) -> tuple[float, float]:
        """Gives the m of a leg's coordinate that a corner's TCP zone and its orientation zone take."""
        return self.corners[corner].radius * float(stretch[corner]), self.corners[corner].turn_radius * float(stretch[corner])

    def close_marks(self) -> FloatArray:
        """Gives the path coordinates (M,) in m near singularities: where the legs' joints were followed in finer steps than elsewhere."""
        found = [np.empty(0)]
        for index, leg in enumerate(self.legs):
            if isinstance(leg, CartesianLeg) and len(leg.marks) > 2:
                width = np.diff(leg.marks)
                fine = width < 0.9 * width.max()
                found.append(self._begins[index] + leg.marks[1:-1][fine[:-1] | fine[1:]])
        marks = np.concatenate(found)
        return np.asarray(self._s_of_g(marks)) if len(marks) else marks

    def unevenness(self) -> FloatArray:
        """Gives for every corner (M,) the logarithm of how differently fast the path's and the legs' coordinates run; 0 without a zone."""
        return self._unevenness

    def leg_ends(self) -> FloatArray:
        """Gives the path coordinates (legs + 1,) in m of the programmed points: the start, the middles of the corners, the end."""
        return np.asarray(self._s_of_g(self._begins))

    def zone_begins(self) -> FloatArray:
        """Gives the path coordinates (legs + 1,) in m at which the zones about the programmed points begin; the points where none is."""
        spans = np.array([0.0, *(self._spans(index, self._into)[0] for index in range(len(self.corners))), 0.0])
        return np.asarray(self._s_of_g(self._begins - spans))

    def last_zone_begin(self, radius: float) -> float:
        """Gives the path coordinate in m at which a zone of a radius in m would begin, were there a leg behind the last one."""
        leg = self.legs[-1]
        own = self._begins[-2] + (leg.coordinate(leg.travel - min(radius, leg.travel / 2)) if leg.travel > 0 else leg.length)
        return float(self._s_of_g(own))

    def zone_widths(self) -> FloatArray:
        """Gives how many m of path the TCP zones of the corners (M,) take."""
        spans = np.array([(self._spans(index, self._into)[0], self._spans(index, self._out_of)[0]) for index in range(len(self.corners))])
        ends = self._begins[1:-1, None] + spans.reshape(-1, 2) * np.array([-1.0, 1.0])
        return np.asarray(np.diff(self._s_of_g(ends), axis=1)[:, 0])

    def coordinate(self, index: int, way: float) -> float:
        """Gives the path coordinate in m of a place on a leg, `way` m of the leg's own TCP travel after its programmed start.

        In a zone the place moves from the leg to the corner, whose own coordinate it keeps.
        """
        leg = self.legs[index]
        if isinstance(leg, JointLeg) and leg.travel > 0:
            shares = np.linspace(0.0, 1.0, _WAY_STEPS + 1)
            position = (self.arm.flange(leg.joints(leg.length * shares)) * leg.X_FT).translation
            ways = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(position, axis=0), axis=1))])
            x = leg.length * float(np.interp(way * ways[-1] / leg.travel, ways, shares))
        else:
            x = leg.coordinate(way) if leg.travel > 0 else 0.0
        return float(self._s_of_g(self._begins[index] + min(x, leg.length)))

    def sample(self, s: FloatArray) -> Sample:
        """Gives the path at ascending coordinates s (N,) in m. Joints are NaN where a pose is out of reach."""
        leg_of, x = self._locate(s)
        n = len(s)
        position, quaternion, joints = np.empty((n, 3)), np.empty((n, 4)), np.empty((n, 6))
        by_joints = np.zeros(n, dtype=bool)
        for index in np.unique(leg_of):
            here = np.flatnonzero(leg_of == index)
            mask = self._by_joints(index, x[here])
            by_joints[here] = mask
            if mask.any():
                joints[here[mask]] = self._joints_directly(index, x[here[mask]])
            if not mask.all():
                free = here[~mask]
                position[free], rotation = self._cartesian(index, x[free])
                quaternion[free] = rotation.as_quat()
        for run in _runs(by_joints, [leg.X_FT for leg in self.legs], leg_of):
            X_FT = self.legs[leg_of[run[0]]].X_FT
            if by_joints[run[0]]:
                X_BT = self.arm.flange(joints[run]) * X_FT
                position[run], quaternion[run] = X_BT.translation, X_BT.rotation.as_quat()
            else:
                R_BT = Rotation.from_quat(quaternion[run]).as_matrix()
                joints[run] = self.arm.joints_of_tip(position[run], R_BT, X_FT, self.legs[leg_of[run[0]]].joints_near(float(x[run[0]])))
        return Sample(position, Rotation.from_quat(quaternion), joints, leg_of)

    def positions(self, s: FloatArray) -> tuple[FloatArray, Rotation]:
        """Gives TCP positions (N, 3) and rotations in the base frame at ascending coordinates; quicker than `sample`."""
        leg_of, x = self._locate(s)
        position, quaternion = np.empty((len(s), 3)), np.empty((len(s), 4))
        for index in np.unique(leg_of):
            here = np.flatnonzero(leg_of == index)
            mask = self._by_joints(index, x[here])
            if mask.any():
                X_BT = self.arm.flange(self._joints_directly(index, x[here[mask]])) * self.legs[index].X_FT
                position[here[mask]], quaternion[here[mask]] = X_BT.translation, X_BT.rotation.as_quat()
            if not mask.all():
                free = here[~mask]
                position[free], rotation = self._cartesian(index, x[free])
                quaternion[free] = rotation.as_quat()
        return position, Rotation.from_quat(quaternion)

    def _locate(self, s: FloatArray) -> tuple[IndexArray, FloatArray]:
        g = np.clip(self._g_of_s(np.clip(s, 0.0, self.length)), 0.0, self._begins[-1])
        leg_of = np.clip(np.searchsorted(self._begins, g, side="right") - 1, 0, len(self.legs) - 1)
        return leg_of, g - self._begins[leg_of]

    def _joint_corner(self, index: int) -> bool:
        """Gives whether corner `index` is blended in joint space: beside a joint move, or where tool or kind of interpolation changes."""
        a, b = self.legs[index], self.legs[index + 1]
        if isinstance(a, JointLeg) or isinstance(b, JointLeg) or a.X_FT is not b.X_FT:
            return True
        return (a.held_wrist is None) != (b.held_wrist is None)

    def _corners_beside(self, index: int) -> list[int]:
        return [corner for corner in (index - 1, index) if 0 <= corner < len(self.corners) and self.corners[corner].radius > 0]

    def _u(self, corner: int, index: int, x: FloatArray, radius: float) -> FloatArray:
        """Gives the distance from the corner over `radius`, negative before it, of coordinates x on leg `index` beside it."""
        if corner == index - 1:
            return np.asarray(x / (radius * self._out_of[corner]))
        return np.asarray((x - self.legs[index].length) / (radius * self._into[corner]))

    def _by_joints(self, index: int, x: FloatArray) -> BoolArray:
        leg = self.legs[index]
        mask = np.full(len(x), isinstance(leg, JointLeg) or leg.held_wrist is not None)
        for corner in self._corners_beside(index):
            if self._joint_corner(corner):
                mask |= np.abs(self._u(corner, index, x, self.corners[corner].radius)) < 1
        return mask

    def _cartesian(self, index: int, x: FloatArray) -> tuple[FloatArray, Rotation]:
        leg = self.legs[index]
        assert isinstance(leg, CartesianLeg)  # noqa: S101 - narrows the type; _by_joints has sorted the others out
        position, rotation = leg.position(x), leg.rotation(x)
        for corner in self._corners_beside(index):
            if self._joint_corner(corner):
                continue
            a, b = self.legs[corner], self.legs[corner + 1]
            assert isinstance(a, CartesianLeg)  # noqa: S101 - see above
            assert isinstance(b, CartesianLeg)  # noqa: S101 - see above
            radius, turn_radius = self.corners[corner].radius, self.corners[corner].turn_radius
            u = self._u(corner, index, x, radius)
            inside = np.abs(u) < 1
            if inside.any():
                v = off_corner(u[inside])
                pa = a.position(a.length + v * radius * self._into[corner])
                pb = b.position(v * radius * self._out_of[corner])
                position[inside] = blended(pa, pb, v, position_blend(v))
            if turn_radius <= 0 or (a.turning == 0 and b.turning == 0):
                continue
            u = self._u(corner, index, x, turn_radius)
            inside = np.abs(u) < 1
            if inside.any():
                v = off_corner(u[inside])
                R_corner = b.rotation(np.zeros(1))
                turned_a = (R_corner.inv() * a.rotation(a.length + v * turn_radius * self._into[corner])).as_rotvec()
                turned_b = (R_corner.inv() * b.rotation(v * turn_radius * self._out_of[corner])).as_rotvec()
                vector = blended(turned_a, turned_b, v, orientation_blend(v))
                quaternion = rotation.as_quat()
                quaternion[inside] = (R_corner * Rotation.from_rotvec(vector)).as_quat()
                rotation = Rotation.from_quat(quaternion)
        return position, rotation

    def _joints_directly(self, index: int, x: FloatArray) -> FloatArray:
        """Gives joints (N, 6) on a joint leg, on a leg with joint-interpolated wrist, or in a joint-space corner."""
        leg = self.legs[index]
        if isinstance(leg, JointLeg):
            joints = leg.joints(x)
        else:
            joints = np.empty((len(x), 6)) if leg.held_wrist is None else self._with_held_wrist(index, x)
        for corner in self._corners_beside(index):
            if not self._joint_corner(corner):
                continue
            radius = self.corners[corner].radius
            u = self._u(corner, index, x, radius)
            inside = np.abs(u) < 1
            if inside.any():
                v = off_corner(u[inside])
                qa = self._extended(corner, v, radius * self._into[corner], end=True)
                qb = self._extended(corner + 1, v, radius * self._out_of[corner], end=False)
                joints[inside] = blended(qa, qb, v, position_blend(v))
        return joints

    def _with_held_wrist(self, index: int, x: FloatArray) -> FloatArray:
        """Gives joints (N, 6) on a leg with joint-interpolated wrist; in a zone to another such leg positions and wrists are blended."""
        leg = self.legs[index]
        assert isinstance(leg, CartesianLeg)  # noqa: S101 - narrows the type
        position, wrist = leg.position(x), _wrist(leg, x)
        for corner in self._corners_beside(index):
            a, b = self.legs[corner], self.legs[corner + 1]
            if self._joint_corner(corner) or not isinstance(a, CartesianLeg) or not isinstance(b, CartesianLeg):
                continue
            ka, kb = self._into[corner], self._out_of[corner]
            for radius, values, on_leg in (
                (self.corners[corner].radius, position, CartesianLeg.position),
                (self.corners[corner].turn_radius, wrist, _wrist),
            ):
                u = self._u(corner, index, x, radius)
                inside = np.abs(u) < 1
                if inside.any():
                    v = off_corner(u[inside])
                    va, vb = on_leg(a, a.length + v * radius * ka), on_leg(b, v * radius * kb)
                    values[inside] = blended(va, vb, v, position_blend(v))
        near = np.stack([np.interp(x, leg.marks, axis) for axis in leg.track[:, :3].T], axis=1)
        return self.arm.joints_with_wrist(position, wrist, leg.X_FT, near)

    def _extended(self, index: int, u: FloatArray, span: float, *, end: bool) -> FloatArray:
        """Gives a leg's joints (N, 6) at u spans (m) from its end or start; a Cartesian leg goes on beyond as a parabola in joint space.

        Its tangent alone would not do: with a bend on one side only the blend's slope would jump at the corner.
        """
        leg = self.legs[index]
        origin = leg.length if end else 0.0
        x = origin + u * span
        if isinstance(leg, JointLeg):
            return leg.joints(x)
        q_corner = leg.q_end if end else leg.q_start
        own = u < 0 if end else u > 0
        step = -_STEP if end else _STEP
        order = np.argsort(np.abs(u[own]))
        asked = np.concatenate([origin + step * np.array([1.0, 2.0, 3.0]) * span, x[own][order]])
        if leg.held_wrist is None:
            q = self.arm.joints_of_tip(leg.position(asked), leg.rotation(asked).as_matrix(), leg.X_FT, q_corner)
        else:
            q = self.arm.joints_with_wrist(leg.position(asked), _wrist(leg, asked), leg.X_FT, np.tile(q_corner[:3], (len(asked), 1)))
        tangent = (18 * q[0] - 9 * q[1] + 2 * q[2] - 11 * q_corner) / 6
        bend = 2 * q_corner - 5 * q[0] + 4 * q[1] - q[2]
        steps = (u / step)[:, None]
        joints = q_corner + steps * (tangent + 0.5 * steps * bend)
        joints[np.flatnonzero(own)[order]] = q[3:]
        return np.asarray(joints)

    def _nodes_of_corner(self, index: int) -> CornerNodes:
        """Gives nodes over a zone. ds/du is smooth over the corner, also where the legs' coordinates run differently fast."""
        radius = self.corners[index].radius
        ka, kb = self._into[index], self._out_of[index]
        u = np.linspace(-1, 1, 2 * _NODES - 1)  # every second one only serves Simpson's rule
        per_u = radius * np.exp(0.5 * ((1 - u) * np.log(ka) + (1 + u) * np.log(kb)))
        if not self._joint_corner(index):
            per_u *= regular(self._tcp_way(index, u))
        way = (per_u[:-2:2] + 4 * per_u[1:-1:2] + per_u[2::2]) * (u[2] - u[0]) / 6
        bend = CubicSpline(u, per_u)(u[::2], 1)
        u, per_u = u[::2], per_u[::2]
        before_corner = np.arange(_NODES - 1) < _NODES // 2
        k = radius * np.where(before_corner, ka, kb)  # of the intervals: dg/du jumps at the corner, where ds/du does not
        return CornerNodes(
            g=self._begins[index + 1] + u * radius * np.where(u < 0, ka, kb),
            way=way,
            after=per_u[:-1] / k,
            before=per_u[1:] / k,
            bend_after=bend[:-1] / k**2,
            bend_before=bend[1:] / k**2,
        )

    def _tcp_way(self, index: int, u: FloatArray) -> FloatArray:
        """Gives the TCP's way in radii per u at u (N,) in the zone between two Cartesian legs."""
        a, b = self.legs[index], self.legs[index + 1]
        assert isinstance(a, CartesianLeg)  # noqa: S101 - _joint_corner said so
        assert isinstance(b, CartesianLeg)  # noqa: S101 - _joint_corner said so
        radius = self.corners[index].radius
        v, h = np.where(u == 0, 1e-4, u), 1e-5  # the slope of 0 / 0 needs a wider berth than its value
        pa, pb = a.curve.position(a.travel + v * radius), b.curve.position(v * radius)
        da = (a.curve.position(a.travel + (v + h) * radius) - a.curve.position(a.travel + (v - h) * radius)) / (2 * h)
        db = (b.curve.position((v + h) * radius) - b.curve.position((v - h) * radius)) / (2 * h)
        ratio = position_blend(v) / (2 * v)
        ratio_slope = (position_blend_slope(v) - position_blend(v) / v) / (2 * v)
        velocity = 0.5 * (da + db) + ratio[:, None] * (db - da) + ratio_slope[:, None] * (pb - pa)
        return np.asarray(np.linalg.norm(velocity, axis=1) / radius)


def _wrist(leg: CartesianLeg, x: FloatArray) -> FloatArray:
    """Gives axes 4 to 6 (N, 3) in rad at coordinates (N,) of a leg that interpolates them."""
    assert leg.held_wrist is not None  # noqa: S101 - narrows the type
    return leg.held_wrist.angles(leg.share(x))


def _runs(by_joints: BoolArray, tools: list[RigidTransform], leg_of: IndexArray) -> list[IndexArray]:
    """Gives runs of sample indices with the same way of evaluation and the same tool."""
    tool_of_leg = np.array([next(i for i, other in enumerate(tools) if other is tool) for tool in tools])
    key = tool_of_leg[leg_of] * 2 + by_joints
    cuts = np.flatnonzero(np.diff(key)) + 1
    return [run for run in np.split(np.arange(len(leg_of)), cuts) if len(run)]
