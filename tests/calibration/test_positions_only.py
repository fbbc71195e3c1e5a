"""A tracker that tells positions alone: what is solved, how well, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from mitl.calibration import CalibrationError, CalibrationPoses, Distortion, load_calibration, save_calibration
from mitl.calibration.positions_only import calibrate_positions
from mitl.paths import PosePath
from mitl.poses import pose_of, transform_of

RIGID = 1.0


def positions(bench, seed, count=25, scale=1.0055):
    """Poses as a reflector shows them, at .2 mm of noise, and the truth."""
    rng = np.random.default_rng(seed)
    truth = bench.scene(rng, scale)
    poses = bench.measured(rng, truth, bench.flange_poses(rng, count))
    tracked = poses.tracked.copy()
    tracked[:, 3:] = [1.0, 0.0, 0.0, 0.0]
    return CalibrationPoses(poses.flange, tracked, poses.jitter), truth, rng


def error(bench, fit, truth, rng):
    """Rms distance in m of predicted from true places of the reflector at fresh flange poses."""
    fresh = bench.flange_poses(rng, 200)
    true = np.array([truth.report(pose).translation for pose in fresh])
    return float(np.sqrt(np.mean(np.sum((fit.tracker_poses(pose_of(fresh))[:, :3] - true) ** 2, axis=1))))


def test_fresh_places_are_predicted_to_a_fraction_of_the_noise(experiments):
    errors = []
    for seed in range(10):
        poses, truth, rng = positions(experiments, seed)
        fit = calibrate_positions(poses)
        assert fit.positions_only
        assert fit.distortion is Distortion.SCALE
        assert fit.X_FM[:3] == pytest.approx(truth.X_FM.translation, abs=1e-3)
        errors.append(error(experiments, fit, truth, rng))
    assert np.median(errors) < 0.25e-3, "three coordinates with .2 mm each at 25 poses, for ten unknowns"


def test_no_scale_is_taken_where_there_is_none(experiments):
    poses, truth, rng = positions(experiments, 3, scale=RIGID)
    fit = calibrate_positions(poses)
    assert fit.distortion is Distortion.RIGID
    assert error(experiments, fit, truth, rng) < 0.25e-3


def test_outliers_are_named_and_change_nothing(experiments):
    poses, truth, rng = positions(experiments, 4)
    tracked = poses.tracked.copy()
    tracked[5, 0] += 0.035
    tracked[11, :3] = 0.0
    fit = calibrate_positions(CalibrationPoses(poses.flange, tracked, poses.jitter), Distortion.SCALE)
    assert [rejection.index for rejection in fit.rejected] == [5, 11]
    assert "outlier: 34." in fit.rejected[0].reason
    assert error(experiments, fit, truth, rng) < 0.3e-3


def test_the_covariance_is_honest(experiments):
    inside = 0
    for seed in range(60):
        poses, truth, _ = positions(experiments, 100 + seed)
        fit = calibrate_positions(poses, Distortion.SCALE)
        turn = (transform_of(fit.X_LB).rotation.inv() * truth.X_LB.rotation).as_rotvec()
        off = np.concatenate(
            [turn, truth.X_LB.translation - fit.X_LB[:3], truth.X_FM.translation - fit.X_FM[:3], truth.scale[:1] - fit.scale[:1]]
        )
        known = [*range(6), *range(9, 13)]
        inside += off @ np.linalg.solve(fit.covariance[np.ix_(known, known)], off) <= chi2.ppf(0.95, 10)
    assert 52 <= inside <= 60, "95 % of 60 are 57; fewer than 52 come once in a hundred"


def test_what_does_not_determine_it_is_refused(experiments):
    poses, _, _ = positions(experiments, 6)
    still = np.tile(poses.flange[0, 3:], (len(poses), 1))
    with pytest.raises(CalibrationError, match="must turn by at least 60 deg about two axes"):
        calibrate_positions(CalibrationPoses(np.hstack([poses.flange[:, :3], still]), poses.tracked, poses.jitter))
    others = np.random.default_rng(1).permutation(poses.tracked)
    with pytest.raises(CalibrationError, match="do not agree with the robot's poses"):
        calibrate_positions(CalibrationPoses(poses.flange, others, poses.jitter))


def test_it_is_stored_and_gives_places_but_no_tool(experiments, tmp_path):
    poses, _, _ = positions(experiments, 7)
    fit = calibrate_positions(poses)
    save_calibration(tmp_path / "c.toml", fit)
    again = load_calibration(tmp_path / "c.toml")
    assert again.positions_only
    assert np.array_equal(again.covariance, fit.covariance)
    path = PosePath(np.arange(len(poses)) * 1.0, poses.tracked[:, :3], poses.tracked[:, 3:], np.ones(len(poses), dtype=bool))
    turned = transform_of(poses.flange).rotation.apply(fit.X_FM[:3])
    assert again.points(path) == pytest.approx(poses.flange[:, :3] + turned, abs=1e-3)
    with pytest.raises(CalibrationError, match="positions alone"):
        again.flange_path(path)
    with pytest.raises(CalibrationError, match="positions alone"):
        replace(again, positions_only=True).tool_path(path, fit.X_FM, fit.X_FM)
