import numpy as np
import pytest

from mitl.metrics.lateness import lateness
from mitl.paths import PosePath


def path(time, late=0.0, across=0.0, noise=0.0, radius=0.2, rate=1.5):
    angle = rate * (time - late)
    position = np.stack([(radius + across) * np.cos(angle), (radius + across) * np.sin(angle), np.zeros_like(time)], axis=1)
    position = position + np.random.default_rng(3).normal(0, noise, position.shape)
    return PosePath(time, position, np.tile([1.0, 0, 0, 0], (len(time), 1)), np.ones(len(time), dtype=bool))


TIME = np.arange(0, 4, 0.004)
AT = np.array([0.5, 1.7, 3.0])


def test_it_tells_how_late_a_tool_is_whatever_its_distance_across():
    found = lateness(path(TIME), path(TIME, late=0.008, across=5e-4), AT)
    assert found.seconds == pytest.approx(0.008, abs=3e-5)
    assert found.speed == pytest.approx(0.3, rel=1e-3)
    assert lateness(path(TIME), path(TIME, late=-0.003), AT).seconds == pytest.approx(-0.003, abs=2e-5)


def test_its_noise_is_the_samples_own():
    errors = [lateness(path(TIME), path(TIME, noise=1e-3), np.arange(0.2, 3.8, 0.2))]
    assert np.sqrt(np.mean(errors[0].seconds ** 2)) < errors[0].random.mean() < 1e-2


def test_where_the_tool_stands_or_nothing_was_recorded_it_tells_nothing():
    standing = path(TIME, rate=0.0)
    assert np.isnan(lateness(standing, standing, AT).seconds).all()
    blind = path(TIME)
    blind = PosePath(blind.time, blind.position, blind.quaternion_wxyz, np.abs(TIME - 1.7) > 0.3)
    found = lateness(path(TIME), blind, AT)
    assert np.isnan(found.seconds[1])
    assert np.isinf(found.random[1])
    assert np.isfinite(found.seconds[[0, 2]]).all()


def test_a_recording_that_ends_within_the_window_tells_by_what_there_is():
    short = path(TIME[TIME < 3.01], late=0.005)
    assert lateness(path(TIME), short, AT).seconds == pytest.approx(0.005, abs=3e-5)
