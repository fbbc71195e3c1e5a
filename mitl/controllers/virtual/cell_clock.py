"""CellClock: virtual time of a cell without a tracker, as `simulation.world.World` is the one of a cell with it.

Invariant: time passes only in `wait`, and the process acts at every instant that it asked for.
"""

from __future__ import annotations

import math

from mitl.errors import RigError
from mitl.simulation.process import Process


class CellClock:
    """A virtual clock that begins at 0 s. Implements Clock."""

    def __init__(self) -> None:
        self._now = 0.0
        self._process: Process | None = None

    def drive(self, process: Process) -> None:
        """Lets a process take part from now on."""
        self._process = process

    def now(self) -> float:
        """Gives the time in s."""
        return self._now

    def wait(self, seconds: float) -> None:
        """Lets time pass."""
        if not (math.isfinite(seconds) and seconds >= 0.0):
            raise ValueError(f"expected a time of 0 s or more to wait, got {seconds}")
        target = self._now + seconds
        while self._process is not None and (event := self._process.next_event()) <= target:
            self._now = max(event, self._now)
            self._process.run(self._now)
            if self._process.next_event() <= self._now:
                raise RigError(f"the program does not get past t = {self._now:.6f} s")
        self._now = target
