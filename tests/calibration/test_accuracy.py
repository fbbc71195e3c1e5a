"""The accuracy that issue 2 promises, on the benchmark's experiments: 20 poses, .2 mm and .05 deg a pose, scale 1.0055."""

import numpy as np

from mitl.calibration import Distortion, choose_distortion

SEEDS = 20


def test_twenty_poses_predict_fresh_poses_within_the_promise(experiments):
    found = experiments.accuracy(SEEDS, 20, Distortion.SCALE)
    # against noise-free truth, rms of norms: promised .2 mm and .04 deg, aimed at .15 mm and .025 deg
    assert found.truth_position < 0.15e-3
    assert np.rad2deg(found.truth_rotation) < 0.025
    # against noisy poses not fitted to, per axis: the noise itself is .2 mm and .05 deg
    assert found.held_out_position / np.sqrt(3) < 0.25e-3
    assert np.rad2deg(found.held_out_rotation) / np.sqrt(3) < 0.06


def test_a_rigid_frame_cannot_absorb_the_scale_however_many_poses(experiments):
    few, many = (experiments.accuracy(5, count, Distortion.RIGID).truth_position for count in (20, 60))
    assert few > 1e-3
    assert many > 1e-3


def test_the_thesis_trackers_distortion_is_absorbed_by_the_affine_model(experiments):
    arguments = (8, 40), (experiments.THESIS_SCALE, experiments.THESIS_SKEW)
    affine = experiments.accuracy(*arguments[0], Distortion.AFFINE, *arguments[1])
    scale = experiments.accuracy(*arguments[0], Distortion.SCALE, *arguments[1])
    assert affine.truth_position < 0.2e-3
    assert scale.truth_position > 0.5e-3
    assert scale.registration > 0.3e-3, "a model that lacks something must say so in its uncertainty"


def test_two_outliers_of_twenty_change_next_to_nothing(experiments):
    without_them, all_good = experiments.outlier_effect(10)
    assert without_them.max() < 1e-6  # m: they are rejected, so the others decide alone
    assert np.median(all_good) < 0.05e-3


def test_the_covariance_is_honest(experiments):
    region, interval = experiments.coverage(100)
    # binomial sd of 100 seeds at 95 % is 2.2 %: three of them either way
    assert 0.86 <= region <= 1.0
    assert 0.88 <= interval <= 1.0


def test_the_registration_uncertainty_bounds_the_true_error_without_hiding_behind_it(experiments):
    found = experiments.accuracy(SEEDS, 20, Distortion.SCALE)
    per_axis = found.truth_position / np.sqrt(3)
    assert 0.7 * per_axis < found.registration < 2.5 * per_axis


def test_the_time_offset_is_found_to_a_fifth_of_a_millisecond(experiments):
    errors = experiments.time_offset_errors(20)
    assert errors.std() < 0.2e-3
    assert np.abs(errors).max() < 0.2e-3


def test_the_richest_justified_distortion_is_chosen(experiments):
    chosen = {}
    for name, scale, skew in (
        ("none", 1.0, None),
        ("scale", experiments.SCALE, None),
        ("affine", experiments.THESIS_SCALE, experiments.THESIS_SKEW),
    ):
        rng = np.random.default_rng(3)
        truth = experiments.scene(rng, scale, skew)
        chosen[name] = choose_distortion(experiments.measured(rng, truth, experiments.flange_poses(rng, 30)))
    assert chosen == {"none": Distortion.RIGID, "scale": Distortion.SCALE, "affine": Distortion.AFFINE}
