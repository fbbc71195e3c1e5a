"""Path: the legs of one chain of moves, joined by corner zones, as functions of one path coordinate s in m.

s is the TCP's arc length wherever the TCP travels more than it turns. Invariant: outside zones the TCP is on its line or circle exactly.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline, PPoly
from scipy.spatial.transform import RigidTransform, Rotation

from mitl.motion.coordinate import CornerNodes, chain_nodes, quintic, regular
from mitl.motion.curves import Curves
from mitl.motion.kinematics import Arm
from mitl.motion.legs import CartesianLeg, JointLeg, Leg
from mitl.motion.zones import FLAT, blended, off_corner, orientation_blend, position_blend, position_blend_slope
from mitl.paths import BoolArray, FloatArray, IndexArray

_NODES = 33
_SHORTEST_PIECE = 1e-7
_WAY_STEPS = 2000
"""Chords by which the TCP's way on a joint leg is measured; a metre of it bent by a radian is then right to .01 um."""
_STEP = 2e-4
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
        self._lengths = np.array([leg.length for leg in self.legs])
        self._begins = np.concatenate([[0.0], np.cumsum(self._lengths)])
        self._curves = Curves(self.legs)
        self._radius = np.array([corner.radius for corner in self.corners])
        self._turn_radius = np.array([corner.turn_radius for corner in self.corners])
        self._by_joints_all = np.array([isinstance(leg, JointLeg) or leg.held_wrist is not None for leg in self.legs])
        self._in_joint_space = np.array([self._joint_corner(index) for index in range(len(self.corners))], dtype=bool)
        turning = np.array([leg.turning > 0 for leg in self.legs])
        self._turns = (self._turn_radius > 0) & ~self._in_joint_space & (turning[:-1] | turning[1:])
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
        nodes = self._nodes_of_corners(np.array(zones, dtype=np.intp))
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
        leg_of, x, by_joints, position, quaternion, joints = self._evaluated(s)
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
        """Gives TCP positions (N, 3) and rotations in the base frame at coordinates (N,); quicker than `sample`."""
        leg_of, _, by_joints, position, quaternion, joints = self._evaluated(s)
        for index in np.unique(leg_of[by_joints]):
            here = np.flatnonzero(by_joints & (leg_of == index))
            X_BT = self.arm.flange(joints[here]) * self.legs[index].X_FT
            position[here], quaternion[here] = X_BT.translation, X_BT.rotation.as_quat()
        return position, Rotation.from_quat(quaternion)

    def _evaluated(self, s: FloatArray) -> tuple[IndexArray, FloatArray, BoolArray, FloatArray, FloatArray, FloatArray]:
        """Gives, at coordinates (N,), legs, their coordinates, whether joints are interpolated there, and what is: poses or joints."""
        leg_of, x = self._locate(s)
        position, quaternion, joints = np.empty((len(s), 3)), np.tile([0.0, 0.0, 0.0, 1.0], (len(s), 1)), np.empty((len(s), 6))
        corner, u = self._corner_at(leg_of, x, self._radius)
        by_joints = self._by_joints_all[leg_of]
        if self._in_joint_space.any():
            by_joints = by_joints | ((corner >= 0) & self._in_joint_space[corner])
        for index in np.unique(leg_of[by_joints]):
            here = np.flatnonzero(by_joints & (leg_of == index))
            joints[here] = self._joints_directly(index, x[here])
        free = np.flatnonzero(~by_joints)
        if len(free):
            position[free], quaternion[free] = self._cartesian(leg_of[free], x[free], corner[free], u[free])
        return leg_of, x, by_joints, position, quaternion, joints

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

    def _corner_at(self, leg: IndexArray, x: FloatArray, radius: FloatArray) -> tuple[IndexArray, FloatArray]:
        """Gives the corners (N,) in whose zones of `radius` (M,) m coordinates x (N,) of legs lie, or -1, and the distances in radii."""
        with np.errstate(divide="ignore", invalid="ignore"):
            behind = x / np.append(radius * self._out_of, 0.0)[leg - 1]  # leg 0 has no corner before it
            before = (x - self._lengths[leg]) / np.append(radius * self._into, 0.0)[leg]
        entering = (leg > 0) & (np.abs(behind) < 1)
        leaving = np.abs(before) < 1
        return np.where(entering, leg - 1, np.where(leaving, leg, -1)), np.where(entering, behind, before)

    def _cartesian(self, leg: IndexArray, x: FloatArray, corner: IndexArray, u: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gives positions (N, 3) and quaternions (N, 4), `xyzw`, on Cartesian legs (N,); in zones of corners (N,) at u (N,)."""
        curves = self._curves
        position, quaternion = curves.position(leg, x), curves.quaternion(leg, x)
        inside = np.flatnonzero(corner >= 0)
        if len(inside):
            at, v = corner[inside], off_corner(u[inside])
            reach = v * self._radius[at]
            pa = curves.position(at, self._lengths[at] + reach * self._into[at])
            pb = curves.position(at + 1, reach * self._out_of[at])
            position[inside] = blended(pa, pb, v, position_blend(v))
        if self._turns.any():
            corner, u = self._corner_at(leg, x, self._turn_radius)
            inside = np.flatnonzero((corner >= 0) & self._turns[corner])
            if len(inside):
                at, v = corner[inside], off_corner(u[inside])
                reach = v * self._turn_radius[at]
                R_corner = Rotation.from_quat(curves.quaternion(at + 1, np.zeros(len(at))))
                before = Rotation.from_quat(curves.quaternion(at, self._lengths[at] + reach * self._into[at]))
                behind = Rotation.from_quat(curves.quaternion(at + 1, reach * self._out_of[at]))
                back = R_corner.inv()
                vector = blended((back * before).as_rotvec(), (back * behind).as_rotvec(), v, orientation_blend(v))
                quaternion[inside] = (R_corner * Rotation.from_rotvec(vector)).as_quat()
        return position, quaternion

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

    def _nodes_of_corners(self, corners: IndexArray) -> list[CornerNodes]:
        """Gives nodes over zones (M,). ds/du is smooth over a corner, also where the legs' coordinates run differently fast."""
        if len(corners) == 0:
            return []
        radius, ka, kb = self._radius[corners], self._into[corners], self._out_of[corners]
        u = np.linspace(-1, 1, 2 * _NODES - 1)[:, None]  # every second one only serves Simpson's rule
        per_u = radius * np.exp(0.5 * ((1 - u) * np.log(ka) + (1 + u) * np.log(kb)))
        free = ~self._in_joint_space[corners]
        per_u[:, free] *= regular(self._tcp_way(corners[free], u))
        way = (per_u[:-2:2] + 4 * per_u[1:-1:2] + per_u[2::2]) * (2 / (_NODES - 1)) / 6
        bend = CubicSpline(u[:, 0], per_u)(u[::2, 0], 1)
        u, per_u = u[::2], per_u[::2]
        before_corner = (np.arange(_NODES - 1) < _NODES // 2)[:, None]
        k = radius * np.where(before_corner, ka, kb)  # of the intervals: dg/du jumps at the corner, where ds/du does not
        g = self._begins[corners + 1] + u * radius * np.where(u < 0, ka, kb)
        found = g, way, per_u[:-1] / k, per_u[1:] / k, bend[:-1] / k**2, bend[1:] / k**2
        return [CornerNodes(*columns) for columns in zip(*(values.T for values in found), strict=True)]

    def _tcp_way(self, corners: IndexArray, u: FloatArray) -> FloatArray:
        """Gives the TCP's way (K, M) in radii per u at u (K, 1) in the zones (M,) between Cartesian legs."""
        shape = (len(u), len(corners))
        at, v = np.tile(corners, len(u)), np.repeat(np.where(u == 0, 1e-4, u)[:, 0], len(corners))  # the slope of 0 / 0 needs a wide berth
        radius, curves = self._radius[at], self._curves
        travel = np.array([leg.travel for leg in self.legs])[at]
        pa, pb = curves.position_after(at, travel + v * radius), curves.position_after(at + 1, v * radius)
        da, db = curves.tangent_after(at, travel + v * radius), curves.tangent_after(at + 1, v * radius)
        ratio = position_blend(v) / (2 * v)
        ratio_slope = (position_blend_slope(v) - position_blend(v) / v) / (2 * v)
        velocity = 0.5 * (da + db) + ratio[:, None] * (db - da) + (ratio_slope / radius)[:, None] * (pb - pa)
        return np.asarray(np.linalg.norm(velocity, axis=1).reshape(shape))


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
