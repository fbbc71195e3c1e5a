"""Subscriptions: which clients watch what, and the events that tell them.

Invariant: an event tells of one resource, and only of a change; whoever connects is told the current values first (facts/rws.md).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from mitl.controllers.virtual.answers import Dialect, Item, Refused, invalid
from mitl.controllers.virtual.rendering import event
from mitl.controllers.virtual.sessions import Session

MOST_RESOURCES, MOST_GROUPS, MOST_URGENT = 1000, 2, 64
_DELAYS = (5.0, 0.2, 0.0)
"""Seconds between two looks at a resource of priority 0, 1, 2."""

Look = Callable[[], tuple[Item, ...]]
Find = Callable[[str], Look]
"""Gives how to look at the resource of an address. Raises Refused where it cannot be subscribed to."""


@dataclass
class Watch:
    """One resource of a group. told: what its client was told last, () before. due: when it is looked at next."""

    look: Look
    priority: int
    told: tuple[Item, ...] = ()
    due: float = 0.0


@dataclass(eq=False)
class Group:
    """A subscription. connected: whether its WebSocket is open."""

    number: int
    session: Session
    watches: dict[str, Watch] = field(default_factory=dict)
    connected: bool = False


class Subscriptions:
    """All subscriptions. find: what an address means. now: a monotonic clock in s."""

    def __init__(self, find: Find, now: Callable[[], float], dialect: Dialect) -> None:
        self._find = find
        self._now = now
        self._dialect = dialect
        self._groups: dict[int, Group] = {}
        self._count = 0

    def create(self, session: Session, pairs: Sequence[tuple[str, str]]) -> Group:
        """Gives a new group from the fields of a form. Raises Refused."""
        watches = self._wanted(pairs)
        own = [group for group in self._groups.values() if group.session is session]
        for idle in [group for group in own if not group.connected][: max(len(own) - MOST_GROUPS + 1, 0)]:
            del self._groups[idle.number]
            own.remove(idle)
        if len(own) >= MOST_GROUPS:
            raise Refused(400, -1073445887, f"At most {MOST_GROUPS} subscriptions a client")
        self._count += 1
        group = self._groups[self._count] = Group(self._count, session, watches)
        return group

    def update(self, number: str, session: Session, pairs: Sequence[tuple[str, str]]) -> None:
        """Adds resources to a group. Raises Refused."""
        group = self.find(number, session)
        wanted = self._wanted(pairs)
        if len(group.watches | wanted) > MOST_RESOURCES:
            raise invalid(f"At most {MOST_RESOURCES} resources a subscription")
        group.watches.update(wanted)

    def find(self, number: str, session: Session) -> Group:
        """Gives a session's group. Raises Refused 404."""
        group = self._groups.get(int(number)) if number.isascii() and number.isdigit() and len(number) < 10 else None
        if group is None or group.session is not session:
            raise Refused(404, -1073414146, f"No subscription {number[:20]}")
        return group

    def remove(self, number: str, session: Session, resource: str = "") -> None:
        """Ends a group, or its watch of one resource. Raises Refused 404."""
        group = self.find(number, session)
        if not resource:
            del self._groups[group.number]
        elif group.watches.pop(f"/{resource}", None) is None:
            raise Refused(404, -1073414146, f"Subscription {number} has no resource /{resource}")

    def drop(self, session: Session) -> None:
        """Ends the groups of a session that has ended."""
        self._groups = {number: group for number, group in self._groups.items() if group.session is not session}

    def alive(self, group: Group) -> bool:
        """Gives whether a group is still there."""
        return self._groups.get(group.number) is group

    def connect(self, group: Group) -> None:
        """Has the group's client told all current values next."""
        group.connected = True
        for watch in group.watches.values():
            watch.told, watch.due = (), 0.0

    def events(self) -> Iterator[tuple[Group, str]]:
        """Gives the events that are due, with the group that they are for."""
        now = self._now()
        for group in [group for group in self._groups.values() if group.connected]:
            for watch in group.watches.values():
                if now < watch.due:
                    continue
                watch.due = now + _DELAYS[watch.priority]
                items = watch.look()
                if items and items != watch.told:
                    watch.told = items
                    yield group, event(list(items), f"subscription/{group.number}")

    def _wanted(self, pairs: Sequence[tuple[str, str]]) -> dict[str, Watch]:
        """Gives the watches that a form asks for: key K is subscribed to where there is a K-p, whatever `resources` says."""
        fields = dict(pairs)
        watches: dict[str, Watch] = {}
        for key, address in fields.items():
            priority = fields.get(f"{key}-p")
            if priority is None or key == "resources":
                continue
            if priority not in ("0", "1", "2"):
                raise invalid(f"expected priority 0, 1 or 2 for {address}, got {priority!r}")
            watches[address] = Watch(self._find(address), int(priority))
        if not watches:
            raise invalid("A subscription needs at least one resource with a priority")
        if len(watches) > MOST_RESOURCES or sum(watch.priority == 2 for watch in watches.values()) > MOST_URGENT:
            raise invalid(f"At most {MOST_RESOURCES} resources, {MOST_URGENT} of them of priority 2")
        return watches


SYMBOL_1 = re.compile(r"^/rw/rapid/symbol/data/RAPID/(.+);value$", re.IGNORECASE)
SYMBOL_2 = re.compile(r"^/rw/rapid/symbol/RAPID/(.+)/data;value$", re.IGNORECASE)
SIGNAL = re.compile(r"^/rw/iosystem/signals/(?:[^/;]+/[^/;]+/)?([^/;]+);(?:state|lvalue)$", re.IGNORECASE)
QUEUE = re.compile(r"^/rw/dipc/([^/;]+)$", re.IGNORECASE)
LOG = re.compile(r"^/rw/elog/(\d{1,2})$", re.IGNORECASE)
