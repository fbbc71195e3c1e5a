"""The session's calibration: drives the program from pose to pose and solves. Same seed, same result, whichever cases are run."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mitl.calibration.choice import choose_distortion
from mitl.calibration.pose_set import CalibrationPoses
from mitl.calibration.result import Calibration
from mitl.calibration.solve import calibrate
from mitl.engine.bench import order
from mitl.errors import RigError
from mitl.paths import FloatArray
from mitl.protocols import Rig

CASE_ID = "calibration"
AVERAGE = 0.5
"""Seconds for which a still point is averaged (facts/atc.md)."""


@dataclass(frozen=True, eq=False)
class SessionCalibration:
    """The calibration of this session, the poses that it was solved from, and when the last was measured, in s on the rig's clock."""

    calibration: Calibration
    poses: CalibrationPoses
    measured_at: float


def measure_poses(rig: Rig, program: Path, *, timeout: float = 60.0) -> CalibrationPoses:
    """Gives the poses of the calibration program, as the controller and as the tracker see them.

    The program loops around TEST option; option 1 moves to the pose whose number is subOption; its variable poseCount says how many there
    are. The rig is told that a case of its own begins. The robot is stopped on every way out. Raises RigError.
    """
    rig.begin_case(CASE_ID)
    controller, tracker = rig.controller, rig.tracker
    flange: list[FloatArray] = []
    tracked: list[FloatArray] = []
    jitter: list[float] = []
    try:
        controller.stop()
        controller.load([program])
        controller.start()
        tracker.start()
        for pose in range(1, _pose_count(controller.read("poseCount"), program) + 1):
            order(rig, 1, pose, variables={}, timeout=timeout)
            point = tracker.average(AVERAGE)
            flange.append(controller.flange())
            tracked.append(np.concatenate([point.position, point.quaternion_wxyz]))
            jitter.append(point.jitter)
        tracker.stop()
    finally:
        controller.stop()
    return CalibrationPoses(np.array(flange), np.array(tracked), np.array(jitter))


def calibrate_rig(rig: Rig, program: Path) -> SessionCalibration:
    """Gives the calibration of a rig from the poses of the calibration program. Raises RigError or CalibrationError."""
    poses = measure_poses(rig, program)
    provenance = {"rig": rig.name, "seed": str(rig.seed), "program": program.name}
    measured_at = rig.clock.now()
    return SessionCalibration(calibrate(poses, distortion=choose_distortion(poses), provenance=provenance), poses, measured_at)


def _pose_count(literal: str, program: Path) -> int:
    try:
        count = int(float(literal))
    except ValueError:
        count = 0
    if count < 1:
        raise RigError(f"poseCount of {program.name} is {literal!r}; expected the number of its poses")
    return count
