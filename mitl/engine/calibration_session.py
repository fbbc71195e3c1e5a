"""The session's calibration: drives the program from pose to pose and solves. Same seed, same result, whichever cases are run."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mitl.calibration.choice import choose_distortion
from mitl.calibration.frame_check import change_of_device
from mitl.calibration.pose_set import CalibrationPoses
from mitl.calibration.result import Calibration
from mitl.calibration.solve import calibrate
from mitl.calibration.store import load_calibration_and_reference
from mitl.engine.bench import order
from mitl.errors import RigError
from mitl.metrics.uncertainty import DRIFT_SD, DRIFT_TAU, drift_sigma
from mitl.paths import FloatArray
from mitl.protocols import AveragedPoint, Rig

CASE_ID = "calibration"
AVERAGE = 0.5
"""Seconds for which a still point is averaged (facts/atc.md)."""


STORED_IN = "stored in"
"""Key of the provenance of a calibration that was not made in this session: its file."""
REFERENCE = "reference"
"""Name of the device that stands still in view."""


@dataclass(frozen=True, eq=False)
class SessionCalibration:
    """The calibration of this session, the poses that it was solved from, and when the last was measured, in s on the rig's clock.

    reference: what the device that stands still showed then, if there is one. A stored calibration has no poses and was measured before
    the clock began, at minus infinity.
    """

    calibration: Calibration
    poses: CalibrationPoses
    measured_at: float
    reference: AveragedPoint | None = None


def calibration_program(rig: Rig, wanted: str | None = None) -> Path:
    """Gives the RAPID program with the calibration poses: the one wanted, the rig's, or that of mitl's own cases, for an IRB 140."""
    if wanted is not None:
        return Path(wanted).resolve()
    return rig.calibration_program or Path(__file__).resolve().parents[1] / "atc" / "calibration.mod"


def measure_poses(rig: Rig, program: Path, *, timeout: float = 60.0) -> CalibrationPoses:
    """Gives all poses of the calibration program, as `drive_to_poses` does. The rig is told that a case of its own begins."""
    rig.begin_case(CASE_ID)
    return drive_to_poses(rig, program, timeout=timeout)


def drive_to_poses(rig: Rig, program: Path, numbers: Sequence[int] | None = None, *, timeout: float = 60.0) -> CalibrationPoses:
    """Gives poses of the calibration program (from 1; None for all), as the controller and as the tracker see them.

    The program loops around TEST option; option 1 moves to the pose whose number is subOption; its variable poseCount says how many there
    are. A pose in which the tracker is out of sight is left out, up to a quarter of them. The robot is stopped on every way out.
    Raises RigError.
    """
    controller, tracker = rig.controller, rig.tracker
    flange: list[FloatArray] = []
    tracked: list[FloatArray] = []
    jitter: list[float] = []
    unseen = 0
    try:
        controller.stop()
        controller.load([program])
        controller.start()
        tracker.start()
        count = _pose_count(controller.read("poseCount"), program)
        chosen = range(1, count + 1) if numbers is None else [number for number in numbers if number <= count]
        for pose in chosen:
            order(rig, 1, pose, variables={}, timeout=timeout)
            try:
                point = tracker.average(AVERAGE)
            except RigError as error:
                unseen += 1  # one place out of sight costs its pose, as the arm itself may stand before a base station
                if unseen > max(1, len(chosen) // 4):
                    raise RigError(f"{unseen} of {len(chosen)} poses are out of the tracker's sight; pose {pose}: {error}") from error
                continue
            flange.append(controller.flange())
            tracked.append(np.concatenate([point.position, point.quaternion_wxyz]))
            jitter.append(point.jitter)
        tracker.stop()
    finally:
        controller.stop()
    return CalibrationPoses(np.array(flange), np.array(tracked), np.array(jitter))


def calibrate_rig(rig: Rig, program: Path) -> SessionCalibration:
    """Gives the calibration of a rig: the stored one that it names, or one from the poses of the calibration program.

    Raises RigError, also where the reference device shows that the tracker's frame moved meanwhile, or CalibrationError.
    """
    if rig.calibration is not None:
        return _stored(rig.calibration)
    rig.begin_case(CASE_ID)
    device = rig.devices.get(REFERENCE)
    began = rig.clock.now()
    before = device.average(AVERAGE) if device is not None else None
    poses = drive_to_poses(rig, program)
    measured_at = rig.clock.now()
    reference = device.average(AVERAGE) if device is not None else None
    if before is not None and reference is not None:
        elapsed = measured_at - began
        change = change_of_device(before, reference, drift=drift_sigma(DRIFT_SD, DRIFT_TAU, elapsed), elapsed=elapsed)
        if change.moved:
            raise RigError(f"the tracker's frame moved while it was calibrated, calibrate again: {change.told()}")
    provenance = {
        "rig": rig.name,
        "robot": rig.robot,
        "seed": str(rig.seed),
        "program": program.name,
        "poses seen": str(len(poses)),
        "program sha256": hashlib.sha256(program.read_bytes()).hexdigest(),
        **rig.versions,
    }
    solved = calibrate(poses, distortion=choose_distortion(poses), provenance=provenance)
    return SessionCalibration(solved, poses, measured_at, reference)


def _stored(file: Path) -> SessionCalibration:
    calibration, reference = load_calibration_and_reference(file)
    provenance = {**calibration.provenance, STORED_IN: str(file)}
    none = np.empty((0, 7))
    return SessionCalibration(replace(calibration, provenance=provenance), CalibrationPoses(none, none, np.empty(0)), -math.inf, reference)


def _pose_count(literal: str, program: Path) -> int:
    try:
        count = int(float(literal))
    except ValueError:
        count = 0
    if count < 1:
        raise RigError(f"poseCount of {program.name} is {literal!r}; expected the number of its poses")
    return count
