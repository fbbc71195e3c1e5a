"""The event log of the virtual controller: what it did and what it refused, with ABB's numbering of levels."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from datetime import datetime

LEVELS = {"info": 1, "warning": 2, "error": 3}
_KEPT = 1000
"""Entries kept in a domain, as many as a controller keeps in one."""


@dataclass(frozen=True)
class Entry:
    """One entry. sequence: number of its own, level: info, warning, error, code: ABB's number (domain and number)."""

    sequence: int
    level: str
    code: int
    time: datetime
    title: str
    text: str

    @property
    def domain(self) -> int:
        """The domain that its number belongs to: 1 operational, 2 system, 4 program, 5 motion ..."""
        return self.code // 10000


class EventLog:
    """All entries, newest last."""

    def __init__(self) -> None:
        self._entries: deque[Entry] = deque(maxlen=_KEPT)
        self._count = 0

    @property
    def last(self) -> int:
        """The newest entry's number, 0 without any."""
        return self._count

    def add(self, level: str, code: int, title: str, text: str = "") -> None:
        """Writes an entry with the computer's local time, as a controller has its own."""
        self._count += 1
        self._entries.append(Entry(self._count, level, code, datetime.now().astimezone(), title, text or title))

    def entries(self, domain: int = 0) -> list[Entry]:
        """Gives the entries of a domain, newest first; domain 0 has all."""
        return [entry for entry in reversed(self._entries) if domain in (0, entry.domain)]

    def clear(self, domain: int = 0) -> None:
        """Empties a domain, or all."""
        self._entries = deque((entry for entry in self._entries if domain not in (0, entry.domain)), maxlen=_KEPT)
