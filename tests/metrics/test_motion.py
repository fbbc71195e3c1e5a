"""Speed, stillness, and when a path moves."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mitl.metrics.glitch import without_glitches, without_pulses
from mitl.metrics.moving import moving_interval
from mitl.metrics.speed import line_speed, path_speed, speed, speed_difference, velocity
from mitl.metrics.stillness import is_still, jitter_diameter, overrun, standstill_after
from mitl.paths import PosePath


def path_of(t, position, valid=None):
    return PosePath(t, position, np.tile([1.0, 0, 0, 0], (len(t), 1)), np.ones(len(t), dtype=bool) if valid is None else valid)


def line_at(v, duration=4.0, rest=1.0, noise=0.0, seed=0, rate=250.0):
    t = np.arange(int((duration + 2 * rest) * rate)) / rate
    way = np.clip(t - rest, 0, duration) * v
    position = np.outer(way, [0.6, -0.8, 0.0]) + np.random.default_rng(seed).normal(size=(len(t), 3)) * noise
    return path_of(t, position)


@settings(max_examples=30)
@given(v=st.floats(0.001, 2.0), window=st.sampled_from([0.0, 0.02, 0.4]), start=st.floats(0, 1e5))
def test_a_steady_line_has_its_speed_at_every_sample(v, window, start):
    t = start + np.sort(np.random.default_rng(1).uniform(0, 3, 600))
    t = t[np.concatenate([[True], np.diff(t) > 1e-4])]
    path = path_of(t, np.outer(t - start, [0.6, -0.8, 0.0]) * v + 10.0)
    np.testing.assert_allclose(speed(path, window), v, rtol=1e-5)
    assert line_speed(path, start + 1.0, start + 1.4).value == pytest.approx(v, rel=1e-7)
    assert path_speed(path, start + 1.0, start + 1.4).value == pytest.approx(v, rel=1e-5)


def test_the_speed_of_a_long_recording_keeps_its_digits():
    t = np.arange(400_000) * 0.004 + 1e6
    path = path_of(t, np.stack([np.sin(0.3 * (t - 1e6)), np.cos(0.3 * (t - 1e6)), np.zeros(len(t))], axis=1))
    np.testing.assert_allclose(speed(path, 0.04), 0.3, rtol=1e-4)
    np.testing.assert_allclose(velocity(path, 0.0)[0], [0.3, 0, 0], atol=2e-3)


@settings(max_examples=20)
@given(seed=st.integers(0, 100), shift=st.floats(-100, 100))
def test_speed_does_not_change_with_rigid_motion_and_time_shift(seed, shift):
    rng = np.random.default_rng(seed)
    t = np.arange(100) * 0.004
    position = np.cumsum(rng.normal(size=(100, 3)), axis=0) * 1e-3
    moved = Rotation.random(rng=rng).apply(position) + rng.normal(size=3)
    np.testing.assert_allclose(speed(path_of(t + shift, moved), 0.03), speed(path_of(t, position), 0.03), rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("v", [0.005, 0.5])
def test_the_stated_noise_of_a_mean_speed_is_that_of_its_errors(v):
    found = [line_speed(line_at(v, noise=2e-4, seed=seed), 2.8, 3.2) for seed in range(60)]
    errors = np.array([f.value for f in found]) - v
    assert abs(errors.mean()) < 3 * errors.std() / np.sqrt(60) + 1e-4
    assert 0.7 < errors.std() / np.median([f.random for f in found]) < 1.4


def test_a_circle_reads_low_as_documented():
    t = np.arange(2000) * 0.004
    path = path_of(t, 0.05 * np.stack([np.cos(10 * t), np.sin(10 * t), 0 * t], axis=1))
    found = path_speed(path, 1.0, 4.0, window=0.04)
    assert 1.0 - found.value / 0.5 == pytest.approx((0.5 * 0.04 / 0.05) ** 2 / 40, rel=0.5)


def test_too_little_for_a_speed_is_refused():
    path = line_at(0.1)
    with pytest.raises(ValueError, match="at least 3 valid samples"):
        line_speed(path, 90.0, 91.0)
    with pytest.raises(ValueError, match="at least 3 valid samples"):
        path_speed(path, 90.0, 91.0)
    with pytest.raises(ValueError, match="at least two samples"):
        speed(path.between(0.0, 0.001))


@given(seed=st.integers(0, 200), n=st.sampled_from([2, 10, 3000]))
@settings(max_examples=20, deadline=None)
def test_the_jitter_diameter_is_the_largest_distance_of_two_points(seed, n):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(n, 3))
    some = points[rng.integers(0, n, 50)]
    found = jitter_diameter(points)
    assert found >= max(np.linalg.norm(points - p, axis=1).max() for p in some) - 1e-12
    assert jitter_diameter(Rotation.random(rng=rng).apply(points) + 5.0) == pytest.approx(found, rel=1e-9)


def test_flat_and_tiny_clouds_have_a_jitter_too():
    t = np.linspace(0, 1, 4000)
    assert jitter_diameter(np.outer(t, [1.0, 1.0, 0.0])) == pytest.approx(np.sqrt(2))
    assert jitter_diameter(np.stack([np.cos(9 * t), np.sin(9 * t), 0 * t], axis=1)) == pytest.approx(2.0, rel=1e-3)
    assert jitter_diameter(np.zeros((0, 3))) == jitter_diameter(np.ones((1, 3))) == 0.0


def test_stillness_counts_valid_samples_only():
    path = line_at(0.0, noise=1e-4)
    position, valid = path.position.copy(), path.valid.copy()
    position[5], valid[5] = 0.7, False
    assert is_still(path_of(path.time, position, valid), 2e-3)
    assert not is_still(path_of(path.time, position), 2e-3)
    assert not is_still(path_of(path.time, position, np.zeros_like(valid)), 2e-3)


@pytest.mark.parametrize(("v", "tolerance"), [(0.5, 0.02), (0.05, 0.03), (0.005, 0.25)])
@pytest.mark.parametrize("noise", [0.0, 2e-4])
def test_the_standing_parts_at_both_ends_are_found(v, tolerance, noise):
    for seed in range(5):
        found = moving_interval(line_at(v, noise=noise, seed=seed))
        assert found is not None
        assert found[0] == pytest.approx(1.0, abs=tolerance)
        assert found[1] == pytest.approx(5.0, abs=tolerance)


def test_a_standing_path_never_moves_and_a_cut_one_moves_from_the_start():
    assert moving_interval(line_at(0.0, noise=2e-4)) is None
    assert moving_interval(line_at(0.0, noise=2e-4).between(0.0, 0.0)) is None
    piece = line_at(0.5, noise=2e-4).between(2.0, 4.0)
    assert moving_interval(piece) == (2.0, 4.0)


def test_a_path_that_returns_to_its_start_moves_all_the_while():
    t = np.arange(2000) * 0.004
    way = np.interp(t, [1, 2, 3, 5, 6, 7], [0, 0.1, 0, 0, 0.1, 0])
    found = moving_interval(path_of(t, np.outer(way, [1.0, 0, 0])))
    assert found == pytest.approx((1.0, 7.0), abs=0.03)


@settings(max_examples=15)
@given(seed=st.integers(0, 100), shift=st.integers(-50, 50))
def test_motion_moves_with_the_clock_and_not_with_the_frame(seed, shift):
    rng = np.random.default_rng(seed)
    path = line_at(0.2, noise=1e-4, seed=seed)
    found = moving_interval(path)
    moved = moving_interval(path_of(path.time + shift, Rotation.random(rng=rng).apply(path.position) + 1.0))
    assert moved == pytest.approx((found[0] + shift, found[1] + shift), abs=0.013)


def glitched(path, *firsts, samples=5, size=25e-3):
    position = path.position.copy()
    for first in firsts:
        position[first : first + samples] += size * np.array([0.48, 0.6, 0.64])
    return path_of(path.time, position, path.valid)


@pytest.mark.parametrize("v", [0.0, 0.3, 1.0])
def test_glitches_are_marked_and_nothing_else(v):
    path = glitched(line_at(v, noise=4e-4), 60, 300, 1200)
    valid = without_glitches(path).valid
    expected = np.ones(len(path), dtype=bool)
    for first in (60, 300, 1200):
        expected[first - 1 : first + 6] = False
    np.testing.assert_array_equal(valid, expected)


def test_what_a_robot_can_do_is_no_glitch():
    t = np.arange(1500) * 0.004
    away = np.abs(t - 3.0)
    reversal = np.where(away < 0.05, 10.0 * away**2, away - 0.025)  # 20 m/s^2 from 1 m/s to -1 m/s
    circle = 0.05 * np.stack([np.cos(10 * t), np.sin(10 * t), 0 * t], axis=1)  # .5 m/s
    for position in (np.outer(reversal, [1.0, 0, 0]), circle):
        assert without_glitches(path_of(t, position)).valid.all()
    long = glitched(line_at(0.0, noise=2e-4), 300, samples=50)
    assert without_glitches(long).valid.all()


@given(st.integers(1, 6), st.integers(20, 960), st.floats(0.001, 0.03))
def test_a_pulse_is_taken_off_a_deviation_and_a_step_stays_where_it_is(samples, first, size):
    time = np.arange(1000) * 0.004
    step = np.where(time < 2.0, 0.0, 0.01)
    pulsed = step.copy()
    pulsed[first : first + samples] += size
    away = np.abs(np.arange(1000) - 500) > 8
    seen = without_pulses(time, pulsed)
    np.testing.assert_array_equal(seen[away], step[away])
    np.testing.assert_array_equal(without_pulses(time, step), step)
    assert np.abs(seen).max() <= max(0.01, size)


def test_a_glitch_does_not_start_the_motion():
    path = glitched(line_at(0.2, noise=2e-4), 60, 1450)
    found = moving_interval(path)
    assert found == pytest.approx((1.0, 5.0), abs=0.03)


def test_lost_samples_stay_lost_and_tiny_paths_stay():
    path = line_at(0.1)
    valid = path.valid.copy()
    valid[100:120] = False
    position = np.where(valid[:, None], path.position, 0.0)
    np.testing.assert_array_equal(without_glitches(path_of(path.time, position, valid)).valid, valid)
    assert len(without_glitches(path.between(0, 0.004))) == 2
    sparse = path_of(np.arange(10.0), np.random.default_rng(1).normal(size=(10, 3)))
    assert without_glitches(sparse).valid.all()


@pytest.mark.parametrize(("start", "stop"), [(1.5, 1.56), (1.5, 4.5)])
def test_a_difference_of_speeds_is_known_as_well_as_it_says(start, stop):
    expected = line_at(0.2)
    found = [speed_difference(expected, line_at(0.204, noise=2e-4, seed=seed), start, stop, around=0.4) for seed in range(40)]
    values = np.array([one.value for one in found])
    spread, told = values.std(ddof=1), np.median([one.random for one in found])
    assert values.mean() == pytest.approx(0.004, abs=3 * spread / np.sqrt(len(values)))
    assert 0.5 * spread < told < 3.0 * spread


def test_a_difference_of_speeds_needs_samples():
    with pytest.raises(ValueError, match="got 0"):
        speed_difference(line_at(0.2), line_at(0.2), 20.0, 21.0, around=0.4)


def test_standstill_is_where_the_speed_falls_below_2_mm_in_25_ms():
    assert standstill_after(line_at(0.2), 4.0) == pytest.approx(1.0 - 0.010, abs=0.005)  # the last 2 mm at 200 mm/s take 10 ms
    assert standstill_after(line_at(0.2), 5.5) == 0.0
    assert standstill_after(line_at(0.2).between(0.0, 4.5), 4.0) == np.inf
    with pytest.raises(ValueError, match="no valid samples"):
        standstill_after(line_at(0.2), 99.0)


@pytest.mark.parametrize("delay", [0.0, 0.025])
def test_an_overrun_is_the_way_after_the_call_at_the_speed_before_it(delay):
    path = line_at(0.2, duration=3.04 + delay, noise=3e-4, seed=3)  # on its way from 1 s on
    assert overrun(path, 4.0) == pytest.approx(0.04 + delay, abs=0.003)
    with pytest.raises(ValueError, match="too few valid samples"):
        overrun(path, 99.0)
