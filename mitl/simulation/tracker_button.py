"""A button input of a tracked device: an output of the robot, wired to it, shows in the samples after a latent delay.

Invariant: every change is reported at the first sample not earlier than change + delay; the delays come from the seed, in the order of
the changes, however samples are asked for.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from mitl.paths import FloatArray
from mitl.samples import CodeArray
from mitl.simulation.tracker_parameters import Button

_BUTTON_DRAW = 2_000_000  # keeps these draws apart from those of the sensor model, which takes its own from the same seed


class ButtonInput:
    """One wired button. Feed it with `change` in the order of time, read it with `states` in the order of time.

    Source: facts/tracker.md, trigger input: latent delay uniform on [-.6, 16.6] ms, reported at the next 4 ms sample.
    """

    def __init__(self, button: Button, seed: int, number: int = 0) -> None:
        self._button = button
        self._generator = np.random.default_rng([seed, _BUTTON_DRAW, number])
        self._pending: list[tuple[float, bool]] = []
        self._state = False

    def change(self, time: float, pressed: bool) -> None:
        """Notes that the line changed at `time` s. A change that would overtake the one before comes right after it."""
        delay = self._generator.uniform(self._button.delay_min_s, self._button.delay_max_s)
        at = time + delay
        if self._pending:
            at = max(at, self._pending[-1][0])
        self._pending.append((at, pressed))

    def states(self, times: FloatArray) -> CodeArray:
        """Gives 1 where pressed, else 0, at sample times (N,) in s."""
        known = [change for change in self._pending if len(times) and change[0] <= times[-1]]
        levels = np.array([self._state, *(pressed for _, pressed in known)], dtype=np.int16)
        passed = np.searchsorted(np.array([at for at, _ in known]), times, side="right")
        if known:
            self._state = known[-1][1]
            self._pending = self._pending[len(known) :]
        return levels[passed]


Changes = Callable[[float, float], Sequence[tuple[float, float]]]
"""Gives the changes (time in s, value) of an output of the robot after a time and up to another."""


class WiredButton:
    """A button whose line an output of the robot drives; it asks for the output's changes when samples are made.

    It is pressed while the output is above `above`, as a comparator in an analog output's line does it.
    """

    def __init__(self, changes: Changes, line: ButtonInput, *, above: float = 0.0) -> None:
        self._changes = changes
        self._above = above
        self._pressed = False
        self._line = line
        self._known = -math.inf

    def states(self, times: FloatArray) -> CodeArray:
        """Gives 1 where pressed, else 0, at the next sample times (N,) in s."""
        if len(times):
            for at, value in self._changes(self._known, float(times[-1])):
                if (value > self._above) != self._pressed:
                    self._pressed = not self._pressed
                    self._line.change(at, self._pressed)
            self._known = float(times[-1])
        return self._line.states(times)
