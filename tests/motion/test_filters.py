"""Moving averages of any width: against closed forms and numpy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mitl.motion.filters import moving_average

TICK = 0.004
ROUNDING = 1e-12


@given(st.floats(0.001, 0.2))
def test_what_is_constant_stays(width):
    values = np.tile([1.0, -2.0, 3.0], (50, 1))
    assert moving_average(values, TICK, [width] * 3) == pytest.approx(values, abs=ROUNDING)


@given(st.floats(0.001, 0.1), st.floats(-5, 5))
def test_a_ramp_stays_away_from_its_ends(width, slope):
    values = slope * TICK * np.arange(200.0)[:, None]
    inner = slice(30, -30)
    assert moving_average(values, TICK, [width])[inner] == pytest.approx(values[inner], abs=1e-6 * (1 + abs(slope)))


@pytest.mark.parametrize("ticks", [4, 10, 12])
def test_whole_widths_agree_with_sums_by_the_trapezium_rule(ticks):
    rng = np.random.default_rng(1)
    values = np.cumsum(np.cumsum(rng.normal(size=(300, 1)), axis=0), axis=0) * 1e-4  # as smooth as joints are
    kernel = np.concatenate([[0.5], np.ones(ticks - 1), [0.5]]) / ticks
    expected = np.convolve(values[:, 0], kernel, mode="same")
    inner = slice(ticks, -ticks)
    # the spline's integral against the trapezium rule's: second differences / 12
    allowed = np.abs(np.diff(values[:, 0], 2)).max() / 12
    assert np.abs(moving_average(values, TICK, [ticks * TICK])[inner, 0] - expected[inner]).max() < allowed


def test_every_column_has_its_own_width_and_a_step_becomes_a_ramp_of_that_width():
    values = np.zeros((200, 2))
    values[100:] = 1.0
    filtered = moving_average(values, TICK, [0.04, 0.08])
    for column, width in ((0, 0.04), (1, 0.08)):
        rising = np.flatnonzero((filtered[:, column] > 0.05) & (filtered[:, column] < 0.95))
        assert len(rising) * TICK == pytest.approx(0.9 * width, abs=2 * TICK)
        middle = np.interp(0.5, filtered[80:120, column], TICK * np.arange(80, 120))
        assert middle == pytest.approx(99.5 * TICK, abs=0.5 * TICK), "no delay"


def test_the_ends_are_held():
    values = np.linspace(0, 1, 50)[:, None]
    filtered = moving_average(values, TICK, [0.04])
    assert filtered[0, 0] > 0
    assert filtered[-1, 0] < 1
    assert np.all(np.diff(filtered[:, 0]) >= -ROUNDING)
