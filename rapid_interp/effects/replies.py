"""What a driver may reply.

Invariant: all are frozen.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from rapid_interp.data import JointTarget, RobTarget, ToolData, WObjData


@dataclass(frozen=True, slots=True)
class Failed:
    """A reply: the controller could not do it. `error` is the name of a RAPID error (`ERR_ROBLIMIT`) that the program may handle.

    Without a name the program cannot handle it and ends.
    """

    error: str
    reason: str


@dataclass(frozen=True, slots=True)
class Event:
    """A reply: a message of the event log."""

    domain: int
    number: int
    kind: int
    title: str = ""
    texts: tuple[str, ...] = ()


Answer: TypeAlias = float | str | RobTarget | JointTarget | ToolData | WObjData | Event | Failed | None


@dataclass(frozen=True, slots=True)
class Interrupted:
    """A reply: these interrupts were raised since the last reply, in this order.

    `finished` tells whether the effect is done, with `reply` as its reply; otherwise the task sends `Resume` when the traps are done.
    """

    interrupts: tuple[int, ...]
    reply: Answer = None
    finished: bool = True


Reply: TypeAlias = Answer | Interrupted
