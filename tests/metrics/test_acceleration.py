"""Ramps of speed: the acceleration is the ramp's, noise or not, and a way to and fro is divided at its middle."""

import numpy as np
import pytest

from mitl.metrics.acceleration import middle_passages, ramp_acceleration

TIME = np.arange(0.0, 1.0, 0.004)


def ramp(acceleration, steady=0.5, start=0.1):
    return np.clip((TIME - start) * acceleration, 0.0, steady)


@pytest.mark.parametrize("acceleration", [0.7, 1.0, 1.5, 3.0])
def test_a_ramp_has_its_acceleration_and_so_has_it_backwards(acceleration):
    assert ramp_acceleration(TIME, ramp(acceleration), 0.5) == pytest.approx(acceleration, rel=1e-9)
    assert ramp_acceleration(-TIME[::-1], ramp(acceleration)[::-1], 0.5) == pytest.approx(acceleration, rel=1e-9)


def test_noise_does_not_bias_it():
    rng = np.random.default_rng(1)
    found = [ramp_acceleration(TIME, ramp(1.0) + rng.normal(0.0, 0.01, len(TIME)), 0.5) for _ in range(200)]
    assert np.mean(found) == pytest.approx(1.0, abs=4 * np.std(found) / np.sqrt(200))
    assert np.std(found) < 0.05


def test_a_speed_that_is_never_reached_is_refused():
    with pytest.raises(ValueError, match=r"does not pass 0\.8 m/s"):
        ramp_acceleration(TIME, ramp(1.0), 1.0)


def test_a_way_to_and_fro_passes_its_middle_once_each_way_despite_noise():
    time = np.arange(0.0, 4.0, 0.004)
    way = 0.15 * (1 - np.cos(np.pi * time)) + np.random.default_rng(2).normal(0.0, 2e-3, len(time))
    np.testing.assert_allclose(middle_passages(time, way, 0.3), [0.5, 1.5, 2.5, 3.5], atol=0.02)
