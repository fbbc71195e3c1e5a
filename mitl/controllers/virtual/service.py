"""Service: Robot Web Services without I/O: requests in, responses out.

Invariant: whatever comes in, a response goes out; nothing is done for a caller who did not prove who he is.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from urllib.parse import parse_qsl, unquote, urlsplit

from mitl.controllers.virtual.answers import Answer, Dialect, Item, Refused, invalid
from mitl.controllers.virtual.authentication import Authentication
from mitl.controllers.virtual.cell import VirtualCell
from mitl.controllers.virtual.files import FileService
from mitl.controllers.virtual.mastership import Mastership
from mitl.controllers.virtual.rendering import Form, content_type, rendered, rendered_refusal
from mitl.controllers.virtual.resources.access import AccessResources
from mitl.controllers.virtual.resources.disk import DiskResources
from mitl.controllers.virtual.resources.event_log import EventLogResources
from mitl.controllers.virtual.resources.motion import MotionResources
from mitl.controllers.virtual.resources.panel import PanelResources
from mitl.controllers.virtual.resources.queues import QueueResources
from mitl.controllers.virtual.resources.rapid import RapidResources
from mitl.controllers.virtual.resources.signals import SignalResources
from mitl.controllers.virtual.resources.symbols import SymbolResources
from mitl.controllers.virtual.router import ALL, Call, Route, Router
from mitl.controllers.virtual.sessions import COOKIES, Session, Sessions
from mitl.controllers.virtual.subscriptions import Group, Subscriptions
from mitl.controllers.virtual.watching import Watchable
from mitl.errors import MitlError

SUBPROTOCOLS = {Dialect.RWS1: "robapi2_subscription", Dialect.RWS2: "rws_subscription", Dialect.RWS8: "rws_subscription"}
_MOST_FIELDS = 2100
_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Request:
    """An HTTP request. target: path and query as sent. headers: by lower-case name. secure: whether it came by TLS."""

    method: str
    target: str
    headers: Mapping[str, str]
    body: bytes = b""
    secure: bool = False


@dataclass(frozen=True)
class Response:
    """An HTTP response; cookies go out as their own headers."""

    status: int
    headers: dict[str, str] = field(default_factory=dict)
    body: bytes = b""
    cookies: tuple[str, ...] = ()


class Service:
    """One virtual controller's services. users: name to password; now: monotonic clock in s; rate: requests a second and session, 0 any."""

    def __init__(
        self,
        cell: VirtualCell,
        files: FileService,
        dialect: Dialect,
        users: Mapping[str, str],
        *,
        now: Callable[[], float] = time.monotonic,
        rate: float = 0.0,
    ) -> None:
        self.cell = cell
        self.dialect = dialect
        self._now = now
        self._authentication = Authentication(dialect, users, now)
        self._mastership = Mastership(dialect)
        self._sessions = Sessions(now, self._session_ended, rate=rate)
        symbols, queues = SymbolResources(cell, self._mastership), QueueResources()
        self.subscriptions = Subscriptions(Watchable(cell, symbols, queues, dialect).find, now, dialect)
        rooms = (
            PanelResources(cell, self._mastership),
            RapidResources(cell, self._mastership, files),
            symbols,
            SignalResources(cell),
            MotionResources(cell),
            DiskResources(files),
            EventLogResources(cell),
            AccessResources(self._mastership, self._sessions.close),
            queues,
        )
        own = [
            Route("POST", "subscription", self._subscribe, ALL),
            Route("PUT", "subscription/{group}", self._resubscribe, ALL),
            Route("DELETE", "subscription/{group}", self._unsubscribe, ALL),
            Route("DELETE", "subscription/{group}/{resource*}", self._unsubscribe, ALL),
        ]
        self._router = Router([*own, *(route for room in rooms for route in room.routes())], dialect)

    def respond(self, request: Request) -> Response:
        """Gives the response to a request."""
        form, path, base = Form.XHTML, "/", f"{'https' if request.secure else 'http'}://{request.headers.get('host', 'localhost')}"
        cookies: tuple[str, ...] = ()
        try:
            split = urlsplit(request.target)
            path = unquote(split.path)
            query = dict(parse_qsl(split.query, keep_blank_values=True, max_num_fields=100))
            form = self._form(request, query)
            session, cookies = self._session(request)
            self._sessions.touch(session)
            self._check_types(request, form)
            answer = self._answer(request, path, query, session, base)
        except Refused as refused:
            return self._refusal(refused, form, base, path, cookies)
        except (ValueError, UnicodeError) as error:
            return self._refusal(Refused(400, -1073445879, f"The request cannot be read: {error}"), form, base, path, cookies)
        except MitlError as error:
            return self._refusal(Refused(400, -1073414146, str(error)), form, base, path, cookies)
        except Exception as error:  # noqa: BLE001 - a fault of ours must neither end the server nor go unseen
            _log.exception("%s %s failed", request.method, path)
            return self._refusal(Refused(500, -1073445888, f"Internal error: {type(error).__name__}"), form, base, path, cookies)
        return self._response(answer, form, base, path, cookies)

    def websocket(self, request: Request) -> Group | Response:
        """Gives the group whose events a WebSocket request asks for, or the response that refuses it."""
        path = unquote(urlsplit(request.target).path)
        offered = [word.strip() for word in request.headers.get("sec-websocket-protocol", "").split(",")]
        base = f"ws://{request.headers.get('host', 'localhost')}"
        try:
            session, _ = self._session(request)
            group = self.subscriptions.find(path.rpartition("/")[2], session)
        except Refused as refused:
            return self._refusal(refused, Form.XHTML, base, path, ())
        if SUBPROTOCOLS[self.dialect] in offered:
            return group
        wrong = invalid(f"expected the WebSocket subprotocol {SUBPROTOCOLS[self.dialect]}")
        return self._refusal(wrong, Form.XHTML, base, path, ())

    def keep_alive(self, group: Group) -> None:
        """Tells that a group's WebSocket is open, which keeps its session from idling."""
        group.session.seen = self._now()

    def _form(self, request: Request, query: Mapping[str, str]) -> Form:
        if self.dialect is Dialect.RWS1:
            return Form.JSON if query.get("json") == "1" or request.headers.get("accept") == "application/json" else Form.XHTML
        asked = request.headers.get("accept", "*/*").replace(" ", "").lower()
        return Form.JSON if "application/hal+json;v=2" in asked else Form.XHTML

    def _check_types(self, request: Request, form: Form) -> None:
        """Raises Refused where 2.0's media types are missing."""
        if self.dialect is Dialect.RWS1:
            return
        asked = request.headers.get("accept", "*/*").replace(" ", "").lower()
        served = form is Form.JSON or "application/xhtml+xml;v=2" in asked or "*/*" in asked
        if request.method == "GET" and not served and not request.target.startswith("/fileservice"):
            raise Refused(406, -1073445886, "Accept must be application/xhtml+xml;v=2.0 or application/hal+json;v=2.0")
        sent = request.headers.get("content-type", "").replace(" ", "").lower()
        if request.method == "POST" and not sent.startswith("application/x-www-form-urlencoded;v=2"):
            raise Refused(415, -1073445885, "Content-Type must be application/x-www-form-urlencoded;v=2.0")
        if request.method in ("PUT", "DELETE") and ";v=2" not in sent:
            raise Refused(415, -1073445885, "Content-Type must have the version ;v=2.0")

    def _session(self, request: Request) -> tuple[Session, tuple[str, ...]]:
        """Gives the session of a request, and the cookies of a new one. Raises Refused 401."""
        session = self._sessions.find(_cookies(request.headers.get("cookie", "")).get(COOKIES[1]))
        if session is not None:
            return session, ()
        header = request.headers.get("authorization")
        user = self._authentication.user(header, request.method, request.target)
        if user is None:
            raise Refused(401, -1073445882, "Unauthorized", {"WWW-Authenticate": self._authentication.challenge(header)})
        session = self._sessions.open(user)
        secure = "; Secure" if request.secure else ""
        values = (session.http, session.abbcx)
        return session, tuple(f"{name}={value}; Path=/; HttpOnly{secure}" for name, value in zip(COOKIES, values, strict=True))

    def _answer(self, request: Request, path: str, query: dict[str, str], session: Session, base: str) -> Answer:
        segments = tuple(part for part in path.split("/") if part)
        action = query.get("action", "")
        is_file = bool(segments) and segments[0].lower() == "fileservice" and request.method == "PUT"
        text = "" if is_file else request.body.decode("utf-8")
        pairs = parse_qsl(text, keep_blank_values=True, max_num_fields=_MOST_FIELDS)
        handler, names = self._router.find(request.method, segments, action)
        call = Call(self.dialect, request.method, segments, query, dict(pairs), pairs, request.body, session, base, names)
        return handler(call)

    def _subscribe(self, call: Call) -> Answer:
        group = self.subscriptions.create(call.session, call.pairs)
        address = f"{call.base.replace('http', 'ws', 1)}/poll/{group.number}"
        links = ((address, "self"), (f"subscription/{group.number}", "group"))
        return Answer(201, (Item("sub-group", str(group.number), {}),), location=address, links=links)

    def _resubscribe(self, call: Call) -> Answer:
        self.subscriptions.update(call.names["group"], call.session, call.pairs)
        return Answer(200, ())

    def _unsubscribe(self, call: Call) -> Answer:
        self.subscriptions.remove(call.names["group"], call.session, call.names.get("resource", ""))
        return Answer(200, ())

    def _session_ended(self, session: Session) -> None:
        self._mastership.drop(session)
        self.subscriptions.drop(session)

    def _response(self, answer: Answer, form: Form, base: str, path: str, cookies: tuple[str, ...]) -> Response:
        headers = dict(answer.headers)
        if answer.location:
            headers["Location"] = answer.location
            form = Form.XHTML  # a client of 1.0 reads the address out of XML even where it asked for JSON (facts/rws.md)
        if answer.raw is not None:
            return Response(answer.status, {**headers, "Content-Type": "application/octet-stream"}, answer.raw, cookies)
        if answer.items is None:
            return Response(answer.status, headers, b"", cookies)
        headers["Content-Type"] = content_type(form, self.dialect)
        body = rendered(answer, form, self.dialect, base, path) if answer.items or answer.status == 200 else b""
        return Response(answer.status, headers, body, cookies)

    def _refusal(self, refused: Refused, form: Form, base: str, path: str, cookies: tuple[str, ...]) -> Response:
        headers = {"Content-Type": content_type(form, self.dialect), **refused.headers}
        return Response(refused.status, headers, rendered_refusal(refused, form, self.dialect, base, path), cookies)


def _cookies(header: str) -> dict[str, str]:
    pairs = (part.strip().partition("=") for part in header.split(";"))
    return {name: value.strip('"') for name, _, value in pairs}
