"""Faults of the interpolator and the servo: how the planned motion is played back.

Invariant: the controller does not know of them: what it reports is what it planned.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from mitl.motion.record import MotionRecord
from mitl.paths import FloatArray

Playback = Callable[[MotionRecord, float], FloatArray]
"""Joints (6,) rad of the arm at a time in s of its record."""
Offset = Callable[[float], FloatArray]
"""By how many rad (6,) the arm is off at a time in s since it was switched on."""

_LONG_MOVE = 0.3
_SHORTEST_DIP = 0.05
_CATCH_UP = 4.0
_LATE = 0.06
"""Age in s of the speed that a wrong feed-forward adds."""
_STEP = 0.004
_TAKEN_UP = 0.1
"""Seconds in which play is taken up after a turn."""
_MOVED = 1e-3
"""Radians below which an axis has not moved."""


def straight(record: MotionRecord, time: float) -> FloatArray:
    """Gives the joints as planned: a servo without faults."""
    return record.joints_at(time)


def axis_3_off(angle_deg: float) -> Offset:
    """Gives a constant offset of axis 3."""
    return lambda _: np.array([0.0, 0.0, np.radians(angle_deg), 0.0, 0.0, 0.0])


def axis_1_drifts(deg_per_minute: float) -> Offset:
    """Gives an offset of axis 1 that grows with time."""
    return lambda time: np.array([np.radians(deg_per_minute) * time / 60, 0.0, 0.0, 0.0, 0.0, 0.0])


def late(milliseconds: float) -> Callable[[Playback], Playback]:
    """Gives a playback that is late throughout."""
    return lambda inner: lambda record, time: inner(record, time - milliseconds * 1e-3)


def hiccup(milliseconds: float) -> Callable[[Playback], Playback]:
    """Gives a playback that halts in the middle of every longer move, and then makes the time good."""
    halt = max(milliseconds, 0.0) * 1e-3

    def wrapped(inner: Playback) -> Playback:
        def played(record: MotionRecord, time: float) -> FloatArray:
            lag = 0.0
            for move in record.moves:
                since = time - (move.begins + move.ends) / 2
                if halt and 0.0 < since < (1 + _CATCH_UP) * halt and move.ends - move.begins > _LONG_MOVE:
                    lag += min(since, halt) - max(since - halt, 0.0) / _CATCH_UP
            return inner(record, time - lag)

        return played

    return wrapped


def speed_dip(per_cent: float) -> Callable[[Playback], Playback]:
    """Gives a playback that is slower by so much, on average, through every zone, and makes the time good after it."""

    def wrapped(inner: Playback) -> Playback:
        def played(record: MotionRecord, time: float) -> FloatArray:
            lag = 0.0
            for executed in record.moves:
                if executed.move.fine:
                    continue
                half = max(executed.move.zone.radius / max(executed.move.speed.tcp, 1e-3), _SHORTEST_DIP)
                place = (time - executed.ends) / half
                lag += 2 * half * per_cent / 100 * (_smooth((place + 1) / 2) - _smooth((place - 1) / 2))
            return inner(record, time - lag)

        return played

    return wrapped


def overshoot(milliseconds: float) -> Callable[[Playback], Playback]:
    """Gives a playback that adds the speed of a moment ago, times so much: the arm runs past every stop and comes back."""

    def wrapped(inner: Playback) -> Playback:
        def played(record: MotionRecord, time: float) -> FloatArray:
            then = time - _LATE
            rate = (inner(record, then + _STEP) - inner(record, then - _STEP)) / (2 * _STEP)
            return np.asarray(inner(record, time) + milliseconds * 1e-3 * rate)

        return played

    return wrapped


def scatter(angle_deg: float) -> Callable[[Playback], Playback]:
    """Gives a playback in which axis 1 ends every move a little off, by another angle each time, with this standard deviation."""
    size = np.radians(angle_deg)

    def wrapped(inner: Playback) -> Playback:
        def played(record: MotionRecord, time: float) -> FloatArray:
            joints = inner(record, time).copy()
            last = _move_before(record, time)
            if last >= 0:
                move = record.moves[last]
                share = _smooth((time - move.begins) / max(move.ends - move.begins, _STEP))
                joints[0] += size * (_draw(last - 1) + share * (_draw(last) - _draw(last - 1)))
            return joints

        return played

    return wrapped


def backlash(angle_deg: float) -> Callable[[Playback], Playback]:
    """Gives a playback in which axis 1 has so much play: it stays behind by half of it in the direction of its last motion."""
    half = np.radians(angle_deg) / 2

    def wrapped(inner: Playback) -> Playback:
        def played(record: MotionRecord, time: float) -> FloatArray:
            joints = inner(record, time).copy()
            last = _move_before(record, time)
            if last >= 0:
                share = _smooth((time - record.moves[last].begins) / _TAKEN_UP)
                before = _side(record, last - 1)
                joints[0] -= half * (before + share * (_side(record, last) - before))
            return joints

        return played

    return wrapped


def _move_before(record: MotionRecord, time: float) -> int:
    """Gives the number of the move that began last, -1 before the first."""
    return bisect_right(record.moves, time, key=lambda move: move.begins) - 1


@lru_cache(maxsize=1024)
def _draw(number: int) -> float:
    """Gives a normal number that belongs to a move: the same in every run."""
    return float(np.random.default_rng([0x9283, number + 1]).normal())


def _side(record: MotionRecord, number: int) -> float:
    """Gives to which side axis 1 was last moved at the end of a move, 0 before it first moves."""
    for move in reversed(record.moves[: number + 1]):
        way = record.joints_at(move.ends)[0] - record.joints_at(move.begins)[0]
        if abs(way) > _MOVED:
            return float(np.sign(way))
    return 0.0


def _smooth(share: float) -> float:
    inside = min(max(share, 0.0), 1.0)
    return inside * inside * (3 - 2 * inside)
