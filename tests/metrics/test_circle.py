import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mitl.metrics.circle import arc_angle, circle_deviation, circle_through


def on_circle(angle, radius=0.1):
    return np.stack([np.zeros_like(angle), radius * np.cos(angle), radius * np.sin(angle)], axis=-1)


@given(seed=st.integers(0, 1000), radius=st.floats(0.005, 2.0))
def test_three_points_give_back_their_circle_anywhere(seed, radius):
    rng = np.random.default_rng(seed)
    R, p = Rotation.random(rng=rng), rng.normal(size=3)
    angles = np.array([0.0, 1.0, 2.5])
    circle = circle_through(*(R.apply(on_circle(angles, radius)) + p))
    np.testing.assert_allclose(circle.centre, p, atol=1e-9)
    np.testing.assert_allclose(circle.normal, R.apply([1.0, 0, 0]), atol=1e-9)
    assert circle.radius == pytest.approx(radius, rel=1e-9)
    around = np.linspace(0.0, 6.0, 50)
    found = circle_deviation(R.apply(on_circle(around, radius) + np.array([0.002, 0, 0])) + p, circle)
    np.testing.assert_allclose(found.in_plane, 0.0, atol=1e-9)
    np.testing.assert_allclose(found.out_of_plane, 0.002, atol=1e-9)
    np.testing.assert_allclose(found.angle, around, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(found.vector, axis=1), found.distance, atol=1e-12)


def test_a_larger_radius_is_a_deviation_outwards():
    circle = circle_through(*on_circle(np.array([0.0, 1.5, 3.0])))
    found = circle_deviation(on_circle(np.linspace(0, 3, 10), 0.103), circle)
    np.testing.assert_allclose(found.in_plane, 0.003)
    assert found.angle_range == pytest.approx((0.0, 3.0))


def test_the_order_of_the_points_is_the_sense_of_travel():
    one, two, three = on_circle(np.array([0.0, 1.0, 4.0]))
    assert arc_angle(circle_through(one, two, three), three) == pytest.approx(4.0)
    assert arc_angle(circle_through(three, two, one), one) == pytest.approx(4.0)


def test_points_on_a_line_are_refused():
    with pytest.raises(ValueError, match="not on a line"):
        circle_through(np.zeros(3), np.array([0.1, 0, 0]), np.array([0.3, 0, 0]))
    with pytest.raises(ValueError, match="not on a line"):
        circle_through(np.zeros(3), np.array([0.1, 0, 0]), np.zeros(3))


def test_the_centre_itself_is_one_radius_away():
    circle = circle_through(*on_circle(np.array([0.0, 1.5, 3.0])))
    assert circle_deviation(circle.centre[None], circle).distance[0] == pytest.approx(0.1)
