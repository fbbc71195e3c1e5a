"""From one motion effect to one leg: where it begins and ends, by which solution, with every refusal at its RAPID line.

Invariant: a leg begins where the one before it ended; its joints are within the axis limits all along.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import cumulative_simpson
from scipy.spatial.transform import RigidTransform, Rotation

from mitl.motion import bridge
from mitl.motion.dynamics import AS_FAST_AS_IT_CAN, Dynamics
from mitl.motion.following import Following
from mitl.motion.kinematics import Arm
from mitl.motion.legs import Arc, CartesianLeg, GeometryError, JointLeg, Leg, Line, arc_through, line_through
from mitl.motion.limits import LegSpeed
from mitl.motion.orientation import HeldWrist, OrientationLaw, Turn, even_turn, evenly, path_frame_turn, turn_through
from mitl.motion.path import Corner
from mitl.motion.refusals import beyond, place, refusal
from mitl.motion.robot_model import RobotModel
from mitl.motion.settings import DEFAULT, MoveSettings
from mitl.motion.tracking import followed, refuse_beyond_limits
from mitl.paths import FloatArray
from rapid_interp import data, effects

_QUADRATURE = 64
_AXIS_4_LOCKED = 0.5
"""How far in deg axis 4 may be from 0 or +-180 to count as locked there. ASSUMPTION A-155."""
_MOST_KEPT = 256
"""Orientations of targets that are kept."""
_SHORTEST_MOVE = 5e-7
"""A move of less length in m is none: the arm stands, and the next move begins where it stands."""


@dataclass(frozen=True, eq=False)
class PlannedMove:
    """One motion effect with its leg, its programmed speed and its zone radii in m; fine has none. dynamics: how hard it may accelerate.

    following: how the arm is carried with a belt meanwhile. Then the leg lies where the belt was when its work piece was connected, and
    X_BO where the piece passed the sensor.
    """

    effect: effects.Motion
    leg: Leg
    speed: LegSpeed
    zone: Corner
    X_BO: RigidTransform
    dynamics: Dynamics = AS_FAST_AS_IT_CAN
    settings: MoveSettings = DEFAULT
    following: Following | None = None

    @property
    def fastest(self) -> float:
        """Gives the greatest programmed speed in m of the leg's coordinate a second."""
        leg, speed = self.leg, self.speed
        if speed.duration is not None:
            return leg.length / speed.duration
        return speed.tcp * leg.length / leg.travel if leg.travel > 0 else np.inf

    @property
    def fine(self) -> bool:
        """Gives whether the robot stops at the end of the move."""
        return self.effect.zone.finep


class MovePlanner:
    """Makes the legs of one arm. `orientation_law` is where a controller under development may turn the tool wrongly."""

    def __init__(self, model: RobotModel, *, orientation_law: OrientationLaw = evenly) -> None:
        self.model = model
        self.arm = Arm(model)
        self._law = orientation_law
        self._tools: dict[data.Pose, RigidTransform] = {}
        nowhere = RigidTransform.identity()
        self._arrived = (np.empty(0), nowhere, np.zeros(3), Rotation.identity())
        self._frame, self._X_BD, self._turned = nowhere, np.eye(4), dict[data.Orient, Rotation]()

    def plan(self, effect: effects.Motion, q_start: FloatArray, settings: MoveSettings) -> PlannedMove:
        """Gives the leg of one instruction that begins at joints q_start (6,) rad. Raises MotionError where it cannot be moved as told."""
        if not effect.tool.robhold:
            raise refusal(effect, "a stationary tool (robhold FALSE) is not supported yet")
        if effect.wobj.robhold or not effect.wobj.ufprog:
            raise refusal(effect, "a work object held by a robot or moved by a mechanical unit is not supported yet")
        try:
            # One transform a tool: legs compare tools by identity.
            X_FT = self._tools.setdefault(effect.tool.tframe, bridge.tool_frame(effect.tool))
            X_BO = bridge.work_object_frame(effect.wobj)
            X_BD = bridge.displaced_frame(effect.wobj.uframe, effect.wobj.oframe, settings.displacement)
            leg = self._leg(effect, q_start, X_FT, X_BD, settings)
            if leg.length < _SHORTEST_MOVE:
                leg = JointLeg(q_start, q_start, X_FT, 0.0, 0.0, 0.0)
        except (GeometryError, ValueError) as error:
            raise refusal(effect, str(error)) from error
        return PlannedMove(effect, leg, self._speed(effect), _zone(effect), X_BO, settings=settings)

    def _leg(self, effect: effects.Motion, q_start: FloatArray, X_FT: RigidTransform, X_BD: RigidTransform, settings: MoveSettings) -> Leg:
        """Gives the leg; X_BD: the displaced work object, in which targets are."""
        match effect:
            case effects.MoveAbsJ():
                q_end = bridge.joints_of(effect.target)
                refuse_beyond_limits(self.arm, effect, q_end)
                return self._joint_leg(q_start, q_end, X_FT)
            case effects.MoveJ():
                X_BF = X_BD * bridge.target_frame(effect.target) * X_FT.inv()
                return self._joint_leg(q_start, self._end_of_joint_move(effect, X_BF, q_start, settings), X_FT)
            case effects.MoveL() | effects.MoveC():
                return self._cartesian_leg(effect, q_start, X_FT, X_BD, settings)

    def _joint_leg(self, q_start: FloatArray, q_end: FloatArray, X_FT: RigidTransform) -> JointLeg:
        """Gives the leg with the TCP's way, and its greatest speeds, by differences at both ends and in between."""
        step = 1e-4
        shares = np.linspace(0, 1 - step, _QUADRATURE + 1)[:, None]
        here, there = (self.arm.flange(q_start + s * (q_end - q_start)) * X_FT for s in (shares, shares + step))
        speeds = np.linalg.norm(there.translation - here.translation, axis=1) / step
        turns = (here.rotation.inv() * there.rotation).magnitude() / step
        ways = np.maximum.accumulate(cumulative_simpson(speeds, dx=1 / _QUADRATURE, initial=0.0))
        return JointLeg(q_start, q_end, X_FT, float(ways[-1]), float(speeds.max()), float(turns.max()), ways)

    def _end_of_joint_move(self, effect: effects.MoveJ, X_BF: RigidTransform, near: FloatArray, settings: MoveSettings) -> FloatArray:
        if len(self.arm.solutions(X_BF)) == 0:
            raise refusal(effect, f"target {_point(X_BF)} is out of reach")
        wanted = bridge.configuration_of(effect.target)
        q_end = self.arm.configured(X_BF, wanted) if settings.joint else self.arm.nearest(X_BF, near)
        if q_end is not None:
            return q_end
        possible = [self.arm.turned_near(q, near) for q in self.arm.solutions(X_BF)]
        allowed = [str(self.arm.configuration(q)) for q in possible if self.arm.within_limits(q)]
        if not allowed:
            raise refusal(effect, f"target {_point(X_BF)} can only be reached beyond an axis limit: {beyond(self.model, possible[0])}")
        raise refusal(
            effect,
            f"configuration {wanted} cannot be reached at the target; possible are {', '.join(sorted(set(allowed)))} (or use ConfJ \\Off)",
        )

    def _cartesian_leg(
        self,
        effect: effects.MoveL | effects.MoveC,
        q_start: FloatArray,
        X_FT: RigidTransform,
        X_BD: RigidTransform,
        settings: MoveSettings,
    ) -> CartesianLeg:
        start, R_start = self._tip(q_start, X_FT)
        end, R_end = self._placed(X_BD, effect.target)
        curve: Line | Arc
        turn: Turn
        match effect:
            case effects.MoveL():
                curve, turn = line_through(start, end), even_turn(R_start, R_end, self._law)
            case effects.MoveC():
                via, R_via = self._placed(X_BD, effect.via)
                curve = arc_through(start, via, end)
                turn = self._arc_turn(effect, curve, (R_start, R_via, R_end), settings)
        if settings.singularity != "off":
            turn = self._held_wrist(effect, q_start, RigidTransform.from_components(end, R_end) * X_FT.inv(), settings)
        leg = followed(self.arm, effect, CartesianLeg(curve, turn, X_FT, np.zeros(1), q_start[None]))
        if settings.linear and not self.arm.matches(leg.q_end, bridge.configuration_of(effect.target)):
            wanted = bridge.configuration_of(effect.target)
            raise refusal(
                effect, f"the move ends in configuration {self.arm.configuration(leg.q_end)}, programmed is {wanted} (or use ConfL \\Off)"
            )
        if leg.held_wrist is None:
            self._arrived = (leg.q_end, X_FT, end, R_end)
        return leg

    def _tip(self, q: FloatArray, X_FT: RigidTransform) -> tuple[FloatArray, Rotation]:
        """Gives position and rotation of the tool's tip at joints (6,) rad; where the last leg ended there, as programmed."""
        known, tool, position, rotation = self._arrived
        if q is known and X_FT is tool:
            return position, rotation
        X_BT = self.arm.flange(q) * X_FT
        return X_BT.translation, X_BT.rotation

    def _placed(self, X_BD: RigidTransform, target: data.RobTarget) -> tuple[FloatArray, Rotation]:
        """Gives position and rotation of a target in the base frame; many targets of a frame have one orientation."""
        if X_BD is not self._frame:
            self._frame, self._X_BD, self._turned = X_BD, X_BD.as_matrix(), {}
        trans = target.trans
        position = self._X_BD[:3, :3] @ (bridge.MM * np.array([trans.x, trans.y, trans.z])) + self._X_BD[:3, 3]
        rotation = self._turned.get(target.rot)
        if rotation is None:
            if len(self._turned) >= _MOST_KEPT:
                self._turned = {}
            rotation = self._turned[target.rot] = X_BD.rotation * bridge.rotation_of(target.rot)
        return position, rotation

    def _arc_turn(self, effect: effects.MoveC, arc: Arc, R: tuple[Rotation, Rotation, Rotation], settings: MoveSettings) -> Turn:
        """Gives how the tool turns along an arc through three orientations, by CirPathMode."""
        R_start, R_via, R_end = R
        match settings.circle:
            case "PathFrame":
                return path_frame_turn(R_start, R_end, np.cross(arc.u, arc.v), arc.travel / arc.radius, self._law)
            case "ObjectFrame":
                return even_turn(R_start, R_end, self._law)
            case "CirPointOri":
                return turn_through(R_start, R_via, R_end, arc.via / arc.travel, self._law)
        raise refusal(effect, f"CirPathMode \\{settings.circle} is not supported: expected PathFrame, ObjectFrame or CirPointOri")

    def _held_wrist(self, effect: effects.Motion, q_start: FloatArray, X_BF: RigidTransform, settings: MoveSettings) -> HeldWrist:
        """Gives the joint-interpolated wrist of a linear or circular move with SingArea."""
        q_end = self.arm.nearest(X_BF, q_start)
        if q_end is None:
            raise refusal(effect, f"target {_point(X_BF)} is out of reach")
        if settings.singularity == "lock_axis_4":
            off = [float(np.degrees(np.abs((q[3] + np.pi / 2) % np.pi - np.pi / 2))) for q in (q_start, q_end)]
            if max(off) > _AXIS_4_LOCKED or abs(q_end[3] - q_start[3]) > np.radians(2 * _AXIS_4_LOCKED):
                axis_4 = " to ".join(f"{np.degrees(q[3]):.2f}" for q in (q_start, q_end))
                raise refusal(effect, f"SingArea \\LockAxis4 wants axis 4 at 0 or +-180 deg all along; it would go from {axis_4} deg")
        return HeldWrist(q_start[3:], q_end[3:])

    def _speed(self, effect: effects.Motion) -> LegSpeed:
        tcp = bridge.MM * (effect.speed.v_tcp if effect.tcp_speed is None else effect.tcp_speed)
        if tcp <= 0 or effect.speed.v_ori <= 0:
            raise refusal(effect, f"speed must be positive, is {1e3 * tcp:g} mm/s and {effect.speed.v_ori:g} deg/s")
        if effect.duration is not None and effect.duration <= 0:
            raise refusal(effect, f"\\T must be positive, is {effect.duration:g} s")
        return LegSpeed(min(tcp, self.model.vmax), np.radians(effect.speed.v_ori), effect.duration)


def _zone(effect: effects.Motion) -> Corner:
    zone = effect.zone
    if zone.finep:
        return Corner(0.0, 0.0)
    radius = zone.pzone_tcp if effect.zone_mm is None else effect.zone_mm
    return Corner(bridge.MM * radius, bridge.MM * max(radius, zone.pzone_ori))


def _point(X_BF: RigidTransform) -> str:
    return "with the flange at " + place(X_BF.translation)
