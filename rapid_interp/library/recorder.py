"""The path recorder: going back along the moves that were made, and forth again.

Invariant: a path is what `Recorder` noted; moving back and forth yields ordinary moves, which are not noted again.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, cast

from rapid_interp import effects as fx
from rapid_interp.data import Pos, RobTarget, SpeedData, ZoneData
from rapid_interp.effects import Motion, SourceLine
from rapid_interp.library.poses import normalised, rotate
from rapid_interp.library.table import Effects, LibraryRoutine, record_told
from rapid_interp.meaning.types import Value
from rapid_interp.running.recorder import Recorder
from rapid_interp.running.values import Fault, Reference, error_number, from_record, robtarget, to_record

if TYPE_CHECKING:
    from rapid_interp.running.task import Stepper


def _start(task: Stepper, at: SourceLine, identity: Reference) -> Effects:
    recorder = task.recorder
    if recorder is None:
        start = record_told((yield fx.ReadTarget(at)), RobTarget, "position")
        recorder = task.recorder = Recorder(robtarget(start))
    recorder.records = True
    identity.put(recorder.mark())


def _stop(task: Stepper, clear: bool) -> None:
    if clear:
        task.recorder = None
    elif task.recorder is not None:
        task.recorder.records = False


def _recorder(task: Stepper) -> Recorder:
    if task.recorder is None:
        raise Fault("no path is recorded: PathRecStart comes first", "RAPID-R354", number=error_number("ERR_ARGVALERR"))
    return task.recorder


def _moved(target: RobTarget, offset: Value) -> RobTarget:
    if offset is None:
        return target
    x, y, z = rotate(normalised(from_record(target.rot)), offset)
    return replace(target, trans=Pos(target.trans.x + x, target.trans.y + y, target.trans.z + z))


def _varied(move: Motion, at: SourceLine, offset: Value, speed: Value, *, last: bool) -> Motion:
    found = replace(move, at=at)
    if not isinstance(found, fx.MoveAbsJ):
        found = replace(found, target=_moved(found.target, offset))
        if isinstance(found, fx.MoveC):
            found = replace(found, via=_moved(found.via, offset))
    if speed is not None:
        found = replace(found, speed=cast(SpeedData, to_record("speeddata", speed)), tcp_speed=None, duration=None)
    return replace(found, zone=ZoneData(finep=True)) if last else found


def _along(task: Stepper, at: SourceLine, moves: list[Motion], offset: Value, speed: Value) -> Effects:
    recorder = _recorder(task)
    recorded, recorder.records = recorder.records, False
    for place, move in enumerate(moves, start=1):
        yield _varied(move, at, offset, speed, last=place == len(moves))
    recorder.records = recorded


def _backward(task: Stepper, at: SourceLine, identity: float | None, offset: Value, speed: Value) -> Effects:
    yield from _along(task, at, _recorder(task).back_to(identity), offset, speed)


def _forward(task: Stepper, at: SourceLine, identity: float | None, offset: Value, speed: Value) -> Effects:
    yield from _along(task, at, _recorder(task).on_to(identity), offset, speed)


_WHERE = r"\pathrecid ID \pos ToolOffs \speeddata Speed"
ROUTINES = (
    LibraryRoutine("PROC PathRecStart(INOUT pathrecid ID)", _start, True, task=True),
    LibraryRoutine(r"PROC PathRecStop(\switch Clear)", _stop, task=True),
    LibraryRoutine(rf"PROC PathRecMoveBwd({_WHERE})", _backward, True, task=True),
    LibraryRoutine(rf"PROC PathRecMoveFwd({_WHERE})", _forward, True, task=True),
    LibraryRoutine(
        r"FUNC bool PathRecValidBwd(\pathrecid ID)",
        lambda task, mark: task.recorder is not None and task.recorder.goes_back(mark),
        task=True,
    ),
    LibraryRoutine(
        r"FUNC bool PathRecValidFwd(\pathrecid ID)", lambda task, mark: task.recorder is not None and task.recorder.goes_on(mark), task=True
    ),
)
