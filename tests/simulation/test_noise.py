"""The random processes and the quaternions that the sensor model is made of."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mitl.simulation.noise import LocationField, OrnsteinUhlenbeck
from mitl.simulation.quaternions import small_turn, turned


def test_ornstein_uhlenbeck_noise_has_its_deviation_and_correlation_time_from_the_first_sample_on():
    process = OrnsteinUhlenbeck(np.random.default_rng(1), (1.0, 2.0, 0.5), tau=0.02, period=0.004)
    values = process.sample(200_000)
    # 40,000 independent values: the deviation of the estimate is .35 %; 4 of them.
    assert values.std(axis=0) == pytest.approx([1.0, 2.0, 0.5], rel=0.015)
    lagged = np.mean(values[5:] * values[:-5], axis=0) / values.var(axis=0)
    assert lagged == pytest.approx([math.exp(-1)] * 3, abs=0.02)
    starts = [OrnsteinUhlenbeck(np.random.default_rng([2, n]), 1.0, tau=100.0, period=0.004).sample(1)[0, 0] for n in range(2000)]
    assert np.std(starts) == pytest.approx(1.0, rel=0.07)


def test_a_process_without_deviation_is_zero():
    assert not OrnsteinUhlenbeck(np.random.default_rng(1), 0.0, tau=1.0, period=0.004).sample(10).any()


def test_a_location_field_is_normal_over_space_and_smooth():
    fields = [LocationField(np.random.default_rng(seed), correlation_length=0.25) for seed in range(200)]
    points = np.random.default_rng(0).uniform(-1, 1, (50, 3))
    values = np.array([field.at(points) for field in fields])
    assert values.mean() == pytest.approx(0.0, abs=0.05)
    assert values.std() == pytest.approx(1.0, abs=0.05)
    near = np.array([field.at(points + np.array([0.01, 0.0, 0.0])) for field in fields])
    assert np.abs(near - values).std() < 0.1


def test_small_turns_agree_with_scipy():
    generator = np.random.default_rng(1)
    start = Rotation.random(100, rng=generator)
    turn = generator.normal(size=(100, 3)) * 0.01
    end = turned(start.as_quat(scalar_first=True), turn)
    expected = start * Rotation.from_rotvec(turn)
    third_order = 0.04**3 / 12 + 1e-12  # the largest turn drawn is below .04 rad
    assert (Rotation.from_quat(end, scalar_first=True).inv() * expected).magnitude().max() < third_order
    assert np.linalg.norm(end, axis=1) == pytest.approx(1.0, abs=1e-15)
    # Quaternions q and -q are the same rotation.
    assert small_turn(start.as_quat(scalar_first=True), -end) == pytest.approx(turn, abs=third_order)
