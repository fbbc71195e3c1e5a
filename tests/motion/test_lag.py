"""The lagged path coordinate against closed forms and against the lag's own equation."""

import numpy as np
import pytest

from mitl.motion.lag import behind_at
from mitl.motion.timing import Timing

LAG = 0.0145


def pieces(*rows):
    """Gives a timing of pieces (lasts s, acceleration m/s^2, jerk m/s^3) from rest."""
    start, position, speed = [0.0], [0.0], [0.0]
    for lasts, a, j in rows:
        start.append(start[-1] + lasts)
        position.append(position[-1] + lasts * (speed[-1] + lasts * (a / 2 + lasts * j / 6)))
        speed.append(speed[-1] + lasts * (a + lasts * j / 2))
    a, j = np.array([row[1] for row in rows]), np.array([row[2] for row in rows])
    return Timing(np.array(start[:-1]), np.array(position[:-1]), np.array(speed[:-1]), a, j, start[-1])


def test_under_even_acceleration_it_falls_behind_as_the_closed_form_says():
    t = np.linspace(0, 0.2, 101)
    expected = 3.0 * LAG * (t - LAG * (1 - np.exp(-t / LAG)))
    assert behind_at(pieces((0.2, 3.0, 0.0)), LAG, 0.0, t) == pytest.approx(expected, abs=1e-12)


def test_after_the_end_the_way_behind_decays_exponentially():
    timing = pieces((0.1, 4.0, 0.0), (0.1, -4.0, 0.0))
    at_end, later = behind_at(timing, LAG, 0.0, np.array([0.2, 0.2 + 2 * LAG]))
    assert later == pytest.approx(at_end * np.exp(-2), rel=1e-12)


def test_it_satisfies_the_equation_of_a_first_order_lag_over_all_pieces():
    """d/dt behind = speed - behind / lag, from a start that is behind already."""
    timing = pieces((0.05, 0.0, 60.0), (0.1, 3.0, 0.0), (0.2, 0.0, 0.0), (0.07, -5.0, 10.0))
    t = np.linspace(0.0, timing.duration, 20001)
    behind = behind_at(timing, LAG, 0.004, t)
    middle = 0.5 * (t[1:] + t[:-1])
    slope = timing.at(middle)[1] - behind_at(timing, LAG, 0.004, middle) / LAG
    assert behind[0] == pytest.approx(0.004)
    assert np.diff(behind) / np.diff(t) == pytest.approx(slope, abs=1e-4)


def test_without_a_lag_nothing_is_behind():
    assert not behind_at(pieces((0.1, 4.0, 0.0)), 0.0, 0.0, np.linspace(0, 0.2, 5)).any()
