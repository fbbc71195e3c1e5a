"""Moves beside, onto, on and off a conveyor belt, and the watch over an arm that follows one.

Invariant: an arm that follows a belt goes onto it and off it again along a line or an arc.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import RigidTransform

from mitl.motion import bridge
from mitl.motion.chain import Planner
from mitl.motion.following import Connection, ConveyorUnits, Following, FollowingError
from mitl.motion.moves import PlannedMove
from mitl.motion.record import TICK, MotionRecord
from mitl.motion.refusals import beyond, refusal
from mitl.motion.settings import MoveSettings
from mitl.paths import FloatArray
from rapid_interp import data, effects

_WATCH = 0.02
"""How often in s it is looked whether the arm can go on following."""
_TOO_FAST = 1.02
"""Share of a joint's speed limit beyond which following a belt is given up: 2 per cent for the difference of two samples."""


class FollowedMoves:
    """Plans moves in work objects that conveyors carry. units: None where the controller has no conveyor."""

    def __init__(self, planner: Planner, record: MotionRecord, units: ConveyorUnits) -> None:
        self.units = units
        self._planner = planner
        self._record = record
        self._on: Connection | None = None
        self._last: effects.Motion | None = None
        self._watched = -math.inf

    @property
    def follows(self) -> bool:
        """Gives whether the last move that was given ends on a belt."""
        return self._on is not None

    def plan(self, effect: effects.Motion, q_start: FloatArray, settings: MoveSettings, now: float) -> PlannedMove:
        """Gives the leg of one instruction as `MovePlanner.plan` does, carried along where its work object or the one before is.

        now: time in s, from which on the arm is watched.
        """
        onto = None if effect.wobj.ufprog or not effect.wobj.ufmec else self._connected(effect)
        if onto is None and self._on is None:
            return self._planner.plan_move(effect, q_start, settings)
        if not isinstance(effect, effects.MoveL | effects.MoveC):
            raise refusal(effect, f"{type(effect).__name__} cannot follow a conveyor, nor go onto or off it: MoveL and MoveC can")
        if onto is not None and self._on is not None and onto is not self._on:
            raise refusal(
                effect, "the robot cannot go from one conveyor's work object to another's: a move to one that stands comes between"
            )
        if onto is None:
            plan = self._planner.plan_move(effect, q_start, settings)
        else:
            X_UO = bridge.transform_of(effect.wobj.oframe.trans, effect.wobj.oframe.rot)
            X_BO = self.units.object_frame(effect.wobj.ufmec, X_UO)
            way = onto.begin * onto.belt.conveyor.direction
            standing = replace(effect, wobj=_standing(effect.wobj, RigidTransform.from_translation(way) * X_BO))
            plan = replace(self._planner.plan_move(standing, q_start, settings), effect=effect, X_BO=X_BO)
        connection = onto or self._on
        assert connection is not None  # noqa: S101 - one of the two is there, see above
        plan = replace(plan, following=Following(connection, float(self._on is not None), float(onto is not None)))
        self._watched = max(self._watched, now)
        self._on, self._last = onto, effect
        return plan

    def drop(self, effect: effects.DropWorkObject) -> None:
        """Lets go of a connected work object, once the robot has been told to leave it. Raises MotionError."""
        unit = self._unit(effect)
        if self._on is not None:
            raise refusal(effect, f"the robot still follows the work object of {unit}: a move in one that stands comes first")
        try:
            self.units.connected(unit)
        except FollowingError as error:
            raise refusal(effect, str(error)) from error
        self.units.drop(unit)

    def arrives(self, effect: effects.WaitWorkObject, since: float) -> float:
        """Gives the time in s, `since` or later, at which the awaited work object comes, as its belt runs now; inf if it will not."""
        return self.units.arrives(self._unit(effect), bridge.MM * effect.distance_mm, since)

    def expect(self, effect: effects.WaitWorkObject) -> None:
        """Raises MotionError where the awaited work object could not be connected."""
        self._told(effect, self.units.expect)

    def connect(self, effect: effects.WaitWorkObject, time: float) -> None:
        """Connects the awaited work object, which has come. Raises MotionError."""
        self._told(effect, lambda unit: self.units.connect(unit, time))

    def let_go(self, time: float) -> None:
        """Stops carrying the arm from `time` s on: its program has ended."""
        for scheduled in self._record.chains:
            for move in scheduled.chain.moves:
                if move.following is not None:
                    move.following.connection.let_go = min(move.following.connection.let_go, time)
        self._on = None

    def next_event(self) -> float:
        """Gives the time in s at which the watch over the arm looks next; inf where it follows nothing."""
        return self._watched + _WATCH if self._on is not None else math.inf

    def watch(self, now: float) -> None:
        """Looks whether the arm can still follow at `now` s. Raises MotionError where it cannot."""
        if self._on is None or self._last is None or now < self.next_event():
            return
        self._watched = now
        conveyor, time = self._on.belt.conveyor, np.array([now])
        if float(self._on.passed(time)[0]) > conveyor.farthest:
            raise refusal(self._last, f"{conveyor.unit} has carried its work object farther than {1e3 * conveyor.farthest:g} mm")
        here, before = (self._record.joints_at(moment) for moment in (now, now - TICK))
        if self._record.out_of_reach_at(now):
            raise refusal(self._last, f"{conveyor.unit} has carried its work object out of the robot's reach")
        model = self._planner.model
        if not self._planner.arm.within_limits(here):
            raise refusal(self._last, f"{conveyor.unit} has carried its work object beyond an axis limit: {beyond(model, here)}")
        share = np.abs(here - before) / TICK / model.speed
        if share.max() > _TOO_FAST:
            axis = int(np.argmax(share))
            raise refusal(
                self._last, f"to follow {conveyor.unit} axis {axis + 1} would have to turn at {share[axis]:.0%} of its speed limit"
            )

    def _told(self, effect: effects.WaitWorkObject, does: Callable[[str], None]) -> None:
        try:
            does(self._unit(effect))
        except FollowingError as error:
            raise refusal(effect, str(error)) from error

    def _connected(self, effect: effects.Motion) -> Connection:
        try:
            return self.units.connected(effect.wobj.ufmec)
        except FollowingError as error:
            raise refusal(effect, str(error)) from error

    def _unit(self, effect: effects.WaitWorkObject | effects.DropWorkObject) -> str:
        unit = effect.wobj.ufmec
        if effect.wobj.ufprog or not unit:
            raise refusal(effect, "the work object belongs to no conveyor: ufprog must be FALSE and ufmec name one")
        if unit not in self.units:
            raise refusal(effect, f"there is no conveyor {unit!r}: name a cell that has it (mitl oracle --cell, or cell = in the rig file)")
        return unit


def _standing(wobj: data.WObjData, X_BO: RigidTransform) -> data.WObjData:
    """Gives the work object as one that stands at X_BO."""
    x, y, z = (X_BO.translation / bridge.MM).tolist()
    w, i, j, k = X_BO.rotation.as_quat(scalar_first=True).tolist()
    frame = data.Pose(data.Pos(x, y, z), data.Orient(w, i, j, k))
    return data.WObjData(wobj.robhold, True, "", frame, data.Pose())
