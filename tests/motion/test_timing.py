"""Timing as cubic pieces: at and times_at are inverse, braking ends within its closed form."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mitl.motion.timing import Timing, braked, standing

WINDOW = 0.02
ROUNDING = 1e-9
LIMIT = 10.0


def ramps(*speeds, acceleration=LIMIT, cruise=0.05):
    """Gives a timing that goes from rest through speeds in m/s, each kept for a while, to rest."""
    pieces, s, t, v = [], 0.0, 0.0, 0.0
    for speed in [*speeds, 0.0]:
        a = np.sign(speed - v) * acceleration
        lasts = abs(speed - v) / acceleration
        if lasts > 0:
            pieces.append((t, s, v, a, 0.0))
        t, s, v = t + lasts, s + 0.5 * (v + speed) * lasts, speed
        if speed > 0:
            pieces.append((t, s, v, 0.0, 0.0))
            t, s = t + cruise, s + v * cruise
    return Timing(*np.array(pieces).T, t)


def dense(timing, n=5000):
    times = np.linspace(0, timing.duration, n)
    return times, *timing.at(times)


speeds = st.lists(st.floats(0.01, 2.0), min_size=1, max_size=10)


@settings(max_examples=100, deadline=None)
@given(speeds)
def test_times_at_is_the_inverse_of_at(values):
    timing = ramps(*values)
    times, position, speed, _ = dense(timing, 500)
    assert timing.at(timing.times_at(position))[0] == pytest.approx(position, abs=1e-14)
    moving = speed > 1e-3
    assert timing.times_at(position)[moving] == pytest.approx(times[moving], abs=1e-10)
    at_rest = (2 * 1e-15 / LIMIT) ** 0.5  # s grows with t^2 there, and its last digit is worth so much time
    assert timing.times_at(position[[0, -1]]) == pytest.approx([0, timing.duration], abs=2 * at_rest)


def test_it_stands_before_its_begin_and_after_its_end():
    timing = ramps(1.0)
    position, speed, _ = timing.at(np.array([-1.0, timing.duration + 1]))
    assert position == pytest.approx([0, 0.15], abs=ROUNDING)
    assert speed == pytest.approx([0, 0], abs=ROUNDING)
    assert standing(0.3).at(np.array([0.0, 5.0]))[0] == pytest.approx([0.3, 0.3])


@given(speeds, st.floats(0.0, 1.0))
def test_what_is_kept_until_a_time_is_the_same(values, share):
    timing = ramps(*values)
    time = share * timing.duration
    head = timing.until(time)
    times = np.linspace(0, time, 50)
    assert head.duration == time
    assert head.at(times)[0] == pytest.approx(timing.at(times)[0], abs=1e-12)


@given(st.floats(0.0, 1.2))
def test_braking_follows_the_timing_and_then_comes_to_rest_within_the_closed_form(share):
    timing = ramps(0.4, cruise=1.0)
    time = share * timing.duration
    stopped = braked(timing, time, LIMIT, WINDOW)
    early = np.linspace(0, min(time, timing.duration), 50)
    assert stopped.at(early)[0] == pytest.approx(timing.at(early)[0], abs=1e-12)
    speed, acceleration = (value[0] for value in timing.at(np.array([time]))[1:])
    assert stopped.at(np.array([stopped.duration]))[1][0] == pytest.approx(0, abs=ROUNDING)
    extra = stopped.duration - min(time, timing.duration)
    assert extra <= speed / LIMIT + WINDOW + 2 * abs(acceleration) / LIMIT * WINDOW + ROUNDING
    assert np.all(stopped.at(np.linspace(0, stopped.duration, 500))[1] >= -ROUNDING)
