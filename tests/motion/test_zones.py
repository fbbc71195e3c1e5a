"""The blend of a corner: continuous at its edges, as deep as measured."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mitl.motion.zones import blended, off_corner, orientation_blend, position_blend, position_blend_slope

JUST = 1e-9
SMOOTH = 1e-8  # a jump would be of the order of 1


@pytest.mark.parametrize("edge", [-1, -1 / 3, 0, 1 / 3, 1])
@pytest.mark.parametrize("function", [position_blend, position_blend_slope, orientation_blend])
def test_the_blend_and_its_slope_are_continuous(function, edge):
    below, above = function(np.array([edge - JUST, edge + JUST]))
    assert below == pytest.approx(above, abs=SMOOTH)


def test_the_slope_is_the_derivative_of_the_blend():
    u = np.linspace(-0.99, 0.99, 199)
    h = 1e-6
    assert position_blend_slope(u) == pytest.approx((position_blend(u + h) - position_blend(u - h)) / (2 * h), abs=1e-8)


@pytest.mark.parametrize("function", [position_blend, orientation_blend])
def test_outside_the_zone_the_blend_is_the_distance_and_at_its_edge_the_slope_is_one(function):
    assert function(np.array([-3.0, -1.0, 1.0, 1.5])) == pytest.approx([3, 1, 1, 1.5])
    inside = (function(np.array([1.0])) - function(np.array([1 - 1e-6]))) / 1e-6
    assert inside == pytest.approx(1, abs=1e-5)


@given(st.floats(5, 175))
def test_a_corner_is_cut_as_measured(angle_deg):
    """facts/motion.md: the cut in the middle is .2166 of the radius times |u2 - u1|; the model of facts/planner.md gives .2171."""
    angle = np.radians(angle_deg)
    u1, u2 = np.array([1.0, 0, 0]), np.array([np.cos(angle), np.sin(angle), 0])
    v = off_corner(np.zeros(1))
    middle = blended(v[:, None] * u1, v[:, None] * u2, v, position_blend(v))[0]
    share = np.linalg.norm(middle) / np.linalg.norm(u2 - u1)
    assert 0.2166 <= share <= 0.2171
