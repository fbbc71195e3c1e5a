"""/rw/dipc: message queues between clients. Queues of RAPID tasks (RMQ) are not there: the interpreter has none."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

from mitl.controllers.virtual.answers import DONE, NOT_FOUND, Answer, Item, Refused, answered, invalid
from mitl.controllers.virtual.router import RWS1, Call, Route

_MOST_QUEUES = 50
_LARGEST = 4440


@dataclass
class Queue:
    """A queue. received: messages that ever came in."""

    most: int
    longest: int
    messages: deque[dict[str, str]] = field(default_factory=deque)
    received: int = 0


class QueueResources:
    """All queues, which subscriptions watch."""

    def __init__(self) -> None:
        self.queues: dict[str, Queue] = {}

    def routes(self) -> list[Route]:
        """Gives the table."""
        return [
            Route("POST", "rw/dipc", self.create, RWS1, "dipc-create"),
            Route("GET", "rw/dipc", self.all, RWS1),
            Route("GET", "rw/dipc/{queue}", self.read, RWS1, "dipc-read"),
            Route("POST", "rw/dipc/{queue}", self.send, RWS1, "dipc-send"),
            Route("DELETE", "rw/dipc/{queue}", self.remove, RWS1),
        ]

    def all(self, _call: Call) -> Answer:
        """The queues."""
        return answered(*(Item("dipc-queue-li", name, {"dipc-queue-name": name}) for name in self.queues))

    def create(self, call: Call) -> Answer:
        """Makes a queue."""
        name = call.wanted("dipc-queue-name")
        if name in self.queues:
            raise invalid(f"Queue {name} is there already")
        if len(self.queues) >= _MOST_QUEUES:
            raise invalid(f"At most {_MOST_QUEUES} queues")
        self.queues[name] = Queue(_whole(call.wanted("dipc-queue-size")), _whole(call.wanted("dipc-max-msg-size")))
        return Answer(201, ())

    def send(self, call: Call) -> Answer:
        """Puts a message in a queue."""
        queue = self._queue(call)
        text = call.wanted("dipc-data")
        if len(text) > queue.longest or sum(len(one["dipc-data"]) for one in queue.messages) + len(text) > queue.most:
            raise invalid("The message does not fit into the queue")
        queue.messages.append(
            {
                "dipc-data": text,
                "dipc-userdef": call.form.get("dipc-userdef", "0"),
                "dipc-msgtype": call.form.get("dipc-msgtype", "0"),
                "dipc-cmd": call.form.get("dipc-cmd", "0"),
                "queue-name": call.form.get("dipc-src-queue-name", ""),
            }
        )
        queue.received += 1
        return DONE

    def read(self, call: Call) -> Answer:
        """Takes the messages out of a queue."""
        queue = self._queue(call)
        items = [Item("dipc-read-li", str(number), message) for number, message in enumerate(queue.messages)]
        queue.messages.clear()
        return answered(*items)

    def remove(self, call: Call) -> Answer:
        """Removes a queue."""
        self._queue(call)
        del self.queues[call.names["queue"]]
        return DONE

    def _queue(self, call: Call) -> Queue:
        queue = self.queues.get(call.names["queue"])
        if queue is None:
            raise Refused(404, NOT_FOUND, f"No queue {call.names['queue']!r}")
        return queue


def _whole(text: str) -> int:
    if not text.isascii() or not text.isdigit() or not 0 < int(text[:9]) <= _LARGEST:
        raise invalid(f"expected a size of 1 to {_LARGEST}, got {text[:20]!r}")
    return int(text)
