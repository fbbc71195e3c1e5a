"""Records a rig's tracker and robot to MCAP while they run.

Invariant: what is older than a second of the rig's time is in the file, whatever happens to the process (see RecordingWriter); only what
the controller streams of itself is written at the end.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mitl.errors import RigError
from mitl.feedback import FeedbackSamples
from mitl.paths import FloatArray, PosePath
from mitl.protocols import DetailedTracker, ExecutionState, Rig
from mitl.recording.feedback import feedback_facts, feedback_series, feedback_track
from mitl.recording.mcap_writer import RecordingWriter
from mitl.recording.records import EGM, EGM_FLANGE, JOINTS, TRACKER, Series
from mitl.samples import TrackerSamples

FLANGE = "/robot/flange"
"""Topic of X_BF as the controller reports it, on the rig's clock; the tracker's topics are on the tracker's."""
STATE = "/tracker/state"
"""Topic of result code, buttons and native velocity, where the tracker tells them."""
_POLL = 0.02  # s between two looks at the robot
_EVERY = 0.5  # s between two handings over of samples
_STANDS = 0.8  # s at each calibration pose


class RigRecorder:
    """Writes a rig's tracker and robot into a file. Use as a context manager; `run` lets time pass."""

    def __init__(self, rig: Rig, file: Path, metadata: dict[str, str]) -> None:
        self._rig = rig
        self._writer = RecordingWriter(file)
        self._writer.add_metadata({"rig": rig.name, "robot": rig.robot, "seed": str(rig.seed), **rig.versions, **metadata})
        self._written = 0
        self._robot: list[tuple[float, FloatArray, FloatArray]] = []
        self._handed_over = rig.clock.now()
        self._wrote_robot = False
        rig.tracker.start()
        if rig.feedback is not None:
            rig.feedback.start()

    def __enter__(self) -> RigRecorder:
        return self

    def __exit__(self, *_: object) -> None:
        try:
            self._hand_over()
            self._rig.tracker.stop()
            if self._rig.feedback is not None:
                self._add_feedback(self._rig.feedback.stop())
        finally:
            self._writer.close()

    def run(self, seconds: float) -> None:
        """Records for so many seconds of the rig's time."""
        end = self._rig.clock.now() + seconds
        while True:
            now = self._rig.clock.now()
            self._robot.append((now, self._rig.controller.joints(), self._rig.controller.flange()))
            if now - self._handed_over >= _EVERY:
                self._hand_over()
            if end - now < 1e-9:
                return
            self._rig.clock.wait(min(_POLL, end - now))

    def calibration_poses(self, program: Path, *, timeout: float = 60.0) -> None:
        """Drives the calibration program from pose to pose, standing still at each. Raises RigError where it does not go on."""
        controller = self._rig.controller
        controller.stop()
        controller.load([program])
        controller.start()
        try:
            for pose in range(1, int(float(controller.read("poseCount"))) + 1):
                controller.write("subOption", str(pose))
                controller.write("option", "1")
                self._until_done(pose, timeout)
                self.run(_STANDS)
        finally:
            controller.stop()

    def _until_done(self, pose: int, timeout: float) -> None:
        given = self._rig.clock.now()
        while float(self._rig.controller.read("option")) != 0.0:
            self.run(_POLL)
            if self._rig.controller.state() is ExecutionState.STOPPED:
                raise RigError(f"the controller stopped on the way to pose {pose}")
            if self._rig.clock.now() - given > timeout:
                raise RigError(f"pose {pose} was not reached in {timeout:g} s")

    def _add_feedback(self, samples: FeedbackSamples) -> None:
        """Writes what the controller streamed; as a whole, because its clock is known only then."""
        self._writer.add_metadata({"egm": feedback_facts(samples)})
        if not len(samples):
            return
        self._writer.add_series(EGM, feedback_series(samples))
        track = feedback_track(samples)
        if track is not None:
            self._writer.add_poses(EGM_FLANGE, track.path, frame=track.frame, body=track.body)

    def _hand_over(self) -> None:
        """Writes what has come since the last time."""
        self._handed_over = self._rig.clock.now()
        tracker = self._rig.tracker
        samples = tracker.samples() if isinstance(tracker, DetailedTracker) else TrackerSamples.plain(tracker.path())
        new = samples.select(np.arange(len(samples)) >= self._written)
        self._written = len(samples)
        self._writer.add_poses(TRACKER, new.path, frame="tracker", body="body")
        if len(new) and np.all(np.isfinite(new.velocity)):
            values = np.column_stack([new.result, new.buttons, new.velocity])
            self._writer.add_series(STATE, Series(new.path.time, values, ("result", "buttons", "vx", "vy", "vz")))
        later = [row for i, row in enumerate(self._robot) if i == 0 or row[0] > self._robot[i - 1][0]]
        self._robot = later[-1:]  # kept to tell a repeated time
        rows = later[1:] if self._wrote_robot else later
        if rows:
            time = np.array([row[0] for row in rows])
            joints, flange = np.array([row[1] for row in rows]), np.array([row[2] for row in rows])
            valid = np.ones(len(time), dtype=np.bool_)
            self._writer.add_series(JOINTS, Series(time, joints, tuple(f"j{i}" for i in range(1, joints.shape[1] + 1))))
            self._writer.add_poses(FLANGE, PosePath(time, flange[:, :3], flange[:, 3:], valid), frame="base", body="flange")
            self._wrote_robot = True
        self._writer.flush()  # not by the writer's own wall clock, which would keep rows for a second hand-over
