r"""What an entry of the library is: a routine head written in RAPID, and the Python that carries it out.

Invariant: the head is the only place where a routine's arguments are told; the resolver reads it from here.
Beside RAPID's types a head may use `numeric` (num or dnum), `anytype` (the implementation gets type and value) and
`anydata` and `numericdata` (type and reference, with mode INOUT). A signal parameter gives the signal's name.
Optional arguments that are absent are None, switches are True or False.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Any, TypeAlias

from rapid_interp.effects import Effect, Reply
from rapid_interp.meaning.types import Value
from rapid_interp.running.values import Fault, from_record

Effects: TypeAlias = Generator[Effect, Reply, Value]
"""What the implementation of a routine with effects gives: it yields them, receives the replies, and returns the value."""


@dataclass(frozen=True, slots=True)
class LibraryRoutine:
    """A predefined routine. `run` takes the arguments in the order of the head and gives the function's value.

    With `effects`, `run` is a generator function whose first argument is the `SourceLine` of the call; with `task` the running
    task comes before all other arguments. Without `run` the routine is known by its name and read with any arguments; `refused`
    says why it is not carried out.
    """

    head: str
    run: Callable[..., Any] | None = None
    effects: bool = False
    task: bool = False
    refused: str = ""
    harmless: bool = False
    """Has no effect on motion or data: may be left out if the caller is lenient."""

    @property
    def name(self) -> str:
        """The routine's name as the manuals write it."""
        return self.head.partition("(")[0].split()[-1]

    @property
    def is_function(self) -> bool:
        """Whether it gives a value."""
        return self.head.startswith("FUNC")


def number_told(reply: Reply, what: str) -> float:
    """Gives a reply that must be a number."""
    if not isinstance(reply, int | float):
        raise Fault(f"the controller told no {what}", "RAPID-R320")
    return float(reply)


def text_told(reply: Reply, what: str) -> str:
    """Gives a reply that must be a text."""
    if not isinstance(reply, str):
        raise Fault(f"the controller told no {what}", "RAPID-R320")
    return reply


def record_told(reply: Reply, wanted: type, what: str) -> Value:
    """Gives the value for a reply that must be a record of `data`."""
    if not isinstance(reply, wanted):
        raise Fault(f"the controller told no {what}", "RAPID-R320")
    return from_record(reply)
