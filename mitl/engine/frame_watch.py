"""Looks at the tracker's frame at the start and the end of every case: a case whose frame moved could not be judged.

A device that stands still in view tells it at once, and tells the frame from the robot; without one the robot goes to some poses of the
calibration again. Invariant: it takes the rig's time and leaves the robot stopped, and judges no robot.
"""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Protocol

from mitl.calibration.frame_check import FrameChange, change_of_device, change_of_poses
from mitl.calibration.result import Calibration
from mitl.calibration.store import age
from mitl.engine.calibration_session import AVERAGE, REFERENCE, STORED_IN, SessionCalibration, drive_to_poses
from mitl.engine.recorder import CaseRecorder
from mitl.errors import MitlError, RigError
from mitl.metrics.uncertainty import DRIFT_SD, DRIFT_TAU, drift_sigma
from mitl.protocols import AveragedPoint, Rig, Tracker

# ASSUMPTION A-187: a session lasts half a day; facts/tracker.md: re-register every session.
_FRESH = timedelta(hours=12)
_POSES = (1, 2, 3)
"""The first ones: the plan has looked at the moves from pose to pose in its order, and at no others."""


class FrameWatch(Protocol):
    """Tells how far the tracker's frame is from where it was at the calibration."""

    def look(self) -> FrameChange:
        """Gives the change since the calibration. Raises RigError where it cannot be measured."""
        ...


class ReferenceWatch:
    """Watches a device that stands still."""

    def __init__(self, rig: Rig, device: Tracker, before: AveragedPoint, measured_at: float) -> None:
        self._rig = rig
        self._device = device
        self._before = before
        self._measured_at = measured_at

    def look(self) -> FrameChange:
        """Gives how far the device seems to have moved."""
        elapsed = self._rig.clock.now() - self._measured_at
        now = self._device.average(AVERAGE)
        return change_of_device(self._before, now, drift=_drift(elapsed), elapsed=elapsed)


class PosesWatch:
    """Has the robot go to some of the calibration's poses again."""

    def __init__(self, rig: Rig, session: SessionCalibration, program: Path) -> None:
        self._rig = rig
        self._session = session
        self._program = program

    def look(self) -> FrameChange:
        """Gives how far the poses are from what the calibration predicts. The robot runs the calibration's program meanwhile."""
        elapsed = self._rig.clock.now() - self._session.measured_at
        poses = drive_to_poses(self._rig, self._program, _POSES)
        found = change_of_poses(self._session.calibration, poses, drift=_drift(elapsed), elapsed=elapsed)
        if found is None:
            raise RigError("the tracker's frame could not be verified: no pose is seen; is the tracker in view and awake?")
        return found


def frame_watch(rig: Rig, session: SessionCalibration, program: Path) -> FrameWatch:
    """Gives the watch that the rig allows: by its reference device, or else by poses of the calibration program."""
    device = rig.devices.get(REFERENCE)
    if device is not None and session.reference is not None:
        return ReferenceWatch(rig, device, session.reference, session.measured_at)
    return PosesWatch(rig, session, program)


def _drift(elapsed: float) -> float:
    """Gives what drift explains in m of an axis, the worst, over so many seconds."""
    return drift_sigma(DRIFT_SD, DRIFT_TAU, elapsed)


def tell_age(calibration: Calibration, recorder: CaseRecorder) -> None:
    """Says where a stored calibration came from and how old it is; an old one is a warning, though its frame is verified."""
    file = calibration.provenance.get(STORED_IN)
    if file is None:
        return
    old = age(calibration, datetime.now(UTC))
    told = "of unknown age" if old is None else f"{old.total_seconds() / 3600.0:.1f} h old"
    level = "info" if old is not None and old < _FRESH else "warning"
    recorder.say(level, f"calibrated by {file}, {told}" + ("" if level == "info" else ": calibrate every session (mitl calibrate)"))


def refuse_if_moved(watch: FrameWatch) -> FrameChange:
    """Gives the change before a case begins. Raises RigError where the frame has moved already, because nothing could be judged."""
    change = watch.look()
    if change.moved:
        raise RigError(f"could not be judged: the tracker's frame is not where it was calibrated; {change.told()}; calibrate again")
    return change


def void_if_moved(watch: FrameWatch, before: FrameChange, recorder: CaseRecorder) -> None:
    """Looks again after a case. Where the frame has moved, or cannot be verified, nothing that the case measured counts."""
    try:
        after = watch.look()
    except MitlError as error:
        recorder.void(f"could not be judged: the tracker's frame could not be verified after the case: {error}")
        return
    if after.moved:
        recorder.void(f"could not be judged: the tracker's frame moved during the case; {after.told()}")
    else:
        recorder.say("info", f"the tracker's frame stayed; before the case {before.told()}; after it {after.told()}")
