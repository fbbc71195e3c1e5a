"""Segments: stretches of scheduled motion, when they may still be changed, and how they are brought to rest or carried on.

Invariant: a segment's chain leads to rest by itself; whatever comes after it is a new segment from some time on.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mitl.errors import MitlError
from mitl.motion.chain import Chain, Start
from mitl.motion.moves import PlannedMove
from mitl.motion.trigger_times import bend_time
from mitl.paths import FloatArray

_STEP = 1e-3
_FASTER = 1e-3
"""Speed in m/s by which a braking motion may exceed the plan: rounding."""
_MOST_DOUBLINGS = 8
_STOOD = 1e-9


@dataclass(eq=False)
class Queued:
    """A move that the program has given. cleared: it will not be executed any more."""

    plan: PlannedMove
    cleared: bool = False


@dataclass(frozen=True, eq=False)
class Segment:
    """A chain of queued moves from `start` s on. begin: where on its way it begins, None for its very start."""

    start: float
    chain: Chain
    moves: tuple[Queued, ...]
    begin: Start | None = None

    @property
    def under_way(self) -> int:
        """Gives the index of the move with which the segment begins."""
        return 0 if self.begin is None else self.begin.leg

    def index_of(self, move: Queued) -> int | None:
        """Gives the index of a move that the segment executes, or the rest of which it does; None if it does not."""
        return next((index for index in range(self.under_way, len(self.moves)) if self.moves[index] is move), None)

    @property
    def end(self) -> float:
        """Gives the time in s at which the segment comes to rest."""
        return self.start + self.chain.timing.duration

    def leg_at(self, time: float) -> int:
        """Gives the index of the move under way at `time` s."""
        position = self.chain.timing.at(np.array([time - self.start]))[0]
        place = np.searchsorted(self.chain.path.leg_ends(), position, side="right") - 1
        return int(np.clip(place[0], self.under_way, len(self.moves) - 1))

    def brakes_from(self) -> float:
        """Gives the time in s from which on it slows down for the rest at its end."""
        duration = self.chain.timing.duration
        times = np.linspace(0.0, duration, max(int(duration / _STEP), 8) + 1)
        speed = self.chain.timing.at(times)[1]
        slower = np.flatnonzero(np.diff(speed) >= -_STOOD * max(float(speed.max()), 1.0))
        return self.start + (float(times[slower[-1] + 1]) if len(slower) else 0.0)

    def goes_on_until(self) -> float:
        """Gives the time in s until which moves behind its last one can be added without a stop there."""
        return min(self.brakes_from(), self.start + bend_time(self.chain, len(self.moves) - 1))


@dataclass(frozen=True, eq=False)
class Rest:
    """Where a stopped motion goes on: with the moves `onward`, beginning at `begin` on the first of them, where the joints are (6,) rad.

    lead: the move before it, if there is one, for the sake of their corner.
    """

    lead: tuple[Queued, ...]
    onward: tuple[Queued, ...]
    begin: Start
    joints: FloatArray


def braked(segment: Segment, time: float, deceleration: float, window: float) -> tuple[Segment, Rest | None]:
    """Gives a segment that stops along its path from `time` s on, and where it can go on; None if it ends where it would have anyway.

    deceleration in m/s^2, or more where the plan itself slows down harder; window: over how many s it is built up.
    """
    chain = segment.chain
    begins = time - segment.start
    for doubling in range(_MOST_DOUBLINGS):
        stopped = chain.stopped(begins, deceleration * 2**doubling, window)
        if _never_faster(chain, stopped, begins):
            break
    else:
        return segment, None
    duration = stopped.timing.duration
    position = float(stopped.timing.at(np.array([duration]))[0][0])
    if position > chain.path.length - _STOOD:
        return segment, None
    index, begin = stopped.start_at(duration)
    joints = chain.path.sample(np.array([position])).joints[0]
    leg = index + begin.leg
    rest = Rest(segment.moves[index:leg], segment.moves[leg:], replace(begin, speed=0.0), joints)
    return replace(segment, chain=stopped), rest


def _never_faster(plan: Chain, stopped: Chain, begins: float) -> bool:
    times = np.linspace(begins, stopped.timing.duration, 50)
    position, speed, _ = stopped.timing.at(times)
    if position[-1] > plan.path.length + _STOOD:
        return False
    planned = plan.timing.at(plan.timing.times_at(position))[1]
    return bool(np.all(speed <= planned + _FASTER))


class CannotGoOnError(MitlError):
    """A motion under way has no instant from which a new plan could take it over."""


def taken_over(segment: Segment, time: float) -> tuple[float, int, Start]:
    """Gives when in s a new plan can take a segment over, `time` itself, the first move's index in it, and where that begins.

    Raises CannotGoOnError.
    """
    since = time - segment.start
    if since >= segment.chain.timing.duration:
        raise CannotGoOnError("it stands there already")
    index, begin = segment.chain.start_at(since)
    return time, index, begin
