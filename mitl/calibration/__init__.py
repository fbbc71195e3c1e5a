"""Calibration of the tracker against the robot: X_LM = A(X_LB * X_BF * X_FM), with its uncertainty. Start at `calibrate`.

Invariant: nothing here knows a rig; poses and paths come in as arrays, a `Calibration` goes out.
"""

from __future__ import annotations

from mitl.calibration.choice import choose_distortion
from mitl.calibration.distortion import Distortion
from mitl.calibration.pose_set import CalibrationError, CalibrationPoses
from mitl.calibration.result import Calibration, Rejection, Residuals
from mitl.calibration.solve import calibrate
from mitl.calibration.store import load_calibration, save_calibration
from mitl.calibration.time_offset import TimeOffset, time_offset

__all__ = [
    "Calibration",
    "CalibrationError",
    "CalibrationPoses",
    "Distortion",
    "Rejection",
    "Residuals",
    "TimeOffset",
    "calibrate",
    "choose_distortion",
    "load_calibration",
    "save_calibration",
    "time_offset",
]
