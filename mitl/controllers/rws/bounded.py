"""An HTTP transport that lets go of an answer which is too long, packed, or drips in too slowly, before it has filled the memory.

Invariant: at most MOST_BYTES of any answer are ever held, those that ask for a login included; nothing is unpacked.
"""

from __future__ import annotations

import ssl
import time
from collections.abc import Callable, Iterator
from typing import cast

import httpx

from mitl.controllers.rws.answers import MOST_BYTES
from mitl.controllers.rws.errors import MalformedAnswerError

MOST_SECONDS = 60.0
"""An answer may take so long altogether: a backup's largest file over a slow line takes seconds."""


class Bounded(httpx.BaseTransport):
    """Connections of one client. verify: the context to encrypt with, or False for none to check. now: monotonic clock in s."""

    def __init__(
        self,
        verify: ssl.SSLContext | bool,
        *,
        most: int = MOST_BYTES,
        seconds: float = MOST_SECONDS,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._inner = httpx.HTTPTransport(verify=verify, trust_env=False, limits=httpx.Limits(max_connections=1))
        self._most, self._seconds, self._now = most, seconds, now

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        """Gives the response to a request, its body bounded. Raises MalformedAnswerError for one that is packed."""
        request.headers["Accept-Encoding"] = "identity"
        response = self._inner.handle_request(request)
        if response.headers.get("content-encoding", "identity") != "identity":
            response.close()
            raise MalformedAnswerError("the controller's answer is packed, which was not asked for")
        stream = cast(httpx.SyncByteStream, response.stream)  # a synchronous transport's
        body = _Body(stream, self._most, self._now, self._now() + self._seconds)
        return httpx.Response(response.status_code, headers=response.headers, stream=body, extensions=response.extensions)

    def close(self) -> None:
        """Closes the connections."""
        self._inner.close()


class _Body(httpx.SyncByteStream):
    """The bytes of one answer."""

    def __init__(self, inner: httpx.SyncByteStream, most: int, now: Callable[[], float], deadline: float) -> None:
        self._inner, self._most, self._now, self._deadline = inner, most, now, deadline

    def __iter__(self) -> Iterator[bytes]:
        size = 0
        for part in self._inner:
            size += len(part)
            if size > self._most:
                raise MalformedAnswerError(f"the controller's answer has more than {self._most} bytes; that is no answer of a controller")
            if self._now() > self._deadline:
                raise MalformedAnswerError("the controller's answer was not complete after a minute")
            yield part

    def close(self) -> None:
        self._inner.close()
