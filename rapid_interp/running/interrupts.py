"""The interrupts of a task: which number calls which trap, and which of them wait.

Invariant: a trap runs as soon as the effect at hand is told of it, one at a time, in the order in which they were raised.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rapid_interp.meaning.symbols import RoutineSymbol
    from rapid_interp.meaning.types import RapidType, Value
    from rapid_interp.running.mail import MailBox
    from rapid_interp.running.values import Reference

MAX_WAITING = 30
"""ASSUMPTION A-42: a controller's queue of interrupts has 30 places; what is raised beyond them is lost."""


class Interrupts:
    """Numbers are given by `connect`, beginning with 1; 0 is an `intnum` that is not connected."""

    def __init__(self) -> None:
        self.traps: dict[int, RoutineSymbol] = {}
        self.asleep: set[int] = set()
        self.disabled = False
        self.in_trap = False
        self.current = 0.0
        """INTNO: the number of the interrupt whose trap runs."""
        self.watched: dict[int, tuple[Reference, Value, bool]] = {}
        """`IPers`: data whose changes raise, with its last value."""
        self.mail: dict[int, tuple[MailBox, RapidType, int]] = {}
        """`IRMQMessage`: messages of a type raise, with how many of them were there when it last looked."""
        self._given = 0
        self._waiting: deque[int] = deque()

    def connect(self, trap: RoutineSymbol) -> int:
        """Gives a new interrupt number for a trap, or for a procedure that is called from the path."""
        self._given += 1
        self.traps[self._given] = trap
        return self._given

    def call_once(self, procedure: RoutineSymbol) -> int:
        """Gives the interrupt number that calls a procedure from the path, always the same for the same one."""
        known = next((number for number, routine in self.traps.items() if routine is procedure), None)
        return self.connect(procedure) if known is None else known

    def delete(self, number: int) -> None:
        """Forgets an interrupt, also where it waits."""
        self.traps.pop(number, None)
        self.watched.pop(number, None)
        self.mail.pop(number, None)
        self.asleep.discard(number)
        self._waiting = deque(other for other in self._waiting if other != number)

    def watch(self, number: int, data: Reference, *, single: bool) -> None:
        """Raises the interrupt when this data changes. ASSUMPTION A-43: that is seen at the next instruction with an effect."""
        self.watched[number] = data, data.get(), single

    def await_mail(self, number: int, box: MailBox, kind: RapidType) -> None:
        """Raises the interrupt for every message of this type that comes into a queue, those that wait there included."""
        self.mail[number] = box, kind, 0

    @property
    def looks(self) -> bool:
        """Whether there is anything that only looking can tell."""
        return bool(self.watched or self.mail)

    def look(self) -> None:
        """Raises the interrupts of watched data that has changed, and of messages that have come."""
        for number, (box, kind, before_count) in list(self.mail.items()):
            count = sum(found == kind for found in box.types())
            self.mail[number] = box, kind, count
            self.raise_((number,) * max(0, count - before_count))
        for number, (data, before, single) in list(self.watched.items()):
            if (value := data.get()) != before:
                self.watched[number] = data, value, single
                if single:
                    del self.watched[number]
                self.raise_((number,))

    def raise_(self, numbers: Sequence[int]) -> None:
        """Puts interrupts into the queue; those that sleep or are not connected are lost."""
        for number in numbers:
            if number in self.traps and number not in self.asleep and len(self._waiting) < MAX_WAITING:
                self._waiting.append(number)

    def next(self) -> tuple[int, RoutineSymbol] | None:
        """Gives number and trap of the next interrupt whose turn it is, if any may run now."""
        if self.disabled or self.in_trap or not self._waiting:
            return None
        number = self._waiting.popleft()
        return number, self.traps[number]
