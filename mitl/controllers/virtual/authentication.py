"""HTTP Digest (1.0) and Basic (2.0) authentication of the virtual controller, without I/O.

Invariant: secrets are compared in constant time and appear in no message; a nonce is ours, recent, and no count of it is used twice.
"""

from __future__ import annotations

import base64
import binascii
import hashlib
import hmac
import re
import secrets
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from urllib.parse import unquote

from mitl.controllers.virtual.answers import Dialect

REALM = "validusers@robapi.abb"
_NONCE_LIFETIME = 300.0
_MOST_NONCES = 10_000
_PARAMETER = re.compile(r'(\w+)\s*=\s*(?:"((?:[^"\\]|\\.)*)"|([^\s,]+))')


@dataclass
class _Nonce:
    since: float
    used: set[str] = field(default_factory=set)


class Authentication:
    """Who may come in. users: name to password. now: a monotonic clock in s."""

    def __init__(self, dialect: Dialect, users: Mapping[str, str], now: Callable[[], float]) -> None:
        self._dialect = dialect
        self._users = dict(users)
        self._now = now
        self._nonces: dict[str, _Nonce] = {}
        self._opaque = secrets.token_hex(16)

    def user(self, header: str | None, method: str, target: str) -> str | None:
        """Gives the user that an Authorization header proves to be, or None. target: path and query as they were sent."""
        if header is None:
            return None
        scheme, _, rest = header.partition(" ")
        if self._dialect is Dialect.RWS1:
            return self._digest(rest, method, target) if scheme.lower() == "digest" else None
        return self._basic(rest) if scheme.lower() == "basic" else None

    def challenge(self, header: str | None = None) -> str:
        """Gives the WWW-Authenticate header of a 401; stale where the refused header had a nonce that is no longer known."""
        if self._dialect is not Dialect.RWS1:
            return f'Basic realm="{REALM}"'
        stale = ""
        if header is not None and _parameters(header).get("nonce", "") not in self._nonces:
            stale = ', stale="TRUE"'
        return f'Digest realm="{REALM}", nonce="{self._new_nonce()}", qop="auth", opaque="{self._opaque}", algorithm="MD5"{stale}'

    def _new_nonce(self) -> str:
        now = self._now()
        if len(self._nonces) >= _MOST_NONCES:
            self._nonces = {nonce: state for nonce, state in self._nonces.items() if now - state.since < _NONCE_LIFETIME}
            while len(self._nonces) >= _MOST_NONCES:
                del self._nonces[next(iter(self._nonces))]
        nonce = secrets.token_hex(16)
        self._nonces[nonce] = _Nonce(now)
        return nonce

    def _digest(self, text: str, method: str, target: str) -> str | None:
        given = _parameters(text)
        user, nonce = given.get("username", ""), given.get("nonce", "")
        password, state = self._users.get(user), self._nonces.get(nonce)
        if password is None or state is None or self._now() - state.since > _NONCE_LIFETIME or given.get("qop", "auth") != "auth":
            return None
        if given.get("realm") != REALM or given.get("uri") is None or _without_parameters(given["uri"]) != _without_parameters(target):
            return None
        if given.get("algorithm", "MD5").upper() != "MD5":
            return None
        secret = _md5(f"{user}:{REALM}:{password}")
        request = _md5(f"{method}:{given['uri']}")
        count = given.get("nc", "")
        expected = _md5(f"{secret}:{nonce}:{count}:{given.get('cnonce', '')}:auth:{request}")
        if not hmac.compare_digest(expected.encode(), given.get("response", "").lower().encode()) or count in state.used:
            return None
        state.used.add(count)
        return user

    def _basic(self, text: str) -> str | None:
        try:
            user, colon, password = base64.b64decode(text.strip(), validate=True).decode("utf-8").partition(":")
        except (binascii.Error, UnicodeDecodeError):
            return None
        known = self._users.get(user)
        if known is None or not colon or not hmac.compare_digest(known.encode(), password.encode()):
            return None
        return user


def _parameters(text: str) -> dict[str, str]:
    """Gives the parameters of a header; clients quote `algorithm`, `nc` and `qop` or do not."""
    return {
        name.lower(): (quoted.replace('\\"', '"') if quoted or not plain else plain) for name, quoted, plain in _PARAMETER.findall(text)
    }


def _without_parameters(target: str) -> str:
    """Gives a target without the `;value` at the end of its path, which the Python package requests leaves out of what it signs."""
    path, question, query = unquote(target).partition("?")
    return f"{path.partition(';')[0]}{question}{query}"


def _md5(text: str) -> str:
    return hashlib.md5(text.encode(), usedforsecurity=False).hexdigest()
