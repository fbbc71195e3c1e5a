"""Lines and arcs are closed forms, and three bad points are refused."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mitl.motion.legs import CLOSEST_ARC_POINTS, GeometryError, arc_through, line_through

EXACT = 1e-9  # m: well below the micrometre that is promised
ROUND = 1e-7  # m for arcs through nearly straight points, whose radius is many times their size

points = st.tuples(*[st.floats(-0.5, 0.5)] * 3).map(np.array)


def arc_in(angle_deg, radius=0.2, middle=0.4, frame=(0.3, -0.7, 0.5)):
    """Gives start, via (at a share of the way) and end of a known arc in a turned plane, and its centre."""
    R = Rotation.from_rotvec(frame)
    centre = np.array([0.4, 0.1, 0.3])
    angles = np.radians(angle_deg) * np.array([0, middle, 1])
    return centre + R.apply(radius * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)), centre


@pytest.mark.parametrize("angle_deg", [1, 30, 90, 179.9, 180, 180.1, 239.9, 240])
def test_an_arc_has_the_radius_centre_and_length_of_its_circle(angle_deg):
    (start, via, end), centre = arc_in(angle_deg)
    arc = arc_through(start, via, end)
    assert arc.radius == pytest.approx(0.2, abs=ROUND)
    assert arc.centre == pytest.approx(centre, abs=ROUND)
    assert arc.travel == pytest.approx(0.2 * np.radians(angle_deg), abs=ROUND)


@settings(max_examples=100, deadline=None)
@given(start=points, via=points, end=points)
def test_an_arc_goes_through_its_three_points_at_even_distance_from_its_centre(start, via, end):
    try:
        arc = arc_through(start, via, end)
    except GeometryError:
        assume(False)
    assume(arc.radius < 10)
    distance = np.linspace(0, arc.travel, 200)
    places = arc.position(distance)
    assert places[0] == pytest.approx(start, abs=ROUND)
    assert places[-1] == pytest.approx(end, abs=ROUND)
    assert np.linalg.norm(places - via, axis=1).min() <= arc.travel / 199
    assert np.linalg.norm(places - arc.centre, axis=1) == pytest.approx(arc.radius, abs=EXACT)


def test_a_full_circle_is_two_arcs_of_half_a_turn():
    centre = np.array([0.5, 0, 0.4])
    way = [centre + 0.1 * np.array(offset) for offset in ([1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [1, 0, 0])]
    first, second = arc_through(*way[:3]), arc_through(*way[2:])
    assert first.travel + second.travel == pytest.approx(2 * np.pi * 0.1, abs=EXACT)
    assert first.position(np.array([first.travel])) == pytest.approx(second.position(np.zeros(1)), abs=EXACT)


@pytest.mark.parametrize(
    ("three", "reason"),
    [
        (([0, 0, 0], [0.1, 0, 0], [0.2, 0, 0]), "on a line"),
        (([0, 0, 0], [0.2, 0, 0], [0.1, 0, 0]), "on a line"),
        (([0, 0, 0], [0.5 * CLOSEST_ARC_POINTS, 0, 0], [0.1, 0.1, 0]), "0.05 mm apart, at least 0.1 mm"),
        (([0, 0, 0], [0.1, 0.1, 0], [0, 0, 0]), "apart"),
        (tuple(arc_in(241)[0]), "turns by 241.0 deg, more than the 240 deg"),
        (tuple(arc_in(300)[0]), "300"),
    ],
)
def test_bad_points_of_an_arc_are_refused_with_the_reason(three, reason):
    with pytest.raises(GeometryError, match=reason):
        arc_through(*(np.array(point, dtype=float) for point in three))


def test_a_line_of_no_length_stays_where_it_is():
    line = line_through(np.ones(3), np.ones(3))
    assert line.travel == 0
    assert np.isfinite(line.position(np.array([0.0]))).all()
