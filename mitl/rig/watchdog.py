"""Watchdog: watches a moving robot from a thread of its own and stops it.

Invariant: once it has found a reason it stops the robot, whatever the main thread does, and keeps the reason until it is cleared;
what it cannot see counts as a reason.
"""

from __future__ import annotations

import threading
from collections.abc import Callable

from mitl.errors import MitlError

PERIOD = 0.1


class Watchdog:
    """look: gives why the robot must stop, or "" ; it is asked every PERIOD s while `watching`. stop: stops the robot."""

    def __init__(self, look: Callable[[], str], stop: Callable[[], None]) -> None:
        self._look = look
        self._stop = stop
        self._watching = threading.Event()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="watchdog", daemon=True)
        self._thread.start()
        self.reason = ""
        """Why it stopped the robot."""

    def watch(self) -> None:
        """Begins to watch; forgets an earlier reason."""
        self.reason = ""
        self._watching.set()

    def rest(self) -> None:
        """Ends to watch."""
        self._watching.clear()

    def close(self) -> None:
        """Ends the thread."""
        self._ended.set()
        self._watching.set()
        self._thread.join(5.0)

    @property
    def alive(self) -> bool:
        """Whether it can still act."""
        return self._thread.is_alive()

    def _run(self) -> None:
        while not self._ended.wait(PERIOD):
            self._watching.wait()
            if self._ended.is_set():
                return
            reason = self._found()
            if reason:
                self.reason = self.reason or reason
                try:
                    self._stop()
                except MitlError as error:
                    self.reason += f"; the stop did not get through: {error}"
                else:
                    self._watching.clear()

    def _found(self) -> str:
        try:
            return self._look()
        except Exception as error:  # noqa: BLE001 - a watchdog that cannot look must stop what it watches
            return f"the watchdog cannot see: {error}"
