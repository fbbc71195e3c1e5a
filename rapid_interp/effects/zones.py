"""World zones: volumes that the controller supervises.

Invariant: all are frozen; places are in the world frame, in mm and degrees.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from rapid_interp.data import JointTarget, Pos
from rapid_interp.effects.moves import SourceLine


@dataclass(frozen=True, slots=True)
class BoxShape:
    """A box along the world's axes by its lowest and highest corner. With `inside` the volume is the box, otherwise all around it."""

    low: Pos
    high: Pos
    inside: bool


@dataclass(frozen=True, slots=True)
class SphereShape:
    """A sphere."""

    centre: Pos
    radius: float
    inside: bool


@dataclass(frozen=True, slots=True)
class CylinderShape:
    """A cylinder along the world's z axis from `centre`, the middle of one of its ends."""

    centre: Pos
    radius: float
    height: float
    inside: bool


@dataclass(frozen=True, slots=True)
class JointShape:
    """All axes between two positions; an axis of 9E9 does not count."""

    low: JointTarget
    high: JointTarget
    inside: bool


Shape: TypeAlias = BoxShape | SphereShape | CylinderShape | JointShape


@dataclass(frozen=True, slots=True)
class SuperviseZone:
    """`WZLimSup`, `WZDOSet`: stop the robot before it enters (`signal` None), or hold an output at `value` while it is in the zone.

    With `before` the output is set so early that the robot can still stop before the zone. `stationary` zones cannot be switched.
    """

    at: SourceLine
    zone: int
    shape: Shape
    signal: str | None = None
    value: float = 1.0
    before: bool = False
    stationary: bool = False


@dataclass(frozen=True, slots=True)
class SwitchZone:
    """`WZEnable`, `WZDisable`: supervise a temporary zone, or for now do not."""

    at: SourceLine
    zone: int
    on: bool


@dataclass(frozen=True, slots=True)
class FreeZone:
    """`WZFree`: forget a temporary zone."""

    at: SourceLine
    zone: int
