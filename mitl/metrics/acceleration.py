"""Acceleration of a ramp of speed, from the times at which the speed passes a fifth and four fifths of what the ramp leads to."""

from __future__ import annotations

import numpy as np

from mitl.paths import FloatArray

LOWER, UPPER = 0.2, 0.8
"""Shares of the speed between which a ramp is taken: the controller's rounding lies below and above (facts/motion.md)."""


def ramp_acceleration(time: FloatArray, speed: FloatArray, steady: float) -> float:
    """Gives the mean acceleration in m/s^2 between LOWER and UPPER of the steady speed in m/s, of a speed (N,) that rises from rest.

    For a ramp down give time and speed backwards; times may fall. Unlike the largest of a noisy second derivative it is not
    biased by noise, and it needs no clock. Where noise passes a level several times, the middle of the first and the last passage counts.
    Infinite where the speed passes both at once. Raises ValueError where it does not pass both.
    """
    lower, upper = (_passage(time, speed, level * steady) for level in (LOWER, UPPER))
    took = abs(upper - lower)
    return (UPPER - LOWER) * steady / took if took > 0.0 else float("inf")


def middle_passages(time: FloatArray, way: FloatArray, length: float) -> FloatArray:
    """Gives the times (K,) in s at which a way (N,) along a line, to and fro, passes half of `length` in m, whatever the noise there.

    A passage counts from below two fifths to above three fifths, or back.
    """
    side = np.where(way > 0.6 * length, 1, np.where(way < 0.4 * length, -1, 0))
    known = np.flatnonzero(side)
    turns = np.flatnonzero(np.diff(side[known]) != 0)
    return np.array([(time[known[turn]] + time[known[turn + 1]]) / 2 for turn in turns])


def _passage(time: FloatArray, speed: FloatArray, level: float) -> float:
    """Gives when a speed passes a level, by interpolation."""
    above = speed >= level
    places = np.flatnonzero(above[1:] != above[:-1])
    if len(places) == 0:
        raise ValueError(f"the speed does not pass {level:.3g} m/s: it is between {speed.min():.3g} and {speed.max():.3g} m/s")
    ends = [
        time[place] + (level - speed[place]) / (speed[place + 1] - speed[place]) * (time[place + 1] - time[place])
        for place in (places[0], places[-1])
    ]
    return float(np.mean(ends))
