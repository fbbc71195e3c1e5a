"""Timing as cubic pieces, and the search for it: no cap, acceleration or jerk is exceeded, whatever the caps are."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mitl.motion.cells import Cells
from mitl.motion.pace import Pace, fastest_from, ramp_distance
from mitl.motion.timing import braked, standing

WINDOW = 0.02
ROUNDING = 1e-9
ABOVE_CAP = 2e-6  # the search's own slack, twice
LIMIT = 10.0


def cells_with(caps, width=0.01, ceiling=LIMIT):
    """One joint that turns 1 rad per m: its acceleration is the path's."""
    n = len(caps)
    edges = width * np.arange(n + 1.0) if np.isscalar(width) else np.concatenate([[0.0], np.cumsum(width)])
    still = np.zeros((n, 6))
    return Cells(
        edges=edges,
        middle=0.5 * (edges[1:] + edges[:-1]),
        cap=np.asarray(caps, dtype=float),
        rate=np.ones((n, 6)),
        bend=still,
        twist=still,
        limit=np.full(6, LIMIT),
        ceiling=np.full(n, ceiling),
    )


def timed(cells, **how):
    return Pace(cells, WINDOW, **how).timing()


def dense(timing, n=5000):
    times = np.linspace(0, timing.duration, n)
    return times, *timing.at(times)


caps = st.lists(st.floats(0.01, 2.0), min_size=1, max_size=40)


@settings(max_examples=200, deadline=None)
@given(caps, st.lists(st.floats(1e-4, 0.05), min_size=40, max_size=40))
def test_random_caps_are_never_exceeded_and_the_path_is_passed_forwards_from_rest_to_rest(values, widths):
    cells = cells_with(values, np.array(widths[: len(values)]))
    timing = timed(cells)
    _, position, speed, acceleration = dense(timing)
    cell = np.clip(np.searchsorted(cells.edges, position, side="right") - 1, 0, len(values) - 1)
    # on an edge either cell's cap may hold: rounding decides which one a sample lies in
    neighbour = np.clip(np.searchsorted(cells.edges, position - 1e-12, side="right") - 1, 0, len(values) - 1)
    assert np.all(speed <= np.maximum(cells.cap[cell], cells.cap[neighbour]) * (1 + ABOVE_CAP))
    assert np.all(np.abs(acceleration) <= LIMIT * (1 + ROUNDING))
    assert np.all(np.abs(timing.jerk) <= LIMIT / WINDOW * (1 + 1e-6))
    assert np.all(np.diff(position) >= -1e-15)
    assert (position[0], position[-1]) == (0, pytest.approx(cells.edges[-1], abs=ROUNDING))
    assert (speed[0], speed[-1]) == (0, pytest.approx(0, abs=ROUNDING))
    assert (acceleration[0], acceleration[-1]) == (0, pytest.approx(0, abs=1e-6))


@settings(max_examples=50, deadline=None)
@given(caps, st.integers(1, 39))
def test_a_stop_is_kept(values, stop):
    if stop >= len(values):
        return
    timing = timed(cells_with(values), stops=[stop])
    at_stop = timing.times_at(np.array([0.01 * stop]))
    assert timing.at(at_stop)[1][0] == pytest.approx(0, abs=1e-4)  # the root of s(t) is flat there


def test_one_hump_has_the_closed_form_of_a_jerk_limited_move():
    length, speed, jerk = 0.5, 0.4, LIMIT / WINDOW
    timing = timed(cells_with(np.full(50, speed)))
    ramp = speed / LIMIT + LIMIT / jerk
    assert timing.duration == pytest.approx(length / speed + ramp, abs=ROUNDING)
    times = np.array([0.0, WINDOW, ramp, timing.duration / 2])
    assert timing.at(times)[1] == pytest.approx([0, 0.5 * jerk * WINDOW**2, speed, speed], abs=ROUNDING)


def test_a_short_hump_never_reaches_its_cap():
    length, jerk = 1e-4, LIMIT / WINDOW
    timing = timed(cells_with([5.0], length))
    assert timing.duration == pytest.approx((32 * length / jerk) ** (1 / 3), abs=ROUNDING)


@given(st.floats(0, 2), st.floats(0, 2), st.floats(0.5, 20), st.floats(1e-4, 1))
def test_the_fastest_speed_from_another_uses_the_distance_and_not_more(slow, at_most, acceleration, distance):
    at_most = max(slow, at_most)
    jerk = acceleration / WINDOW
    fast = fastest_from(slow, distance, acceleration, jerk, at_most)
    assert slow <= fast <= at_most
    assert ramp_distance(slow, fast, acceleration, jerk) <= distance * (1 + 1e-9)
    if fast < at_most:
        assert ramp_distance(slow, fast, acceleration, jerk) == pytest.approx(distance, rel=1e-6)


@settings(max_examples=100, deadline=None)
@given(caps)
def test_times_at_is_the_inverse_of_at(values):
    timing = timed(cells_with(values))
    times, position, speed, _ = dense(timing, 500)
    assert timing.at(timing.times_at(position))[0] == pytest.approx(position, abs=1e-14)
    moving = speed > 1e-3
    assert timing.times_at(position)[moving] == pytest.approx(times[moving], abs=1e-10)
    at_rest = (6 * 1e-15 / timing.jerk.max()) ** (1 / 3)  # s grows with t^3 there, and its last digit is worth so much time
    assert timing.times_at(position[[0, -1]]) == pytest.approx([0, timing.duration], abs=2 * at_rest)


def test_it_stands_before_its_begin_and_after_its_end():
    timing = timed(cells_with([1.0, 1.0]))
    position, speed, _ = timing.at(np.array([-1.0, timing.duration + 1]))
    assert position == pytest.approx([0, 0.02], abs=ROUNDING)
    assert speed == pytest.approx([0, 0], abs=ROUNDING)
    assert standing(0.3).at(np.array([0.0, 5.0]))[0] == pytest.approx([0.3, 0.3])


def test_it_is_calm_where_it_runs_evenly_and_both_parts_together_are_the_whole():
    timing = timed(cells_with(np.full(50, 0.4)))
    assert timing.calm_from(0.499) is None, "it brakes there"
    calm = timing.calm_from(0.0)
    speed, acceleration = (value[0] for value in timing.at(np.array([calm]))[1:])
    assert (speed, acceleration) == (pytest.approx(0.4), pytest.approx(0, abs=1e-9))
    head, tail = timing.until(calm), timing.beyond(calm)
    assert head.duration == calm
    assert head.duration + tail.duration == pytest.approx(timing.duration)
    later = calm + np.linspace(0, tail.duration, 50)
    assert tail.at(later - calm)[0] == pytest.approx(timing.at(later)[0], abs=1e-12)
    assert head.at(np.linspace(0, calm, 50))[0] == pytest.approx(timing.at(np.linspace(0, calm, 50))[0], abs=1e-12)


@given(st.floats(0.0, 1.2))
def test_braking_follows_the_timing_and_then_comes_to_rest_within_the_closed_form(share):
    timing = timed(cells_with(np.full(50, 0.4)))
    time = share * timing.duration
    stopped = braked(timing, time, LIMIT, WINDOW)
    early = np.linspace(0, min(time, timing.duration), 50)
    assert stopped.at(early)[0] == pytest.approx(timing.at(early)[0], abs=1e-12)
    speed, acceleration = (value[0] for value in timing.at(np.array([time]))[1:])
    assert stopped.at(np.array([stopped.duration]))[1][0] == pytest.approx(0, abs=ROUNDING)
    extra = stopped.duration - min(time, timing.duration)
    assert extra <= speed / LIMIT + WINDOW + 2 * max(acceleration, 0) / LIMIT * WINDOW + ROUNDING
    assert np.all(stopped.at(np.linspace(0, stopped.duration, 500))[1] >= -ROUNDING)


def test_a_start_on_the_way_keeps_its_speed():
    timing = timed(cells_with(np.full(50, 0.4)), speed_at_start=0.4)
    assert timing.at(np.zeros(1))[1][0] == 0.4


@settings(max_examples=100, deadline=None)
@given(st.floats(0.05, 1), st.floats(1e-7, 1e-3), st.floats(0.01, 1))
def test_a_ramp_that_just_fits_never_runs_back(speed, length, share):
    """Ruckig may take a run-up, or fail, where a ramp's distance is the least possible to within rounding."""
    slower = fastest_from(share * speed, length, LIMIT, LIMIT / WINDOW, speed)
    cells = cells_with([speed, slower, share * speed], np.array([0.2, length, 0.2]))
    _, position, speeds, acceleration = dense(timed(cells))
    assert np.all(np.diff(position) >= -1e-15)
    assert speeds.min() >= -ROUNDING
    assert np.abs(acceleration).max() <= LIMIT * (1 + 1e-6)
