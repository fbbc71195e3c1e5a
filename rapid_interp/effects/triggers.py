"""Outputs and interrupts at places of a path.

Invariant: all are frozen.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from rapid_interp.effects.moves import Motion, SourceLine


@dataclass(frozen=True, slots=True)
class SetOutput:
    """Action of a trigger: set an output signal."""

    name: str
    value: float


@dataclass(frozen=True, slots=True)
class RaiseInterrupt:
    """Action of a trigger: raise an interrupt of the program (`TriggInt`, `MoveLSync`), as a subscription would."""

    interrupt: int


@dataclass(frozen=True, slots=True)
class FollowSpeed:
    """Action of a trigger (`TriggSpeed`): from here on the analog output is `scale` times the TCP speed in mm/s, `lag` seconds ahead."""

    name: str
    scale: float
    lag: float


@dataclass(frozen=True, slots=True)
class RampOutput:
    """Action of a trigger (`TriggRampAO`): from here on an analog output goes to `value` over `ramp` mm, or s with `in_seconds`."""

    name: str
    value: float
    ramp: float
    in_seconds: bool = False


@dataclass(frozen=True, slots=True)
class CheckSignal:
    """Action of a trigger (`TriggCheckIO`): compare a signal (`EQ`, `NOTEQ`, `LT`, `LTEQ`, `GT`, `GTEQ`); if it does not hold, raise.

    With `stops` the motion stops before the trap runs.
    """

    name: str
    condition: str
    value: float
    interrupt: int
    stops: bool = False


Action: TypeAlias = SetOutput | RaiseInterrupt | FollowSpeed | RampOutput | CheckSignal


@dataclass(frozen=True, slots=True, kw_only=True)
class Trigger:
    """Something that happens at a place of a path.

    `distance_mm` or `seconds` before the end of the path, or after its start with `from_start`; `lag` seconds earlier (`EquipLag`).
    Without either it is in the middle of the corner at the end, or at the end if that is a stop point (`MoveLDO`, `MoveLSync`).
    """

    action: Action
    distance_mm: float | None = None
    seconds: float | None = None
    from_start: bool = False
    lag: float = 0.0


@dataclass(frozen=True, slots=True)
class TriggerMove:
    """A motion during which something happens: `TriggL`, `TriggJ`, `TriggC`, `MoveLDO`, `MoveLSync` and their kind."""

    at: SourceLine
    move: Motion
    triggers: tuple[Trigger, ...]
