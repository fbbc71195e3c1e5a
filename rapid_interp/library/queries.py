"""What a program asks about its controller, its task and its robot, and what it sets of it.

Invariant: nothing is answered from the machine that the interpreter runs on.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, cast

from rapid_interp import effects as fx
from rapid_interp.data import LoadData, ToolData, WObjData
from rapid_interp.effects import SourceLine
from rapid_interp.library.table import Effects, LibraryRoutine, number_told, record_told, text_told
from rapid_interp.meaning.types import RapidType, Value
from rapid_interp.running.values import Fault, Reference, error_number, to_record

if TYPE_CHECKING:
    from rapid_interp.running.task import Stepper

MEMORY_FREE, DISK_SIZE, DISK_FREE = 100e6, 1e9, 500e6
"""ASSUMPTION A-179: bytes of program memory and of disk that a program is told; it has that much and more."""
_UNIT, _AXES = "ROB_1", 6.0
_ASKED = ("SerialNo", "SWVersion", "RobotType", "CtrlId", "LanIp", "CtrlLang", "SystemName")


def _always(value: Value) -> Callable[..., Value]:
    return lambda *_: value


def _override(at: SourceLine, _task: bool) -> Effects:
    return number_told((yield fx.ReadSpeedOverride(at)), "speed override")


def _system(at: SourceLine, *chosen: bool) -> Effects:
    what = next((name for name, on in zip(_ASKED, chosen, strict=True) if on), "SerialNo")
    return text_told((yield fx.ReadSystem(at, what)), what)[:80]


def _is_system(at: SourceLine, identity: str) -> Effects:
    return text_told((yield fx.ReadSystem(at, "SerialNo")), "SerialNo") == identity


def _active(task: Stepper, unit: str) -> bool:
    return task.units.get(unit.lower(), unit.upper().startswith("ROB"))


def _next_unit(
    number: Reference,
    name: Reference,
    mec_ref: tuple[RapidType, Reference] | None,
    robot: Reference | None,
    axes: Reference | None,
    *_: Value,
) -> bool:
    """The robot is the only mechanical unit that a program sees."""
    unit = None
    if mec_ref is not None:
        kind, unit = mec_ref
        if kind.name != "mecunit":
            raise Fault(f"\\MecRef of GetNextMechUnit is a mecunit, found {kind.name}", "RAPID-R356", number=error_number("ERR_ARGVALERR"))
    if number.get() != 0:
        return False
    number.put(1.0)
    for reference, value in ((name, _UNIT), (unit, _UNIT), (robot, True), (axes, _AXES)):
        if reference is not None:
            reference.put(value)
    return True


def _get_system_data(
    task: Stepper, at: SourceLine, _ref: Value, _name: Value, target: tuple[RapidType, Reference], object_name: Reference | None
) -> Effects:
    kind = target[0].name
    if kind == "tooldata":
        value = record_told((yield fx.ReadTool(at)), ToolData, "tool")
    elif kind == "wobjdata":
        value = record_told((yield fx.ReadWorkObject(at)), WObjData, "work object")
    elif kind == "loaddata":
        value = task.load
    else:
        raise Fault(f"GetSysData gives tooldata, wobjdata or loaddata, not {kind}", "RAPID-R356")
    target[1].put(value)
    if object_name is not None:
        object_name.put("")


def _set_system_data(task: Stepper, at: SourceLine, typed: tuple[RapidType, Value], _name: Value) -> Effects:
    kind, value = typed[0].name, typed[1]
    if kind == "loaddata":
        task.load = value
        yield fx.SetLoad(at, cast(LoadData, to_record(kind, value)))
    elif kind == "tooldata":
        yield fx.SetActive(at, tool=cast(ToolData, to_record(kind, value)))
    elif kind == "wobjdata":
        yield fx.SetActive(at, wobj=cast(WObjData, to_record(kind, value)))
    else:
        raise Fault(f"SetSysData takes tooldata, wobjdata or loaddata, not {kind}", "RAPID-R356")


def _grip_load(task: Stepper, at: SourceLine, load: Value) -> Effects:
    task.load = load
    yield fx.SetLoad(at, cast(LoadData, to_record("loaddata", load)))


def _unit(*, active: bool) -> Callable[..., Effects]:
    def run(task: Stepper, at: SourceLine, unit: Value) -> Effects:
        task.units[str(unit or "").lower()] = active
        yield fx.ActivateUnit(at, str(unit or ""), active)

    return run


def _size(_name: str, _total: bool, free: bool) -> float:
    return DISK_FREE if free else DISK_SIZE


def _is_mine(task: Stepper, name: str) -> bool:
    return name.lower() == task.name.lower()


_SYSTEM = " | ".join(rf"\switch {name}" for name in _ASKED)
ROUTINES = (
    LibraryRoutine(r"FUNC num CSpeedOverride(\switch CTask)", _override, True),
    LibraryRoutine(f"FUNC string GetSysInfo({_SYSTEM})", _system, True),
    LibraryRoutine("FUNC bool IsSysId(string SystemId)", _is_system, True),
    LibraryRoutine("FUNC bool IsMechUnitActive(mecunit MechUnit)", _active, task=True),
    LibraryRoutine("FUNC string GetMecUnitName(mecunit MechUnit)", str),
    LibraryRoutine(
        r"FUNC bool GetNextMechUnit(INOUT num ListNumber, INOUT string UnitName \INOUT anydata MecRef \INOUT bool TCPRob"
        r" \INOUT num NoOfAxes \INOUT num MecTaskNo \INOUT num MotPlanNo \INOUT bool Active \INOUT num DriveModule \INOUT num OKToDeact)",
        _next_unit,
    ),
    LibraryRoutine(
        r"PROC GetSysData(\taskid TaskRef | string TaskName, INOUT anydata DestObject \INOUT string ObjectName)",
        _get_system_data,
        True,
        task=True,
    ),
    LibraryRoutine(r"PROC SetSysData(anytype SourceObject \string ObjectName)", _set_system_data, True, task=True),
    LibraryRoutine("PROC GripLoad(loaddata Load)", _grip_load, True, task=True),
    LibraryRoutine("PROC ActUnit(mecunit MechUnit)", _unit(active=True), True, task=True),
    LibraryRoutine("PROC DeactUnit(mecunit MechUnit)", _unit(active=False), True, task=True),
    LibraryRoutine(
        r"FUNC bool IsStopMoveAct(\switch FromMoveTask | switch FromNonMoveTask)", lambda task, *_: task.stopped_motion, task=True
    ),
    LibraryRoutine("FUNC num PathLevel()", lambda task: 1.0 + task.stored_paths, task=True),
    LibraryRoutine("FUNC num ExecLevel()", lambda task: float(task.interrupts.in_trap), task=True),
    LibraryRoutine("FUNC bool TaskIsActive(string TaskName)", _is_mine, task=True),
    LibraryRoutine("FUNC bool TaskIsExecuting(string TaskName)", _is_mine, task=True),
    LibraryRoutine("FUNC bool UIClientExist()", _always(True)),
    LibraryRoutine(r"FUNC bool PFRestart(\switch Base | switch Irpt)", _always(False)),
    LibraryRoutine("FUNC bool PPMovedInManMode()", _always(False)),
    LibraryRoutine(r"FUNC bool IsStopStateEvent(\switch PPMoved | switch PPToMain)", _always(False)),
    LibraryRoutine("FUNC bool IsBrakeCheckActive()", _always(False)),
    LibraryRoutine(r"FUNC bool IsLeadThrough(\mecunit MechUnit)", _always(False)),
    LibraryRoutine("FUNC bool IsSyncMoveOn()", _always(False)),
    LibraryRoutine("FUNC num MotionPlannerNo()", _always(1.0)),
    LibraryRoutine("FUNC num ProgMemFree()", _always(MEMORY_FREE)),
    LibraryRoutine(r"FUNC num FSSize(string Name \switch Total | switch Free)", _size),
)
