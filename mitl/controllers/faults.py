"""Faults that a controller under development may have, injected where such a bug would live: interpreter, planner or servo.

Invariant: a fault changes what the simulated controller does, never what is measured of it, and never the oracle.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mitl.controllers import effect_faults as bugs
from mitl.controllers import servo_faults as servo
from mitl.controllers import setting_faults as settings
from mitl.errors import UsageError
from mitl.motion.following import Encoder
from mitl.motion.orientation import OrientationLaw, evenly
from mitl.motion.robot_model import RobotModel
from mitl.motion.task_run import EffectFilter
from mitl.paths import FloatArray
from rapid_interp import effects


@dataclass(frozen=True)
class FaultKind:
    """A kind of fault. layer: where the bug lives, "interpreter", "planner", "interpolator", "servo" or "I/O".
    size: the default, in `unit`.

    One of these says what it does, given its size: a filter of effects, a law of turning, another robot model, a way to play the plan
    back, or by how much the arm's axes are off. stop_delay: seconds by which one unit of it delays a stop.
    resume_offset: rad by which one unit of it puts axis 1 off after a restart. encoder_gain: share by which one unit of it makes encoders
    count too much. encoder_delay: s by which one unit of it delays them.
    """

    name: str
    title: str
    layer: str
    unit: str
    size: float
    make_filter: Callable[[float], EffectFilter] | None = None
    make_law: Callable[[float], OrientationLaw] | None = None
    make_model: Callable[[float], Callable[[RobotModel], RobotModel]] | None = None
    make_playback: Callable[[float], Callable[[servo.Playback], servo.Playback]] | None = None
    make_offset: Callable[[float], servo.Offset] | None = None
    stop_delay: float = 0.0
    resume_offset: float = 0.0
    encoder_gain: float = 0.0
    encoder_delay: float = 0.0


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
            if isinstance(effect, effects.TriggerMove):  # the motion in it is as wrong as any other
                inner = one(effect.move)
                assert isinstance(inner, effects.Motion)  # noqa: S101 - a filter makes no other effect of a motion
                effect = replace(effect, move=inner)
        return effect

    return all_of_them


def orientation_law(faults: Sequence[Fault]) -> OrientationLaw:
    """Gives the law by which the planner turns the tool; the last fault of that kind decides."""
    laws = [fault.kind.make_law(fault.size) for fault in faults if fault.kind.make_law is not None]
    return laws[-1] if laws else evenly


def robot_model(model: RobotModel, faults: Sequence[Fault]) -> RobotModel:
    """Gives the robot as the controller believes it to be."""
    for fault in faults:
        if fault.kind.make_model is not None:
            model = fault.kind.make_model(fault.size)(model)
    return model


def playback(faults: Sequence[Fault]) -> servo.Playback:
    """Gives how the plan is played back, all faults of that kind one around the other."""
    played: servo.Playback = servo.straight
    for fault in faults:
        if fault.kind.make_playback is not None:
            played = fault.kind.make_playback(fault.size)(played)
    return played


def joint_offset(faults: Sequence[Fault]) -> servo.Offset:
    """Gives by how many rad (6,) the arm's axes are off from where the controller believes them, at a time in s since it was on."""
    offsets = [fault.kind.make_offset(fault.size) for fault in faults if fault.kind.make_offset is not None]
    return lambda time: np.asarray(np.sum([np.zeros(6), *(offset(time) for offset in offsets)], axis=0))


def stop_delay(faults: Sequence[Fault]) -> float:
    """Gives by how many s a stop comes after its call."""
    return sum(max(fault.kind.stop_delay * fault.size, 0.0) for fault in faults)


def resume_offset(faults: Sequence[Fault]) -> float:
    """Gives by how many rad axis 1 is off after a restart."""
    return sum(fault.kind.resume_offset * fault.size for fault in faults)


def encoder(faults: Sequence[Fault]) -> Encoder:
    """Gives how the controller reads the encoders of conveyors."""
    gain = 1.0 + sum(fault.kind.encoder_gain * fault.size for fault in faults)
    return Encoder(gain, sum(max(fault.kind.encoder_delay * fault.size, 0.0) for fault in faults))


def _late_orientation(share: float) -> OrientationLaw:
    late = min(max(share, 0.0), 0.99)

    def law(done: FloatArray) -> FloatArray:
        u = np.clip((done - late) / (1 - late), 0.0, 1.0)
        return np.asarray(u * u * (3 - 2 * u))

    return law


def _lagging_orientation(share: float) -> OrientationLaw:
    # beyond a quarter the turn would begin backwards
    late = min(max(share, 0.0), 0.25)

    def law(done: FloatArray) -> FloatArray:
        return np.asarray(done - 4 * late * done * (1 - done))

    return law


def wider_limits(angle_deg: float) -> Callable[[RobotModel], RobotModel]:
    """Gives a change of the robot model: every axis believed to turn so much further, both ways."""
    wider = np.radians(angle_deg)
    return lambda model: replace(model, lower=model.lower - wider, upper=model.upper + wider)


def less_acceleration(per_cent: float) -> Callable[[RobotModel], RobotModel]:
    """Gives a change of the robot model: the TCP believed to stand so much less acceleration."""
    share = max(1 - per_cent / 100, 0.01)
    return lambda model: replace(model, tcp_acceleration=share * model.tcp_acceleration)


KINDS = {
    kind.name: kind
    for kind in (
        FaultKind("wrong-work-object", "the work object is turned about its z axis", "interpreter", "deg", 5.0, bugs.wrong_work_object),
        FaultKind("wrong-tool", "the tool is taken for longer than it is", "interpreter", "mm", 10.0, bugs.wrong_tool),
        FaultKind("target-offset", "every target is shifted along the work object's x axis", "interpreter", "mm", 10.0, bugs.target_offset),
        FaultKind("target-turn", "every target is turned about its own z axis", "interpreter", "deg", 8.0, bugs.target_turn),
        FaultKind(
            "axis-sign", "y of every target is mirrored; a share below 1 mirrors it in part", "interpreter", "share", 1.0, bugs.axis_sign
        ),
        FaultKind("circle-radius", "the middle of every arc lies too far out", "planner", "mm", 10.0, bugs.circle_radius),
        FaultKind("zone-as-fine", "zones lose a share of their size; 1 is a stop point", "planner", "share", 1.0, bugs.zone_as_fine),
        FaultKind("zone-size", "zones are too large (or, negative, too small)", "planner", "per cent", 100.0, bugs.zone_size),
        FaultKind("speed", "programmed speeds are off", "planner", "per cent", 8.0, bugs.speed),
        FaultKind("joint-offset", "axis 3 is not where the controller believes it", "servo", "deg", 3.0, make_offset=servo.axis_3_off),
        FaultKind(
            "orientation-not-interpolated",
            "the tool keeps its orientation for this share of a move, then turns in what is left",
            "planner",
            "share",
            0.9,
            make_law=_late_orientation,
        ),
        FaultKind(
            "work-object-ignored",
            "a share of the work object's place is lost; 1 is the base",
            "interpreter",
            "share",
            0.1,
            bugs.work_object_ignored,
        ),
        FaultKind("object-frame-inverted", "the object frame is inverted", "interpreter", "share", 1.0, bugs.object_frame_inverted),
        FaultKind("frame-order", "user and object frame are composed the wrong way round", "interpreter", "share", 1.0, bugs.frame_order),
        FaultKind("tool-inverted", "the tool is inverted; a share of .5 ignores it", "interpreter", "share", 1.0, bugs.tool_inverted),
        FaultKind("wrong-arc", "arcs are run on the other side of their chord", "planner", "share", 1.0, bugs.wrong_arc),
        FaultKind("wait-time", "WaitTime is too long", "interpreter", "per cent", 20.0, bugs.wait_time),
        FaultKind(
            "acceleration-limit-ignored",
            "PathAccLim and AccSet lose a share of what they take away",
            "planner",
            "share",
            1.0,
            settings.acceleration_limits_ignored,
        ),
        FaultKind(
            "wrong-configuration", "joint moves end with the wrist turned over", "planner", "share", 1.0, settings.wrong_configuration
        ),
        FaultKind("configuration-ignored", "ConfL and ConfJ are always \\Off", "planner", "share", 1.0, settings.configuration_ignored),
        FaultKind("override-ignored", "VelSet loses a share of what it takes away", "planner", "share", 1.0, settings.override_ignored),
        FaultKind(
            "displacement-ignored", "a program displacement loses its shift", "interpreter", "share", 1.0, settings.displacement_ignored
        ),
        FaultKind("orientation-late", "the turn of the tool is behind its way", "planner", "share", 0.2, make_law=_lagging_orientation),
        FaultKind("sing-area-ignored", "SingArea is always \\Off", "planner", "share", 1.0, settings.sing_area_ignored),
        FaultKind("trigger-late", "triggers come late (or, negative, early)", "I/O", "ms", 60.0, settings.trigger_late),
        FaultKind("trigger-missing", "a share of the triggers does not come", "I/O", "share", 0.2, settings.trigger_missing),
        FaultKind("equip-lag-sign", "EquipLag acts the wrong way; a share of .5 ignores it", "I/O", "share", 1.0, settings.equip_lag_sign),
        FaultKind("analog-scale", "analog outputs of triggers are too large", "I/O", "per cent", 40.0, settings.analog_scale),
        FaultKind("stop-late", "the motion goes on for a while after a stop was called", "interpolator", "ms", 200.0, stop_delay=1e-3),
        FaultKind("resume-offset", "axis 1 is off after a restart", "interpolator", "deg", 1.5, resume_offset=float(np.radians(1.0))),
        FaultKind("joint-limit-ignored", "axes may turn beyond their range", "planner", "deg", 30.0, make_model=wider_limits),
        FaultKind("speed-dip", "the speed sags in every zone", "interpolator", "per cent", 20.0, make_playback=servo.speed_dip),
        FaultKind("hiccup", "the motion halts within moves", "interpolator", "ms", 40.0, make_playback=servo.hiccup),
        FaultKind("late-start", "every motion comes late", "interpolator", "ms", 150.0, make_playback=servo.late),
        FaultKind("overshoot", "the arm runs past stops by so much of its speed", "servo", "ms", 25.0, make_playback=servo.overshoot),
        FaultKind("scatter", "axis 1 stops a little elsewhere every time", "servo", "deg", 0.4, make_playback=servo.scatter),
        FaultKind("backlash", "axis 1 has play", "servo", "deg", 0.8, make_playback=servo.backlash),
        FaultKind(
            "sluggish", "the TCP's acceleration is smaller than it may be", "planner", "per cent", 80.0, make_model=less_acceleration
        ),
        FaultKind("conveyor-gain", "encoders of conveyors count too much", "interpolator", "per cent", 5.0, encoder_gain=1e-2),
        FaultKind("conveyor-delay", "conveyors are followed late", "interpolator", "ms", 80.0, encoder_delay=1e-3),
        FaultKind("joint-drift", "axis 1 drifts with time", "servo", "deg/min", 0.2, make_offset=servo.axis_1_drifts),
    )
}
"""All kinds of faults by name."""
