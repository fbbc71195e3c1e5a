"""GuardedController: a physical robot behind everything that must hold before and while it moves. Implements Controller.

Invariant: nothing moves unarmed, un-pre-flown, with another tool than the program's, or unwatched; whatever goes wrong, it is stopped.
Nothing moves without the tracker but the nudge that wakes it.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from mitl.controllers.rws.controller import RwsController
from mitl.controllers.rws.errors import NotAllowedError
from mitl.errors import RigError
from mitl.motion.robot_model import RobotModel
from mitl.paths import FloatArray
from mitl.protocols import Clock, ExecutionState, LoggedEvent, Tracker
from mitl.rig.frames import compare_frames
from mitl.rig.guardian import Guardian
from mitl.rig.heartbeat import BEAT, LOOKS, HeartBeat, with_heartbeat
from mitl.rig.nudge import NAME, nudge_program
from mitl.rig.physical_config import PhysicalConfig
from mitl.rig.shadow import ORDER, Shadow
from mitl.rig.watchdog import Watchdog

_THERE = 5e-3
"""rad by which the axes may still be off where the program waits for orders."""
_SLOWEST, _LATEST, _POLL = 100.0, 10.0, 0.1
"""The least speed ratio is 1 per cent; and some seconds for what is no motion."""
_NUDGED, _AGAIN = 60.0, 0.02
"""Seconds that a nudge may take at the slowest, and between two looks at a tracker that shows nothing."""
_HELD = 3
"""Orders for which each speed of a first pass is held."""
_AUTO = "AUTO"
NOT_ARMED = "the robot is not armed, so nothing was moved: look at the cell, then run mitl verify --arm"


class GuardedController:
    """controller: what is guarded; second: a session of its own for the watchdog. guardian: starts the process that outlives us."""

    def __init__(
        self,
        controller: RwsController,
        second: RwsController,
        config: PhysicalConfig,
        model: RobotModel,
        tracker: Tracker,
        clock: Clock,
        *,
        armed: bool,
        guardian: Callable[[], Guardian],
    ) -> None:
        self._controller = controller
        self._second = second
        self._safety = config.safety
        self._egm_device = config.egm.device if config.egm is not None else ""
        self._model = model
        self._tracker = tracker
        self._clock = clock
        self._armed = armed
        self._make_guardian = guardian
        self._guardian: Guardian | None = None
        self._sources: list[Path] = []
        self._shadow: Shadow | None = None
        self._corridor: cKDTree | None = None
        self._seen = 0.0
        self._watchdog = Watchdog(self._look, second.stop)
        period = config.safety.heartbeat_s / LOOKS
        self._heart = HeartBeat(lambda beat: controller.write(BEAT, beat), period, lambda: self._watchdog.alive)
        self._ramp: list[float] = []
        self._blind = False
        """Whether the motion under way is the nudge, which the tracker need not see."""
        self._held = False
        """Whether it was us who stopped the program that is loaded, on its way."""
        self._speed = config.safety.speed
        self._orders = -1
        corners = np.array(config.safety.workspace_mm) / 1000.0
        self._workspace: FloatArray | None = corners if corners.size else None

    # --- Controller ----------------------------------------------------------------------------------------------------------

    def load(self, sources: Sequence[Path]) -> None:
        """Replaces the program by the given module files with the heartbeat in them; the pointer is at main."""
        self._require_armed()
        self._heart.rest()
        self._sources, self._shadow, self._held = list(sources), None, False
        with tempfile.TemporaryDirectory(prefix="mitl-program-") as folder:
            self._controller.load(with_heartbeat(sources, Path(folder), self._safety.heartbeat_s, egm_device=self._egm_device))

    def start(self) -> None:
        """Compares tools and work objects, pre-flies the way to where the program waits for orders, then starts it."""
        self._require_armed()
        if not self._sources:
            raise RigError("start refused: no program is loaded")
        self._require_ready()
        if self._shadow is not None:
            self._resume()
            return
        compare_frames(self._sources, self._controller.read)
        shadow = Shadow(self._sources, self._model, self._controller.joints(), self._workspace)
        way = shadow.begin()
        self._shadow = shadow
        self._watch(way)
        self._controller.set_speed_ratio(min(self._safety.first_speed, self._speed))
        self._heart.go()
        self._controller.start()
        if shadow.takes_orders():
            self._wait_until_there(shadow)
            self._controller.set_speed_ratio(self._speed)

    def stop(self) -> None:
        """Stops the robot. Safe to call at any time, also twice and unarmed."""
        try:
            self._held = self._held or self._controller.state() is ExecutionState.RUNNING
            self._controller.stop()
        except RigError:
            self._held = False
            self._second.stop()  # the first session may be what is broken
        self._watchdog.rest()
        self._heart.rest()

    def state(self) -> ExecutionState:
        """Gives whether RAPID is executing. Raises RigError with the watchdog's reason where it stopped the robot."""
        self._raise_reason()
        return self._controller.state()

    def read(self, name: str) -> str:
        """Gives a RAPID variable as a RAPID literal."""
        self._raise_reason()
        return self._controller.read(name)

    def write(self, name: str, literal: str) -> None:
        """Sets a RAPID variable. An order, which is a value other than 0 of `option`, is pre-flown before."""
        self._require_armed()
        self._raise_reason()
        if self._shadow is None:
            raise RigError(f"writing {name} refused: the program is not running, so nothing can be pre-flown")
        if name.lower() == ORDER and _number(literal) != 0:
            self._require_ready()
            self._watch(self._shadow.fly(literal))
            self._climb()
        else:
            self._shadow.write(name, literal)
        self._controller.write(name, literal)

    def read_signal(self, name: str) -> float:
        """Gives the value of an I/O signal."""
        return self._controller.read_signal(name)

    def joints(self) -> FloatArray:
        """Gives the axis positions (6,) in rad."""
        return self._controller.joints()

    def flange(self) -> FloatArray:
        """Gives X_BF (7,)."""
        return self._controller.flange()

    def set_motors(self, on: bool) -> None:
        """Switches the motors; on only when armed."""
        if on:
            self._require_armed()
        self._controller.set_motors(on)

    def set_speed_ratio(self, per_cent: float) -> None:
        """Sets the speed override, which may not exceed what the rig file allows."""
        if per_cent > self._safety.speed:
            raise RigError(f"speed ratio refused: the rig file allows {self._safety.speed:g} per cent, asked for {per_cent:g}")
        self._controller.set_speed_ratio(per_cent)
        self._speed = per_cent

    def event_log(self) -> list[LoggedEvent]:
        """Gives the events logged since `load`, oldest first."""
        return self._controller.event_log()

    # --- beyond Controller ---------------------------------------------------------------------------------------------------

    def begin(self, *, first: bool) -> None:
        """Sets the speed of the orders that follow: in the session's first pass it climbs from the rig file's first speed, order by order.

        Whatever follows, a program's way to where it waits for orders is driven at the first speed.
        """
        full, slow = self._safety.speed, min(self._safety.first_speed, self._safety.speed)
        self._ramp = [share for share in (slow, 1.5 * slow, 2.0 * slow) if share < full] if first else []
        self._speed = self._ramp[0] if self._ramp else full
        self._orders = -1

    def look(self) -> None:
        """Asks the controller on both sessions whether it is there. Raises RigError; a robot that was left running is stopped.

        A guardian that has ended, because it had to stop the robot, is let go: the next motion starts with another. Armed, mastership is
        taken, so that whoever waits for the rig waits for it too: that of a mitl that was killed is free after five minutes at most.
        """
        if self._guardian is not None and not self._guardian.alive:
            self._guardian.close()
            self._guardian = None
        if self._controller.state() is ExecutionState.RUNNING and self._shadow is None:
            self.stop()
        self._second.state()
        if self._armed:
            try:
                self._controller.take_control()
            except NotAllowedError:
                if self._controller.mode() == _AUTO:
                    raise  # in manual mode nobody can have it, which `start` tells

    @property
    def armed(self) -> bool:
        """Whether it may move."""
        return self._armed

    def nudge(self) -> None:
        """Turns axis 6 a little to and fro where the robot stands: a tracker that sleeps shows nothing until it is moved.

        Pre-flown, watched in its corridor and with its heartbeat as any motion; only the tracker need not see it. The program that was
        loaded is gone. Raises RigError where the robot may not move or does not come back to where it stood.
        """
        self._require_armed()
        self._require_power()
        self._heart.rest()
        self._shadow, self._sources, self._held = None, [], False
        where = self._controller.joints()
        with tempfile.TemporaryDirectory(prefix="mitl-nudge-") as folder:
            file = Path(folder) / NAME
            file.write_text(nudge_program(self._model, where), encoding="utf-8")
            way = Shadow([file], self._model, where, self._workspace).begin()
            guarded = Path(folder) / "guarded"
            guarded.mkdir()
            self._controller.load(with_heartbeat([file], guarded, self._safety.heartbeat_s, egm_device=self._egm_device))
        self._blind = True
        try:
            self._watch(way)
            self._controller.set_speed_ratio(min(self._safety.first_speed, self._safety.speed))
            self._heart.go()
            self._controller.start()
            until = self._clock.now() + _NUDGED
            while self.state() is ExecutionState.RUNNING:
                if self._clock.now() > until:
                    raise RigError(f"the nudge that wakes the tracker did not end within {_NUDGED:g} s")
                self._clock.wait(_POLL)
        finally:
            self.stop()
            self._blind = False
        if np.abs(self._controller.joints() - where).max() > _THERE:
            raise RigError("the nudge that wakes the tracker did not end where it began")

    def close(self) -> None:
        """Stops the robot, puts back what was found on the controller, and lets the guardian go."""
        try:
            self._watchdog.rest()
            self._heart.rest()
            self._controller.close()
        except RigError:
            self._second.stop()
            raise
        finally:
            self._heart.close()
            self._watchdog.close()
            if self._guardian is not None:
                self._guardian.close()
            self._second.leave()

    # -------------------------------------------------------------------------------------------------------------------------

    def _require_armed(self) -> None:
        if not self._armed:
            raise RigError(NOT_ARMED)

    def _require_ready(self) -> None:
        """Refuses to move while anything that must watch the motion does not."""
        self._require_power()
        self._require_tracker()

    def _require_tracker(self) -> None:
        """Never move blind; but a single sample that is not valid is no lost tracker."""
        until = self._clock.now() + self._safety.tracker_lost_s
        while True:
            try:
                self._tracker.latest()
            except RigError:
                if self._clock.now() >= until:
                    raise
                self._clock.wait(_AGAIN)
            else:
                return

    def _require_power(self) -> None:
        """Refuses to move unless the key, the motors and the watchers are as they must be."""
        if self._controller.mode() != _AUTO:
            raise RigError(f"the controller is in {self._controller.mode()}, expected AUTO: turn the key")
        state = self._controller.controller_state()
        if state != "motoron":
            raise RigError(f"the motors are not on (controller state {state}): switch them on at the cell, after a look at it")
        if self._guardian is None:
            self._guardian = self._make_guardian()
        if not self._guardian.alive or not self._watchdog.alive:
            raise RigError("the guardian process or the watchdog has ended: nothing may move")

    def _resume(self) -> None:
        """Starts a program that we ourselves stopped: its way is the one that was pre-flown. Raises RigError for any other."""
        if not self._held or self._watchdog.reason:
            raise RigError("start refused: the program stopped itself or has ended; load it again")
        self._watchdog.watch()
        self._seen = self._clock.now()
        self._heart.go()
        self._held = False
        self._controller.start()

    def _climb(self) -> None:
        """Sets the speed of the next order of a first pass; each speed is held for three orders."""
        if not self._ramp:
            return
        self._orders += 1
        step = self._orders // _HELD
        self._speed = self._ramp[step] if step < len(self._ramp) else self._safety.speed
        if self._orders % _HELD == 0:
            self._controller.set_speed_ratio(self._speed)
        if step >= len(self._ramp):
            self._ramp = []

    def _watch(self, way: FloatArray) -> None:
        if self._corridor is not None:
            way = np.concatenate([self._corridor.data[-1:], way])
        self._corridor = cKDTree(way)
        self._seen = self._clock.now()
        self._watchdog.watch()

    def _look(self) -> str:
        """Gives why the robot must stop, or ""."""
        now = self._clock.now()
        try:
            self._tracker.latest()
        except RigError as error:
            if not self._blind and now - self._seen > self._safety.tracker_lost_s:
                return f"stopped by the watchdog: the tracker is lost for more than {self._safety.tracker_lost_s:g} s ({error})"
        else:
            self._seen = now
        if self._guardian is not None and not self._guardian.alive:
            return "stopped by the watchdog: the guardian process has ended"
        if self._corridor is None:
            return ""
        distance = float(self._corridor.query(self._second.flange()[:3])[0])
        if distance > self._safety.corridor_mm / 1000.0:
            return (
                f"stopped by the watchdog: the flange is {1000 * distance:.0f} mm off its pre-flown way, "
                f"allowed are {self._safety.corridor_mm:g} mm"
            )
        return ""

    def _wait_until_there(self, shadow: Shadow) -> None:
        """Waits until the robot stands where the program waits for orders: what follows is recorded, and begins there."""
        until = self._clock.now() + _SLOWEST * shadow.duration + _LATEST
        while np.abs(self._controller.joints() - shadow.joints()).max() > _THERE:
            if self.state() is ExecutionState.STOPPED:
                events = [event.text for event in self._controller.event_log() if event.level != "info"]
                raise RigError(f"the program stopped on the way to where it waits for orders: {' | '.join(events) or 'no reason logged'}")
            if self._clock.now() > until:
                self.stop()
                raise RigError("the robot did not come to where the program waits for orders in time; it was stopped")
            self._clock.wait(_POLL)

    def _raise_reason(self) -> None:
        if self._watchdog.reason:
            raise RigError(self._watchdog.reason)


def _number(literal: str) -> float:
    try:
        return float(literal)
    except ValueError:
        return math.nan  # an expression: it may well be an order
