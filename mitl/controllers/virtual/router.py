"""Calls and the table of what answers them.

Invariant: a path is matched segment by segment after decoding; `{name}` takes one segment, `{name*}` all that are left.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from mitl.controllers.virtual.answers import Answer, Dialect, Refused, invalid
from mitl.controllers.virtual.sessions import Session

RWS1: tuple[Dialect, ...] = (Dialect.RWS1,)
RWS2: tuple[Dialect, ...] = (Dialect.RWS2, Dialect.RWS8)
ALL: tuple[Dialect, ...] = tuple(Dialect)


@dataclass(frozen=True)
class Call:
    """A request after authentication. segments: the decoded path, form: the fields of its body in order, base: the server's address."""

    dialect: Dialect
    method: str
    segments: tuple[str, ...]
    query: Mapping[str, str]
    form: Mapping[str, str]
    pairs: Sequence[tuple[str, str]]
    body: bytes
    session: Session
    base: str
    names: Mapping[str, str] = field(default_factory=dict)

    def wanted(self, name: str) -> str:
        """Gives a field of the form or, in 2.0, of the query. Raises Refused where it is missing."""
        value = self.form.get(name, self.query.get(name))
        if value is None:
            raise invalid(f"Missing parameter {name}")
        return value

    @property
    def implicit(self) -> bool:
        """Whether the caller asks for mastership to be taken for this call alone."""
        return self.query.get("mastership", "").lower() == "implicit"


Handler: TypeAlias = Callable[[Call], Answer]


@dataclass(frozen=True)
class Route:
    """One line of the table. action: value of `?action=` in 1.0, or empty."""

    method: str
    pattern: str
    handler: Handler
    dialects: tuple[Dialect, ...] = ALL
    action: str = ""


class Router:
    """The table of one dialect."""

    def __init__(self, routes: Sequence[Route], dialect: Dialect) -> None:
        self._routes = [(route, tuple(route.pattern.split("/"))) for route in routes if dialect in route.dialects]

    def find(self, method: str, segments: Sequence[str], action: str) -> tuple[Handler, dict[str, str]]:
        """Gives the handler of a request and the names in its path. Raises Refused 404, or 405 where only the method is wrong."""
        known_by: set[str] = set()
        for route, pattern in self._routes:
            names = matched(pattern, segments)
            if names is None:
                continue
            if route.method == method and route.action == action:
                return route.handler, names
            known_by.add(route.method)
        if not known_by:
            raise Refused(404, -1073445884, f"Resource not found: /{'/'.join(segments)}")
        if method in known_by:
            raise invalid(f"Unknown action {action!r} of /{'/'.join(segments)}")
        raise Refused(405, -1073445880, f"Method {method} is not allowed here", {"Allow": ", ".join(sorted(known_by))})


def matched(pattern: Sequence[str], segments: Sequence[str]) -> dict[str, str] | None:
    """Gives the names that a pattern finds in a path, or None where it does not fit."""
    names: dict[str, str] = {}
    for index, part in enumerate(pattern):
        if part.endswith("*}"):
            names[part[1:-2]] = "/".join(segments[index:])
            return names
        if index >= len(segments):
            return None
        if part.startswith("{"):
            names[part[1:-1]] = segments[index]
        elif part.lower() != segments[index].lower():
            return None
    return names if len(pattern) == len(segments) else None
