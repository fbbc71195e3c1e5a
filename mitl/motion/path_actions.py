"""What the actions of triggers do when their place is reached: outputs, ramps, outputs that follow the speed, checks, interrupts.

Invariant: an action happens at its time and knows nothing of places.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from dataclasses import dataclass
from typing import assert_never

from mitl.motion.signals import SignalTable
from rapid_interp.effects import Action, CheckSignal, FollowSpeed, RaiseInterrupt, RampOutput, SetOutput

UPDATE = 4e-3
"""How often (s) an analog output that follows or ramps is set anew. ASSUMPTION A-134."""
_RELATIONS: dict[str, Callable[[float, float], bool]] = {
    "EQ": operator.eq,
    "NOTEQ": operator.ne,
    "LT": operator.lt,
    "LTEQ": operator.le,
    "GT": operator.gt,
    "GTEQ": operator.ge,
}


@dataclass(eq=False)
class _Ramp:
    """An analog output on its way: from `since` s at `begin` to `value`, `seconds` later, or when the TCP has gone `way` m on."""

    name: str
    begin: float
    value: float
    since: float
    seconds: float | None
    way: float
    gone: float = 0.0


class PathActions:
    """Carries out actions.

    tcp_speed: gives the TCP's speed in m/s at a time in s. raised: called with an interrupt's number. stopped: called with the time.
    """

    def __init__(
        self,
        signals: SignalTable,
        *,
        tcp_speed: Callable[[float], float],
        raised: Callable[[int], None],
        stopped: Callable[[float], None],
    ) -> None:
        self._signals = signals
        self._tcp_speed = tcp_speed
        self._raised = raised
        self._stopped = stopped
        self._followers: dict[str, FollowSpeed] = {}
        self._ramps: dict[str, _Ramp] = {}
        self._updated = math.inf

    def do(self, action: Action, time: float) -> None:
        """Carries out an action at `time` s."""
        match action:
            case SetOutput():
                self._forget(action.name)
                self._signals.put(action.name, action.value, time)
            case RaiseInterrupt():
                self._raised(action.interrupt)
            case FollowSpeed():
                self._forget(action.name)
                if action.scale != 0:
                    self._followers[action.name.lower()] = action
                self._signals.put(action.name, self._scaled(action, time), time)
                self._updated = time
            case RampOutput():
                self._forget(action.name)
                seconds = action.ramp if action.in_seconds else None
                way = 0.0 if action.in_seconds else 1e-3 * action.ramp
                begin = self._signals.value(action.name, time)
                self._ramps[action.name.lower()] = _Ramp(action.name, begin, action.value, time, seconds, way)
                self._updated = time
            case CheckSignal():
                if not _RELATIONS[action.condition](self._signals.value(action.name, time), action.value):
                    if action.stops:
                        self._stopped(time)
                    self._raised(action.interrupt)
            case _:
                assert_never(action)

    def next_event(self) -> float:
        """Gives the time in s at which outputs that follow or ramp are next set."""
        return self._updated + UPDATE if self._followers or self._ramps else math.inf

    def update(self, now: float) -> None:
        """Sets the outputs that follow the speed or ramp."""
        if self.next_event() > now:
            return
        self._updated = now
        for follower in self._followers.values():
            value = self._scaled(follower, now)
            if value != self._signals.value(follower.name, now):
                self._signals.put(follower.name, value, now)
        for ramp in list(self._ramps.values()):
            ramp.gone += UPDATE * self._tcp_speed(now - UPDATE / 2)
            whole, done = (ramp.way, ramp.gone) if ramp.seconds is None else (ramp.seconds, now - ramp.since)
            share = min(done / whole, 1.0) if whole > 0 else 1.0
            self._signals.put(ramp.name, ramp.begin + share * (ramp.value - ramp.begin), now)
            if share == 1.0:
                del self._ramps[ramp.name.lower()]

    def _scaled(self, follower: FollowSpeed, time: float) -> float:
        return follower.scale * round(1e3 * self._tcp_speed(time + follower.lag), 6)

    def _forget(self, name: str) -> None:
        self._followers.pop(name.lower(), None)
        self._ramps.pop(name.lower(), None)
