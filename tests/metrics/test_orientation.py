import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from mitl.metrics.orientation import angle_between, orientation_deviation, slerp, turn_between


def quaternions(seed, n=20):
    return Rotation.random(n, rng=np.random.default_rng(seed))


@given(seed=st.integers(0, 1000), angle=st.floats(1e-9, 3.14))
def test_a_known_turn_is_found_whatever_the_sign_of_the_quaternion(seed, angle):
    R = quaternions(seed)
    axis = np.random.default_rng(seed).normal(size=(20, 3))
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    first = R.as_quat(scalar_first=True)
    second = (R * Rotation.from_rotvec(axis * angle)).as_quat(scalar_first=True) * np.where(np.arange(20) % 2, 1.0, -1.0)[:, None]
    np.testing.assert_allclose(angle_between(first, second), angle, rtol=1e-6, atol=1e-15)
    np.testing.assert_allclose(turn_between(first, second), axis * angle, rtol=1e-5, atol=1e-15)


@given(seed=st.integers(0, 1000))
def test_the_angle_does_not_change_when_both_are_turned(seed):
    a, b, by = quaternions(seed), quaternions(seed + 1), quaternions(seed + 2, 1)[0]
    before = angle_between(a.as_quat(scalar_first=True), b.as_quat(scalar_first=True))
    after = angle_between((by * a).as_quat(scalar_first=True), (by * b).as_quat(scalar_first=True))
    np.testing.assert_allclose(after, before, atol=1e-9)
    np.testing.assert_allclose(before, (a.inv() * b).magnitude(), atol=1e-9)


@given(seed=st.integers(0, 1000))
def test_slerp_agrees_with_scipy(seed):
    R = quaternions(seed, 2)
    t = np.linspace(0, 1, 11)
    expected = Slerp([0, 1], R)(t).as_quat(scalar_first=True)
    start, end = R.as_quat(scalar_first=True)
    np.testing.assert_allclose(angle_between(slerp(start, end, t), expected), 0.0, atol=1e-9)
    np.testing.assert_allclose(angle_between(slerp(start, -end, t), expected), 0.0, atol=1e-9)


def test_slerp_between_equal_orientations_stays_there():
    q = np.array([1.0, 0, 0, 0])
    np.testing.assert_allclose(slerp(q, q, np.array([0.0, 0.3, 1.0])), np.tile(q, (3, 1)))


def test_an_orientation_that_lags_deviates_by_its_lag():
    start, end = Rotation.identity(), Rotation.from_euler("x", 90, degrees=True)
    progress = np.linspace(0, 1, 11)
    late = Rotation.from_rotvec(np.outer(np.maximum(0.0, progress - 0.1) * np.pi / 2, [1.0, 0, 0]))
    found = orientation_deviation(late.as_quat(scalar_first=True), *(r.as_quat(scalar_first=True) for r in (start, end)), progress)
    np.testing.assert_allclose(np.rad2deg(found[2:, 0]), -9.0)
    np.testing.assert_allclose(found[:, 1:], 0.0, atol=1e-12)
