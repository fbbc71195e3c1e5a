"""What the virtual controller answers, free of representation: items, answers and refusals with ABB's codes.

Invariant: nothing here knows XML, JSON or HTTP libraries; codes come from the corpus of live errors in facts/rws.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import TypeAlias

Field: TypeAlias = str | tuple[Mapping[str, str], ...]


class Dialect(Enum):
    """The generation of Robot Web Services: 1.0 (RobotWare 6), 2.0 (RobotWare 7), and that of RobotWare 8."""

    RWS1 = "1"
    RWS2 = "2"
    RWS8 = "8"


@dataclass(frozen=True)
class Item:
    """One list item of an answer. kind: its class, title: its title, fields: name to text in the order in which clients count them.

    href: its own address, if it has one.
    """

    kind: str
    title: str
    fields: Mapping[str, Field]
    href: str = ""


@dataclass(frozen=True)
class Answer:
    """An answer. items: the state, or None for no content. raw: a file's bytes instead. location: header of a new resource.

    links: (href, rel) pairs of the answer itself. more: relative address of the next page, if there is one.
    """

    status: int = 200
    items: tuple[Item, ...] | None = None
    raw: bytes | None = None
    location: str = ""
    links: tuple[tuple[str, str], ...] = ()
    headers: Mapping[str, str] = field(default_factory=dict)


DONE = Answer(204)


def answered(*items: Item) -> Answer:
    """Gives an answer with items."""
    return Answer(200, items)


class Refused(Exception):  # noqa: N818 - an answer, not a failure of this program
    """A refusal: HTTP status, ABB's code and text."""

    def __init__(self, status: int, code: int, text: str, headers: Mapping[str, str] | None = None) -> None:
        super().__init__(text)
        self.status = status
        self.code = code
        self.text = text
        self.headers = dict(headers or {})


INVALID = -1073445879
NOT_ALLOWED = -1073445881
HELD = -1073445862
NO_SIGNAL = -1073445866
NOT_FOUND = -1073414146
NO_MODULE_FILE = -1073438708
NO_MODULE = -1073442816
WRONG_STATE = -1073442809
BAD_MODULE = -1073442813
BAD_VOLUME = -1073438716
NO_STATION = -1073435871
BAD_STATION = -1073435870
GENERAL = -1073445888


def invalid(text: str) -> Refused:
    """Gives the refusal of a parameter."""
    return Refused(400, INVALID, text)


def not_found(text: str, status: int = 404, code: int = NOT_FOUND) -> Refused:
    """Gives the refusal of something that is not there."""
    return Refused(status, code, text)


def wrong_state(text: str) -> Refused:
    """Gives the refusal of what the controller's state does not allow."""
    return Refused(400, WRONG_STATE, text)
