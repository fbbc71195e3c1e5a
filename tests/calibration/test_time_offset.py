import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mitl.calibration import TimeOffset, time_offset
from mitl.paths import PosePath

TOLERANCE = 1e-5  # s, exact paths: linear interpolation between samples of 4 ms at corners


@settings(max_examples=15, deadline=None)
@given(offset=st.floats(-20, 20), seed=st.integers(0, 100))
def test_any_offset_is_found_in_any_frame(experiments, offset, seed):
    reference = experiments.motion()
    R = Rotation.random(rng=np.random.default_rng(seed))
    moved = dataclasses.replace(reference, position=R.apply(reference.position) + 3.0)
    found = time_offset(reference, moved.shifted(-offset))
    assert found.seconds == pytest.approx(offset, abs=TOLERANCE)
    assert abs(found.seconds - time_offset(moved, reference.shifted(-offset)).seconds) < TOLERANCE


def test_a_piece_of_the_motion_suffices(experiments):
    reference = experiments.motion()
    piece = reference.between(1.2, 3.6).shifted(100.0)
    assert time_offset(reference, piece).seconds == pytest.approx(-100.0, abs=TOLERANCE)


def test_standing_before_and_after_does_not_matter(experiments):
    reference = experiments.motion()
    t = np.arange(0, 12, 0.004)
    longer = np.stack([np.interp(t - 3.0, reference.time, reference.position[:, i]) for i in range(3)], axis=1)
    noisy = longer + np.random.default_rng(1).normal(size=longer.shape) * 2e-4
    path = PosePath(t, noisy, np.tile([1.0, 0, 0, 0], (len(t), 1)), np.ones(len(t), dtype=bool))
    assert time_offset(reference, path).seconds == pytest.approx(-3.0, abs=0.2e-3)


def test_the_stated_sigma_is_that_of_the_errors(experiments):
    reference = experiments.motion()
    errors, stated = [], []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        noisy = dataclasses.replace(reference, position=reference.position + rng.normal(size=reference.position.shape) * 2e-4)
        found = time_offset(reference, noisy)
        errors.append(found.seconds)
        stated.append(found.sigma)
    assert 0.5 < np.std(errors) / np.median(stated) < 2.0


def test_correlated_noise_widens_sigma(experiments):
    reference = experiments.motion()
    rng = np.random.default_rng(1)
    white = rng.normal(size=reference.position.shape) * 2e-4
    slow = np.stack([np.convolve(np.pad(white[:, i], 12, mode="wrap"), np.ones(25) / 5.0, "valid") for i in range(3)], axis=1)
    sigmas = [time_offset(reference, dataclasses.replace(reference, position=reference.position + n)).sigma for n in (white, slow)]
    assert sigmas[1] > 2.0 * sigmas[0]


def test_invalid_samples_do_not_count(experiments):
    reference = experiments.motion()
    position, valid = reference.position.copy(), reference.valid.copy()
    position[300:340], valid[300:340] = 0.0, False
    lossy = dataclasses.replace(reference, position=position, valid=valid)
    assert time_offset(reference, lossy.shifted(0.5)).seconds == pytest.approx(-0.5, abs=1e-4)


def test_paths_that_stand_still_do_not_tell(experiments):
    reference = experiments.motion()
    rng = np.random.default_rng(1)
    still, other = (dataclasses.replace(reference, position=rng.normal(size=reference.position.shape) * 2e-4) for _ in range(2))
    for pair in ((reference, still), (still, reference), (still, other.shifted(1.0)), (reference.between(0, 0.01), reference)):
        found = time_offset(*pair)
        assert found == TimeOffset(0.0, np.inf)
        assert not found.significant


def test_an_offset_within_its_noise_is_not_significant():
    assert TimeOffset(0.005, 0.001).significant
    assert not TimeOffset(0.003, 0.001).significant
    assert not TimeOffset(5e-6, 0.0).significant


@pytest.mark.parametrize("offset", [0.0, 0.7, -1.2])
@pytest.mark.parametrize("noise", [0.0, 2e-4])
def test_a_motion_that_repeats_itself_is_matched_over_its_whole_length(offset, noise):
    rng = np.random.default_rng(1)
    t = np.arange(5000) * 0.004
    w = 2 * np.pi * t / 5.0  # half a period later the figure is its own mirror image
    position = 0.4 * np.stack([np.cos(w), np.sin(2 * w), 0.3 * np.sin(3 * w)], axis=1)
    reference = PosePath(t, position, np.tile([1.0, 0, 0, 0], (5000, 1)), np.ones(5000, dtype=bool))
    seen = Rotation.random(rng=rng).apply(position) + rng.normal(size=position.shape) * noise
    found = time_offset(reference, dataclasses.replace(reference, position=seen).shifted(-offset))
    assert found.seconds == pytest.approx(offset, abs=1e-4)
