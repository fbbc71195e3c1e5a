"""Shadow: the program that runs on the controller, run beside it in the planner, always one order ahead: the pre-flight of each motion.

Invariant: it was given every order and every variable that the controller was given, in the same order, from the same joints; so the way
that it flies is the way that the controller is about to go.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import rapid_interp
from mitl.errors import MitlError, RigError
from mitl.motion.chain import Planner
from mitl.motion.program_run import ProgramRun
from mitl.motion.record import MotionRecord, View
from mitl.motion.robot_model import RobotModel
from mitl.paths import FloatArray

ORDER = "option"
_IDLE, _LONGEST = 1.0, 600.0
_STEP = 0.02


class Shadow:
    """A program from the joints (6,) rad at which the robot stands. workspace: corners (2, 3) m of the flange's, or None."""

    def __init__(self, sources: Sequence[Path], model: RobotModel, joints: FloatArray, workspace: FloatArray | None = None) -> None:
        self._workspace = workspace
        self._task = rapid_interp.load(list(sources)).start()
        self._run = ProgramRun(self._task.run(), Planner(model), MotionRecord(model, joints))
        self._flown = 0.0
        self._now = 0.0

    def begin(self) -> FloatArray:
        """Gives the flange's way (N, 3) m in the base frame from the start until the program waits for orders or ends."""
        with _told("the start of the program"):
            while (following := self._run.next_event()) < _LONGEST and following <= self._run.record.end + _IDLE:
                self._advance(following)
        return self._way()

    @property
    def duration(self) -> float:
        """The robot's time in s of all that was flown."""
        return self._flown

    def joints(self) -> FloatArray:
        """Gives the joints (6,) rad at the end of what was flown."""
        return self._run.record.joints_at(math.inf, View.CONTROLLER)

    def write(self, name: str, literal: str) -> None:
        """Sets a variable."""
        self._task.set(name, literal)

    def takes_orders(self) -> bool:
        """Gives whether the program has a variable `option`, by which it is given orders."""
        try:
            self._task.get(ORDER)
        except rapid_interp.RapidError:
            return False
        return True

    def fly(self, literal: str) -> FloatArray:
        """Gives the flange's way (N, 3) m for an order, until the program waits for the next. Raises RigError where it cannot be flown."""
        with _told(f"order {literal}"):
            self._task.set(ORDER, literal)
            until = self._run.next_event() + _LONGEST
            while (following := self._run.next_event()) < until and self._task.get(ORDER) != 0:
                self._advance(following)
            if self._task.get(ORDER) != 0 and not self._run.finished:
                raise MitlError(f"not done after {_LONGEST:g} s of the robot's time")
            while (following := self._run.next_event()) <= self._run.record.end:
                self._advance(following)
        return self._way()

    def _advance(self, to: float) -> None:
        self._now = to
        self._run.run(to)

    def _way(self) -> FloatArray:
        """Gives the way since the last call. Raises RigError where it leaves the workspace."""
        record = self._run.record
        end = record.end if math.isfinite(record.end) else self._now
        times = np.arange(self._flown, max(end, self._flown) + _STEP, _STEP)
        self._flown = max(end, self._flown)
        way = np.asarray(self._run.planner.arm.flange(record.joints(times, View.TOOL)).translation)
        if self._workspace is not None:
            outside = np.any((way < self._workspace[0]) | (way > self._workspace[1]), axis=1)
            if outside.any():
                place = ", ".join(f"{1000 * value:.0f}" for value in way[int(np.argmax(outside))])
                raise RigError(f"pre-flight: the flange would leave the workspace at ({place}) mm; nothing was moved")
        return way


class _told:  # noqa: N801 - reads as a word where it is used
    """Turns what a program cannot do into a RigError that says what was pre-flown."""

    def __init__(self, what: str) -> None:
        self._what = what

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _traceback: object) -> None:
        if isinstance(error, MitlError | rapid_interp.RapidError) and not isinstance(error, RigError):
            raise RigError(f"pre-flight of {self._what}: {error}; nothing was moved") from error
