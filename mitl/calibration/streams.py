"""Calibration poses from continuous recordings of robot and tracker: where the robot stood still, and by how much the clocks differ.

Invariant: both streams stay on their own clocks; only windows in which the robot stands still, well inside its standstill, are averaged.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import correlate
from scipy.spatial.transform import Rotation

from mitl.calibration.choice import choose_distortion
from mitl.calibration.distortion import Distortion
from mitl.calibration.known_offset import refine_offset
from mitl.calibration.pose_set import CalibrationError, CalibrationPoses
from mitl.calibration.positions_only import calibrate_positions
from mitl.calibration.result import Calibration
from mitl.calibration.solve import calibrate
from mitl.calibration.time_offset import TimeOffset, time_offset
from mitl.paths import FloatArray, PosePath

_STILL = 0.2e-3  # m from one report of the robot to the next
_STILL_TURN = float(np.deg2rad(0.02))
# ASSUMPTION A-102: a pose is averaged over at most half a second, beginning .1 s after the stop (as the test cases do), and the coarse
# offset of the clocks may be wrong by .1 s, which a standstill must leave room for.
_SETTLING, _AVERAGE, _MARGIN = 0.1, 0.5, 0.1
_LEAST = 0.2
# ASSUMPTION A-105: a tool that turns by 10 deg/s somewhere tells the offset by its turning, if the two agree to nine tenths.
_LEAST_TURNING = float(np.deg2rad(10.0))
_ALIKE = 0.9
_GRID, _SPAN = 0.02, 0.1


@dataclass(frozen=True, eq=False)
class StreamCalibration:
    """A calibration from streams, the poses it was solved from, and the seconds to add to the tracker's times for the robot's clock."""

    calibration: Calibration
    poses: CalibrationPoses
    offset: TimeOffset


def calibrate_streams(flange: PosePath, tracker: PosePath, distortion: Distortion | None = None) -> StreamCalibration:
    """Gives the calibration from X_BF as the controller reports it and X_LM as tracked, each on its own clock.

    distortion: None for what the poses justify. Raises CalibrationError where the clocks' offset cannot be told or the poses do not do.
    """
    coarse = turning_offset(flange, tracker) or time_offset(flange, tracker)
    if not np.isfinite(coarse.sigma):
        raise CalibrationError("the clocks' offset cannot be told: robot and tracker do not show the same motion; record some of it")

    def solved(poses: CalibrationPoses) -> Calibration:
        if without_orientation(poses):
            return calibrate_positions(poses, distortion)
        return calibrate(poses, distortion=distortion or choose_distortion(poses))

    first = solved(still_poses(flange, tracker.shifted(coarse.seconds)))
    if first.positions_only:
        fine = refine_offset(body_path(flange, first), places(tracker, first).only_valid(), coarse.seconds)
    else:
        fine = refine_offset(flange, first.flange_path(tracker).only_valid(), coarse.seconds)
    offset = fine if np.isfinite(fine.sigma) else coarse
    poses = still_poses(flange, tracker.shifted(offset.seconds), margin=0.0 if offset is fine else _MARGIN)
    return StreamCalibration(solved(poses), poses, offset)


def without_orientation(poses: CalibrationPoses) -> bool:
    """Gives whether the tracker tells positions alone, as a reflector of a laser tracker does: nothing turns while the flange does."""
    if len(poses) < 2:
        return False
    return bool(np.ptp(poses.tracked[:, 3:], axis=0).max() == 0.0 and np.ptp(poses.flange[:, 3:], axis=0).max() > 0.0)


def body_path(flange: PosePath, calibration: Calibration) -> PosePath:
    """Gives where the tracked body is in the robot's base, not turned, as the flange's path X_BF says."""
    turned = Rotation.from_quat(flange.quaternion_wxyz, scalar_first=True).apply(calibration.X_FM[:3])
    return replace(flange, position=flange.position + turned, quaternion_wxyz=_unturned(flange))


def places(tracker: PosePath, calibration: Calibration) -> PosePath:
    """Gives where the tracked body is in the robot's base, not turned, as the tracker's path X_LM says."""
    return replace(tracker, position=calibration.points(tracker), quaternion_wxyz=_unturned(tracker))


def _unturned(path: PosePath) -> FloatArray:
    return np.tile([1.0, 0.0, 0.0, 0.0], (len(path), 1))


def turning_offset(flange: PosePath, tracker: PosePath) -> TimeOffset | None:
    """Gives the clocks' offset, to some hundredths of a second, by the speed of turning, which all points and frames share.

    None where too little turns to tell. `time_offset` goes by speeds, which differ between two points of a turning tool.
    """
    tracker = tracker.only_valid()
    if len(flange) < 10 or len(tracker) < 10:
        return None
    speeds = [_turning_speed(path) for path in (flange, tracker)]
    if min(float(speed.max(initial=0.0)) for speed in speeds) < _LEAST_TURNING:
        return None
    # standstill is the same as being outside the recording, so that nothing is subtracted
    score = correlate(speeds[0], speeds[1], mode="full", method="fft") / (np.linalg.norm(speeds[0]) * np.linalg.norm(speeds[1]))
    best = int(np.argmax(score))
    if score[best] < _ALIKE:
        return None
    lag = best - (len(speeds[1]) - 1)
    return TimeOffset(float(flange.time[0] - tracker.time[0] + lag * _GRID), _GRID)


def _turning_speed(path: PosePath) -> FloatArray:
    """Gives the speed of turning in rad/s every _GRID s from the path's beginning, over _SPAN s each."""
    grid = path.time[0] + np.arange(int((path.time[-1] - path.time[0]) / _GRID) + 1) * _GRID
    nearest = [np.clip(np.searchsorted(path.time, grid + shift), 0, len(path) - 1) for shift in (-_SPAN / 2, _SPAN / 2)]
    R = [Rotation.from_quat(path.quaternion_wxyz[index], scalar_first=True) for index in nearest]
    return np.asarray((R[0].inv() * R[1]).magnitude() / _SPAN)


def still_poses(flange: PosePath, tracker: PosePath, *, margin: float = _MARGIN) -> CalibrationPoses:
    """Gives the averaged poses at every standstill of the robot; both paths are on one clock, to within `margin` s.

    Raises CalibrationError for none.
    """
    flanges: list[FloatArray] = []
    tracked: list[FloatArray] = []
    jitter: list[float] = []
    for begin, end in standstills(flange):
        first = flange.time[begin] + _SETTLING + (margin if begin else 0.0)
        last = min(flange.time[end] - margin, first + _AVERAGE)
        if last - first < _LEAST:
            continue
        window = tracker.between(first, last).only_valid()
        if len(window) < 5:
            continue
        middle = (begin + end) // 2
        mean = Rotation.from_quat(window.quaternion_wxyz, scalar_first=True).mean().as_quat(canonical=True, scalar_first=True)
        flanges.append(np.concatenate([flange.position[middle], flange.quaternion_wxyz[middle]]))
        tracked.append(np.concatenate([window.position.mean(axis=0), mean]))
        jitter.append(2.0 * float(np.linalg.norm(window.position - window.position.mean(axis=0), axis=1).max()))
    if not flanges:
        raise CalibrationError("the robot does not stand still anywhere for half a second while it is tracked: let it stop at every pose")
    return CalibrationPoses(np.array(flanges), np.array(tracked), np.array(jitter))


def standstills(flange: PosePath) -> list[tuple[int, int]]:
    """Gives the first and last sample of every standstill."""
    if len(flange) < 2:
        return []
    R = Rotation.from_quat(flange.quaternion_wxyz, scalar_first=True)
    turn = (R[:-1].inv() * R[1:]).magnitude()
    still = (np.linalg.norm(np.diff(flange.position, axis=0), axis=1) < _STILL) & (turn < _STILL_TURN)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(np.int8)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
