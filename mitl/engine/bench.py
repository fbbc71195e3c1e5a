"""Bench: what a case works with. It runs the case's program, tracks it, brings the recording into the work object, and judges nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from mitl.calibration.pose_set import CalibrationPoses
from mitl.calibration.result import Calibration
from mitl.engine.case_recording import RecordedRun, bounds_of, moves_of, signals_of
from mitl.engine.recorder import CaseRecorder
from mitl.errors import RigError
from mitl.feedback import FeedbackSamples
from mitl.metrics.glitch import without_glitches
from mitl.paths import FloatArray, PosePath
from mitl.protocols import AveragedPoint, Clock, Controller, DetailedTracker, ExecutionState, LoggedEvent, Oracle, Rig, Tracker
from mitl.recording.feedback import feedback_facts, feedback_series, feedback_track
from mitl.recording.records import EGM, EGM_FLANGE, PoseTrack
from mitl.samples import TrackerSamples

STILL = 0.3
"""Seconds recorded before the order and after its end, so that both ends of the motion are seen at rest."""

POLL = 0.05
"""Seconds between two looks at the program's `option`."""


@dataclass(frozen=True, eq=False)
class TrackedRun:
    """One order to the program, tracked.

    raw: X_LM on the tracker's clock, invalid samples included. tool: the valid samples as X_OT, times unchanged. oracle: on its own clock,
    0 where the program starts. began, ended: s on the rig's clock, when the order was given and when it was seen to be done. samples: what
    the tracker told besides `raw`, buttons above all.
    given: when it was given on the tracker's clock, as near as the rig knows. beside: X_LM of the further devices that were asked for, by
    name, on the same clock, invalid samples included.
    """

    option: int
    sub_option: int
    variables: dict[str, str]
    raw: PosePath
    tool: PosePath
    oracle: Oracle
    began: float
    ended: float
    samples: TrackerSamples
    given: float
    beside: Mapping[str, PosePath] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class StoppedRun:
    """An order that was stopped on its way: X_OT of the tool on the tracker's clock, and when stop was called, on the same clock, in s.

    restarted: when start was called again, if it was.
    """

    tool: PosePath
    called: float
    restarted: float | None = None


@dataclass(frozen=True, eq=False)
class StillPoint:
    """A still point: as the tracker averaged it (X_LM), and the same as X_OT, (7,) x y z in m, qw qx qy qz, in the work object."""

    raw: AveragedPoint
    tool: FloatArray


class Bench:
    """The fixture `bench` of one case: rig, the session's calibration with the poses it was solved from, and the case's program."""

    def __init__(
        self, rig: Rig, calibration: Calibration, poses: CalibrationPoses, recorder: CaseRecorder, *, calibrated_at: float
    ) -> None:
        self.rig = rig
        self._calibrated_at = calibrated_at
        self.calibration = calibration
        self._poses = poses
        self._still: list[tuple[AveragedPoint, FloatArray]] = []
        self._recorder = recorder
        self._loaded = False
        self._tracking: str | None = None
        self._oracles: dict[tuple[tuple[str, str], ...], Oracle] = {}
        self._last: Oracle | None = None
        if rig.feedback is not None:
            rig.feedback.start()

    @property
    def controller(self) -> Controller:
        """The rig's controller."""
        return self.rig.controller

    @property
    def tracker(self) -> Tracker:
        """The rig's tracker."""
        return self.rig.tracker

    @property
    def clock(self) -> Clock:
        """The rig's clock."""
        return self.rig.clock

    @property
    def program(self) -> Path:
        """The case's RAPID file. Raises ValueError where the case named none."""
        if self._recorder.info.program is None:
            raise ValueError(f"case {self._recorder.info.id} names no program: give @case(..., program='file.mod')")
        return self._recorder.info.program

    @property
    def calibration_poses(self) -> CalibrationPoses:
        """The poses that the session's calibration was solved from; a case that asks for them judges them, so its recording has them."""
        self._recorder.paths.update(calibration_tracks(self._poses))
        return self._poses

    @property
    def since_calibration(self) -> float:
        """The time in s since the calibration was measured, in which the tracker may have drifted."""
        return self.clock.now() - self._calibrated_at

    @property
    def last_oracle(self) -> Oracle:
        """The oracle of the last `run` or `oracle`, whose tool and work object are in force. Raises ValueError before the first."""
        if self._last is None:
            raise ValueError("no order yet: the tool and work object are those of the last bench.run or bench.oracle")
        return self._last

    def run(
        self,
        option: int,
        sub_option: int = 0,
        *,
        variables: Mapping[str, str] | None = None,
        timeout: float = 120.0,
        name: str | None = None,
        beside: Sequence[str] = (),
    ) -> TrackedRun:
        """Gives the tracked execution of one order to the case's program, and records it under `name`.

        variables: RAPID variables set to literals before the order. timeout in s of the rig's time. beside: names of the rig's further
        devices to be tracked as well. Raises RigError where the controller stops by itself, the order is not done in time, or
        the tracker is lost.
        """
        chosen = dict(variables or {})
        oracle = self.oracle(option, sub_option, variables=chosen)
        label = name or f"{len(self._recorder.runs) + 1} option {option}.{sub_option}"
        if self._recorder.round > 1:
            label += f" round {self._recorder.round}"
        self.start()
        devices = {device: self.rig.devices[device] for device in beside}
        for tracker in (self.tracker, *devices.values()):
            tracker.start()
        self._tracking = label
        started = self.clock.now()
        self.clock.wait(STILL)
        began = self._order(option, sub_option, chosen, timeout)
        ended = self.clock.now()
        self.clock.wait(STILL)
        self._tracking = None
        raw = self.tracker.stop()
        others = {device: tracker.stop() for device, tracker in devices.items()}
        for device, path in others.items():
            self.record_path(f"{label} {device}", path, frame="tracker", body=device)
        tool = self.in_work_object(raw, oracle) if raw.valid.any() else None
        shift = float(raw.time[0]) + began - started if len(raw) else 0.0
        since = began - (self._recorder.began or 0.0)
        expected = (moves_of(oracle), signals_of(oracle))
        known = bounds_of(oracle)
        self._recorder.runs.append(RecordedRun(label, raw, tool, oracle.tcp, shift, *expected, since, oracle.tool, oracle.wobj, known))
        if tool is None or not len(tool):
            raise RigError(f"the tracker gave no valid pose during {label} ({len(raw)} samples): is it in view and awake?")
        samples = self.tracker.samples() if isinstance(self.tracker, DetailedTracker) else TrackerSamples.plain(raw)
        return TrackedRun(option, sub_option, chosen, raw, tool, oracle, began, ended, samples, shift, others)

    def oracle(self, option: int, sub_option: int = 0, *, variables: Mapping[str, str] | None = None) -> Oracle:
        """Gives what a nominal controller does with an order to the case's program; tool and work object of later points are its own."""
        presets = {**(variables or {}), "option": str(option), "subOption": str(sub_option)}
        key = tuple(sorted(presets.items()))
        if key not in self._oracles:
            self._oracles[key] = self.rig.oracles.oracle([self.program], presets)
        self._last = self._oracles[key]
        return self._last

    def start(self) -> None:
        """Loads the case's program unless it is loaded, and starts the controller unless it runs."""
        if not self._loaded:
            self.controller.stop()
            self.controller.load([self.program])
            self._loaded = True
        if self.controller.state() is ExecutionState.STOPPED:
            self.controller.start()

    def go(
        self, option: int, sub_option: int = 0, *, variables: Mapping[str, str] | None = None, timeout: float = 120.0, settle: float = 0.0
    ) -> Oracle:
        """Gives the case's program an order without tracking it, waits until it is done and `settle` seconds longer; gives its oracle."""
        oracle = self.oracle(option, sub_option, variables=variables)
        self.start()
        self._order(option, sub_option, variables or {}, timeout)
        self.clock.wait(settle)
        return oracle

    def provoke(
        self, option: int, sub_option: int = 0, *, variables: Mapping[str, str] | None = None, timeout: float = 10.0
    ) -> list[LoggedEvent]:
        """Gives an order that the controller must refuse; gives what its event log says of it, empty where it did not refuse.

        Waits until the controller has stopped by itself, or until the order is done. The program is loaded again for what follows.
        """
        self.start()
        known = len(self.controller.event_log())
        try:
            order(self.rig, option, sub_option, variables=variables or {}, timeout=timeout)
        except RigError:
            return [event for event in self.controller.event_log()[known:] if event.level != "info"]
        finally:
            self.controller.stop()
            self._loaded = False
        return []

    def run_stopped(
        self,
        option: int,
        sub_option: int = 0,
        *,
        after: float,
        variables: Mapping[str, str] | None = None,
        name: str,
        settle: float = 0.7,
        resume_for: float = 0.0,
    ) -> StoppedRun:
        """Gives the tracked motion of an order that is stopped `after` seconds, and `settle` seconds more.

        resume_for: seconds for which it is then started again and tracked on. The program is loaded again for what follows. Raises RigError
        where the controller stops before it is told to, or refuses to go on.
        """
        oracle = self.oracle(option, sub_option, variables=variables)
        self.start()
        for variable, literal in (variables or {}).items():
            self.controller.write(variable, literal)
        self.tracker.start()
        began = self.clock.now()
        self.controller.write("subOption", str(sub_option))
        self.controller.write("option", str(option))
        self._go_on(option, after)
        called = self.clock.now()
        self.controller.stop()
        self._loaded = False
        self.clock.wait(settle)
        restarted = self.clock.now() if resume_for > 0.0 else None
        if restarted is not None:
            self.controller.start()
            self._go_on(option, resume_for)
            self.controller.stop()
            self.clock.wait(settle)
        raw = self.tracker.stop()
        tool = self.in_work_object(raw, oracle)
        label = name if self._recorder.round == 1 else f"{name} round {self._recorder.round}"
        self._recorder.runs.append(RecordedRun(label, raw, tool, None))
        if not len(tool):
            raise RigError(f"the tracker gave no valid pose during {name} ({len(raw)} samples): is it in view and awake?")
        first = float(raw.time[0]) - began
        return StoppedRun(tool, first + called, None if restarted is None else first + restarted)

    def _go_on(self, option: int, seconds: float) -> None:
        """Lets the controller run. Raises RigError where it has stopped by itself meanwhile."""
        self.clock.wait(seconds)
        if self.controller.state() is ExecutionState.STOPPED:
            raise RigError(f"the controller stopped by itself during option {option}{_last_events(self.controller)}")

    def _order(self, option: int, sub_option: int, variables: Mapping[str, str], timeout: float) -> float:
        """Gives an order and returns when it was given.

        One that is not done stops the robot, and the program is loaded again for what may follow.
        """
        try:
            return order(self.rig, option, sub_option, variables=variables, timeout=timeout)
        except RigError:
            self.controller.stop()
            self._loaded = False
            self._break_off()
            raise

    def still_point(self, seconds: float = 0.5) -> StillPoint:
        """Gives the point where the tool stands, averaged over `seconds`, in the work object and with the tool of the last order.

        Raises ValueError before the first `run`, `go` or `oracle`, RigError where the tracker is lost.
        """
        oracle = self.last_oracle
        raw = self.tracker.average(seconds)
        tool = self.in_work_object(_one_sample(raw.time, raw.position, raw.quaternion_wxyz), oracle)
        if not len(tool):
            raise RigError("the tracker's averaged point has no orientation: is it in view and awake?")
        found = StillPoint(raw, np.concatenate([tool.position[0], tool.quaternion_wxyz[0]]))
        self._still.append((raw, found.tool))
        return found

    def in_work_object(self, raw: PosePath, oracle: Oracle) -> PosePath:
        """Gives the valid samples of X_LM as X_OT, the tool of `oracle` in its work object; times stay on the tracker's clock."""
        return self.calibration.tool_path(without_glitches(raw), oracle.tool, oracle.wobj).only_valid()

    def flange(self) -> FloatArray:
        """Gives X_BF (7,), as the controller reports it."""
        return self.controller.flange()

    def record_path(self, name: str, path: PosePath, *, frame: str = "wobj", body: str = "tool") -> None:
        """Keeps a path of `body` in `frame` in the case's recording, besides those of `run`."""
        self._recorder.add_path(name, PoseTrack(path, frame, body))

    def close(self) -> None:
        """Keeps the still points, what the tracker saw of a run that was broken off, the controller's event log and its own view."""
        try:
            self._recorder.keep_events(self.controller.event_log())
        except RigError as error:
            self._recorder.say("warning", f"the controller's event log could not be read: {error}")
        if self._still:
            raw = np.array([np.concatenate([point.position, point.quaternion_wxyz]) for point, _ in self._still])
            time = np.array([point.time for point, _ in self._still])
            self._recorder.paths["/tracker/still"] = PoseTrack(_path(time, raw), "tracker", "body")
            self._recorder.paths["/tool/still"] = PoseTrack(_path(time, np.array([tool for _, tool in self._still])), "wobj", "tool")
        self._break_off()
        if self.rig.feedback is not None:
            self._keep_feedback(self.rig.feedback.stop())

    def _keep_feedback(self, samples: FeedbackSamples) -> None:
        whole = len(samples) and not samples.lost
        self._recorder.say("info" if whole else "warning", feedback_facts(samples))
        if len(samples):
            self._recorder.series[EGM] = feedback_series(samples)
            track = feedback_track(samples)
            if track is not None:
                self._recorder.paths[EGM_FLANGE] = track

    def _break_off(self) -> None:
        if self._tracking is not None:
            label, self._tracking = self._tracking, None
            self._recorder.runs.append(RecordedRun(f"{label} broken off", self.tracker.stop(), None, None))


def order(rig: Rig, option: int, sub_option: int, *, variables: Mapping[str, str], timeout: float) -> float:
    """Gives an order to a running program that loops around TEST option, and waits until it is done.

    Returns the time in s on the rig's clock at which the controller had taken the order: it may take its time to let it pass.

    Raises RigError where the controller stops by itself or `option` is not 0 again after `timeout` seconds.
    """
    controller, clock = rig.controller, rig.clock
    for variable, literal in variables.items():
        controller.write(variable, literal)
    controller.write("subOption", str(sub_option))
    controller.write("option", str(option))
    given = clock.now()
    until = given + timeout
    while controller.read("option").strip() != "0":
        if controller.state() is ExecutionState.STOPPED:
            raise RigError(f"the controller stopped by itself during option {option}, subOption {sub_option}{_last_events(controller)}")
        if clock.now() >= until:
            raise RigError(
                f"option {option}, subOption {sub_option} was not done after {timeout:g} s: expected the program to set option to 0"
            )
        clock.wait(POLL)
    return given


def calibration_tracks(poses: CalibrationPoses) -> dict[str, PoseTrack]:
    """Gives the poses of a calibration as tracks for a recording; their times are their numbers, because they stand still."""
    number = np.arange(len(poses), dtype=np.float64)
    return {
        "/calibration/flange": PoseTrack(_path(number, poses.flange), "base", "flange"),
        "/calibration/tracker": PoseTrack(_path(number, poses.tracked), "tracker", "body"),
    }


def _path(time: FloatArray, poses: FloatArray) -> PosePath:
    return PosePath(time, poses[:, :3], poses[:, 3:], np.full(len(time), True))


def _one_sample(time: float, position: FloatArray, quaternion_wxyz: FloatArray) -> PosePath:
    return PosePath(np.array([time]), position[None], quaternion_wxyz[None], np.array([True]))


def _last_events(controller: Controller) -> str:
    events = [event for event in controller.event_log() if event.level != "info"] or controller.event_log()
    return "; its log ends with: " + " | ".join(f"{event.number} {event.text}" for event in events[-3:]) if events else ""
