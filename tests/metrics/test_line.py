import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mitl.metrics.line import line_deviation

START, END = np.array([0.5, -0.2, 0.4]), np.array([0.5, 0.3, 0.4])


def test_points_beside_the_line_have_signed_parts():
    points = np.array([[0.5, 0.0, 0.4], [0.503, 0.0, 0.4], [0.5, 0.1, 0.396], [0.5, -0.21, 0.4], [0.504, 0.303, 0.4]])
    found = line_deviation(points, START, END)
    np.testing.assert_allclose(found.along, [0.2, 0.2, 0.3, -0.01, 0.503], atol=1e-12)
    np.testing.assert_allclose(np.abs(found.sideways), [0, 0.003, 0, 0, 0.004], atol=1e-12)
    np.testing.assert_allclose(found.upwards, [0, 0, -0.004, 0, 0], atol=1e-12)
    np.testing.assert_allclose(found.beyond, [0, 0, 0, -0.01, 0.003], atol=1e-12)
    np.testing.assert_allclose(found.distance, [0, 0.003, 0.004, 0.01, 0.005], atol=1e-12)
    assert found.summary().max == pytest.approx(0.004)


@given(seed=st.integers(0, 1000))
def test_distances_do_not_change_with_a_rigid_motion(seed):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(20, 3))
    R, p = Rotation.random(rng=rng), rng.normal(size=3)
    there = line_deviation(points, START, END)
    here = line_deviation(R.apply(points) + p, R.apply(START) + p, R.apply(END) + p)
    np.testing.assert_allclose(here.distance, there.distance, atol=1e-12)
    np.testing.assert_allclose(here.along, there.along, atol=1e-12)
    np.testing.assert_allclose(np.hypot(here.sideways, here.upwards), np.hypot(there.sideways, there.upwards), atol=1e-12)


def test_a_vertical_line_has_two_directions_too():
    found = line_deviation(np.array([[0.003, 0.004, 0.5]]), np.zeros(3), np.array([0, 0, 1.0]))
    assert np.hypot(found.sideways, found.upwards)[0] == pytest.approx(0.005)


def test_a_line_of_no_length_is_refused():
    with pytest.raises(ValueError, match="two different points"):
        line_deviation(np.zeros((1, 3)), START, START)
