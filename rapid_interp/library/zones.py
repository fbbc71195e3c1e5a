"""World zones.

Invariant: a shape is a `Shape` of `effects`; a zone is the number that the task gave it, 0 before it is defined.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, cast

from rapid_interp import effects as fx
from rapid_interp.data import JointTarget, Pos
from rapid_interp.effects import SourceLine
from rapid_interp.library.signals import signal_name
from rapid_interp.library.table import Effects, LibraryRoutine
from rapid_interp.meaning.types import RapidType, Value
from rapid_interp.running.values import Fault, Reference, error_number, to_record

if TYPE_CHECKING:
    from rapid_interp.running.task import Stepper

MOST_ZONES = 20
"""ASSUMPTION A-174: a controller has 20 world zones."""
SMALLEST_MM = 10.0
"""ASSUMPTION A-175: sides and radii of zones are at least 10 mm."""
_UNUSED = 8.9e9


def _wrong(message: str) -> Fault:
    return Fault(message, "RAPID-R346", number=error_number("ERR_ARGVALERR"))


def _pos(value: Value) -> Pos:
    return cast(Pos, to_record("pos", value))


def _joints(value: Value) -> JointTarget:
    return cast(JointTarget, to_record("jointtarget", value))


def _box(inside: bool, outside: bool, shape: Reference, one: Value, other: Value) -> None:
    low, high = (tuple(pick(a, b) for a, b in zip(one, other, strict=True)) for pick in (min, max))
    if any(b - a < SMALLEST_MM for a, b in zip(low, high, strict=True)):
        raise _wrong(f"a world zone has sides of at least {SMALLEST_MM:g} mm")
    shape.put(fx.BoxShape(_pos(low), _pos(high), inside or not outside))


def _sphere(inside: bool, outside: bool, shape: Reference, centre: Value, radius: float) -> None:
    if radius < SMALLEST_MM:
        raise _wrong(f"a world zone has a radius of at least {SMALLEST_MM:g} mm, found {radius:g}")
    shape.put(fx.SphereShape(_pos(centre), radius, inside or not outside))


def _cylinder(inside: bool, outside: bool, shape: Reference, centre: Value, radius: float, height: float) -> None:
    if radius < SMALLEST_MM or abs(height) < SMALLEST_MM:
        raise _wrong(f"a world zone is at least {SMALLEST_MM:g} mm large, found radius {radius:g} and height {height:g}")
    shape.put(fx.CylinderShape(_pos(centre), radius, height, inside or not outside))


def _home(inside: bool, outside: bool, shape: Reference, middle: Value, delta: Value) -> None:
    low, high = (
        tuple(
            tuple(9e9 if max(a, b) > _UNUSED else a + sign * b for a, b in zip(one, other, strict=True))
            for one, other in zip(middle, delta, strict=True)
        )
        for sign in (-1, 1)
    )
    shape.put(fx.JointShape(_joints(low), _joints(high), inside or not outside))


def _limits(inside: bool, outside: bool, shape: Reference, low: Value, high: Value) -> None:
    shape.put(fx.JointShape(_joints(low), _joints(high), inside or not outside))


def _defined(task: Stepper, zone: tuple[RapidType, Reference], shape: Value) -> int:
    if zone[0].name not in ("wztemporary", "wzstationary"):
        raise _wrong(f"a world zone is kept in a wztemporary or wzstationary, not in {zone[0].name}")
    if shape is None:
        raise _wrong("the shape of the world zone has not been defined")
    if zone[1].get():
        raise _wrong("the world zone is in use already")
    task.zones += 1
    if task.zones > MOST_ZONES:
        raise _wrong(f"more than {MOST_ZONES} world zones")
    zone[1].put(float(task.zones))
    return task.zones


def _supervise(task: Stepper, at: SourceLine, _temp: bool, stationary: bool, zone: tuple[RapidType, Reference], shape: Value) -> Effects:
    yield fx.SuperviseZone(at, _defined(task, zone, shape), shape, stationary=stationary)


def _output(
    task: Stepper, at: SourceLine, _temp: bool, stationary: bool, zone: tuple[RapidType, Reference], _inside: bool, before: bool,
    shape: Value, signal: Value, value: float,
) -> Effects:  # fmt: skip
    number = _defined(task, zone, shape)
    yield fx.SuperviseZone(at, number, shape, signal_name(signal), float(bool(value)), before, stationary)


def _known(zone: Reference) -> int:
    if not zone.get():
        raise _wrong("the world zone has not been defined")
    return int(zone.get())


def _switch(*, on: bool) -> Callable[..., Effects]:
    def run(at: SourceLine, zone: Reference) -> Effects:
        yield fx.SwitchZone(at, _known(zone), on)

    return run


def _free(at: SourceLine, zone: Reference) -> Effects:
    yield fx.FreeZone(at, _known(zone))
    zone.put(0.0)


_SIDE = r"\switch Inside | switch Outside, INOUT shapedata Shape"
_KIND = r"\switch Temp | switch Stat, INOUT anydata WorldZone"
ROUTINES = (
    LibraryRoutine(rf"PROC WZBoxDef({_SIDE}, pos LowPoint, pos HighPoint)", _box),
    LibraryRoutine(rf"PROC WZSphDef({_SIDE}, pos CentrePoint, num Radius)", _sphere),
    LibraryRoutine(rf"PROC WZCylDef({_SIDE}, pos CentrePoint, num Radius, num Height)", _cylinder),
    LibraryRoutine(rf"PROC WZHomeJointDef({_SIDE}, jointtarget MiddleJointVal, jointtarget DeltaJointVal)", _home),
    LibraryRoutine(rf"PROC WZLimJointDef({_SIDE}, jointtarget LowJointVal, jointtarget HighJointVal)", _limits),
    LibraryRoutine(rf"PROC WZLimSup({_KIND}, shapedata Shape)", _supervise, True, task=True),
    LibraryRoutine(
        rf"PROC WZDOSet({_KIND} \switch Inside | switch Before, shapedata Shape, signaldo Signal, num SetValue)", _output, True, task=True
    ),
    LibraryRoutine("PROC WZEnable(INOUT wztemporary WorldZone)", _switch(on=True), True),
    LibraryRoutine("PROC WZDisable(INOUT wztemporary WorldZone)", _switch(on=False), True),
    LibraryRoutine("PROC WZFree(INOUT wztemporary WorldZone)", _free, True),
)
