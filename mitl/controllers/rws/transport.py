"""Transport: one session with a controller over HTTP. It paces, repeats what may be repeated, keeps the session and opens it again.

Invariant: fewer than 20 requests go out in a second; nothing that changes something is sent twice unless it surely never arrived;
credentials go only to whoever shows the pinned certificate or a verified one.
"""

from __future__ import annotations

import hashlib
import ssl
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from urllib.parse import urlencode, urlsplit

import httpx

from mitl.controllers.rws import answers
from mitl.controllers.rws.answers import Item
from mitl.controllers.rws.bounded import Bounded
from mitl.controllers.rws.credentials import Credentials
from mitl.controllers.rws.dialects import Ask, Rws1
from mitl.controllers.rws.errors import (
    BusyError,
    LoginRefusedError,
    MalformedAnswerError,
    NotAllowedError,
    UnreachableError,
    refusal,
)

PATIENCE = 15.0
"""Seconds for which an unreachable or busy controller is asked again."""
REQUESTS_PER_SECOND = 18.0
TIMEOUT = 5.0
_FIRST_REST, _LONGEST_REST = 0.2, 2.0


@dataclass(frozen=True)
class Answered:
    """A successful answer. location: of a resource that was made."""

    status: int
    items: tuple[Item, ...]
    body: bytes
    location: str = ""


class Transport:
    """A session at `address` (http:// or https://). fingerprint: SHA-256 of the certificate to trust, or None to verify it as browsers do.

    rate: requests a second; patience, timeout in s. rest: waits in s; now: monotonic clock. Safe to use from several threads.
    """

    def __init__(
        self,
        address: str,
        dialect: Rws1,
        credentials: Credentials,
        *,
        fingerprint: str | None = None,
        rate: float = REQUESTS_PER_SECOND,
        patience: float = PATIENCE,
        timeout: float = TIMEOUT,
        rest: Callable[[float], None] = time.sleep,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self.address = address.rstrip("/")
        self.dialect = dialect
        self._credentials = credentials
        self._fingerprint = fingerprint.lower().replace(":", "") if fingerprint else None
        self._interval = 1.0 / rate if rate > 0 else 0.0
        self._patience = patience
        self._timeout = timeout
        self._rest = rest
        self._now = now
        self._next = 0.0
        self._client: httpx.Client | None = None
        self._introduced = False
        self.session = ""
        """The session's cookies as a header, as of its last answer; may be read from any thread at any time. A secret."""
        self._renewed = False
        """Whether the controller opened a new session by itself, as one with basic authentication does."""
        self._lock = threading.RLock()
        self.on_new_session: Callable[[], None] | None = None
        """Called when a session had to be opened again, so that what the old one held can be asked for again."""

    def ask(self, ask: Ask) -> Answered:
        """Gives the answer to a request. Raises an RwsError with the controller's own text, UnreachableError or MalformedAnswerError."""
        with self._lock:
            if not self._introduced:
                self._introduce()
            self._renewed = False
            try:
                answered = self._patiently(ask)
            except LoginRefusedError:
                # the session has expired, or the password is wrong: a new session tells which
                self._drop_client()
                self._begin_again()
                return self._patiently(ask)
            except NotAllowedError:
                if not self._renewed:
                    raise
                self._begin_again()
                return self._patiently(ask)
            if self._renewed:
                self._begin_again()
            return answered

    def items(self, ask: Ask) -> tuple[Item, ...]:
        """Gives the items of the answer."""
        return self.ask(ask).items

    def item(self, ask: Ask) -> Item:
        """Gives the first item of the answer. Raises MalformedAnswerError where it has none."""
        found = self.items(ask)
        if not found:
            raise MalformedAnswerError(f"{ask.what}: the controller's answer is empty")
        return found[0]

    def cookies(self) -> str:
        """Gives the session's cookies as a header, for its WebSocket."""
        with self._lock:
            return _cookies(self._open())

    def end_session(self, cookies: str) -> None:
        """Ends another session than ours, of a process that is gone, by its cookies. Raises UnreachableError."""
        ask = self.dialect.log_out()
        headers = {**self.dialect.headers(ask), "Cookie": cookies}
        verify: ssl.SSLContext | bool = self._context() if self.address.startswith("https:") else False
        try:
            with httpx.Client(transport=Bounded(verify), timeout=self._timeout, trust_env=False) as client:
                client.request(ask.method, self.address + self.dialect.target(ask), headers=headers)
        except (httpx.TransportError, MalformedAnswerError) as error:
            raise UnreachableError(f"ending the session that is left over: {self.address} cannot be reached: {_said(error)}") from error

    def tls(self) -> ssl.SSLContext | None:
        """Gives the context that the session is encrypted with, or None for plain HTTP."""
        return self._context() if self.address.startswith("https:") else None

    def close(self) -> None:
        """Ends the session as far as the controller can still be reached."""
        with self._lock:
            if self._client is None:
                return
            try:
                if self._introduced:
                    self._once(self.dialect.log_out())
            except (httpx.HTTPError, MalformedAnswerError):
                self._introduced = False  # it cannot be reached: the controller ends an idle session by itself
            finally:
                self._drop_client()

    def _begin_again(self) -> None:
        """Asks in a new session for all that the old one held."""
        self._renewed = False
        self._introduce()
        if self.on_new_session is not None:
            self.on_new_session()

    def _introduce(self) -> None:
        self._introduced = True
        try:
            for ask in self.dialect.introduce():
                self._patiently(ask)
        except BaseException:
            self._introduced = False
            raise

    def _patiently(self, ask: Ask) -> Answered:
        """Asks until there is an answer or patience ends."""
        deadline = self._now() + self._patience
        rest = _FIRST_REST
        while True:
            try:
                response = self._once(ask)
            except (httpx.ConnectError, httpx.ConnectTimeout, httpx.PoolTimeout) as error:
                problem: Exception = error  # it never arrived
            except httpx.TransportError as error:
                if not ask.repeatable:
                    raise UnreachableError(
                        f"{ask.what}: the connection to {self.address} broke: {_said(error)}; it is not known whether it was done"
                    ) from error
                problem = error
            else:
                if response.status_code not in (429, 503):
                    return self._read(ask, response)
                code, text = answers.status(response.headers.get("content-type", ""), response.content)
                problem = BusyError(ask.what, response.status_code, code, text)
                rest = max(rest, _retry_after(response))
            if self._now() + rest > deadline:
                if isinstance(problem, BusyError):
                    raise problem
                raise UnreachableError(
                    f"{ask.what}: {self.address} cannot be reached for {self._patience:g} s: {_said(problem)}"
                ) from problem
            self._rest(rest)
            rest = min(2 * rest, _LONGEST_REST)

    def _once(self, ask: Ask) -> httpx.Response:
        self._pace()
        headers = self.dialect.headers(ask)
        target = self.address + self.dialect.target(ask)
        content = ask.body
        if ask.method == "POST":
            content = urlencode(list(ask.form.items()) if isinstance(ask.form, Mapping) else list(ask.form)).encode()
        client = self._open()
        before = _session(client)
        response = client.request(ask.method, target, content=content, headers=headers)
        self.session = _cookies(client)
        self._renewed = self._renewed or (before is not None and _session(client) != before)
        return response

    def _read(self, ask: Ask, response: httpx.Response) -> Answered:
        kind, body = response.headers.get("content-type", ""), response.content
        if response.is_success:
            is_file = ask.path.startswith("/fileservice")
            found = () if is_file and "xml" not in kind and "json" not in kind else tuple(answers.items(kind, body))
            return Answered(response.status_code, found, body, response.headers.get("location", ""))
        code, text = answers.status(kind, body)
        raise refusal(ask.what, response.status_code, code, text)

    def _pace(self) -> None:
        wait = self._next - self._now()
        if wait > 0:
            self._rest(wait)
        self._next = self._now() + self._interval

    def _open(self) -> httpx.Client:
        if self._client is None:
            user, password = self._credentials.user, self._credentials.password
            auth: httpx.Auth = httpx.BasicAuth(user, password) if self.dialect.basic_authentication else httpx.DigestAuth(user, password)
            verify: ssl.SSLContext | bool = self._context() if self.address.startswith("https:") else False
            self._client = httpx.Client(
                auth=auth, transport=Bounded(verify), timeout=self._timeout, trust_env=False, follow_redirects=False
            )
        return self._client

    def _drop_client(self) -> None:
        if self._client is not None:
            self._client.close()
        self._client, self._introduced, self.session = None, False, ""

    def _context(self) -> ssl.SSLContext:
        if self._fingerprint is None:
            return ssl.create_default_context()
        try:
            shown = _certificate(self.address, self._timeout)
        except OSError as error:
            raise httpx.ConnectError(f"no certificate from {urlsplit(self.address).hostname}: {error}") from error
        found = _fingerprint(shown)
        if found != self._fingerprint:
            raise UnreachableError(
                f"{self.address} shows another certificate than the pinned one: expected SHA-256 {self._fingerprint}, "
                f"seen {found}; no password was sent"
            )
        context = ssl.create_default_context(cadata=shown)
        context.check_hostname = False
        context.verify_flags |= ssl.VERIFY_X509_PARTIAL_CHAIN
        return context


def certificate_fingerprint(address: str, timeout: float) -> str:
    """Gives the SHA-256 in hex of the certificate that https://host[:port] shows. Raises OSError where there is none."""
    return _fingerprint(_certificate(address, timeout))


def _certificate(address: str, timeout: float) -> str:
    parts = urlsplit(address)
    return ssl.get_server_certificate((parts.hostname or "", parts.port or 443), timeout=timeout)


def _fingerprint(certificate_pem: str) -> str:
    return hashlib.sha256(ssl.PEM_cert_to_DER_cert(certificate_pem)).hexdigest()


def _cookies(client: httpx.Client) -> str:
    return "; ".join(f"{cookie.name}={cookie.value}" for cookie in client.cookies.jar)


def _session(client: httpx.Client) -> str | None:
    return next((cookie.value for cookie in client.cookies.jar if cookie.name == "ABBCX"), None)


def _retry_after(response: httpx.Response) -> float:
    text = response.headers.get("retry-after", "")
    return min(float(text), 5.0) if text.isascii() and text.isdigit() and len(text) < 5 else 0.0


def _said(error: Exception) -> str:
    return str(error) or type(error).__name__
