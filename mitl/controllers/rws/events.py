"""Events: what a controller tells by itself, over the WebSocket of a subscription.

Invariant: after the connection was lost the subscription is made anew and the current values are told again, so nothing stays stale;
for as long as it is lost `connected` is false, and a watchdog must treat it as such.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from types import TracebackType
from urllib.parse import urlsplit

from websockets.exceptions import WebSocketException
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from mitl.controllers.rws import answers
from mitl.controllers.rws.answers import Item
from mitl.controllers.rws.errors import MalformedAnswerError
from mitl.controllers.rws.transport import Transport
from mitl.errors import RigError

_OPEN_TIMEOUT, _LOOK, _AGAIN_AFTER = 5.0, 0.2, 1.0


class Events:
    """A subscription to resources with their priorities, as a context manager. told: called with every item, in a thread of its own.

    A problem that cannot be mended (refused resources, wrong password) ends it; `problem` then says what it was.
    """

    def __init__(self, transport: Transport, resources: Sequence[tuple[str, int]], told: Callable[[Item], None]) -> None:
        self._transport = transport
        self._resources = tuple(resources)
        self._told = told
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._listen, name="rws-events", daemon=True)
        self.connected = threading.Event()
        """Set while the subscription is alive."""
        self.problem: RigError | None = None

    def __enter__(self) -> Events:
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None) -> None:
        self._ended.set()
        self._thread.join(2 * _OPEN_TIMEOUT)

    def _listen(self) -> None:
        while not self._ended.is_set():
            try:
                with self._connected() as socket:
                    self.connected.set()
                    self._receive(socket)
            except (OSError, WebSocketException):
                self._ended.wait(_AGAIN_AFTER)
            except RigError as error:
                self.problem = error
                return
            finally:
                self.connected.clear()

    def _connected(self) -> ClientConnection:
        answered = self._transport.ask(self._transport.dialect.subscribe(self._resources))
        path = urlsplit(answered.location).path
        if not path.startswith("/poll/"):
            raise MalformedAnswerError(f"subscribing: expected the address of a WebSocket, got {answered.location!r}")
        address = self._transport.address.replace("http", "ws", 1)  # the host as we reach it, not as the controller calls itself
        return connect(
            address + path,
            subprotocols=[Subprotocol(self._transport.dialect.subprotocol)],
            additional_headers={"Cookie": self._transport.cookies()},
            ssl=self._transport.tls(),
            compression=None,
            proxy=None,
            open_timeout=_OPEN_TIMEOUT,
            close_timeout=_LOOK,
        )

    def _receive(self, socket: ClientConnection) -> None:
        while not self._ended.is_set():
            try:
                text = socket.recv(timeout=_LOOK)
            except TimeoutError:
                continue
            for item in answers.items("application/xhtml+xml", text.encode() if isinstance(text, str) else text):
                self._told(item)
