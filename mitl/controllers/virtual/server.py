"""VirtualServer: the HTTP and WebSocket shell of a Service, and the pump that lets the cell's time pass.

Invariant: cell and service are touched by the event loop's thread alone.
"""

from __future__ import annotations

import asyncio
import logging
import ssl
import time
from enum import Enum

from aiohttp import WSMsgType, web

from mitl.controllers.virtual.answers import Dialect
from mitl.controllers.virtual.egm_sender import PERIOD as EGM_PERIOD
from mitl.controllers.virtual.egm_sender import EgmSender
from mitl.controllers.virtual.service import SUBPROTOCOLS, Request, Response, Service
from mitl.controllers.virtual.subscriptions import Group
from mitl.errors import MitlError, UsageError

_LARGEST_BODY = 16 * 1024 * 1024
_PING = 30.0
_PERIOD = 0.01
_FAST_STEP, _FAST_REST = 0.02, 0.001
_MOST_BEHIND, _SLICE = 0.25, 0.05
"""Seconds by which a cell may be behind the wall's clock before it stops catching up, and that it catches up at once."""
_MOST_UNSENT = 10_000
_log = logging.getLogger(__name__)
_QUIET = logging.getLogger(f"{__name__}.http")
"""Takes what aiohttp says of requests that are none: it would quote them, with what may be somebody's password in them."""
_QUIET.addHandler(logging.NullHandler())
_QUIET.propagate = False


class Pace(Enum):
    """How virtual time passes: with the wall's clock, as fast as possible while RAPID runs, or only by `VirtualServer.advance`."""

    REALTIME = "realtime"
    FAST = "fast"
    MANUAL = "manual"


class VirtualServer:
    """A server on host and port (0: any free one). tls: its context, or None for plain HTTP. egm: streams while time passes, or None."""

    def __init__(
        self, service: Service, *, host: str, port: int, pace: Pace, tls: ssl.SSLContext | None = None, egm: EgmSender | None = None
    ) -> None:
        self.service = service
        self._egm = egm
        self._host = host
        self._port = port
        self._pace = pace
        self._tls = tls
        self._runner: web.AppRunner | None = None
        self._pump: asyncio.Task[None] | None = None
        self._unsent: dict[Group, asyncio.Queue[str]] = {}
        self._origin = self._slipped = 0.0

    async def start(self) -> str:
        """Opens the port and gives the server's address. Raises UsageError where it cannot be opened."""
        app = web.Application(client_max_size=_LARGEST_BODY)
        app.router.add_route("*", "/{tail:.*}", self._handle)
        self._runner = web.AppRunner(app, access_log=None, logger=_QUIET, handle_signals=False, shutdown_timeout=1.0)
        await self._runner.setup()
        site = web.TCPSite(self._runner, self._host, self._port, ssl_context=self._tls)
        try:
            await site.start()
        except OSError as error:
            await self._runner.cleanup()
            raise UsageError(f"cannot listen on {self._host} port {self._port}: {error.strerror or error}") from error
        host, port = self._runner.addresses[0][:2]
        self._origin = time.monotonic() - self.service.cell.clock.now()
        self._pump = asyncio.create_task(self._run())
        shown = f"[{host}]" if ":" in host else host
        return f"{'https' if self._tls else 'http'}://{shown}:{port}"

    async def stop(self) -> None:
        """Stops the program, closes the port and all connections."""
        if self._pump is not None:
            self._pump.cancel()
            await asyncio.gather(self._pump, return_exceptions=True)
        if self._runner is not None:
            await self._runner.cleanup()
        if self._egm is not None:
            self._egm.close()
        self.service.cell.close()

    async def advance(self, seconds: float) -> None:
        """Lets virtual time pass and sends the events of it."""
        self._step(seconds)

    async def _run(self) -> None:
        while True:
            rest = EGM_PERIOD if self._egm is not None else _PERIOD
            match self._pace:
                case Pace.REALTIME:
                    self._catch_up()
                case Pace.FAST if self.service.cell.running or self.service.cell.moving:
                    self._step(_FAST_STEP)
                    rest = _FAST_REST
                case Pace.FAST:
                    self._step(_PERIOD)
                case Pace.MANUAL:
                    self._step(0.0)
            await asyncio.sleep(rest)

    def _catch_up(self) -> None:
        """Lets time pass as on the wall. What took long to compute takes long: a robot that leapt to where it should be by now would
        outrun whoever watches it, and its own heartbeat.
        """
        behind = time.monotonic() - self._origin - self.service.cell.clock.now()
        if behind > _MOST_BEHIND:
            self._slipped += behind - _MOST_BEHIND
            self._origin += behind - _MOST_BEHIND
            behind = _MOST_BEHIND
        self._step(min(max(behind, 0.0), _SLICE))

    def _step(self, seconds: float) -> None:
        cell = self.service.cell
        try:
            cell.advance(seconds)
        except MitlError as error:
            cell.log.add("error", 20000, "The program was stopped", str(error))
            cell.stop()
        if self._egm is not None:
            self._egm.send(self._slipped)
        for group, text in self.service.subscriptions.events():
            queue = self._unsent.get(group)
            if queue is not None and not queue.full():
                queue.put_nowait(text)
            elif queue is not None:
                _log.warning("a subscriber reads too slowly; an event for it is lost")

    async def _handle(self, request: web.Request) -> web.StreamResponse:
        asked = Request(
            request.method,
            request.raw_path,
            {name.lower(): value for name, value in request.headers.items()},
            await request.read(),
            secure=self._tls is not None,
        )
        if self._pace is Pace.REALTIME:
            self._catch_up()
        if asked.headers.get("upgrade", "").lower() == "websocket":
            found = self.service.websocket(asked)
            return await self._serve_events(request, found) if isinstance(found, Group) else _sent(found)
        return _sent(self.service.respond(asked))

    async def _serve_events(self, request: web.Request, group: Group) -> web.WebSocketResponse:
        socket = web.WebSocketResponse(protocols=(SUBPROTOCOLS[self.service.dialect],), heartbeat=_PING, compress=False)
        await socket.prepare(request)
        queue: asyncio.Queue[str] = asyncio.Queue(_MOST_UNSENT)
        self._unsent[group] = queue
        self.service.subscriptions.connect(group)
        sender = asyncio.create_task(self._send(socket, group, queue))
        try:
            async for message in socket:
                self.service.keep_alive(group)
                if message.type is WSMsgType.TEXT and message.data == "PING" and self.service.dialect is not Dialect.RWS1:
                    await socket.send_str("PONG")
        finally:
            sender.cancel()
            await asyncio.gather(sender, return_exceptions=True)
            if self._unsent.get(group) is queue:
                del self._unsent[group]
                group.connected = False
        return socket

    async def _send(self, socket: web.WebSocketResponse, group: Group, queue: asyncio.Queue[str]) -> None:
        """Sends events until the group is gone; while its socket is open its session does not idle."""
        while self.service.subscriptions.alive(group):
            self.service.keep_alive(group)
            try:
                text = await asyncio.wait_for(queue.get(), 1.0)
            except TimeoutError:
                continue
            await socket.send_str(text)
        await socket.close()


def _sent(response: Response) -> web.Response:
    made = web.Response(status=response.status, body=response.body or None, headers=response.headers)
    for cookie in response.cookies:
        made.headers.add("Set-Cookie", cookie)
    return made
