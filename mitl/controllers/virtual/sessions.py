"""Sessions of the virtual controller: at most 70, five minutes idle, twenty-five minutes long (facts/rws.md).

Invariant: whoever holds something by a session loses it when the session ends: `on_end` is called exactly once for each.
"""

from __future__ import annotations

import secrets
from collections.abc import Callable
from dataclasses import dataclass, field

from mitl.controllers.virtual.answers import Refused

MOST_SESSIONS = 70
IDLE = 300.0
LIFETIME = 1500.0
COOKIES = ("-http-session-", "ABBCX")


@dataclass(eq=False)
class Session:
    """One client's session. http, abbcx: its two cookies. since, seen: s on the server's clock."""

    number: int
    user: str
    since: float
    seen: float
    http: str = field(default_factory=lambda: secrets.token_hex(16))
    abbcx: str = field(default_factory=lambda: secrets.token_hex(16))
    application: str = ""
    location: str = ""
    station: tuple[str, str] | None = None
    release_when_lost: bool = False
    remote: str = "NONE"
    """State of its request for remote mastership in manual mode (RMMP)."""


class Sessions:
    """All sessions. now: a monotonic clock in s. rate: requests per second that a session may send; 0 for any."""

    def __init__(
        self, now: Callable[[], float], on_end: Callable[[Session], None], *, rate: float = 0.0, most: int = MOST_SESSIONS
    ) -> None:
        self._now = now
        self._on_end = on_end
        self._rate = rate
        self._most = most
        self._open: dict[str, Session] = {}
        self._spent: dict[str, tuple[float, float]] = {}
        self._count = 0

    def __len__(self) -> int:
        return len(self._open)

    def find(self, abbcx: str | None) -> Session | None:
        """Gives the live session of a cookie."""
        self.expire()
        return self._open.get(abbcx) if abbcx else None

    def open(self, user: str) -> Session:
        """Gives a new session. Raises Refused 503 where there are too many."""
        self.expire()
        if len(self._open) >= self._most:
            raise Refused(503, -1073445865, f"Too many sessions: {self._most} are open", {"Retry-After": "5"})
        self._count += 1
        session = Session(self._count, user, self._now(), self._now())
        self._open[session.abbcx] = session
        return session

    def touch(self, session: Session) -> None:
        """Counts a request. Raises Refused 503 where the session sends too many (a bucket of one second's worth)."""
        now = session.seen = self._now()
        if self._rate <= 0:
            return
        level, at = self._spent.get(session.abbcx, (0.0, now))
        level = max(level - (now - at) * self._rate, 0.0) + 1.0
        self._spent[session.abbcx] = (min(level, self._rate + 1.0), now)
        if level > self._rate:
            raise Refused(503, -1073445864, f"Too many requests: at most {self._rate:g} a second", {"Retry-After": "1"})

    def close(self, session: Session) -> None:
        """Ends a session."""
        if self._open.pop(session.abbcx, None) is not None:
            self._spent.pop(session.abbcx, None)
            self._on_end(session)

    def expire(self) -> None:
        """Ends the sessions that were idle or open too long."""
        now = self._now()
        for session in [one for one in self._open.values() if now - one.seen > IDLE or now - one.since > LIFETIME]:
            self.close(session)
