"""What a RAPID program asks of the world: frozen effects, each with the source line it comes from.

The interpreter is a generator: `effect = run.send(reply)`. It never waits, moves or measures; whoever
drives it decides when the next `send` happens, and that is where look-ahead, zones and stopping live.
Units are RAPID's (mm, deg, s). Every effect's reply is None unless its docstring says otherwise; instead of it the
driver may reply `Failed`, which is a RAPID error at that instruction, or `Interrupted`, which runs traps first.
A driver must refuse an effect that it does not know: ignoring one makes its results wrong.
"""

from __future__ import annotations

from typing import TypeAlias

from rapid_interp.effects.basic import ReadClock, ReadSignal, SetSignal, StopProgram, Wait, Write
from rapid_interp.effects.guidance import (
    ActivateGuidance,
    CorrectPath,
    GuidedMove,
    MoveUnits,
    ReadGuidanceState,
    RunGuidance,
    SetUpGuidance,
    StopGuidance,
    StreamPositions,
)
from rapid_interp.effects.interrupts import (
    AnalogCondition,
    Elapsed,
    EventLogged,
    Resume,
    SignalChange,
    Source,
    Subscribe,
    Unsubscribe,
    WaitForTasks,
)
from rapid_interp.effects.moves import Motion, Move, MoveAbsJ, MoveC, MoveJ, MoveL, SetConfiguration, SourceLine
from rapid_interp.effects.questions import (
    AskOperator,
    BreakSignal,
    Question,
    ReadDate,
    ReadEvent,
    ReadJoints,
    ReadSpeedOverride,
    ReadSystem,
    ReadTarget,
    ReadTool,
    ReadWorkObject,
    SolveForward,
    SolveInverse,
)
from rapid_interp.effects.replies import Answer, Event, Failed, Interrupted, Reply
from rapid_interp.effects.settings import (
    ActivateUnit,
    ClearMotion,
    DropWorkObject,
    LimitPathAcceleration,
    LimitWorldAcceleration,
    RefreshSpeed,
    RestoreMotion,
    SetAcceleration,
    SetActive,
    SetAxisOffsets,
    SetCirclePathMode,
    SetDisplacement,
    SetLoad,
    SetSingularity,
    SetSoftness,
    Setting,
    SetVelocity,
    StartMotion,
    StopMotion,
    StoreMotion,
    WaitWorkObject,
)
from rapid_interp.effects.triggers import Action, CheckSignal, FollowSpeed, RaiseInterrupt, RampOutput, SetOutput, Trigger, TriggerMove
from rapid_interp.effects.zones import (
    BoxShape,
    CylinderShape,
    FreeZone,
    JointShape,
    Shape,
    SphereShape,
    SuperviseZone,
    SwitchZone,
)

Effect: TypeAlias = (
    Motion | SetConfiguration | Wait | SetSignal | ReadSignal | ReadClock | Write | StopProgram
    | TriggerMove | Setting | Question | Subscribe | Unsubscribe | Resume | WaitForTasks
    | SuperviseZone | SwitchZone | FreeZone
    | SetUpGuidance | ActivateGuidance | RunGuidance | StopGuidance | StreamPositions | GuidedMove | ReadGuidanceState
    | MoveUnits | CorrectPath
)  # fmt: skip

__all__ = [
    "Action",
    "ActivateGuidance",
    "ActivateUnit",
    "AnalogCondition",
    "Answer",
    "AskOperator",
    "BoxShape",
    "BreakSignal",
    "CheckSignal",
    "ClearMotion",
    "CorrectPath",
    "CylinderShape",
    "DropWorkObject",
    "Effect",
    "Elapsed",
    "Event",
    "EventLogged",
    "Failed",
    "FollowSpeed",
    "FreeZone",
    "GuidedMove",
    "Interrupted",
    "JointShape",
    "LimitPathAcceleration",
    "LimitWorldAcceleration",
    "Motion",
    "Move",
    "MoveAbsJ",
    "MoveC",
    "MoveJ",
    "MoveL",
    "MoveUnits",
    "Question",
    "RaiseInterrupt",
    "RampOutput",
    "ReadClock",
    "ReadDate",
    "ReadEvent",
    "ReadGuidanceState",
    "ReadJoints",
    "ReadSignal",
    "ReadSpeedOverride",
    "ReadSystem",
    "ReadTarget",
    "ReadTool",
    "ReadWorkObject",
    "RefreshSpeed",
    "Reply",
    "RestoreMotion",
    "Resume",
    "RunGuidance",
    "SetAcceleration",
    "SetActive",
    "SetAxisOffsets",
    "SetCirclePathMode",
    "SetConfiguration",
    "SetDisplacement",
    "SetLoad",
    "SetOutput",
    "SetSignal",
    "SetSingularity",
    "SetSoftness",
    "SetUpGuidance",
    "SetVelocity",
    "Setting",
    "Shape",
    "SignalChange",
    "SolveForward",
    "SolveInverse",
    "Source",
    "SourceLine",
    "SphereShape",
    "StartMotion",
    "StopGuidance",
    "StopMotion",
    "StopProgram",
    "StoreMotion",
    "StreamPositions",
    "Subscribe",
    "SuperviseZone",
    "SwitchZone",
    "Trigger",
    "TriggerMove",
    "Unsubscribe",
    "Wait",
    "WaitForTasks",
    "WaitWorkObject",
    "Write",
]
