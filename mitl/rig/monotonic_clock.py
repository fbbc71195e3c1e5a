"""MonotonicClock: the time of a physical rig, which no change of the computer's date touches."""

from __future__ import annotations

import time


class MonotonicClock:
    """Seconds since it was made. Implements Clock."""

    def __init__(self) -> None:
        self._origin = time.monotonic()

    def now(self) -> float:
        """Gives the time in s."""
        return time.monotonic() - self._origin

    def wait(self, seconds: float) -> None:
        """Lets time pass."""
        time.sleep(seconds)
