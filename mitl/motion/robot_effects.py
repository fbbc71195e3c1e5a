"""RobotEffects: how the effects of a task act on the motion of its arm: moves with their settings and triggers, stops, paths put aside.

Invariant: an effect either acts as ABB's controller would, or is refused with its line, or is told in the event log as left out.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import astuple, dataclass, replace
from enum import Enum
from functools import partial

import numpy as np

from mitl.motion.dynamics import AS_FAST_AS_IT_CAN, Dynamics
from mitl.motion.followed_moves import FollowedMoves
from mitl.motion.following import ConveyorUnits
from mitl.motion.motion_queue import MotionQueue
from mitl.motion.refusals import refusal
from mitl.motion.segments import Queued
from mitl.motion.settings import MoveSettings
from rapid_interp import data, effects

REGAIN_DISTANCE = np.radians(10.0)
"""A joint may be this far (rad) from where the motion stopped for `StartMove` to go back by itself. ASSUMPTION A-136."""
_REGAIN_SPEED = data.SpeedData(100.0, 50.0, 100.0, 50.0)
_THERE = 1e-6
_UNUSED = 0.9 * data.UNUSED_AXIS


class StopKind(Enum):
    """How an arm is stopped; always along its path. After an emergency stop the motors are off."""

    PROGRAM = "program stop"
    QUICK = "quick stop"
    EMERGENCY = "emergency stop"


_HARDNESS = {StopKind.PROGRAM: 0.5, StopKind.QUICK: 1.0, StopKind.EMERGENCY: 1.0}
"""Shares of the arm's path acceleration with which it is stopped. ASSUMPTION A-137."""


@dataclass(frozen=True)
class _Velocity:
    """VelSet: share of programmed speeds, most mm/s of the TCP."""

    share: float = 1.0
    most_mm_s: float = math.inf

    def limited(self, effect: effects.Motion) -> effects.Motion:
        r"""Gives a motion with the speeds that are in force; a time given by `\T` stays."""
        if self.share == 1 and self.most_mm_s == math.inf:
            return effect
        speed = effect.speed
        tcp = None if effect.tcp_speed is None else min(self.share * effect.tcp_speed, self.most_mm_s)
        limited = replace(speed, v_tcp=min(self.share * speed.v_tcp, self.most_mm_s), v_ori=self.share * speed.v_ori)
        return replace(effect, speed=limited, tcp_speed=tcp)


class RobotEffects:
    """The motion side of one task.

    triggered: carries out the action of a trigger at a time in s. told: enters a text in the event log. units: the controller's conveyors.
    """

    def __init__(
        self,
        motion: MotionQueue,
        *,
        triggered: Callable[[effects.Action, float], None],
        told: Callable[[float, str], None],
        units: ConveyorUnits,
    ) -> None:
        self.motion = motion
        self.followed = FollowedMoves(motion.planner, motion.record, units)
        self.settings = MoveSettings()
        self.last: effects.Motion | None = None
        self._dynamics: Dynamics = AS_FAST_AS_IT_CAN
        self._velocity = _Velocity()
        self._triggered = triggered
        self._told = told
        self._warned: set[str] = set()

    def add(self, effect: effects.Motion, triggers: tuple[effects.Trigger, ...], now: float) -> Queued:
        """Puts a move, with what happens on its way, behind the others. Raises MotionError where it cannot be moved as told."""
        self._warn_of_external_axes(effect, now)
        motion = self.motion
        plan = self.followed.plan(self._velocity.limited(effect), motion.programmed, self.settings, now)
        queued = motion.add(replace(plan, dynamics=self._dynamics))
        for trigger in triggers:
            motion.at_place(queued, trigger, partial(self._triggered, trigger.action))
        self.last = effect
        return queued

    def set(self, effect: effects.SetConfiguration | effects.Setting, now: float) -> bool:
        """Puts a setting in force for the moves to come; False if the effect is none."""
        match effect:
            case effects.SetConfiguration() | effects.SetSingularity() | effects.SetCirclePathMode() | effects.SetDisplacement():
                self.settings = self.settings.after(effect)
            case effects.SetLoad():
                self.settings = self.settings.after(effect)
            case effects.SetVelocity():
                self._velocity = _Velocity(effect.override / 100, effect.max_tcp)
            case effects.SetAcceleration():
                self._dynamics = replace(self._dynamics, acceleration=effect.acceleration / 100)
            case effects.LimitPathAcceleration():
                most = (math.inf if limit is None else limit for limit in (effect.acceleration, effect.deceleration))
                acceleration, deceleration = most
                self._dynamics = replace(self._dynamics, path_acceleration=acceleration, path_deceleration=deceleration)
            case effects.LimitWorldAcceleration():
                if effect.acceleration is not None:
                    raise refusal(effect, "a limit of acceleration in the world (WorldAccLim \\On) is not simulated; PathAccLim is")
            case effects.SetSoftness():
                if effect.axis is not None:
                    self._warn(now, "SoftAct", "soft servo is not simulated: the axes stay stiff")
            case effects.SetAxisOffsets():
                if any(abs(offset) > 0 and offset < _UNUSED for offset in astuple(effect.offsets)):
                    self._warn(now, "EOffs", "external axes are not simulated: their offsets are left out")
            case effects.ActivateUnit() if effect.unit in self.followed.units:
                self.followed.units.activate(effect.unit, effect.active)
            case effects.ActivateUnit():
                self._warn(now, f"unit {effect.unit}", f"mechanical unit {effect.unit} is not simulated: ActUnit and DeactUnit do nothing")
            case _:
                return False
        return True

    def refresh_speed(self, effect: effects.RefreshSpeed, now: float) -> None:
        """Puts the program's share of all speeds in force, for the motion under way too."""
        self.motion.change_speed(replace(self.motion.ratios, program=effect.override / 100), now)

    def stop(self, now: float, kind: StopKind) -> float:
        """Stops the arm along its path; gives the time in s from which on it stands."""
        return self.motion.stop(now, _HARDNESS[kind] * self.motion.planner.model.tcp_acceleration)

    def go(self, now: float) -> effects.Failed | None:
        """Lets the stopped motion go on; gives why it cannot: the arm is too far from its path."""
        place = self.motion.resting_place
        if place is not None:
            away = float(np.abs(place - self.motion.record.joints_planned_last).max())
            if away > REGAIN_DISTANCE:
                reason = (
                    f"the robot is {np.degrees(away):.1f} deg from where its path stopped, more than {np.degrees(REGAIN_DISTANCE):.0f} deg"
                )
                return effects.Failed("ERR_PATHDIST", reason)
            if away > _THERE and self.last is not None:
                robax = data.RobJoint(*np.degrees(place).tolist())
                back = effects.MoveAbsJ(
                    at=self.last.at, speed=_REGAIN_SPEED, zone=data.ZoneData(finep=True), tool=self.last.tool, wobj=self.last.wobj,
                    target=data.JointTarget(robax, data.ExtJoint()),
                )  # fmt: skip
                self.motion.regain(self.motion.planner.plan_move(back, self.motion.record.joints_planned_last, self.settings), now)
        self.motion.go(now)
        return None

    def brought_to_rest(self, now: float) -> float:
        """Stops the arm if it moves, without holding what comes; gives the time in s from which on it stands."""
        if self.motion.standing_from() <= now:
            return now
        held = self.motion.held
        standing = self.stop(now, StopKind.PROGRAM)
        self.motion.held = held
        return standing

    def take_back(self, now: float) -> effects.Failed | None:
        """Takes the path back that was put aside last, and goes on with it unless it was stopped; gives why it cannot."""
        if not self.motion.take_back():
            return effects.Failed("", "RestoPath without StorePath: no path was put aside")
        return None if self.motion.held else self.go(now)

    def _warn_of_external_axes(self, effect: effects.Motion, now: float) -> None:
        used = [name for name, value in zip("abcdef", astuple(effect.target.extax), strict=True) if value < _UNUSED]
        if used and any(getattr(effect.target.extax, f"eax_{name}") != 0 for name in used):
            at = effect.at
            self._warn(
                now, "external axes", f"external axes are not simulated: eax_{', eax_'.join(used)} at {at.module}:{at.line} stay still"
            )

    def _warn(self, now: float, topic: str, text: str) -> None:
        if topic not in self._warned:
            self._warned.add(topic)
            self._told(now, text)
