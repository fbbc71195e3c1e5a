"""Faults that a controller under development may have, injected where such a bug would live: interpreter, planner or servo.

Invariant: a fault changes what the simulated controller does, never what is measured of it, and never the oracle.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mitl.errors import UsageError
from mitl.motion.orientation import OrientationLaw, evenly
from mitl.motion.program_run import EffectFilter
from mitl.paths import FloatArray
from rapid_interp import data, effects


@dataclass(frozen=True)
class FaultKind:
    """A kind of fault. layer: where the bug lives, "interpreter", "planner" or "servo". size: the default, in `unit`.

    One of three says what it does, given its size: a filter of effects, a law of turning, or the joints (6,) rad by which the arm is off.
    """

    name: str
    title: str
    layer: str
    unit: str
    size: float
    make_filter: Callable[[float], EffectFilter] | None = None
    make_law: Callable[[float], OrientationLaw] | None = None
    make_offset: Callable[[float], FloatArray] | None = None


@dataclass(frozen=True)
class Fault:
    """A fault of a certain size, in its kind's unit."""

    kind: FaultKind
    size: float

    def __str__(self) -> str:
        return f"{self.kind.name}={self.size:g}"


def parse_fault(text: str) -> Fault:
    """Gives the fault that `NAME` or `NAME=SIZE` means. Raises UsageError where there is none of this name or the size is no number."""
    name, equals, size = text.partition("=")
    kind = KINDS.get(name.strip())
    if kind is None:
        near = difflib.get_close_matches(name, KINDS, n=1)
        hint = f"; did you mean {near[0]}?" if near else f"; known are {', '.join(KINDS)}"
        raise UsageError(f"no fault {name!r}{hint}")
    if not equals:
        return Fault(kind, kind.size)
    try:
        value = float(size)
    except ValueError:
        value = float("nan")
    if not np.isfinite(value):
        raise UsageError(f"fault {text}: expected a number of {kind.unit} after '=', e.g. {kind.name}={kind.size:g}")
    return Fault(kind, value)


def effect_filter(faults: Sequence[Fault]) -> EffectFilter:
    """Gives one filter that applies all faults of the interpreter layer in order; make it anew for every run of a program."""
    filters = [fault.kind.make_filter(fault.size) for fault in faults if fault.kind.make_filter is not None]

    def all_of_them(effect: effects.Effect) -> effects.Effect:
        for one in filters:
            effect = one(effect)
        return effect

    return all_of_them


def orientation_law(faults: Sequence[Fault]) -> OrientationLaw:
    """Gives the law by which the planner turns the tool; the last fault of that kind decides."""
    laws = [fault.kind.make_law(fault.size) for fault in faults if fault.kind.make_law is not None]
    return laws[-1] if laws else evenly


def joint_offset(faults: Sequence[Fault]) -> FloatArray:
    """Gives by how many rad (6,) the arm's axes are off from where the controller believes them."""
    offsets = [fault.kind.make_offset(fault.size) for fault in faults if fault.kind.make_offset is not None]
    return np.asarray(np.sum([np.zeros(6), *offsets], axis=0))


def _wrong_work_object(angle_deg: float) -> EffectFilter:
    half = np.radians(angle_deg) / 2
    c, s = float(np.cos(half)), float(np.sin(half))

    def turned(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, effects.MoveJ | effects.MoveL | effects.MoveC):
            return effect
        frame = effect.wobj.uframe
        w, x, y, z = frame.rot.q1, frame.rot.q2, frame.rot.q3, frame.rot.q4
        rot = data.Orient(w * c - z * s, x * c + y * s, y * c - x * s, z * c + w * s)  # the frame turned about its own z
        return replace(effect, wobj=replace(effect.wobj, uframe=replace(frame, rot=rot)))

    return turned


def _wrong_tool(size_mm: float) -> EffectFilter:
    def longer(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, effects.MoveJ | effects.MoveL | effects.MoveC):
            return effect
        frame = effect.tool.tframe
        trans = replace(frame.trans, z=frame.trans.z + size_mm)
        return replace(effect, tool=replace(effect.tool, tframe=replace(frame, trans=trans)))

    return longer


def _axis_3_off(angle_deg: float) -> FloatArray:
    return np.array([0.0, 0.0, np.radians(angle_deg), 0.0, 0.0, 0.0])


def _shifted(target: data.RobTarget, x_mm: float) -> data.RobTarget:
    return replace(target, trans=replace(target.trans, x=target.trans.x + x_mm))


def _target_offset(size_mm: float) -> EffectFilter:
    def shifted(effect: effects.Effect) -> effects.Effect:
        match effect:
            case effects.MoveJ() | effects.MoveL():
                return replace(effect, target=_shifted(effect.target, size_mm))
            case effects.MoveC():
                return replace(effect, via=_shifted(effect.via, size_mm), target=_shifted(effect.target, size_mm))
            case _:
                return effect

    return shifted


def _axis_sign(share: float) -> EffectFilter:
    def mirrored(target: data.RobTarget) -> data.RobTarget:
        return replace(target, trans=replace(target.trans, y=(1 - 2 * share) * target.trans.y))

    def flipped(effect: effects.Effect) -> effects.Effect:
        match effect:
            case effects.MoveJ() | effects.MoveL():
                return replace(effect, target=mirrored(effect.target))
            case effects.MoveC():
                return replace(effect, via=mirrored(effect.via), target=mirrored(effect.target))
            case _:
                return effect

    return flipped


def _circle_radius(size_mm: float) -> EffectFilter:
    """Gives a filter that moves the middle of every arc outwards; it remembers where the last move ended."""
    last = data.Pos()

    def bulged(effect: effects.Effect) -> effects.Effect:
        nonlocal last
        start = last
        if isinstance(effect, effects.MoveJ | effects.MoveL | effects.MoveC):
            last = effect.target.trans
        if not isinstance(effect, effects.MoveC):
            return effect
        chord = 0.5 * (_vector(start) + _vector(effect.target.trans))
        outwards = _vector(effect.via.trans) - chord
        length = float(np.linalg.norm(outwards))
        if length < 1e-6:
            return effect
        x, y, z = (_vector(effect.via.trans) + size_mm * outwards / length).tolist()
        return replace(effect, via=replace(effect.via, trans=data.Pos(x, y, z)))

    return bulged


def _vector(position: data.Pos) -> FloatArray:
    return np.array([position.x, position.y, position.z])


def _zone_as_fine(share: float) -> EffectFilter:
    def lost(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, effects.MoveAbsJ | effects.MoveJ | effects.MoveL | effects.MoveC) or effect.zone.finep:
            return effect
        if share >= 1:
            return replace(effect, zone=replace(effect.zone, finep=True))
        return _scaled_zone(effect, 1 - share)

    return lost


def _scaled_zone(effect: effects.Motion, factor: float) -> effects.Motion:
    zone = effect.zone
    scaled = replace(zone, pzone_tcp=factor * zone.pzone_tcp, pzone_ori=factor * zone.pzone_ori)
    return replace(effect, zone=scaled, zone_mm=None if effect.zone_mm is None else factor * effect.zone_mm)


def _zone_size(per_cent: float) -> EffectFilter:
    def resized(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, effects.MoveAbsJ | effects.MoveJ | effects.MoveL | effects.MoveC):
            return effect
        return _scaled_zone(effect, max(1 + per_cent / 100, 0.0))

    return resized


def _speed(per_cent: float) -> EffectFilter:
    factor = 1 + per_cent / 100

    def faster(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, effects.MoveAbsJ | effects.MoveJ | effects.MoveL | effects.MoveC):
            return effect
        speed = replace(effect.speed, v_tcp=factor * effect.speed.v_tcp, v_ori=factor * effect.speed.v_ori)
        return replace(effect, speed=speed, tcp_speed=None if effect.tcp_speed is None else factor * effect.tcp_speed)

    return faster


def _late_orientation(share: float) -> OrientationLaw:
    late = min(max(share, 0.0), 0.99)

    def law(done: FloatArray) -> FloatArray:
        u = np.clip((done - late) / (1 - late), 0.0, 1.0)
        return np.asarray(u * u * (3 - 2 * u))

    return law


KINDS = {
    kind.name: kind
    for kind in (
        FaultKind("wrong-work-object", "the work object is turned about its z axis", "interpreter", "deg", 5.0, _wrong_work_object),
        FaultKind("wrong-tool", "the tool is taken for longer than it is", "interpreter", "mm", 10.0, _wrong_tool),
        FaultKind("target-offset", "every target is shifted along the work object's x axis", "interpreter", "mm", 10.0, _target_offset),
        FaultKind(
            "axis-sign", "y of every target is mirrored; a share below 1 mirrors it in part", "interpreter", "share", 1.0, _axis_sign
        ),
        FaultKind("circle-radius", "the middle of every arc lies too far out", "planner", "mm", 10.0, _circle_radius),
        FaultKind("zone-as-fine", "zones lose a share of their size; 1 is a stop point", "planner", "share", 1.0, _zone_as_fine),
        FaultKind("zone-size", "zones are too large (or, negative, too small)", "planner", "per cent", 100.0, _zone_size),
        FaultKind("speed", "programmed speeds are off", "planner", "per cent", 5.0, _speed),
        FaultKind("joint-offset", "axis 3 is not where the controller believes it", "servo", "deg", 3.0, make_offset=_axis_3_off),
        FaultKind(
            "orientation-not-interpolated",
            "the tool keeps its orientation for this share of a move, then turns in what is left",
            "planner",
            "share",
            0.9,
            make_law=_late_orientation,
        ),
    )
}
"""All kinds of faults by name."""
