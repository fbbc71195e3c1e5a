"""Faults of the interpreter and of what the planner is told: filters of effects.

Invariant: a filter is made anew for every run of a program; size 0 changes nothing.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mitl.motion.bridge import work_object_frame
from mitl.motion.task_run import EffectFilter
from mitl.paths import FloatArray
from rapid_interp import data, effects

_CARTESIAN = effects.MoveJ | effects.MoveL | effects.MoveC
_MOTION = effects.MoveAbsJ | _CARTESIAN


def wrong_work_object(angle_deg: float) -> EffectFilter:
    """Gives a filter that turns the work object about its own z axis."""
    half = np.radians(angle_deg) / 2
    c, s = float(np.cos(half)), float(np.sin(half))

    def turned(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, _CARTESIAN):
            return effect
        frame = effect.wobj.uframe
        w, x, y, z = frame.rot.q1, frame.rot.q2, frame.rot.q3, frame.rot.q4
        rot = data.Orient(w * c - z * s, x * c + y * s, y * c - x * s, z * c + w * s)  # the frame turned about its own z
        return replace(effect, wobj=replace(effect.wobj, uframe=replace(frame, rot=rot)))

    return turned


def wrong_tool(size_mm: float) -> EffectFilter:
    """Gives a filter that takes the tool for longer than it is."""

    def longer(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, _CARTESIAN):
            return effect
        frame = effect.tool.tframe
        trans = replace(frame.trans, z=frame.trans.z + size_mm)
        return replace(effect, tool=replace(effect.tool, tframe=replace(frame, trans=trans)))

    return longer


def _shifted(target: data.RobTarget, x_mm: float) -> data.RobTarget:
    return replace(target, trans=replace(target.trans, x=target.trans.x + x_mm))


def target_offset(size_mm: float) -> EffectFilter:
    """Gives a filter that shifts every target along the work object's x axis."""

    def shifted(effect: effects.Effect) -> effects.Effect:
        match effect:
            case effects.MoveJ() | effects.MoveL():
                return replace(effect, target=_shifted(effect.target, size_mm))
            case effects.MoveC():
                return replace(effect, via=_shifted(effect.via, size_mm), target=_shifted(effect.target, size_mm))
            case _:
                return effect

    return shifted


def target_turn(angle_deg: float) -> EffectFilter:
    """Gives a filter that turns every target about its own z axis."""
    half = np.radians(angle_deg) / 2
    c, s = float(np.cos(half)), float(np.sin(half))

    def turned(target: data.RobTarget) -> data.RobTarget:
        w, x, y, z = target.rot.q1, target.rot.q2, target.rot.q3, target.rot.q4
        return replace(target, rot=data.Orient(w * c - z * s, x * c + y * s, y * c - x * s, z * c + w * s))

    def all_turned(effect: effects.Effect) -> effects.Effect:
        match effect:
            case effects.MoveJ() | effects.MoveL():
                return replace(effect, target=turned(effect.target))
            case effects.MoveC():
                return replace(effect, via=turned(effect.via), target=turned(effect.target))
            case _:
                return effect

    return all_turned


def axis_sign(share: float) -> EffectFilter:
    """Gives a filter that mirrors y of every target, or a share of it."""

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


def circle_radius(size_mm: float) -> EffectFilter:
    """Gives a filter that moves the middle of every arc outwards; it remembers where the last move ended."""
    last = data.Pos()

    def bulged(effect: effects.Effect) -> effects.Effect:
        nonlocal last
        start = last
        if isinstance(effect, _CARTESIAN):
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


def zone_as_fine(share: float) -> EffectFilter:
    """Gives a filter that takes a share of every zone away; all of it makes a stop point."""

    def lost(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, _MOTION) or effect.zone.finep:
            return effect
        if share >= 1:
            return replace(effect, zone=replace(effect.zone, finep=True))
        return _scaled_zone(effect, 1 - share)

    return lost


def _scaled_zone(effect: effects.Motion, factor: float) -> effects.Motion:
    zone = effect.zone
    scaled = replace(zone, pzone_tcp=factor * zone.pzone_tcp, pzone_ori=factor * zone.pzone_ori)
    return replace(effect, zone=scaled, zone_mm=None if effect.zone_mm is None else factor * effect.zone_mm)


def zone_size(per_cent: float) -> EffectFilter:
    """Gives a filter that makes zones larger or smaller."""

    def resized(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, _MOTION):
            return effect
        return _scaled_zone(effect, max(1 + per_cent / 100, 0.0))

    return resized


def speed(per_cent: float) -> EffectFilter:
    """Gives a filter that changes programmed speeds."""
    factor = 1 + per_cent / 100

    def faster(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, _MOTION):
            return effect
        speed = replace(effect.speed, v_tcp=factor * effect.speed.v_tcp, v_ori=factor * effect.speed.v_ori)
        return replace(effect, speed=speed, tcp_speed=None if effect.tcp_speed is None else factor * effect.tcp_speed)

    return faster


def work_object_ignored(share: float) -> EffectFilter:
    """Gives a filter that loses a share of the work object's place; 1 leaves it in the robot's base."""

    def nearer(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, _CARTESIAN):
            return effect
        frame = effect.wobj.uframe
        return replace(effect, wobj=replace(effect.wobj, uframe=replace(frame, trans=_times(1 - share, frame.trans))))

    return nearer


def object_frame_inverted(share: float) -> EffectFilter:
    """Gives a filter that takes the object frame for its inverse; a share below 1 turns and moves it in part."""

    def inverted(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, _CARTESIAN):
            return effect
        frame = effect.wobj.oframe
        rot = frame.rot
        angle = 2 * np.arctan2(np.linalg.norm([rot.q2, rot.q3, rot.q4]), rot.q1)
        sine = np.sin(angle / 2)
        half = (1 - 2 * share) * angle / 2
        axis = np.array([rot.q2, rot.q3, rot.q4]) / sine if abs(sine) > 1e-9 else np.zeros(3)
        x, y, z = (np.sin(half) * axis).tolist()
        turned = data.Pose(_times(1 - 2 * share, frame.trans), data.Orient(float(np.cos(half)), x, y, z))
        return replace(effect, wobj=replace(effect.wobj, oframe=turned))

    return inverted


def frame_order(share: float) -> EffectFilter:
    """Gives a filter that composes user and object frame the wrong way round; a share below 1 goes part of the way to where that leads."""

    def swapped(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, _CARTESIAN):
            return effect
        wobj = effect.wobj
        right = work_object_frame(wobj).translation
        wrong = work_object_frame(replace(wobj, uframe=wobj.oframe, oframe=wobj.uframe)).translation
        x, y, z = (1e3 * share * (wrong - right)).tolist()
        trans = wobj.uframe.trans
        moved = data.Pos(trans.x + x, trans.y + y, trans.z + z)
        return replace(effect, wobj=replace(wobj, uframe=replace(wobj.uframe, trans=moved)))

    return swapped


def tool_inverted(share: float) -> EffectFilter:
    """Gives a filter that takes the tool for its inverse; a share of .5 ignores it."""

    def inverted(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, _CARTESIAN):
            return effect
        frame = effect.tool.tframe
        return replace(effect, tool=replace(effect.tool, tframe=replace(frame, trans=_times(1 - 2 * share, frame.trans))))

    return inverted


def wrong_arc(share: float) -> EffectFilter:
    """Gives a filter that runs every arc on the other side of its chord; it remembers where the last move ended."""
    last = data.Pos()

    def mirrored(effect: effects.Effect) -> effects.Effect:
        nonlocal last
        start = last
        if isinstance(effect, _CARTESIAN):
            last = effect.target.trans
        if not isinstance(effect, effects.MoveC):
            return effect
        chord = 0.5 * (_vector(start) + _vector(effect.target.trans))
        x, y, z = (_vector(effect.via.trans) + 2 * share * (chord - _vector(effect.via.trans))).tolist()
        return replace(effect, via=replace(effect.via, trans=data.Pos(x, y, z)))

    return mirrored


def wait_time(per_cent: float) -> EffectFilter:
    """Gives a filter that makes every wait longer."""

    def longer(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, effects.Wait):
            return effect
        return replace(effect, seconds=max(effect.seconds * (1 + per_cent / 100), 0.0))

    return longer


def _times(factor: float, position: data.Pos) -> data.Pos:
    return data.Pos(factor * position.x, factor * position.y, factor * position.z)
