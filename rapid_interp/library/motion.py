r"""Motion instructions.

Invariant: each yields exactly one effect that holds all it needs; nothing here knows what was moved before.
"""

from __future__ import annotations

import math
from typing import Any, TypedDict, cast

from rapid_interp.data import JointTarget as JointTargetData
from rapid_interp.data import SpeedData, ToolData, WObjData, ZoneData
from rapid_interp.effects import MoveAbsJ, MoveC, MoveJ, MoveL, SetConfiguration, SourceLine, Wait
from rapid_interp.library.table import Effects, LibraryRoutine
from rapid_interp.meaning.predefined import DATA
from rapid_interp.meaning.types import Value
from rapid_interp.running.values import Fault, robtarget, to_record

ORIENTATION_TOLERANCE = 0.1
"""ASSUMPTION A-29: a quaternion whose length is further from 1 is refused (`VAR pose p;` without value is all zeros)."""

_WOBJ0 = DATA["wobj0"][2]
_COMMON = r"speeddata Speed \num V | num T, zonedata Zone"
_INPOS = r"\stoppointdata Inpos"
_TOOL = r"tooldata Tool \wobjdata WObj"


class _Common(TypedDict):
    at: SourceLine
    speed: SpeedData
    zone: ZoneData
    tool: ToolData
    wobj: WObjData
    tcp_speed: float | None
    duration: float | None
    zone_mm: float | None


def _common(
    at: SourceLine, speed: Value, zone: Value, tool: Value, wobj: Value, tcp_speed: Value, duration: Value, zone_mm: Value, inpos: Value
) -> _Common:
    if tcp_speed is not None and tcp_speed <= 0:
        raise Fault(f"\\V must be positive, found {tcp_speed:g}", "RAPID-R310")
    if duration is not None and duration <= 0:
        raise Fault(f"\\T must be positive, found {duration:g}", "RAPID-R310")
    zone_data = ZoneData(finep=True) if inpos is not None else cast(ZoneData, to_record("zonedata", zone))
    tool_data = cast(ToolData, to_record("tooldata", tool))
    wobj_data = cast(WObjData, to_record("wobjdata", _WOBJ0 if wobj is None else wobj))
    _orientation(tool[1][1], "the tool frame")
    for frame, name in ((3, "user frame"), (4, "object frame")):
        if wobj is not None:
            _orientation(wobj[frame][1], f"the work object's {name}")
    return _Common(
        at=at,
        speed=cast(SpeedData, to_record("speeddata", speed)),
        zone=zone_data,
        tool=tool_data,
        wobj=wobj_data,
        tcp_speed=tcp_speed,
        duration=duration,
        zone_mm=zone_mm,
    )


def _orientation(rot: Value, owner: str) -> None:
    length = math.sqrt(sum(part * part for part in rot))
    if abs(length - 1.0) > ORIENTATION_TOLERANCE:
        raise Fault(f"the orientation of {owner} is no unit quaternion: [{','.join(f'{part:g}' for part in rot)}]", "RAPID-R311")


def move_absj(
    at: SourceLine, _conc: bool, target: Value, _id: Value, _eoffs: bool,
    speed: Value, v: Value, t: Value, zone: Value, z: Value, inpos: Value, tool: Value, wobj: Value, _load: Value,
) -> Effects:  # fmt: skip
    """Yields the MoveAbsJ of its arguments."""
    common = _common(at, speed, zone, tool, wobj, v, t, z, inpos)
    yield MoveAbsJ(target=cast(JointTargetData, to_record("jointtarget", target)), **common)


def move_j(
    at: SourceLine, _conc: bool, target: Value, _id: Value,
    speed: Value, v: Value, t: Value, zone: Value, z: Value, inpos: Value, tool: Value, wobj: Value, _load: Value,
) -> Effects:  # fmt: skip
    """Yields the MoveJ of its arguments."""
    common = _common(at, speed, zone, tool, wobj, v, t, z, inpos)
    _orientation(target[1], "the target")
    yield MoveJ(target=robtarget(target), **common)


def move_l(
    at: SourceLine, _conc: bool, target: Value, _id: Value,
    speed: Value, v: Value, t: Value, zone: Value, z: Value, inpos: Value, tool: Value, wobj: Value, corr: bool, _load: Value,
) -> Effects:  # fmt: skip
    """Yields the MoveL of its arguments."""
    common = _common(at, speed, zone, tool, wobj, v, t, z, inpos)
    _orientation(target[1], "the target")
    yield MoveL(target=robtarget(target), corrected=corr, **common)


def move_c(
    at: SourceLine, _conc: bool, via: Value, target: Value, _id: Value,
    speed: Value, v: Value, t: Value, zone: Value, z: Value, inpos: Value, tool: Value, wobj: Value, corr: bool, _load: Value,
) -> Effects:  # fmt: skip
    """Yields the MoveC of its arguments."""
    common = _common(at, speed, zone, tool, wobj, v, t, z, inpos)
    _orientation(via[1], "the circle point")
    _orientation(target[1], "the target")
    yield MoveC(via=robtarget(via), target=robtarget(target), corrected=corr, **common)


def _configuration(*, joint_moves: bool) -> Any:  # noqa: ANN401 - a generator function for the table
    def run(at: SourceLine, on: bool, off: bool) -> Effects:
        yield SetConfiguration(at, joint_moves=joint_moves, on=on or not off)

    return run


_HEAD = rf"{_COMMON} \num Z {_INPOS}, {_TOOL}"


def _wait_rob(at: SourceLine, _in_position: bool, _zero_speed: bool) -> Effects:
    yield Wait(at, 0.0, in_position=True)


ROUTINES = (
    LibraryRoutine(r"PROC WaitRob(\switch InPos | switch ZeroSpeed)", _wait_rob, True),
    LibraryRoutine(
        rf"PROC MoveAbsJ(\switch Conc, jointtarget ToJointPos \identno ID \switch NoEOffs, {_HEAD} \loaddata TLoad)", move_absj, True
    ),
    LibraryRoutine(rf"PROC MoveJ(\switch Conc, robtarget ToPoint \identno ID, {_HEAD} \loaddata TLoad)", move_j, True),
    LibraryRoutine(rf"PROC MoveL(\switch Conc, robtarget ToPoint \identno ID, {_HEAD} \switch Corr \loaddata TLoad)", move_l, True),
    LibraryRoutine(
        rf"PROC MoveC(\switch Conc, robtarget CirPoint, robtarget ToPoint \identno ID, {_HEAD} \switch Corr \loaddata TLoad)", move_c, True
    ),
    LibraryRoutine(r"PROC ConfL(\switch On | switch Off)", _configuration(joint_moves=False), True),
    LibraryRoutine(r"PROC ConfJ(\switch On | switch Off)", _configuration(joint_moves=True), True),
)
