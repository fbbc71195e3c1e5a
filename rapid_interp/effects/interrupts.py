"""Interrupts, and tasks that meet.

Invariant: all are frozen, and each names the source line that it comes from.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from rapid_interp.effects.moves import SourceLine


@dataclass(frozen=True, slots=True)
class SignalChange:
    """A signal changes to `value`, or to any other value if that is None (`ISignalDI`, `ISignalDO`, `ISignalGI`, `ISignalGO`)."""

    name: str
    value: float | None


@dataclass(frozen=True, slots=True)
class AnalogCondition:
    """An analog signal fulfils a condition and has moved by `delta` since the last time (`ISignalAI`, `ISignalAO`).

    `condition` is 1 above high, 2 below high, 3 above low, 4 below low, 5 between, 6 outside, 7 always.
    """

    name: str
    condition: int
    high: float
    low: float
    delta: float


@dataclass(frozen=True, slots=True)
class Elapsed:
    """Time passes (`ITimer`): `seconds` after the subscription, and so on unless it is for once."""

    seconds: float


@dataclass(frozen=True, slots=True)
class EventLogged:
    """A message of this domain and type comes into the controller's event log (`IError`); `number` 0 is any."""

    domain: int
    kind: int
    number: int = 0


Source: TypeAlias = SignalChange | AnalogCondition | Elapsed | EventLogged


@dataclass(frozen=True, slots=True)
class Subscribe:
    """From now on raise an interrupt when something happens: put its number into `Interrupted`. With `single` only the first time."""

    at: SourceLine
    interrupt: int
    source: Source
    single: bool = False


@dataclass(frozen=True, slots=True)
class Unsubscribe:
    """`IDelete`: from now on do not raise this interrupt."""

    at: SourceLine
    interrupt: int


@dataclass(frozen=True, slots=True)
class Resume:
    """The traps are done: go on with the effect whose reply was `Interrupted` and unfinished. The reply is that effect's.

    The time that the traps took counts: a wait ends when it would have ended, or at once if that is over.
    """

    at: SourceLine


@dataclass(frozen=True, slots=True)
class WaitForTasks:
    """`WaitSyncTask`: wait until every one of `tasks` waits for the same `meeting`; `Failed` with `ERR_WAITSYNCTASK` after `time_out` s."""

    at: SourceLine
    meeting: str
    tasks: tuple[str, ...]
    in_position: bool = False
    time_out: float | None = None
