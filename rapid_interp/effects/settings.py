"""Settings of motion, and stopping and starting it.

Invariant: all are frozen, and each names the source line that it comes from.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from rapid_interp.data import ExtJoint, LoadData, Pose, ToolData, WObjData
from rapid_interp.effects.moves import SourceLine


@dataclass(frozen=True, slots=True)
class SetAcceleration:
    """`AccSet`: acceleration and its rate of change in per cent of the robot's, the latter also before stop points."""

    at: SourceLine
    acceleration: float
    ramp: float
    fine_point_ramp: float = 100.0


@dataclass(frozen=True, slots=True)
class SetVelocity:
    """`VelSet`: all programmed speeds in per cent, and the most mm/s of the TCP."""

    at: SourceLine
    override: float
    max_tcp: float


@dataclass(frozen=True, slots=True)
class LimitPathAcceleration:
    """`PathAccLim`: the most m/s^2 of the TCP along the path, and when slowing down; None is no limit."""

    at: SourceLine
    acceleration: float | None
    deceleration: float | None


@dataclass(frozen=True, slots=True)
class LimitWorldAcceleration:
    """`WorldAccLim`: the most m/s^2 of the TCP in any direction; None is no limit."""

    at: SourceLine
    acceleration: float | None


@dataclass(frozen=True, slots=True)
class RefreshSpeed:
    """`SpeedRefresh`: the speed override in per cent, at once, also of the motion that is going on."""

    at: SourceLine
    override: float


@dataclass(frozen=True, slots=True)
class SetCirclePathMode:
    """`CirPathMode`: how orientation goes along arcs: `PathFrame`, `ObjectFrame`, `CirPointOri`, `Wrist45`, `Wrist46` or `Wrist56`."""

    at: SourceLine
    mode: str


@dataclass(frozen=True, slots=True)
class SetSingularity:
    """`SingArea`: near singularities `wrist` (joints of the wrist interpolated), `lock_axis_4` or `off`. Only told when it changes."""

    at: SourceLine
    mode: str


@dataclass(frozen=True, slots=True)
class SetDisplacement:
    """`PDispOn`, `PDispSet`, `PDispOff`: from now on targets are displaced: X_OT becomes `displacement` X_OT."""

    at: SourceLine
    displacement: Pose


@dataclass(frozen=True, slots=True)
class SetAxisOffsets:
    """`EOffsOn`, `EOffsSet`, `EOffsOff`: from now on external axes are offset by these mm or deg."""

    at: SourceLine
    offsets: ExtJoint


@dataclass(frozen=True, slots=True)
class SetLoad:
    """`GripLoad`: what the gripper holds."""

    at: SourceLine
    load: LoadData


@dataclass(frozen=True, slots=True)
class SetActive:
    """`SetSysData`: from now on this tool or work object counts as that of the last move."""

    at: SourceLine
    tool: ToolData | None = None
    wobj: WObjData | None = None


@dataclass(frozen=True, slots=True)
class SetSoftness:
    """`SoftAct`, `SoftDeact`: how soft an axis is in per cent; without `axis` all become stiff."""

    at: SourceLine
    axis: int | None
    softness: float
    ramp: float = 100.0
    unit: str = ""


@dataclass(frozen=True, slots=True)
class ActivateUnit:
    """`ActUnit`, `DeactUnit`: a mechanical unit joins the motion or leaves it."""

    at: SourceLine
    unit: str
    active: bool


@dataclass(frozen=True, slots=True)
class StopMotion:
    """`StopMove`: stop on the path; moves that follow wait for `StartMotion`. `quick` stops as fast as it can."""

    at: SourceLine
    quick: bool = False


@dataclass(frozen=True, slots=True)
class StartMotion:
    """`StartMove`: go on after `StopMotion`."""

    at: SourceLine


@dataclass(frozen=True, slots=True)
class ClearMotion:
    """`ClearPath`: forget all moves that are not done."""

    at: SourceLine


@dataclass(frozen=True, slots=True)
class StoreMotion:
    """`StorePath`: put the interrupted path aside, so that other moves can be made."""

    at: SourceLine


@dataclass(frozen=True, slots=True)
class RestoreMotion:
    """`RestoPath`: take back the path of the last `StoreMotion`."""

    at: SourceLine


@dataclass(frozen=True, slots=True)
class WaitWorkObject:
    """`WaitWObj`: wait until the conveyor's next work object is `distance_mm` past its start; fails after `max_time` seconds."""

    at: SourceLine
    wobj: WObjData
    distance_mm: float = 0.0
    max_time: float | None = None


@dataclass(frozen=True, slots=True)
class DropWorkObject:
    """`DropWObj`: let go of the conveyor's work object."""

    at: SourceLine
    wobj: WObjData


Setting: TypeAlias = (
    SetAcceleration | SetVelocity | LimitPathAcceleration | LimitWorldAcceleration | RefreshSpeed | SetCirclePathMode | SetSingularity
    | SetDisplacement | SetAxisOffsets | SetLoad | SetActive | SetSoftness | ActivateUnit
    | StopMotion | StartMotion | ClearMotion | StoreMotion | RestoreMotion | WaitWorkObject | DropWorkObject
)  # fmt: skip
