r"""Externally guided motion, corrected paths, and axes without a tool.

Invariant: a process of EGM is its number, from 1; what it does to the robot is the controller's.
ASSUMPTION A-176: order and names of the arguments of the EGM instructions, from memory.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, cast

from rapid_interp import effects as fx
from rapid_interp.data import JointTarget, Pose, ToolData, WObjData
from rapid_interp.effects import Motion, SourceLine
from rapid_interp.library.motion import move_c, move_l
from rapid_interp.library.table import Effects, LibraryRoutine, number_told
from rapid_interp.meaning.types import Value
from rapid_interp.running.values import Fault, Reference, error_number, to_record

if TYPE_CHECKING:
    from rapid_interp.running.task import Stepper

MOST_PROCESSES = 4
"""ASSUMPTION A-177: a task may use four EGM processes."""
_JOINTS = tuple(f"J{axis}" for axis in range(1, 8))
_DIRECTIONS = ("x", "y", "z", "rx", "ry", "rz")


def _process(identity: Reference) -> int:
    number = int(identity.get())
    if number == 0:
        raise Fault("the EGM identity has no process: EGMGetId comes first", "RAPID-R347", number=error_number("ERR_UDPUC_COMM"))
    return number


def _get_id(task: Stepper, identity: Reference) -> None:
    free = next((number for number in range(1, MOST_PROCESSES + 1) if number not in task.guidance), None)
    if free is None:
        raise Fault(
            f"all {MOST_PROCESSES} EGM processes are in use: EGMReset frees one", "RAPID-R347", number=error_number("ERR_UDPUC_COMM")
        )
    task.guidance.add(free)
    identity.put(float(free))


def _reset(task: Stepper, at: SourceLine, identity: Reference) -> Effects:
    process = _process(identity)
    yield fx.StopGuidance(at, process, forget=True)
    task.guidance.discard(process)
    identity.put(0.0)


def _set_up(source: str) -> Callable[..., Effects]:
    def run(at: SourceLine, unit: str, identity: Reference, configuration: str, *given: Value) -> Effects:
        device, rest = (given[0], given[1:]) if source in ("UC", "LTAPP") else ("", given)
        joint, pose, path, _a, _l, *others = rest
        mode = "joint" if joint else "path" if path else "pose" if pose or source != "LTAPP" else "path"
        time_out = others[0] if source == "UC" else None
        signals = tuple(signal for signal in others if isinstance(signal, str))
        yield fx.SetUpGuidance(at, _process(identity), source, str(unit), configuration, device, mode, time_out, signals)

    return run


def _ranges(names: tuple[str, ...], values: tuple[Value, ...]) -> fx.guidance.Ranges:
    return tuple((name, value[0], value[1]) for name, value in zip(names, values, strict=True) if value is not None)


def _tool(value: Value) -> ToolData | None:
    return None if value is None else cast(ToolData, to_record("tooldata", value))


def _wobj(value: Value) -> WObjData | None:
    return None if value is None else cast(WObjData, to_record("wobjdata", value))


def _pose(value: Value) -> Pose | None:
    return None if value is None else cast(Pose, to_record("pose", value))


def _act_joint(at: SourceLine, identity: Reference, streams: bool, tool: Value, wobj: Value, _load: Value, *rest: Value) -> Effects:
    filter_hz, period, deviation, speed = rest[7:]
    yield fx.ActivateGuidance(
        at, _process(identity), "joint", _tool(tool), _wobj(wobj), ranges=_ranges(_JOINTS, rest[:7]), filter_hz=filter_hz,
        period_ms=period, most_deviation=deviation, most_speed=speed, streams=streams,
    )  # fmt: skip


def _act_pose(
    at: SourceLine, identity: Reference, streams: bool, tool: Value, wobj: Value, _load: Value, correction: Value, correction_frame: float,
    sensor: Value, sensor_frame: float, *rest: Value,
) -> Effects:  # fmt: skip
    filter_hz, period, deviation, speed = rest[6:]
    yield fx.ActivateGuidance(
        at, _process(identity), "pose", _tool(tool), _wobj(wobj), _pose(correction), int(correction_frame), _pose(sensor),
        int(sensor_frame), _ranges(_DIRECTIONS, rest[:6]), filter_hz, period, deviation, speed, streams,
    )  # fmt: skip


def _act_move(at: SourceLine, identity: Reference, sensor: Value, period: float | None) -> Effects:
    yield fx.ActivateGuidance(at, _process(identity), "path", sensor=_pose(sensor), period_ms=period)


def _run(mode: str, names: tuple[str, ...]) -> Callable[..., Effects]:
    def run(at: SourceLine, identity: Reference, stop: float, at_once: bool, *given: Value) -> Effects:
        axes, (condition, ramp_in, ramp_out, *rest) = given[: len(names)], given[len(names) :]
        chosen = tuple(name for name, on in zip(names, axes, strict=True) if on)
        offset = _pose(rest[0]) if mode == "pose" else None
        yield fx.RunGuidance(
            at, _process(identity), mode, chosen, stop != _HOLD, not at_once, condition, ramp_in, ramp_out, offset, rest[-1]
        )

    return run


_HOLD = 1.0


def _stop(at: SourceLine, identity: Reference, mode: float, ramp_out: float | None) -> Effects:
    yield fx.StopGuidance(at, _process(identity), mode != _HOLD, ramp_out)


def _stream(*, on: bool) -> Callable[..., Effects]:
    def run(at: SourceLine, identity: Reference, period: float | None = None) -> Effects:
        yield fx.StreamPositions(at, _process(identity), on, period)

    return run


def _state(at: SourceLine, identity: Reference) -> Effects:
    return number_told((yield fx.ReadGuidanceState(at, _process(identity))), "state of the guidance")


def _guided(mover: Callable[..., Effects], targets: int) -> Callable[..., Effects]:
    def run(at: SourceLine, identity: Reference, *given: Value) -> Effects:
        points, (speed, zone, tool, wobj, load, _no) = given[:targets], given[targets:]
        moves = mover(at, False, *points, None, speed, None, None, zone, None, None, tool, wobj, False, load)
        move = cast(Motion, next(moves))
        yield fx.GuidedMove(at, _process(identity), move)

    return run


# ---------------------------------------------------------------- corrected paths


def _connect(task: Stepper, descriptor: Reference) -> None:
    if descriptor.get() in task.corrections:
        raise Fault("the correction generator is connected already", "RAPID-R348", number=error_number("ERR_ARGVALERR"))
    number = float(max(task.corrections, default=0.0) + 1)
    task.corrections[number] = (0.0, 0.0, 0.0)
    descriptor.put(number)


def _total(task: Stepper) -> Value:
    return tuple(sum(axis) for axis in zip((0.0, 0.0, 0.0), *task.corrections.values(), strict=True))


def _told(task: Stepper, at: SourceLine) -> Effects:
    yield fx.CorrectPath(at, *_total(task))


def _write(task: Stepper, at: SourceLine, descriptor: Reference, offset: Value) -> Effects:
    if descriptor.get() not in task.corrections:
        raise Fault("the correction generator is not connected: CorrCon comes first", "RAPID-R348", number=error_number("ERR_ARGVALERR"))
    task.corrections[descriptor.get()] = offset
    yield from _told(task, at)


def _disconnect(task: Stepper, at: SourceLine, descriptor: Reference) -> Effects:
    task.corrections.pop(descriptor.get(), None)
    descriptor.put(0.0)
    yield from _told(task, at)


def _clear(task: Stepper, at: SourceLine) -> Effects:
    task.corrections.clear()
    yield from _told(task, at)


def _move_units(
    at: SourceLine, _conc: bool, target: Value, _id: Value, _offsets: bool, speed: Value, duration: Value, zone: Value, inpos: Value
) -> Effects:
    fly_by = inpos is None and not zone[0]
    yield fx.MoveUnits(at, cast(JointTarget, to_record("jointtarget", target)), speed[3], speed[2], fly_by, duration)


_MODE = r"\switch Joint | switch Pose | switch PathCorr \switch APTR | switch LATR"
_ENTRY = r"PROC EGMSetup{source}(mecunit MecUnit, INOUT egmident EGMid, string ExtConfigName"
_LIMITS = r"\num LpFilter \num SampleRate \num MaxPosDeviation \num MaxSpeedDeviation"
_FRAME = r"\tooldata Tool \wobjdata WObj \loaddata TLoad"
_ENDS = r"\num CondTime \num RampInTime \num RampOutTime"


def _signals(kind: str) -> str:
    return " ".join(rf"\signal{kind} {kind}R{place}{axis}" for place in (1,) for axis in ("x", "y", "z", "rx", "ry", "rz"))


def _each(kind: str, names: tuple[str, ...]) -> str:
    return " ".join(rf"\{kind} {name}" for name in names)


ROUTINES = (
    LibraryRoutine("PROC EGMGetId(INOUT egmident EGMid)", _get_id, task=True),
    LibraryRoutine("PROC EGMReset(INOUT egmident EGMid)", _reset, True, task=True),
    LibraryRoutine(rf"{_ENTRY.format(source='UC')}, string UCDevice {_MODE} \num CommTimeout)", _set_up("UC"), True),
    LibraryRoutine(rf"{_ENTRY.format(source='LTAPP')}, string Device {_MODE})", _set_up("LTAPP"), True),
    LibraryRoutine(rf"{_ENTRY.format(source='AI')} {_MODE} {_signals('ai')})", _set_up("AI"), True),
    LibraryRoutine(rf"{_ENTRY.format(source='AO')} {_MODE} {_signals('ao')})", _set_up("AO"), True),
    LibraryRoutine(rf"{_ENTRY.format(source='GI')} {_MODE} {_signals('gi')})", _set_up("GI"), True),
    LibraryRoutine(
        rf"PROC EGMActJoint(INOUT egmident EGMid \switch StreamStart {_FRAME} {_each('egm_minmax', _JOINTS)} {_LIMITS})", _act_joint, True
    ),
    LibraryRoutine(
        rf"PROC EGMActPose(INOUT egmident EGMid \switch StreamStart {_FRAME}, pose CorrFrame, egmframetype CorrFrType, pose SensorFrame,"
        rf" egmframetype SensorFrType {_each('egm_minmax', _DIRECTIONS)} {_LIMITS})",
        _act_pose,
        True,
    ),
    LibraryRoutine(r"PROC EGMActMove(INOUT egmident EGMid, pose SensorFrame \num SampleRate)", _act_move, True),
    LibraryRoutine(
        rf"PROC EGMRunJoint(INOUT egmident EGMid, egmstopmode Mode \switch NoWaitCond {_each('switch', _JOINTS)} {_ENDS} \num PosCorrGain)",
        _run("joint", _JOINTS),
        True,
    ),
    LibraryRoutine(
        rf"PROC EGMRunPose(INOUT egmident EGMid, egmstopmode Mode \switch NoWaitCond {_each('switch', _DIRECTIONS)} {_ENDS} \pose Offset"
        r" \num PosCorrGain)",
        _run("pose", _DIRECTIONS),
        True,
    ),
    LibraryRoutine(r"PROC EGMStop(INOUT egmident EGMid, egmstopmode Mode \num RampOutTime)", _stop, True),
    LibraryRoutine(r"PROC EGMStreamStart(INOUT egmident EGMid \num SampleRate)", _stream(on=True), True),
    LibraryRoutine("PROC EGMStreamStop(INOUT egmident EGMid)", _stream(on=False), True),
    LibraryRoutine("FUNC egmstate EGMGetState(INOUT egmident EGMid)", _state, True),
    LibraryRoutine(
        r"PROC EGMMoveL(INOUT egmident EGMid, robtarget ToPoint, speeddata Speed, zonedata Zone, tooldata Tool \wobjdata WObj"
        r" \loaddata TLoad \switch NoCorr)",
        _guided(move_l, 1),
        True,
    ),
    LibraryRoutine(
        r"PROC EGMMoveC(INOUT egmident EGMid, robtarget CirPoint, robtarget ToPoint, speeddata Speed, zonedata Zone, tooldata Tool"
        r" \wobjdata WObj \loaddata TLoad \switch NoCorr)",
        _guided(move_c, 2),
        True,
    ),
    LibraryRoutine("PROC CorrCon(INOUT corrdescr Descr)", _connect, task=True),
    LibraryRoutine("PROC CorrWrite(INOUT corrdescr Descr, pos Data)", _write, True, task=True),
    LibraryRoutine("PROC CorrDiscon(INOUT corrdescr Descr)", _disconnect, True, task=True),
    LibraryRoutine("PROC CorrClear()", _clear, True, task=True),
    LibraryRoutine("FUNC pos CorrRead()", _total, task=True),
    LibraryRoutine(
        r"PROC MoveExtJ(\switch Conc, jointtarget ToJointPos \identno ID \switch UseEOffs, speeddata Speed \num T, zonedata Zone"
        r" \stoppointdata Inpos)",
        _move_units,
        True,
    ),
)
