"""Where the robot is, and its kinematics: questions that only the controller can answer.

Invariant: nothing about the robot is known here.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

from rapid_interp import effects as fx
from rapid_interp.data import JointTarget, RobTarget, ToolData, WObjData
from rapid_interp.effects import SourceLine
from rapid_interp.library.table import Effects, LibraryRoutine, record_told
from rapid_interp.meaning.predefined import DATA
from rapid_interp.meaning.types import Value
from rapid_interp.running.values import Fault, Reference, robtarget, to_record

_WOBJ0 = DATA["wobj0"][2]


def _tool(value: Value) -> ToolData:
    return cast(ToolData, to_record("tooldata", value))


def _wobj(value: Value) -> WObjData:
    return cast(WObjData, to_record("wobjdata", _WOBJ0 if value is None else value))


def _target(at: SourceLine, tool: Value, wobj: Value) -> Effects:
    question = fx.ReadTarget(at, None if tool is None else _tool(tool), None if wobj is None else _wobj(wobj))
    return record_told((yield question), RobTarget, "position")


def _crobt(at: SourceLine, _name: Value, tool: Value, wobj: Value) -> Effects:
    return (yield from _target(at, tool, wobj))


def _cpos(at: SourceLine, tool: Value, wobj: Value) -> Effects:
    return (yield from _target(at, tool, wobj))[0]


def _asked(question: Callable[[SourceLine], fx.Question], wanted: type, what: str) -> Callable[..., Effects]:
    def run(at: SourceLine, *_: Value) -> Effects:
        return record_told((yield question(at)), wanted, what)

    return run


def _calc_robt(at: SourceLine, joints: Value, tool: Value, wobj: Value) -> Effects:
    question = fx.SolveForward(at, cast(JointTarget, to_record("jointtarget", joints)), _tool(tool), _wobj(wobj))
    return record_told((yield question), RobTarget, "position")


def _calc_jointt(at: SourceLine, _current: bool, target: Value, tool: Value, wobj: Value, error: Reference | None) -> Effects:
    try:
        found = record_told((yield fx.SolveInverse(at, robtarget(target), _tool(tool), _wobj(wobj))), JointTarget, "axis positions")
    except Fault as fault:
        if error is None or fault.number is None:
            raise
        error.put(fault.number)
        return ((0.0,) * 6, target[3])
    if error is not None:
        error.put(0.0)
    return found


ROUTINES = (
    LibraryRoutine(r"FUNC robtarget CRobT(\string TaskName \tooldata Tool \wobjdata WObj)", _crobt, True),
    LibraryRoutine(r"FUNC pos CPos(\tooldata Tool \wobjdata WObj)", _cpos, True),
    LibraryRoutine(r"FUNC jointtarget CJointT(\string TaskName)", _asked(fx.ReadJoints, JointTarget, "axis positions"), True),
    LibraryRoutine(r"FUNC tooldata CTool(\string TaskName)", _asked(fx.ReadTool, ToolData, "tool"), True),
    LibraryRoutine(r"FUNC wobjdata CWObj(\string TaskName)", _asked(fx.ReadWorkObject, WObjData, "work object"), True),
    LibraryRoutine(r"FUNC robtarget CalcRobT(jointtarget Joint_target, tooldata Tool \wobjdata WObj)", _calc_robt, True),
    LibraryRoutine(
        r"FUNC jointtarget CalcJointT(\switch UseCurWObjPos, robtarget Rob_target, tooldata Tool \wobjdata WObj"
        r" \INOUT errnum ErrorNumber)",
        _calc_jointt,
        True,
    ),
)
