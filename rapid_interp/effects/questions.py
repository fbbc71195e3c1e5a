"""Questions to the controller and to the operator.

Invariant: all are frozen, and each names the source line that it comes from.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from rapid_interp.data import JointTarget, RobTarget, ToolData, WObjData
from rapid_interp.effects.moves import SourceLine


@dataclass(frozen=True, slots=True)
class ReadTarget:
    """`CRobT`, `CPos`: where the TCP is. The reply is a RobTarget in the object frame. None is the tool or work object of the last move."""

    at: SourceLine
    tool: ToolData | None = None
    wobj: WObjData | None = None


@dataclass(frozen=True, slots=True)
class ReadJoints:
    """`CJointT`: where the axes are. The reply is a JointTarget."""

    at: SourceLine


@dataclass(frozen=True, slots=True)
class ReadTool:
    """`CTool`: the reply is the ToolData of the last move."""

    at: SourceLine


@dataclass(frozen=True, slots=True)
class ReadWorkObject:
    """`CWObj`: the reply is the WObjData of the last move."""

    at: SourceLine


@dataclass(frozen=True, slots=True)
class SolveForward:
    """`CalcRobT`: where the TCP would be with these axes. The reply is a RobTarget in the object frame."""

    at: SourceLine
    joints: JointTarget
    tool: ToolData
    wobj: WObjData


@dataclass(frozen=True, slots=True)
class SolveInverse:
    """`CalcJointT`: the axes for a target. The reply is a JointTarget, or `Failed` with `ERR_ROBLIMIT` or `ERR_OUTSIDE_REACH`."""

    at: SourceLine
    target: RobTarget
    tool: ToolData
    wobj: WObjData


@dataclass(frozen=True, slots=True)
class ReadDate:
    """`CDate`, `CTime`, `GetTime`: the reply is the controller's date and time as `YYYY-MM-DD HH:MM:SS`."""

    at: SourceLine


@dataclass(frozen=True, slots=True)
class ReadSpeedOverride:
    """`CSpeedOverride`: the reply is the operator's speed override in per cent."""

    at: SourceLine


@dataclass(frozen=True, slots=True)
class ReadSystem:
    """`GetSysInfo`, `IsSysId`: the reply is a text.

    `what` is `SerialNo`, `SWVersion`, `RobotType`, `CtrlId`, `LanIp`, `CtrlLang` or `SystemName`.
    """

    at: SourceLine
    what: str


@dataclass(frozen=True, slots=True)
class ReadEvent:
    """`ReadErrData`: what raised this interrupt (`EventLogged`). The reply is an `Event`."""

    at: SourceLine
    interrupt: int


@dataclass(frozen=True, slots=True)
class BreakSignal:
    r"""A signal that ends a question (`\DIBreak`, `\DOBreak`) when it is, or becomes, `value`; then the reply is `Failed` with `error`."""

    name: str
    value: float
    error: str


@dataclass(frozen=True, slots=True)
class AskOperator:
    """`UIMsgBox`, `UINumEntry`, `UIAlphaEntry`, `UIListView`, `TPReadNum`, `TPReadFK` and their kind: wait for an answer.

    `wants` is `choice` (the reply is the 0-based place in `choices`), `number` (a float from `least` to `most`) or `text` (a str).
    When nobody has answered after `max_time` seconds, the reply is `Failed` with `ERR_TP_MAXTIME`.
    """

    at: SourceLine
    wants: str
    text: str
    choices: tuple[str, ...] = ()
    least: float | None = None
    most: float | None = None
    max_time: float | None = None
    breaks: tuple[BreakSignal, ...] = ()


Question: TypeAlias = (
    ReadTarget | ReadJoints | ReadTool | ReadWorkObject | SolveForward | SolveInverse | ReadDate | AskOperator
    | ReadSpeedOverride | ReadEvent | ReadSystem
)  # fmt: skip
