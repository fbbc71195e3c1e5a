"""InterruptSources: what raises a task's interrupts, and when: signals that change, and timers.

Invariant: a number is raised at the very time of its cause; whether a trap may run then is the task's own affair.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import assert_never

from rapid_interp.effects import AnalogCondition, Elapsed, EventLogged, SignalChange, Source, Subscribe


@dataclass(eq=False)
class _Subscription:
    interrupt: int
    source: Source
    single: bool
    due: float = math.inf
    last: float | None = None


class InterruptSources:
    """The subscriptions of one task. `raised` are the numbers raised and not yet told to the task, in their order."""

    def __init__(self) -> None:
        self.raised: list[int] = []
        self._subscriptions: list[_Subscription] = []

    @property
    def active(self) -> bool:
        """Gives whether anything may raise an interrupt."""
        return bool(self._subscriptions)

    @property
    def signals(self) -> set[str]:
        """Gives the names, in lower case, of the signals whose changes may raise an interrupt."""
        return {other.source.name.lower() for other in self._subscriptions if not isinstance(other.source, Elapsed | EventLogged)}

    def subscribe(self, effect: Subscribe, now: float) -> None:
        """Begins to raise an interrupt when its source says so."""
        due = now + effect.source.seconds if isinstance(effect.source, Elapsed) else math.inf
        self._subscriptions.append(_Subscription(effect.interrupt, effect.source, effect.single, due))

    def unsubscribe(self, interrupt: int) -> None:
        """Stops raising an interrupt; what was raised and not told is forgotten."""
        self._subscriptions = [other for other in self._subscriptions if other.interrupt != interrupt]
        self.raised = [other for other in self.raised if other != interrupt]

    def next_event(self) -> float:
        """Gives the time in s at which the next timer runs out."""
        return min((subscription.due for subscription in self._subscriptions), default=math.inf)

    def elapse(self, now: float) -> None:
        """Raises the interrupts of the timers that run out at `now` s."""
        for subscription in sorted(self._subscriptions, key=lambda other: other.due):
            if isinstance(subscription.source, Elapsed) and subscription.due <= now:
                subscription.due = math.inf if subscription.single else subscription.due + subscription.source.seconds
                self._raise(subscription)

    def changed(self, name: str, before: float, value: float, _time: float) -> None:
        """Raises the interrupts that a signal's change from one value to another calls for. name: in lower case."""
        for subscription in list(self._subscriptions):
            source = subscription.source
            match source:
                case SignalChange():
                    if source.name.lower() == name and source.value in (None, value):
                        self._raise(subscription)
                case AnalogCondition():
                    if source.name.lower() == name and _fulfils(source, before, value, subscription.last):
                        subscription.last = value
                        self._raise(subscription)
                case Elapsed() | EventLogged():  # the simulated controller logs no events
                    pass
                case _:
                    assert_never(source)

    def _raise(self, subscription: _Subscription) -> None:
        self.raised.append(subscription.interrupt)
        if subscription.single:
            self._subscriptions.remove(subscription)


def _fulfils(source: AnalogCondition, before: float, value: float, last: float | None) -> bool:
    """Gives whether an analog value raises: it holds the condition now, and newly so or moved by `delta` since it last raised."""
    if not _holds(source, value):
        return False
    return last is None or not _holds(source, before) or abs(value - last) >= max(source.delta, 1e-12)


def _holds(source: AnalogCondition, value: float) -> bool:
    between = source.low <= value <= source.high
    holds = (value > source.high, value < source.high, value > source.low, value < source.low, between, not between, True)
    return holds[source.condition - 1] if 1 <= source.condition <= len(holds) else False
