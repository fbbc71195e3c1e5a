import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mitl.metrics.path import interpolate, nearest_distance, path_deviation
from mitl.paths import PosePath


def path_of(t, position, R=None):
    q = np.tile([1.0, 0, 0, 0], (len(t), 1)) if R is None else R.as_quat(scalar_first=True)
    return PosePath(t, position, q, np.ones(len(t), dtype=bool))


def around_a_corner(n=400):
    t = np.linspace(0, 4, n)
    way = np.stack([np.minimum(t, 2.0) * 0.1, np.maximum(t - 2.0, 0.0) * 0.1, np.zeros(n)], axis=1)
    return path_of(t, way, Rotation.from_rotvec(np.outer(t * 0.3, [0, 0, 1.0])))


def test_a_path_that_lags_deviates_in_time_and_not_in_space():
    expected = around_a_corner()
    found = path_deviation(expected, expected.shifted(0.05))
    middle = (found.time > 0.5) & (found.time < 1.9)
    np.testing.assert_allclose(found.distance[middle], 0.005, rtol=1e-6)
    np.testing.assert_allclose(found.vector[middle], [[-0.005, 0, 0]] * middle.sum(), atol=1e-9)
    np.testing.assert_allclose(found.angle[middle], 0.015, rtol=1e-6)
    np.testing.assert_allclose(found.nearest, 0.0, atol=1e-9)


def test_a_path_beside_deviates_in_both():
    expected = around_a_corner()
    beside = PosePath(expected.time, expected.position + np.array([0, 0, 0.002]), expected.quaternion_wxyz, expected.valid)
    found = path_deviation(expected, beside)
    np.testing.assert_allclose(found.distance, 0.002)
    np.testing.assert_allclose(found.nearest, 0.002)
    np.testing.assert_allclose(found.angle, 0.0, atol=1e-9)


@settings(max_examples=20)
@given(seed=st.integers(0, 1000), shift=st.floats(-100, 100))
def test_deviations_do_not_change_when_both_move_rigidly_and_in_time(seed, shift):
    rng = np.random.default_rng(seed)
    expected = around_a_corner(60)
    noisy = PosePath(expected.time, expected.position + rng.normal(size=(60, 3)) * 1e-3, expected.quaternion_wxyz, expected.valid)
    R, p = Rotation.random(rng=rng), rng.normal(size=3)

    def moved(path):
        turn = (R * Rotation.from_quat(path.quaternion_wxyz, scalar_first=True)).as_quat(scalar_first=True)
        return PosePath(path.time + shift, R.apply(path.position) + p, turn, path.valid)

    before, after = path_deviation(expected, noisy), path_deviation(moved(expected), moved(noisy))
    np.testing.assert_allclose(after.distance, before.distance, atol=1e-9)
    np.testing.assert_allclose(after.nearest, before.nearest, atol=1e-9)
    np.testing.assert_allclose(after.angle, before.angle, atol=1e-7)


def test_the_nearest_point_of_sparse_and_of_standing_curves():
    corner = np.array([[0.0, 0, 0], [0, 0, 0], [1.0, 0, 0], [1.0, 0, 0], [1.0, 1.0, 0]])
    points = np.array([[0.4567, 0.003, 0], [1.004, 0.777, 0.003], [-0.01, 0, 0], [1.01, 0, 0]])
    np.testing.assert_allclose(nearest_distance(corner, points), [0.003, 0.005, 0.01, 0.01], atol=1e-12)
    np.testing.assert_allclose(nearest_distance(corner[:2], points[2:3]), [0.01])


def test_a_closed_curve_has_no_gap_where_it_closes():
    square = np.array([[0.0, 0, 0], [1.0, 0, 0], [1.0, 1.0, 0], [0, 1.0, 0], [0, 0, 0]])
    np.testing.assert_allclose(nearest_distance(square, np.array([[0.0, 0.0008, 0], [0.0008, 0.0, 0.001]])), [0.0, 0.001], atol=1e-12)


def test_only_valid_samples_in_common_time_count():
    expected = around_a_corner()
    valid = expected.valid.copy()
    valid[100:] = False
    measured = PosePath(expected.time - 0.5, expected.position, expected.quaternion_wxyz, valid)
    found = path_deviation(expected, measured)
    assert found.time[0] >= 0.0
    assert found.time[-1] <= expected.time[99] - 0.5
    with pytest.raises(ValueError, match="no time in common"):
        path_deviation(expected, expected.shifted(10.0))


def test_interpolation_meets_the_samples_and_halves_between_them():
    path = around_a_corner(5)
    there = interpolate(path, np.array([0.0, 0.5, 1.0, 4.0]))
    np.testing.assert_allclose(there.position[:, 0], [0.0, 0.05, 0.1, 0.2])
    angles = Rotation.from_quat(there.quaternion_wxyz, scalar_first=True).magnitude()
    np.testing.assert_allclose(angles, [0.0, 0.15, 0.3, 1.2], atol=1e-12)
    holes = PosePath(path.time, path.position, path.quaternion_wxyz, np.array([True, False, True, True, True]))
    assert interpolate(holes, np.array([0.0, 0.5, 1.5, 2.0, 2.5])).valid.tolist() == [True, False, False, True, True]
    assert len(interpolate(path.select(np.arange(5) == 0), np.array([0.0]))) == 1
