"""Errors of the RWS client, each with the controller's own text.

Invariant: all are RigErrors; none carries a password, a cookie or an Authorization header.
"""

from __future__ import annotations

from mitl.errors import RigError


class RwsError(RigError):
    """The controller refused. status: HTTP status, code: ABB's number or None, text: the controller's own words."""

    def __init__(self, what: str, status: int, code: int | None, text: str) -> None:
        number = f" ({code})" if code is not None else ""
        super().__init__(f"{what} refused by the controller: {text or 'no reason given'} [HTTP {status}{number}]")
        self.what = what
        self.status = status
        self.code = code
        self.text = text


class LoginRefusedError(RwsError):
    """401: user or password is wrong."""


class NotAllowedError(RwsError):
    """403: mastership or write access is held by another, the mode forbids it, or the user lacks the grant."""


class NotFoundError(RwsError):
    """404 or 410, or 1.0's 400 for symbols: there is no such thing."""


class BusyError(RwsError):
    """429 or 503: too many requests or sessions, for longer than our patience."""


class UnreachableError(RigError):
    """The controller did not answer for longer than our patience, or is not the one whose certificate was pinned."""


class MalformedAnswerError(RigError):
    """The controller answered something that is not what Robot Web Services answer."""


_NOT_FOUND = -1073414146
_KINDS: dict[int, type[RwsError]] = {
    401: LoginRefusedError,
    403: NotAllowedError,
    404: NotFoundError,
    410: NotFoundError,
    429: BusyError,
    503: BusyError,
}


def refusal(what: str, status: int, code: int | None, text: str) -> RwsError:
    """Gives the error for a refusal of what we asked."""
    kind = NotFoundError if code == _NOT_FOUND else _KINDS.get(status, RwsError)
    return kind(what, status, code, text)
