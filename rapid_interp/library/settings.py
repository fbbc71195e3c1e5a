"""Settings of motion, and stopping and starting it.

Invariant: each yields exactly one effect; what it means for the robot is the controller's.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from rapid_interp import effects as fx
from rapid_interp.data import ExtJoint, Pose, RobTarget, ToolData, WObjData
from rapid_interp.effects import SourceLine
from rapid_interp.library.poses import multiply, rotate
from rapid_interp.library.table import Effects, LibraryRoutine, record_told
from rapid_interp.meaning.types import Value
from rapid_interp.running.values import Fault, Reference, error_number, to_record

if TYPE_CHECKING:
    from collections.abc import Callable

    from rapid_interp.running.task import Stepper

NO_DISPLACEMENT: Value = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
NO_OFFSETS: Value = (0.0,) * 6
_UNUSED = 8.9e9


def _acc_set(at: SourceLine, acceleration: float, ramp: float, fine_point_ramp: float | None) -> Effects:
    """ASSUMPTION A-44: values outside of 20 to 100 per cent (ramp: 10 to 100) are brought to the nearest limit."""
    yield fx.SetAcceleration(
        at, min(max(acceleration, 20.0), 100.0), min(max(ramp, 10.0), 100.0), 100.0 if fine_point_ramp is None else fine_point_ramp
    )


def _vel_set(at: SourceLine, override: float, most: float) -> Effects:
    if override <= 0 or most <= 0:
        raise Fault(f"VelSet needs positive values, found {override:g} and {most:g}", "RAPID-R312")
    yield fx.SetVelocity(at, override, most)


def _path_acc_lim(at: SourceLine, limited: bool, most: float | None, slowing: bool, most_slowing: float | None) -> Effects:
    for wanted, value, name in ((limited, most, "AccMax"), (slowing, most_slowing, "DecelMax")):
        if wanted and (value is None or value <= 0):
            raise Fault(f"PathAccLim needs a positive \\{name}", "RAPID-R312")
    yield fx.LimitPathAcceleration(at, most if limited else None, most_slowing if slowing else None)


def _speed_refresh(at: SourceLine, override: float) -> Effects:
    if not 0 <= override <= 100:
        message = f"SpeedRefresh needs 0 to 100 per cent, found {override:g}"
        raise Fault(message, "RAPID-R312", number=error_number("ERR_SPEED_REFRESH_LIM"))
    yield fx.RefreshSpeed(at, override)


_CIRCLE_MODES = ("PathFrame", "ObjectFrame", "CirPointOri", "Wrist45", "Wrist46", "Wrist56")


def _circle_mode(at: SourceLine, *chosen: bool) -> Effects:
    yield fx.SetCirclePathMode(at, next((mode for mode, on in zip(_CIRCLE_MODES, chosen, strict=True) if on), "PathFrame"))


def _sing_area(task: Stepper, at: SourceLine, wrist: bool, lock: bool, _off: bool) -> Effects:
    mode = "wrist" if wrist else "lock_axis_4" if lock else "off"
    if mode != task.singularity:
        task.singularity = mode
        yield fx.SetSingularity(at, mode)


def _displace(task: Stepper, at: SourceLine, displacement: Value) -> Effects:
    task.displacement = displacement
    yield fx.SetDisplacement(at, cast(Pose, to_record("pose", displacement)))


def _pdisp_on(task: Stepper, at: SourceLine, turned: bool, reached: Value, programmed: Value, tool: Value, wobj: Value) -> Effects:
    r"""The displacement takes the programmed point to `\ExeP`, or to where the TCP is; with `\Rot` its orientation too."""
    if reached is None:
        question = fx.ReadTarget(at, cast(ToolData, to_record("tooldata", tool)), _wobj(wobj))
        reached = record_told((yield question), RobTarget, "position")
        if task.displacement != NO_DISPLACEMENT:
            reached = _moved(task.displacement, reached)
    (ax, ay, az), (bx, by, bz) = reached[0], programmed[0]
    if not turned:
        yield from _displace(task, at, ((ax - bx, ay - by, az - bz), (1.0, 0.0, 0.0, 0.0)))
        return
    w, x, y, z = programmed[1]
    turn = multiply(reached[1], (w, -x, -y, -z))
    cx, cy, cz = rotate(turn, programmed[0])
    yield from _displace(task, at, ((ax - cx, ay - cy, az - cz), turn))


def _moved(displacement: Value, target: Value) -> Value:
    x, y, z = rotate(displacement[1], target[0])
    dx, dy, dz = displacement[0]
    return ((x + dx, y + dy, z + dz), multiply(displacement[1], target[1]), *target[2:])


def _orobt(task: Stepper, target: Value, in_displacement: bool, in_offsets: bool) -> Value:
    r"""ASSUMPTION A-45: the target without displacement and offsets, unless `\InPDisp` or `\InEOffs` keep the one or the other."""
    found = target if in_displacement else _moved(task.displacement, target)
    if in_offsets:
        return found
    return (*found[:3], tuple(value if value > _UNUSED else value + off for value, off in zip(found[3], task.offsets, strict=True)))


def _offset(task: Stepper, at: SourceLine, offsets: Value) -> Effects:
    task.offsets = offsets
    yield fx.SetAxisOffsets(at, cast(ExtJoint, to_record("extjoint", offsets)))


def _eoffs_on(task: Stepper, at: SourceLine, reached: Value, programmed: Value) -> Effects:
    if reached is None:
        reached = record_told((yield fx.ReadTarget(at)), RobTarget, "position")
    pairs = zip(reached[3], programmed[3], strict=True)
    yield from _offset(task, at, tuple(0.0 if max(a, b) > _UNUSED else a - b for a, b in pairs))


def _wobj(value: Value) -> WObjData | None:
    return None if value is None else cast(WObjData, to_record("wobjdata", value))


def _wait_wobj(at: SourceLine, wobj: Value, distance: float | None, max_time: float | None, flag: Reference | None) -> Effects:
    try:
        yield fx.WaitWorkObject(at, cast(WObjData, to_record("wobjdata", wobj)), distance or 0.0, max_time)
    except Fault as fault:
        if flag is None or fault.number != error_number("ERR_WAIT_MAXTIME"):
            raise
        flag.put(True)
        return
    if flag is not None:
        flag.put(False)


def _drop_wobj(at: SourceLine, wobj: Value) -> Effects:
    yield fx.DropWorkObject(at, cast(WObjData, to_record("wobjdata", wobj)))


def _soft_act(at: SourceLine, unit: str | None, axis: float, softness: float, ramp: float | None) -> Effects:
    yield fx.SetSoftness(at, int(axis), softness, 100.0 if ramp is None else ramp, unit or "")


def _soft_deact(at: SourceLine, ramp: float | None) -> Effects:
    yield fx.SetSoftness(at, None, 0.0, 100.0 if ramp is None else ramp)


def _stop_move(task: Stepper, at: SourceLine, quick: bool, _all: bool) -> Effects:
    task.stopped_motion = True
    yield fx.StopMotion(at, quick)


def _world_acc_lim(at: SourceLine, most: float | None, _off: bool) -> Effects:
    yield fx.LimitWorldAcceleration(at, most)


def _start_move(task: Stepper, at: SourceLine, *_: Value) -> Effects:
    task.stopped_motion = False
    yield fx.StartMotion(at)


def _reset_stop(task: Stepper, at: SourceLine, *_: Value) -> Effects:
    task.stopped_motion = False
    yield fx.ClearMotion(at)


def _store(task: Stepper, at: SourceLine, *_: Value) -> Effects:
    task.stored_paths += 1
    yield fx.StoreMotion(at)


def _restore(task: Stepper, at: SourceLine) -> Effects:
    task.stored_paths = max(0, task.stored_paths - 1)
    yield fx.RestoreMotion(at)


def _plain(effect: Callable[[SourceLine], fx.Effect]) -> Callable[..., Effects]:
    def run(at: SourceLine, *_: Value) -> Effects:
        yield effect(at)

    return run


ROUTINES = (
    LibraryRoutine(r"PROC AccSet(num Acc, num Ramp \num FinePointRamp)", _acc_set, True),
    LibraryRoutine("PROC VelSet(num Override, num Max)", _vel_set, True),
    LibraryRoutine(r"PROC PathAccLim(bool AccLim \num AccMax, bool DecelLim \num DecelMax)", _path_acc_lim, True),
    LibraryRoutine(r"PROC WorldAccLim(\num On | switch Off)", _world_acc_lim, True),
    LibraryRoutine("PROC SpeedRefresh(num Override)", _speed_refresh, True),
    LibraryRoutine(f"PROC CirPathMode({' | '.join(f'{chr(92)}switch {mode}' for mode in _CIRCLE_MODES)})", _circle_mode, True),
    LibraryRoutine(r"PROC SingArea(\switch Wrist | switch LockAxis4 | switch Off)", _sing_area, True, task=True),
    LibraryRoutine(
        r"PROC PDispOn(\switch Rot \robtarget ExeP, robtarget ProgPoint, tooldata Tool \wobjdata WObj)", _pdisp_on, True, task=True
    ),
    LibraryRoutine("PROC PDispSet(pose DispFrame)", _displace, True, task=True),
    LibraryRoutine("PROC PDispOff()", lambda task, at: _displace(task, at, NO_DISPLACEMENT), True, task=True),
    LibraryRoutine(r"PROC EOffsOn(\robtarget ExeP, robtarget ProgPoint)", _eoffs_on, True, task=True),
    LibraryRoutine("PROC EOffsSet(extjoint EAxOffs)", _offset, True, task=True),
    LibraryRoutine("PROC EOffsOff()", lambda task, at: _offset(task, at, NO_OFFSETS), True, task=True),
    LibraryRoutine(r"FUNC robtarget ORobT(robtarget OrgPoint \switch InPDisp | switch InEOffs)", _orobt, task=True),
    LibraryRoutine(r"PROC SoftAct(\mecunit MechUnit, num Axis, num Softness \num Ramp)", _soft_act, True),
    LibraryRoutine(r"PROC SoftDeact(\num Ramp)", _soft_deact, True),
    LibraryRoutine(r"PROC StopMove(\switch Quick \switch AllMotionTasks)", _stop_move, True, task=True),
    LibraryRoutine(r"PROC StartMove(\switch AllMotionTasks)", _start_move, True, task=True),
    LibraryRoutine(r"PROC StartMoveRetry()", _start_move, True, task=True),
    LibraryRoutine(r"PROC StopMoveReset(\switch AllMotionTasks)", _reset_stop, True, task=True),
    LibraryRoutine("PROC ClearPath()", _plain(fx.ClearMotion), True),
    LibraryRoutine(r"PROC StorePath(\switch KeepSync)", _store, True, task=True),
    LibraryRoutine("PROC RestoPath()", _restore, True, task=True),
    LibraryRoutine(r"PROC WaitWObj(wobjdata WObj \num RelDist \num MaxTime \INOUT bool TimeFlag)", _wait_wobj, True),
    LibraryRoutine("PROC DropWObj(wobjdata WObj)", _drop_wobj, True),
)
