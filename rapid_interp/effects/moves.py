"""Motions.

Invariant: all are frozen, and each names the source line that it comes from.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from rapid_interp.data import JointTarget, RobTarget, SpeedData, ToolData, WObjData, ZoneData


@dataclass(frozen=True, slots=True)
class SourceLine:
    """Where an effect comes from: module, routine, file as given by the caller, and 1-based line and column; column 0 is not known."""

    module: str
    routine: str
    file: str
    line: int
    column: int = field(default=0, compare=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class Move:
    r"""What all motion instructions share.

    `tcp_speed` is `\V` in mm/s and replaces `speed.v_tcp`; `duration` is `\T` in seconds and replaces
    both; `zone_mm` is `\Z` and replaces the zone's TCP size; `corrected` is `\Corr`: `CorrectPath` counts.
    """

    at: SourceLine
    speed: SpeedData
    zone: ZoneData
    tool: ToolData
    wobj: WObjData
    tcp_speed: float | None = None
    duration: float | None = None
    zone_mm: float | None = None
    corrected: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveAbsJ(Move):
    """Move all axes to given positions."""

    target: JointTarget


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveJ(Move):
    """Move to a pose, axes interpolated."""

    target: RobTarget


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveL(Move):
    """Move to a pose along a straight line of the TCP in the object frame."""

    target: RobTarget


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveC(Move):
    """Move to a pose along the arc through `via`."""

    via: RobTarget
    target: RobTarget


@dataclass(frozen=True, slots=True)
class SetConfiguration:
    """`ConfL` or `ConfJ`: whether linear (`joint_moves` false) or joint moves must reach the programmed configuration."""

    at: SourceLine
    joint_moves: bool
    on: bool


Motion: TypeAlias = MoveAbsJ | MoveJ | MoveL | MoveC
