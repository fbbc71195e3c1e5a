"""What names stand for, and where they are looked up.

Invariant: names are looked up in lower case, in the order routine, module, other modules, predefined.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Any, TypeAlias

from rapid_interp.meaning.types import RapidType, Value
from rapid_interp.source import SourceText

Frame: TypeAlias = list[Any]
"""Slots of a running routine: globals, task, return value, failure being handled, then parameters, local data and temporaries."""
GLOBALS, TASK, RESULT, FAILED, FIRST_LOCAL = 0, 1, 2, 3, 4
Run: TypeAlias = Callable[[Frame], Value]
"""A compiled expression."""
Step: TypeAlias = Callable[[Frame], Any]
"""A compiled statement part: gives the next step's index, or what the task must do first."""


@dataclass(frozen=True, slots=True)
class Failure:
    """What an error handler handles: the steps to go back to, how often in a row that statement failed, and why."""

    begin: int
    following: int
    count: int
    reason: str
    code: str
    number: float = 0.0


@dataclass(frozen=True, slots=True)
class Restart:
    """Tells the task to begin its entry routine again."""


@dataclass(frozen=True, slots=True)
class DataSymbol:
    """Data or a parameter. A `by_reference` slot holds a reference; an `optional` one may hold ABSENT.

    `fixed` holds the value of a constant, once it is known.
    """

    name: str
    type: RapidType
    storage: str
    slot: int
    is_global: bool = False
    by_reference: bool = False
    optional: bool = False
    module: str = ""
    scope: str = ""
    fixed: tuple[Value, ...] = ()


@dataclass(frozen=True, slots=True)
class ParameterInfo:
    """A parameter as a call sees it."""

    name: str
    type: RapidType
    mode: str
    optional: bool
    group: int

    @property
    def is_switch(self) -> bool:
        """Whether it is a switch, which takes no value."""
        return self.type.name == "switch"


@dataclass(slots=True)
class Code:
    """The compiled form of a routine. It grows while the routine is compiled and is not changed afterwards.

    `places` has the offset of each step's statement, `size` the number of slots of a frame. `statements` has for a step the
    first step of its statement and the first after it. From `body_end` on the steps are those of the other sections, which begin
    at `undo` and `handler`. `elements` counts the elements of its own arrays.
    """

    steps: list[Step] = field(default_factory=list)
    places: list[int] = field(default_factory=list)
    size: int = FIRST_LOCAL
    statements: dict[int, tuple[int, int]] = field(default_factory=dict)
    body_end: int = 0
    undo: int | None = None
    handler: int | None = None
    handler_numbers: tuple[Run, ...] = ()
    elements: int = 0


@dataclass(frozen=True, slots=True)
class RoutineSymbol:
    """A routine of the program. `kind` is PROC, FUNC or TRAP."""

    name: str
    kind: str
    parameters: tuple[ParameterInfo, ...]
    result: RapidType | None
    module: str
    scope: str
    source: SourceText
    code: Code


class Scope:
    """Names of one level, with the level around it."""

    def __init__(self, outer: Scope | None = None) -> None:
        self.outer = outer
        self.data: dict[str, DataSymbol] = {}
        self.routines: dict[str, RoutineSymbol] = {}
        self.types: dict[str, RapidType] = {}

    def levels(self) -> Iterator[Scope]:
        """Gives this level and those around it, from the inside out."""
        level: Scope | None = self
        while level is not None:
            yield level
            level = level.outer

    def find_data(self, name: str) -> DataSymbol | None:
        """Gives the data of this name."""
        key = name.lower()
        return next((level.data[key] for level in self.levels() if key in level.data), None)

    def find_routine(self, name: str) -> RoutineSymbol | None:
        """Gives the routine of this name."""
        key = name.lower()
        return next((level.routines[key] for level in self.levels() if key in level.routines), None)

    def find_type(self, name: str) -> RapidType | None:
        """Gives the type of this name."""
        key = name.lower()
        return next((level.types[key] for level in self.levels() if key in level.types), None)

    def data_names(self) -> list[str]:
        """Gives all names of data that can be seen from here, as declared."""
        return [symbol.name for level in self.levels() for symbol in level.data.values()]

    def routine_names(self) -> list[str]:
        """Gives all names of routines that can be seen from here, as declared."""
        return [symbol.name for level in self.levels() for symbol in level.routines.values()]


def did_you_mean(name: str, known: list[str]) -> str:
    """Gives `; did you mean 'x'?` for the nearest known name, or nothing."""
    by_key = {other.lower(): other for other in known}
    near = get_close_matches(name.lower(), by_key, n=1, cutoff=0.65)
    return f"; did you mean {by_key[near[0]]!r}?" if near else ""
