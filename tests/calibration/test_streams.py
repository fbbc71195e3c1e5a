"""Calibration from robot and tracker over time: poses are found where the robot stands, the clocks' offset comes with it."""

import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation, Slerp

from mitl.calibration import CalibrationError, Distortion
from mitl.calibration.streams import calibrate_streams, standstills, turning_offset
from mitl.paths import PosePath
from mitl.poses import pose_of, transform_of

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
import calibration as experiment

OFFSET = -417.3456


def tour(stops, rate, move=1.0, stand=0.8):
    """The flange's way from stop to stop, sampled at a rate, and its times."""
    duration = len(stops) * (move + stand)
    time = np.arange(round(duration * rate)) / rate
    leg = np.minimum((time // (move + stand)).astype(int), len(stops) - 1)
    share = np.clip((time - leg * (move + stand)) / move, 0.0, 1.0)
    share = 0.5 - 0.5 * np.cos(np.pi * share)
    before = np.maximum(leg - 1, 0)
    position = stops.translation[before] + share[:, None] * (stops.translation[leg] - stops.translation[before])
    number = before + share * (leg - before)
    turn = Slerp(np.arange(len(stops)), stops.rotation)(number)
    return time, RigidTransform.from_components(position, turn)


def path_of(time, X):
    pose = pose_of(X)
    return PosePath(time, pose[:, :3], pose[:, 3:], np.ones(len(time), dtype=bool))


def streams(seed=1, count=24, noise=1e-4):
    rng = np.random.default_rng(seed)
    truth = experiment.scene(rng)
    stops = experiment.flange_poses(rng, count)
    time, flange = tour(stops, 50)
    tracked_time, seen = tour(stops, 250)
    reported = truth.report(seen)
    position = reported.translation + rng.normal(size=(len(seen), 3)) * noise
    turn = reported.rotation * Rotation.from_rotvec(rng.normal(size=(len(seen), 3)) * 5e-4)
    tracked = path_of(tracked_time - OFFSET, RigidTransform.from_components(position, turn))
    return truth, path_of(time, flange), tracked


def test_poses_and_clock_offset_come_from_the_streams():
    truth, flange, tracked = streams()
    found = calibrate_streams(flange, tracked, Distortion.SCALE)
    assert found.calibration.pose_count >= 20
    assert found.calibration.held_out.position_axis_rms < 0.15e-3
    assert found.calibration.scale[0] == pytest.approx(experiment.SCALE, abs=2e-4)
    error = transform_of(found.calibration.X_LB).inv() * truth.X_LB
    assert np.linalg.norm(error.translation) < 1e-3
    assert found.offset.seconds == pytest.approx(OFFSET, abs=1e-3)
    assert found.offset.sigma < 1e-3


def test_standstills_are_where_nothing_moves():
    _, flange, _ = streams(count=6)
    found = standstills(flange)
    assert len(found) >= 5
    for begin, end in found:
        assert np.ptp(flange.position[begin : end + 1], axis=0).max() < 3e-3


def test_a_robot_that_does_not_stand_or_does_not_move_is_refused():
    _, flange, tracked = streams(count=8)
    still = flange.select(np.arange(len(flange)) < 40)
    with pytest.raises(CalibrationError, match="offset cannot be told"):
        calibrate_streams(PosePath(still.time, still.position * 0.0, still.quaternion_wxyz, still.valid), tracked)
    with pytest.raises(CalibrationError, match=r"usable poses|does not stand still|offset cannot be told"):
        calibrate_streams(flange.between(0.0, 6.0), tracked.between(0.0 - OFFSET, 6.0 - OFFSET))


@pytest.mark.parametrize("seed", range(2, 6))
def test_a_body_far_from_the_flange_that_turns_all_the_time_still_tells_the_clock_offset(seed):
    _, flange, tracked = streams(seed=seed, count=16, noise=5e-4)
    assert turning_offset(flange, tracked).seconds == pytest.approx(OFFSET, abs=0.05)
    assert calibrate_streams(flange, tracked).offset.seconds == pytest.approx(OFFSET, abs=1e-3)


def test_a_tool_that_does_not_turn_leaves_the_offset_to_its_speed():
    _, flange, tracked = streams(count=6)
    facing = np.tile([1.0, 0.0, 0.0, 0.0], (len(flange), 1))
    assert turning_offset(PosePath(flange.time, flange.position, facing, flange.valid), tracked) is None
