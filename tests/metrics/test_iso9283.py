"""ISO 9283: every criterion gives what was put into made-up data, and refuses too few cycles."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import f as fisher

from mitl.metrics.iso9283.cornering import cornering
from mitl.metrics.iso9283.distance import distance
from mitl.metrics.iso9283.multi_direction import multi_directional
from mitl.metrics.iso9283.path_criteria import path_criteria
from mitl.metrics.iso9283.pose_accuracy import pose_accuracy
from mitl.metrics.iso9283.pose_drift import pose_drift
from mitl.metrics.iso9283.posing_time import posing_time
from mitl.metrics.iso9283.repeatability import PER_SIGMA, repeatability, rp
from mitl.metrics.iso9283.settling import stabilisation
from mitl.metrics.iso9283.velocity import path_velocity
from mitl.paths import PosePath

LEVEL = np.array([1.0, 0.0, 0.0, 0.0])


def cloud(seed, count, sigma, centre=(0.0, 0.0, 0.0)):
    return np.asarray(centre) + np.random.default_rng(seed).normal(0.0, sigma, (count, 3))


def test_pose_accuracy_is_the_distance_of_the_mean_and_the_angle_of_the_mean_turn():
    turn = Rotation.from_rotvec([0.0, 0.02, 0.0]).as_quat(scalar_first=True)
    attained = np.column_stack([cloud(1, 30, 1e-4, (0.003, 0.004, 0.0)), np.tile(turn, (30, 1))])
    found = pose_accuracy(attained, np.concatenate([np.zeros(3), LEVEL]))
    assert found.position == pytest.approx(5e-3, abs=1e-4)
    assert found.angle == pytest.approx(0.02, abs=1e-9)


def test_repeatability_of_three_even_axes_is_the_constant_times_sigma():
    assert rp(cloud(2, 20_000, 1e-3)) == pytest.approx(PER_SIGMA * 1e-3, rel=0.02)


def test_the_trackers_share_is_taken_off_and_what_is_left_is_told_with_its_uncertainty():
    whole = [repeatability(cloud(seed, 30, 0.5e-3), cloud(1000 + seed, 30, 0.3e-3)) for seed in range(200)]
    expected = PER_SIGMA * 0.4e-3
    assert np.mean([found.robot for found in whole]) == pytest.approx(expected, rel=0.05)
    outside = np.mean([abs(found.robot - expected) > 1.65 * found.uncertainty + 0.2e-3 for found in whole])
    assert outside < 0.1
    alone = repeatability(cloud(1, 30, 0.3e-3), cloud(2, 30, 0.3e-3))
    assert alone.robot < alone.rp
    assert 0.3e-3 < alone.smallest < 2e-3


def test_a_robot_of_the_smallest_size_is_told_from_a_perfect_one_nineteen_times_in_twenty():
    still = cloud(0, 30, 1.0)
    factor = repeatability(still, still).smallest / PER_SIGMA / np.sqrt(np.mean(np.var(still, axis=0, ddof=1)))
    critical = fisher.ppf(0.95, 87, 87)

    def variance(seed, sigma):
        return np.mean(np.var(cloud(seed, 30, sigma), axis=0, ddof=1))

    found = [variance(seed, np.hypot(1.0, factor)) / variance(10_000 + seed, 1.0) > critical for seed in range(600)]
    assert np.mean(found) == pytest.approx(0.95, abs=0.03)


def test_directions_differ_by_the_largest_distance_of_their_means():
    found, random = multi_directional([cloud(1, 30, 1e-5), cloud(2, 30, 1e-5, (2e-3, 0, 0)), cloud(3, 30, 1e-5, (0, 1e-3, 0))])
    assert found == pytest.approx(np.sqrt(5) * 1e-3, abs=2e-5)
    assert random < 1e-5


def test_a_distance_has_accuracy_and_repeatability():
    first = np.zeros((40, 3))
    second = np.zeros((40, 3))
    second[:, 0] = 0.1 + np.where(np.arange(40) % 2, 1e-3, -1e-3)
    found = distance(first, second, 0.098)
    assert found.accuracy == pytest.approx(2e-3)
    assert found.repeatability == pytest.approx(3e-3, rel=0.02)


@pytest.mark.parametrize(("beyond", "took"), [(0.0, 0.0), (8e-3, 0.1)])
def test_a_stop_that_runs_over_takes_its_time(beyond, took):
    time = np.arange(0.0, 1.0, 0.004)
    way = np.clip(time, 0.0, 0.5) + np.where((time > 0.5) & (time < 0.6), beyond * np.sin(np.pi * (time - 0.5) / 0.1), 0.0)
    position = np.column_stack([way, 3e-3 * (time < 0.49), np.zeros_like(way)])
    found, overshoot = stabilisation(time, position, np.array([0.5, 0.0, 0.0]), 2e-3)
    assert found == pytest.approx(took, abs=0.02)
    assert overshoot == pytest.approx(beyond, abs=1.5e-3)


def test_a_band_that_is_not_kept_is_refused():
    time = np.arange(0.0, 1.0, 0.004)
    with pytest.raises(ValueError, match="not kept"):
        stabilisation(time, np.outer(time, [1.0, 0, 0]), np.array([0.5, 0, 0]), 2e-3)


def test_drift_is_from_the_first_batch():
    mean, spread = pose_drift([cloud(1, 10, 1e-5), cloud(1, 10, 1e-5, (1e-3, 0, 0)), cloud(1, 10, 3e-5, (0, 2e-3, 0))])
    assert mean == pytest.approx(2e-3, abs=3e-5)
    assert 2e-5 < spread < 3e-4


def test_a_path_beside_its_line_and_a_turn_that_is_late_show():
    start, end = (np.concatenate([[x, 0.0, 0.0], LEVEL]) for x in (0.0, 0.4))
    share = np.linspace(-0.05, 1.05, 300)
    passes = []
    for number in range(10):
        aside = 3e-3 * np.sin(np.pi * share) + (1e-3 if number % 2 else -1e-3)
        turned = Rotation.from_rotvec(np.outer(0.05 * np.sin(np.pi * share), [0, 0, 1])).as_quat(scalar_first=True)
        passes.append(PosePath(share, np.column_stack([0.4 * share, aside, 0 * share]), turned, np.full(300, True)))
    found = path_criteria(passes, start, end)
    assert found.accuracy == pytest.approx(3e-3, rel=0.02)
    assert found.angle == pytest.approx(0.05, rel=0.02)
    assert found.repeatability == pytest.approx(1e-3, rel=0.1)
    with pytest.raises(ValueError, match="at least three passes"):
        path_criteria(passes[:2], start, end)


def test_a_corner_is_cut_and_run_past():
    time = np.arange(0.0, 1.0, 0.002)
    way = np.clip(time, 0, 0.5)
    aside = np.clip(time - 0.5, 0, 0.5)
    path = np.column_stack([way - 0.5 + 4e-3 * np.exp(-(((time - 0.52) / 0.02) ** 2)), aside, np.zeros_like(way)])
    cut, over = cornering(time, path, np.zeros(3), np.array([-0.5, 0, 0]))
    assert cut < 6e-3
    assert over == pytest.approx(4e-3, abs=1e-3)


def test_speeds_are_off_scatter_and_fluctuate():
    passes = [np.full(50, 0.505 + offset) for offset in (-2e-3, 0.0, 2e-3)]
    passes[1] = passes[1] + np.linspace(-0.01, 0.01, 50)
    found = path_velocity(passes, 0.5)
    assert (found.accuracy, found.repeatability, found.fluctuation) == pytest.approx((0.01, 0.012, 0.02))


def test_posing_time_is_from_leaving_to_staying():
    time = np.arange(0.0, 2.0, 0.004)
    way = np.clip(time - 0.5, 0.0, 0.5)
    position = np.column_stack([way, 0 * way, 0 * way])
    found = posing_time(time, position, np.zeros(3), np.array([0.5, 0, 0]), 2e-3)
    assert found == pytest.approx(0.5, abs=0.03)
    with pytest.raises(ValueError, match="does not lead"):
        posing_time(time, position, np.zeros(3), np.array([0.7, 0, 0]), 2e-3)
