"""Tracker statistics of made-up recordings whose noise is known."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.signal import lfilter

from mitl.metrics.allan import allan_deviation, structure_function
from mitl.metrics.noise_fit import fit_noise
from mitl.metrics.stretches import still_stretches
from mitl.metrics.tracker_statistics import tracker_statistics
from mitl.paths import PosePath

PERIOD = 0.004


def recording(position, time=None, valid=None):
    count = len(position)
    time = np.arange(count) * PERIOD if time is None else time
    valid = np.ones(count, dtype=bool) if valid is None else valid
    return PosePath(time, position, np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)), valid)


def wandering(seconds, seed=1, fast=0.15e-3, tau=0.01, walk=0.2e-3):
    random, count = np.random.default_rng(seed), round(seconds / PERIOD)
    decay = np.exp(-PERIOD / tau)
    white = random.standard_normal((count, 3)) * fast * np.sqrt(1 - decay**2)
    return lfilter([1.0], [1.0, -decay], white, axis=0) + np.cumsum(random.standard_normal((count, 3)) * walk * np.sqrt(PERIOD), axis=0)


def test_white_noise_averages_out_and_a_random_walk_grows():
    random = np.random.default_rng(1)
    white = random.standard_normal((100_000, 1))
    assert allan_deviation(white, [1, 100])[:, 0] == pytest.approx([1.0, 0.1], rel=0.05)
    walk = np.cumsum(white, axis=0)
    assert allan_deviation(walk, [100])[0, 0] == pytest.approx(np.sqrt(100 / 3), rel=0.1)
    assert np.isnan(allan_deviation(white, [60_000])).all()
    assert structure_function(walk, [1, 100])[:, 0] == pytest.approx([1.0, 100.0], rel=0.1)


def test_the_noise_fit_finds_what_went_in():
    fit = tracker_statistics(recording(wandering(60.0))).noise
    assert fit.fast_sd == pytest.approx(0.15e-3, rel=0.1)
    assert fit.fast_tau == pytest.approx(0.01, rel=0.2)
    assert fit.walk == pytest.approx(0.2e-3, rel=0.3)
    assert fit_noise(np.array([0.1]), np.array([1.0])) is None


def test_jitter_by_window_is_that_of_the_cloud_and_grows_with_the_window():
    found = tracker_statistics(recording(wandering(20.0))).jitter
    assert [j.window for j in found] == [0.1, 0.2, 0.5, 1.0, 2.0]
    assert all(b.mean > a.mean for a, b in pairwise(found))
    one = tracker_statistics(recording(np.tile([[0.0, 0, 0], [3e-3, 4e-3, 0]], (500, 1)))).jitter
    assert [j.mean for j in one] == pytest.approx([5e-3] * 5)
    assert [j.sd for j in one] == pytest.approx([0.0] * 5)


def test_gaps_losses_and_frozen_samples_are_counted():
    position = wandering(4.0)
    position[100:103] = position[99]
    time = np.arange(1000) * PERIOD
    time[500:] += 0.02
    valid = np.ones(1000, dtype=bool)
    valid[[300, 301, 700]] = False
    s = tracker_statistics(recording(position, time, valid))
    assert (s.samples, s.missing, s.invalid, s.losses, s.frozen) == (1000, 5, 3, 2, 3)
    assert s.longest_gap == pytest.approx(0.024)
    assert s.rate == pytest.approx(250.0)


def test_only_stretches_at_rest_count_for_noise():
    position = wandering(6.0)
    position[500:750, 0] += np.linspace(0.0, 0.2, 250)
    position[750:, 0] += 0.2
    s = tracker_statistics(recording(position))
    assert max(j.largest for j in s.jitter) < 2e-3
    assert 3.0 < s.still < 5.0
    stretches = still_stretches(recording(position))
    assert len(stretches) == 2
    moving = tracker_statistics(recording(np.linspace([0, 0, 0], [1, 0, 0], 1000)))
    assert moving.jitter == ()
    assert moving.noise is None


def test_drift_is_told_of_long_stretches():
    position = wandering(600.4, walk=0.0)[::50]
    position[:, 1] += np.linspace(0.0, 1e-3, len(position))
    drift = tracker_statistics(recording(position, np.arange(len(position)) * 0.2)).drift
    assert drift.range[1] == pytest.approx(0.9e-3, rel=0.1)
    assert drift.slope[1] == pytest.approx(1e-3 / 600.0, rel=0.1)
    assert tracker_statistics(recording(wandering(5.0))).drift is None


def test_two_samples_are_too_few():
    with pytest.raises(ValueError, match="at least three samples, got 2"):
        tracker_statistics(recording(np.zeros((2, 3))))
