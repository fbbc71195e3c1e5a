"""SimulatedController: executes RAPID in virtual time and moves a simulated arm. It offers nothing that a real controller lacks.

Invariant: between two events of its program the arm's motion is known; nothing here knows about tracker or verdict.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from mitl.controllers.faults import (
    Fault,
    effect_filter,
    encoder,
    joint_offset,
    orientation_law,
    playback,
    resume_offset,
    robot_model,
    stop_delay,
)
from mitl.errors import MotionError, RigError
from mitl.motion.chain import Planner
from mitl.motion.conveyor import Belt
from mitl.motion.following import ConveyorUnits
from mitl.motion.program_run import ProgramRun, joints_home
from mitl.motion.record import MotionRecord, View
from mitl.motion.robot_effects import StopKind
from mitl.motion.robot_model import RobotModel
from mitl.paths import FloatArray
from mitl.poses import pose_of
from mitl.protocols import Clock, ExecutionState, LoggedEvent
from rapid_interp import Program, RapidError, RapidErrors, Task, load
from rapid_interp.effects import SourceLine

_RUNTIME_ERROR = 40000
_MOTION_ERROR = 50000
_INFORMATION = 10000
_OFF_WITHIN = 0.2
"""Seconds within which an arm that resumes in the wrong place gets there."""


class SimulatedController:
    """A controller for one arm. Implements Controller for test cases, Process and JointSource for the simulated world.

    Call `connect` with the world's clock before anything else. faults: what is wrong with it, on purpose. belts: the conveyors whose
    encoders and drives are wired to it, in the world's time.
    """

    def __init__(self, model: RobotModel, faults: Sequence[Fault] = (), belts: Sequence[Belt] = ()) -> None:
        self._belts = tuple(belts)
        self._model = model = robot_model(model, faults)
        self._faults = tuple(faults)
        self._playback = playback(faults)
        self._stop_delay = stop_delay(faults)
        self._resume_offset = resume_offset(faults)
        self._resumed_at = math.inf
        self._joint_offset = joint_offset(faults)
        self._planner = Planner(model, orientation_law=orientation_law(faults))
        self._clock: Clock | None = None
        self._inputs: Callable[[str, float], float] | None = None
        self._origin = 0.0
        self._record = MotionRecord(model, joints_home())
        self._program: Program | None = None
        self._task: Task | None = None
        self._run: ProgramRun | None = None
        self._former_outputs: dict[str, list[tuple[float, float]]] = {}
        self._failed = False
        self._motors = True
        self._speed_ratio = 1.0
        self._events: list[LoggedEvent] = []

    def connect(self, clock: Clock) -> None:
        """Gives the controller its clock."""
        self._clock = clock

    def use_inputs(self, inputs: Callable[[str, float], float]) -> None:
        """Has programs started from now on read their inputs from `inputs`: value by name and time in s. Without, all inputs are 0."""
        self._inputs = inputs

    @property
    def at(self) -> SourceLine | None:
        """Where the program pointer is: the line of the last instruction that was taken on, or None before the first."""
        return None if self._run is None else self._run.at

    @property
    def resumable(self) -> bool:
        """Whether a program was stopped, or stopped itself, and `start` resumes it."""
        return self._run is not None and self._run.resumable

    def reset(self) -> None:
        """Puts everything back to how it was switched on: arm at home, no program, no event; its motion begins now."""
        self._origin = self._now()
        for belt in self._belts:
            belt.restart(self._origin)
        self._record = MotionRecord(self._model, joints_home())
        self._program = self._task = self._run = None
        self._former_outputs = {}
        self._failed, self._motors, self._speed_ratio = False, True, 1.0
        self._events = []

    # --- Process and JointSource ---------------------------------------------------------------------------------------------

    def next_event(self) -> float:
        """Gives the time in s at which the program goes on; inf when none runs."""
        return math.inf if self._run is None else self._origin + self._run.next_event()

    def run(self, now: float) -> None:
        """Lets the program go on. What stops it by itself goes to the event log, as on a real controller."""
        self._watched(now, lambda run: run.run(now - self._origin))

    def _watched(self, now: float, step: Callable[[ProgramRun], None]) -> None:
        """Lets the program do something; what goes wrong, and what it tells, goes to the event log."""
        if self._run is None:
            return
        known, told = len(self._run.events), self._run.stopped_at
        try:
            step(self._run)
        except (RapidError, RapidErrors) as error:
            self._fail(now, _RUNTIME_ERROR, str(error))
        except MotionError as error:
            self._fail(now, _MOTION_ERROR, str(error))
        for event in self._run.events[known:]:
            number, _, text = event.text.partition(" ")
            known_number = int(number) if number.isdigit() else _INFORMATION
            self._log(now, known_number, "warning", text if number.isdigit() else event.text)
        if self._run.stopped_at is not None and told is None:
            at = self._run.stopped_at
            self._log(now, _INFORMATION, "info", f"the program stopped itself at {at.module}:{at.line}")

    def joints_at(self, time: float) -> FloatArray:
        """Gives the joints (6,) rad of the arm at `time` s."""
        joints = self._playback(self._record, time - self._origin) + self._joint_offset(time)
        if self._resume_offset:
            joints[0] += self._resume_offset * min(max((time - self._resumed_at) / _OFF_WITHIN, 0.0), 1.0)
        return joints

    # --- Controller ----------------------------------------------------------------------------------------------------------

    def load(self, sources: Sequence[Path]) -> None:
        """Replaces the program by the given module files; the program pointer is at main. Waits until the arm stands still."""
        if self.state() is ExecutionState.RUNNING:
            raise RigError("load refused: RAPID is executing, stop it first")
        self._let_it_come_to_rest()
        try:
            self._program = load(list(sources))
        except RapidErrors as error:
            raise RigError(f"load refused, the program has errors:\n{error}") from error
        except OSError as error:
            raise RigError(f"load refused: {error.filename}: {error.strerror or error}") from error
        rest = self._record.joints_at(max(self._now() - self._origin, self._record.end))
        self._resumed_at = math.inf
        self._keep_outputs()
        self._origin = self._now()
        self._record = MotionRecord(self._model, rest)
        self._task = self._program.start()
        self._run = None
        self._events = []

    def start(self) -> None:
        """Starts execution at main, or resumes a program that was stopped on its way; the arm goes on along its path."""
        if self._task is None:
            raise RigError("start refused: no program is loaded")
        if not self._motors:
            raise RigError("start refused: the motors are off")
        if self.state() is ExecutionState.RUNNING:
            raise RigError("start refused: RAPID is executing already")
        now = self._now() - self._origin
        if self._run is not None:
            if not self._run.resumable:
                raise RigError("start refused: the program has ended; load it again")
            self._log(self._now(), _INFORMATION, "info", "program restarted")
            self._resumed_at = min(self._resumed_at, self._now())
            self._watched(self._now(), lambda run: run.resume(now))
            return
        self._run = ProgramRun(
            self._task.run(),
            self._planner,
            self._record,
            now=now,
            live_inputs=self._inputs,
            effect_filter=effect_filter(self._faults),
            units=ConveyorUnits(self._belts, origin=self._origin, horizon=self._record.half_filter, encoder=encoder(self._faults)),
        )
        self._run.set_speed_ratio(self._speed_ratio, now)
        self._failed = False
        self._log(self._now(), _INFORMATION, "info", "program started")

    def stop(self, kind: StopKind = StopKind.PROGRAM) -> None:
        """Stops execution along the path, so that `start` can resume it. Safe to call at any time, also twice."""
        if self._run is not None and self.state() is ExecutionState.RUNNING:
            self._run.hold(self._now() - self._origin + self._stop_delay, kind)
            self._log(self._now(), _INFORMATION, "info", f"program stopped ({kind.value})")

    def state(self) -> ExecutionState:
        """Gives whether RAPID is executing; a program that has ended or was stopped runs until its last motion has."""
        if self._run is None or self._failed:
            return ExecutionState.STOPPED
        ended = not self._run.going and self._now() - self._origin >= self._record.end
        return ExecutionState.STOPPED if ended else ExecutionState.RUNNING

    def read(self, name: str) -> str:
        """Gives a RAPID variable as a RAPID literal."""
        try:
            return self._loaded_task("read").literal(name)
        except RapidError as error:
            raise RigError(f"reading {name} refused: {error}") from error

    def write(self, name: str, literal: str) -> None:
        """Sets a RAPID variable from a RAPID literal."""
        try:
            self._loaded_task("write").set(name, literal)
        except RapidError as error:
            raise RigError(f"writing {name} refused: {error}") from error

    def read_signal(self, name: str) -> float:
        """Gives the value of an output signal; 0 before it was first set."""
        return 0.0 if self._run is None else self._run.value_of(name, self._now() - self._origin)

    def output_changes(self, name: str, after: float, until: float) -> list[tuple[float, float]]:
        """Gives the changes (time in s, value) of an output after a time and up to another, as the wire at its terminal carries them."""
        changes = [] if self._run is None else self._run.signals.get(name, [])
        every = [*self._former_outputs.get(name, ()), *((self._origin + at, value) for at, value in changes)]
        return [change for change in every if after < change[0] <= until]

    def _keep_outputs(self) -> None:
        """Keeps what the outputs did until now, as the program that did it goes."""
        for name, changes in self._run.signals.items() if self._run is not None else ():
            former = ((self._origin + at, value) for at, value in changes)
            self._former_outputs.setdefault(name, []).extend(change for change in former if change[0] <= self._now())

    def joints(self) -> FloatArray:
        """Gives the axis positions (6,) in rad, as the controller reports them."""
        return self._record.joints_at(self._now() - self._origin, View.CONTROLLER)

    def reported_joints(self, times: FloatArray) -> FloatArray:
        """Gives the axis positions (N, 6) in rad at times (N,) in s, as the controller reports them."""
        return np.array([self._record.joints_at(time, View.CONTROLLER) for time in (times - self._origin).tolist()])

    def planned_joints(self, times: FloatArray) -> FloatArray:
        """Gives the axis positions (N, 6) in rad that it plans for times (N,) in s."""
        return self._record.joints(times - self._origin, View.PLANNED)

    def flange(self) -> FloatArray:
        """Gives X_BF (7,), as the controller reports it."""
        return pose_of(self._planner.arm.flange(self.joints()))

    def set_motors(self, on: bool) -> None:
        """Switches the motors; off stops the program as hard as it can."""
        if not on:
            self.stop(StopKind.EMERGENCY)
        self._motors = on

    def set_speed_ratio(self, per_cent: float) -> None:
        """Sets the speed override, 1 to 100 per cent, of the motion under way too."""
        if not 1 <= per_cent <= 100:
            raise RigError(f"speed ratio refused: expected 1 to 100 per cent, got {per_cent:g}")
        self._speed_ratio = per_cent / 100
        if self._run is not None:
            now = self._now()
            self._watched(now, lambda run: run.set_speed_ratio(self._speed_ratio, now - self._origin))

    def event_log(self) -> list[LoggedEvent]:
        """Gives the events logged since `load`, oldest first."""
        return list(self._events)

    # -------------------------------------------------------------------------------------------------------------------------

    def _now(self) -> float:
        if self._clock is None:
            raise RigError("the simulated controller has no clock: connect() it to a world first")
        return self._clock.now()

    def _let_it_come_to_rest(self) -> None:
        remaining = self._origin + self._record.end - self._now()
        if remaining > 0 and self._clock is not None:
            self._clock.wait(remaining)

    def _loaded_task(self, what: str) -> Task:
        if self._task is None:
            raise RigError(f"{what} refused: no program is loaded")
        return self._task

    def _fail(self, now: float, number: int, text: str) -> None:
        if self._run is not None:
            self._run.close(now - self._origin)
        self._failed = True
        self._log(now, number, "error", text)

    def _log(self, now: float, number: int, level: str, text: str) -> None:
        self._events.append(LoggedEvent(now, number, level, text))
