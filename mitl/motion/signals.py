"""SignalTable: the values of all signals over time, outputs as the program sets them and inputs as they are given.

Names are those of RAPID: case does not count. Invariant: changes are entered in the order of time; what lies in the past stays.
"""

from __future__ import annotations

import bisect
import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class InputChange:
    """An input signal that takes a value at a time in s."""

    name: str
    value: float
    time: float


@dataclass(frozen=True)
class _Due:
    """An output that changes later."""

    time: float
    name: str
    value: float


class SignalTable:
    """Signals of one controller. `outputs` holds the changes (time s, value) by name as first written.

    inputs: changes known beforehand. live: gives inputs by name and time in s as they are from outside, for those that nothing else sets.
    """

    def __init__(self, inputs: Sequence[InputChange] = (), live: Callable[[str, float], float] | None = None) -> None:
        self.outputs: dict[str, list[tuple[float, float]]] = {}
        self._values: dict[str, float] = {}
        self._spelt: dict[str, str] = {}
        self._due: list[_Due] = []
        self.live = live
        self._coming = sorted(inputs, key=lambda change: change.time)
        self._watchers: list[Callable[[str, float, float, float], None]] = []

    def watch(self, watcher: Callable[[str, float, float, float], None]) -> None:
        """Has every change of a value told: name in lower case, former value, value, time in s."""
        self._watchers.append(watcher)

    def next_input(self) -> float:
        """Gives the time in s of the next change of an input that is known."""
        return self._coming[0].time if self._coming else math.inf

    def next_output(self) -> float:
        """Gives the time in s at which the next output that was set with a delay changes."""
        return self._due[0].time if self._due else math.inf

    def happen(self, now: float) -> None:
        """Makes the changes that are due at `now` s."""
        while self._coming and self._coming[0].time <= now:
            change = self._coming.pop(0)
            self._change(change.name, change.value, now)
        while self._due and self._due[0].time <= now:
            due = self._due.pop(0)
            self._enter(due.name, due.value, due.time)

    def put(self, name: str, value: float, time: float, delay: float = 0.0) -> None:
        """Sets an output at `time` s, or `delay` s later."""
        if delay > 0:
            bisect.insort(self._due, _Due(time + delay, name, value), key=lambda due: due.time)
        else:
            self._enter(name, value, time)

    def give(self, name: str, value: float, time: float) -> None:
        """Sets an input from outside."""
        self._change(name, value, time)

    def look(self, names: Collection[str], now: float) -> None:
        """Looks at inputs from outside, names in lower case, so that their changes are told."""
        if self.live is not None:
            for name in names:
                if name not in self._spelt:
                    self._change(name, self.live(name, now), now)

    def value(self, name: str, now: float) -> float:
        """Gives the value that a signal has now, at `now` s; 0 before it was first set."""
        if self.live is not None and name.lower() not in self._spelt:
            return self.live(name, now)
        return self._values.get(name.lower(), 0.0)

    def output_at(self, name: str, time: float) -> float:
        """Gives the value that an output had at `time` s; 0 before it was first set. Inputs are known by their present value only."""
        changes = self.outputs.get(self._spelt.get(name.lower(), name))
        if changes is None:
            return self._values.get(name.lower(), 0.0)
        place = bisect.bisect_right(changes, time, key=lambda change: change[0])
        return changes[place - 1][1] if place else 0.0

    def _enter(self, name: str, value: float, time: float) -> None:
        spelt = self._spelt.setdefault(name.lower(), name)
        bisect.insort(self.outputs.setdefault(spelt, []), (time, value), key=lambda change: change[0])
        self._change(name, value, time)

    def _change(self, name: str, value: float, time: float) -> None:
        key = name.lower()
        before = self._values.get(key, 0.0)
        self._values[key] = value
        if value != before:
            for watcher in self._watchers:
                watcher(key, before, value, time)
