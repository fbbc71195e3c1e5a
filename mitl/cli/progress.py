"""A progress line on standard error for work that takes long, on a terminal only."""

from __future__ import annotations

import sys
import time
from types import TracebackType

_QUIET = 2.0
_EVERY = 0.2


class Progress:
    """Shows what long work is at, from its third second on, if standard error is a terminal. Use as a context manager."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._began = time.monotonic()
        self._shown = 0.0

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self._shown:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()

    def at(self, what: str) -> None:
        """Tells what the work is at now."""
        now = time.monotonic()
        if now - self._began < _QUIET or now - self._shown < _EVERY or not sys.stderr.isatty():
            return
        self._shown = now
        sys.stderr.write(f"\r\x1b[K{self._title}: {what}")
        sys.stderr.flush()
