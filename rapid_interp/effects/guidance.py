"""Externally guided motion: a computer or a sensor leads the robot.

Invariant: all are frozen; `process` is the EGM process of the program, from 1.
"""

from __future__ import annotations

from dataclasses import dataclass

from rapid_interp.data import JointTarget, Pose, ToolData, WObjData
from rapid_interp.effects.moves import Motion, SourceLine

Ranges = tuple[tuple[str, float, float], ...]
"""Axis or direction with its lowest and highest value for convergence."""


@dataclass(frozen=True, slots=True)
class SetUpGuidance:
    """`EGMSetupUC`, `EGMSetupAI`, ...: where guidance comes from. `source` is `UC`, `AI`, `AO`, `GI` or `LTAPP`; `mode` what it tells."""

    at: SourceLine
    process: int
    source: str
    unit: str
    configuration: str
    device: str
    mode: str
    time_out: float | None = None
    signals: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ActivateGuidance:
    """`EGMActJoint`, `EGMActPose`, `EGMActMove`: its frames, ranges, filter (Hz), period (ms) and limits (deg; deg/s)."""

    at: SourceLine
    process: int
    mode: str
    tool: ToolData | None = None
    wobj: WObjData | None = None
    correction: Pose | None = None
    correction_frame: int = 0
    sensor: Pose | None = None
    sensor_frame: int = 0
    ranges: Ranges = ()
    filter_hz: float | None = None
    period_ms: float | None = None
    most_deviation: float | None = None
    most_speed: float | None = None
    streams: bool = False


@dataclass(frozen=True, slots=True)
class RunGuidance:
    """`EGMRunJoint`, `EGMRunPose`: follow until all `axes` are in their ranges for `condition_s`, or go on at once without `waits`."""

    at: SourceLine
    process: int
    mode: str
    axes: tuple[str, ...]
    ramps_down: bool
    waits: bool = True
    condition_s: float | None = None
    ramp_in_s: float | None = None
    ramp_out_s: float | None = None
    offset: Pose | None = None
    gain: float | None = None


@dataclass(frozen=True, slots=True)
class StopGuidance:
    """`EGMStop`, `EGMReset`: stop following; with `forget` the process is free again."""

    at: SourceLine
    process: int
    ramps_down: bool = False
    ramp_out_s: float | None = None
    forget: bool = False


@dataclass(frozen=True, slots=True)
class StreamPositions:
    """`EGMStreamStart`, `EGMStreamStop`: send positions without following."""

    at: SourceLine
    process: int
    on: bool
    period_ms: float | None = None


@dataclass(frozen=True, slots=True)
class GuidedMove:
    """`EGMMoveL`, `EGMMoveC`: a programmed path that a sensor corrects."""

    at: SourceLine
    process: int
    move: Motion


@dataclass(frozen=True, slots=True)
class ReadGuidanceState:
    """`EGMGetState`: the reply is 0 disconnected, 1 connected, 2 running."""

    at: SourceLine
    process: int


@dataclass(frozen=True, slots=True)
class MoveUnits:
    """`MoveExtJ`: move the axes of mechanical units that carry no tool."""

    at: SourceLine
    target: JointTarget
    axis_speed: float
    """deg/s or mm/s of the axes: `speed.v_reax` and `v_leax`."""
    linear_speed: float
    fly_by: bool
    duration: float | None = None


@dataclass(frozen=True, slots=True)
class CorrectPath:
    r"""`CorrWrite`, `CorrClear`, `CorrDiscon`: from now on moves with `\Corr` are offset by this in the path's frame, in mm."""

    at: SourceLine
    x: float
    y: float
    z: float
