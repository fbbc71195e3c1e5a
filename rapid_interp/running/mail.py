"""Messages between the tasks of a controller (RAPID Message Queue).

Invariant: a message is a value with its type; a task sees only those sent to it, in their order.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

from rapid_interp.meaning.types import RapidType, Value

MOST_WAITING = 32


@dataclass(frozen=True, slots=True)
class Message:
    """A value with its type, the slot that sent it, and what the sender called it."""

    type: RapidType
    value: Value
    sender: int
    user: float = 0.0


@dataclass(slots=True)
class Mail:
    """The queues of all tasks. Slots are numbers from 1 in the order in which their names were first used."""

    names: list[str] = field(default_factory=list)
    queues: dict[int, deque[Message]] = field(default_factory=dict)

    def slot(self, name: str) -> int:
        """Gives the slot of a queue by its name, `RMQ_` and the task's."""
        key = name.lower()
        if key not in self.names:
            self.names.append(key)
            self.queues[len(self.names)] = deque()
        return self.names.index(key) + 1

    def known(self, name: str) -> int | None:
        """Gives the slot of a queue that is there."""
        return self.names.index(name.lower()) + 1 if name.lower() in self.names else None

    def send(self, slot: int, message: Message) -> bool:
        """Puts a message into a queue; False if it is full."""
        queue = self.queues[slot]
        if len(queue) >= MOST_WAITING:
            return False
        queue.append(message)
        return True


class MailBox:
    """The queue of one task, as its interrupts look at it."""

    def __init__(self, mail: Mail, slot: int) -> None:
        self._mail = mail
        self._slot = slot

    def types(self) -> list[RapidType]:
        """Gives the types of the messages that wait."""
        return [message.type for message in self._mail.queues[self._slot]]
