"""What a task waits for: an event of the motion or of another task, and some time after it.

Invariant: a wait says when it ends as far as that is known now; asked again later it may say another time.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from rapid_interp import effects

Reply = Callable[[float], effects.Reply]


def _long_ago() -> float:
    return -math.inf


def _nothing(_now: float) -> effects.Reply:
    return None


@dataclass(frozen=True, eq=False)
class Waiting:
    """A task that waits from `since` s on for an event and `seconds` after it, until `latest` s at most; then `reply` is its reply.

    event: gives the time in s of the event as far as known, inf where it is not.
    """

    since: float = -math.inf
    event: Callable[[], float] = field(default=_long_ago)
    seconds: float = 0.0
    latest: float = math.inf
    reply: Reply = field(default=_nothing)

    def until(self) -> float:
        """Gives the time in s at which the wait ends."""
        return min(max(self.since, self.event()) + self.seconds, self.latest)

    def held(self, begin: float, end: float) -> Waiting:
        """Gives the wait after the program was held from `begin` to `end` s: what was left of its time then is left now.

        ASSUMPTION A-138: times that a program waits for stand still while it is stopped.
        """
        latest = self.latest + (end - begin)
        if max(self.since, self.event()) > begin:
            return replace(self, latest=latest)
        left = max(self.until() - begin, 0.0)
        return replace(self, since=end, event=_long_ago, seconds=left, latest=latest)


@dataclass(eq=False)
class Meeting:
    """A place where tasks wait for each other. met: time in s at which the last one came."""

    waiting: set[str] = field(default_factory=set)
    met: float = math.inf


@dataclass(eq=False)
class Meetings:
    """The meetings of a controller's tasks. tasks: the names of those that run on it, in lower case."""

    tasks: frozenset[str] = frozenset()
    _open: dict[str, Meeting] = field(default_factory=dict)

    def absent(self, effect: effects.WaitForTasks) -> list[str]:
        """Gives the tasks that a meeting waits for and that do not run here."""
        return [name for name in effect.tasks if name.lower() not in self.tasks]

    def join(self, effect: effects.WaitForTasks, task: str, now: float) -> Meeting:
        """Gives the meeting that a task comes to at `now` s."""
        meeting = self._open.setdefault(effect.meeting.lower(), Meeting())
        meeting.waiting.add(task.lower())
        if meeting.waiting >= {name.lower() for name in effect.tasks}:
            meeting.met = now
            del self._open[effect.meeting.lower()]
        return meeting
