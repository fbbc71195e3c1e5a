"""Whether the tracker's frame is still where it was at the calibration, from a device that stands still or from the robot's poses.

Invariant: a frame within its drift and noise is called moved once in ten thousand looks; nothing here knows a rig.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.calibration.pose_set import CalibrationPoses, invalid_reasons
from mitl.calibration.result import Calibration
from mitl.calibration.solve import ROTATION_SIGMA
from mitl.paths import FloatArray
from mitl.protocols import AveragedPoint

# ASSUMPTION A-186: 4.6 standard deviations of an axis bound the length of three normal numbers but once in ten thousand.
_BOUND = 4.6
_OF_JITTER = 5.0
"""A mean is as uncertain as a fifth of its jitter (ASSUMPTION A-66)."""


@dataclass(frozen=True)
class FrameChange:
    """How far the tracker's frame seems to have moved: shift in m and turn in rad, with the greatest that drift and noise explain.

    of: what was looked at. elapsed: s since the calibration.
    """

    shift: float
    turn: float
    shift_limit: float
    turn_limit: float
    of: str
    elapsed: float

    @property
    def moved(self) -> bool:
        """Gives whether drift and noise do not explain it."""
        return self.shift > self.shift_limit or self.turn > self.turn_limit

    def told(self) -> str:
        """Gives one line about it."""
        since = f" {self.elapsed:.0f} s after the calibration" if np.isfinite(self.elapsed) else " since the stored calibration"
        return (
            f"{self.of}: {1e3 * self.shift:.1f} mm and {np.degrees(self.turn):.2f} deg{since};"
            f" drift and noise explain {1e3 * self.shift_limit:.1f} mm and {np.degrees(self.turn_limit):.2f} deg"
        )


def change_of_device(before: AveragedPoint, now: AveragedPoint, *, drift: float, elapsed: float) -> FrameChange:
    """Gives the change that a device shows which stands still. drift: standard deviation in m of an axis over the `elapsed` s."""
    noise = np.hypot(before.jitter, now.jitter) / _OF_JITTER
    turn = Rotation.from_quat([before.quaternion_wxyz, now.quaternion_wxyz], scalar_first=True)
    return FrameChange(
        shift=float(np.linalg.norm(now.position - before.position)),
        turn=float((turn[0].inv() * turn[1]).magnitude()),
        shift_limit=_BOUND * float(np.hypot(drift, noise)),
        turn_limit=_BOUND * ROTATION_SIGMA * np.sqrt(2.0),
        of="the reference device moved",
        elapsed=elapsed,
    )


def change_of_poses(calibration: Calibration, poses: CalibrationPoses, *, drift: float, elapsed: float) -> FrameChange | None:
    """Gives the mean difference of poses measured now from what the calibration predicts; None where no pose is usable.

    A robot that has moved, e.g. by a slipped joint, looks the same: which of the two it was only a device that stands still can tell.
    """
    usable = np.array([not reason for reason in invalid_reasons(poses)], dtype=np.bool_)
    if not np.any(usable):
        return None
    seen = poses.select(usable)
    count = len(seen)
    expected = calibration.tracker_poses(seen.flange)
    noise = float(np.sqrt(np.mean(seen.jitter**2))) / _OF_JITTER
    spread = np.sqrt((calibration.position_noise**2 + noise**2) / count + calibration.position_uncertainty() ** 2 + drift**2)
    turn_spread = np.sqrt((calibration.rotation_noise**2 + ROTATION_SIGMA**2) / count + calibration.rotation_uncertainty() ** 2)
    return FrameChange(
        shift=float(np.linalg.norm(np.mean(seen.tracked[:, :3] - expected[:, :3], axis=0))),
        turn=float(np.linalg.norm(_turns(expected, seen.tracked).mean(axis=0))),
        shift_limit=_BOUND * float(spread),
        turn_limit=_BOUND * float(turn_spread),
        of=f"{count} calibration poses are off",
        elapsed=elapsed,
    )


def _turns(expected: FloatArray, seen: FloatArray) -> FloatArray:
    """Gives the rotation vectors (N, 3) in L from expected to seen poses (N, 7)."""
    R_expected, R_seen = (Rotation.from_quat(poses[:, 3:], scalar_first=True) for poses in (expected, seen))
    return np.asarray((R_seen * R_expected.inv()).as_rotvec())
