"""Looks over a program's motion before a robot runs it: reach, configuration, axis and speed limits, singularities, workspace.

Invariant: every finding names a RAPID instruction; of each kind an instruction has at most one, at its worst instant.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from mitl.errors import MotionError
from mitl.motion import bridge
from mitl.motion.chain import Planner
from mitl.motion.legs import CartesianLeg, JointLeg
from mitl.motion.limits import LegSpeed
from mitl.motion.moves import PlannedMove
from mitl.motion.path import Corner
from mitl.motion.program_run import ProgramRun
from mitl.motion.record import TICK, View
from mitl.motion.robot_model import RobotModel
from mitl.motion.settings import MoveSettings
from mitl.paths import BoolArray, FloatArray, IndexArray
from rapid_interp import effects


class Severity(Enum):
    """Whether a finding forbids to run the program."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True)
class Finding:
    """What is wrong with one instruction: code, words, place in RAPID, and the worst value with its limit where there is one."""

    severity: Severity
    code: str
    message: str
    file: str
    module: str
    line: int
    column: int
    time_s: float | None = None
    value: float | None = None
    limit: float | None = None
    unit: str = ""


@dataclass(frozen=True)
class Margins:
    """How much is asked for. axis, wrist (axis 5 from 0) and elbow (from straight) in rad; shoulder: wrist centre from axis 1, m.

    speed: share of a joint's speed limit from which on it counts as reached. box: least and greatest (2, 3) m of the tool's tip in the
    base frame, or None.
    """

    axis: float = math.radians(1.0)
    speed: float = 0.98
    wrist: float = math.radians(2.0)
    elbow: float = math.radians(2.0)
    shoulder: float = 0.02
    box: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class Motion:
    """A program's executed motion, tool view, at N times while it moves: joints (N, 6) rad and the index (N,) of the executed move."""

    run: ProgramRun
    time: FloatArray
    joints: FloatArray
    move: IndexArray

    def at(self, index: int) -> effects.SourceLine:
        """Gives where the instruction stands that is executed at a sample."""
        return self.run.record.moves[int(self.move[index])].move.effect.at

    def finding(self, index: int, severity: Severity, code: str, message: str, **measured: float | str) -> Finding:
        """Gives a finding at a sample. measured: value, limit, unit."""
        at = self.at(index)
        value, limit, unit = measured.get("value"), measured.get("limit"), str(measured.get("unit", ""))
        return Finding(
            severity,
            code,
            message,
            at.file,
            at.module,
            at.line,
            at.column,
            float(self.time[index]),
            None if value is None else float(value),
            None if limit is None else float(limit),
            unit,
        )

    def worst_by_line(self, badness: FloatArray, bad: BoolArray) -> Iterator[int]:
        """Gives for every instruction with bad samples (N,) the index of the worst, in the program's order of execution."""
        lines: dict[tuple[str, int, int], int] = {}
        for index in np.flatnonzero(bad):
            at = self.at(int(index))
            key = at.module, at.line, at.column
            if key not in lines or badness[index] > badness[lines[key]]:
                lines[key] = int(index)
        yield from sorted(lines.values(), key=lambda index: float(self.time[index]))


class ForgivingPlanner(Planner):
    """A planner that notes what cannot be moved and stays where it is, so that one bad target does not hide the next."""

    def __init__(self, model: RobotModel) -> None:
        super().__init__(model)
        self.refused: list[MotionError] = []

    def plan_move(self, effect: effects.Motion, q_start: FloatArray, settings: MoveSettings) -> PlannedMove:
        """Gives the leg of an instruction; one of no length where it cannot be moved as told."""
        try:
            return super().plan_move(effect, q_start, settings)
        except MotionError as error:
            self.refused.append(error)
            X_FT = bridge.tool_frame(effect.tool) if effect.tool.robhold else self.arm.flange(q_start).identity()
            standing = JointLeg(q_start, q_start, X_FT, 0.0, 0.0, 0.0)
            return PlannedMove(effect, standing, LegSpeed(1.0, 1.0), Corner(0.0, 0.0), bridge.work_object_frame(effect.wobj))


def refusals(planner: ForgivingPlanner) -> list[Finding]:
    """Gives a finding for every instruction that could not be planned; one in a loop once."""
    found = {(error.module, error.line, error.column, str(error)): of_error(error) for error in planner.refused}
    return list(found.values())


def of_error(error: MotionError) -> Finding:
    """Gives the finding of a refused instruction."""
    message = str(error.args[0])
    codes = (("singularity", "singular"), ("axis-limit", "its limit is"), ("configuration", "configuration"), ("reach", "out of reach"))
    code = next((code for code, sign in codes if sign in message), "motion")
    return Finding(Severity.ERROR, code, message, error.file, error.module, error.line, error.column)


def executed(run: ProgramRun) -> Motion:
    """Gives what a run did, at ticks while it moves."""
    record = run.record
    ticks: FloatArray = TICK * np.arange(int(np.ceil(record.end / TICK)) + 1, dtype=np.float64)
    if not record.moves:
        return Motion(run, np.empty(0), np.empty((0, 6)), np.empty(0, dtype=np.intp))
    joints = record.joints(ticks, View.TOOL)
    moving = np.ones(len(ticks), dtype=bool)
    moving[1:] = np.any(joints[1:] != joints[:-1], axis=1)
    return Motion(run, ticks[moving], joints[moving], record.move_at(ticks[moving]))


@dataclass(frozen=True, eq=False)
class Measures:
    """What the motion used of the arm: least way (6,) rad to an axis limit, greatest share (6,) of the speed limits.

    wrist, elbow rad, and shoulder m: least distances to singularities as in Margins, in linear and circular moves; inf where there is
    none. tool_step: greatest way in m of the tool's tip from one sample to the next.
    """

    axis_margin: FloatArray = field(default_factory=lambda: np.full(6, np.inf))
    speed_share: FloatArray = field(default_factory=lambda: np.zeros(6))
    wrist: float = math.inf
    elbow: float = math.inf
    shoulder: float = math.inf
    tool_step: float = 0.0


def look_over(motion: Motion, margins: Margins) -> tuple[Measures, list[Finding]]:
    """Gives measures and findings of an executed motion."""
    if len(motion.time) == 0:
        return Measures(), []
    model, arm = motion.run.record.model, motion.run.planner.arm
    q = motion.joints
    room = np.minimum(q - model.lower, model.upper - q)
    adjoining = np.diff(motion.time, append=np.inf) < 1.5 * TICK
    share = np.abs(np.diff(q, axis=0, append=q[-1:])) / TICK / model.speed * adjoining[:, None]
    moves = [executed_move.move for executed_move in motion.run.record.moves]
    free = np.array([isinstance(move.leg, CartesianLeg) and move.leg.held_wrist is None for move in moves])[motion.move]
    linear = np.array([isinstance(move.leg, CartesianLeg) for move in moves])[motion.move]
    shoulder, elbow = _shoulder_and_elbow(model, q)
    wrist = np.abs(q[:, 4])
    steps = np.zeros(len(q))
    tips = np.empty((len(q), 3))
    for tool in {id(move.leg.X_FT): move.leg.X_FT for move in moves}.values():
        here = np.array([move.leg.X_FT is tool for move in moves])[motion.move]
        if here.any():
            tips[here] = (arm.flange(q[here]) * tool).translation
    same = adjoining[:-1] & (np.diff(motion.move) == 0)
    steps[1:] = np.where(same, np.linalg.norm(np.diff(tips, axis=0), axis=1), 0.0)
    measures = Measures(
        room.min(axis=0),
        share.max(axis=0),
        float(wrist[free].min(initial=math.inf)),
        float(elbow[linear].min(initial=math.inf)),
        float(shoulder[linear].min(initial=math.inf)),
        float(steps.max()),
    )
    found = [*_axis_findings(motion, room, margins), *_speed_findings(motion, share, margins)]
    for words, values, least, concerned, scale, unit in (
        ("axis 5 comes to {} of 0", wrist, margins.wrist, free, 180 / math.pi, "deg"),
        ("the arm stretches to {} of straight", elbow, margins.elbow, linear, 180 / math.pi, "deg"),
        ("the wrist comes to {} of axis 1", shoulder, margins.shoulder, linear, 1e3, "mm"),
    ):
        for index in motion.worst_by_line(-values, concerned & (values < least)):
            near, wanted = scale * float(values[index]), scale * least
            message = f"near a singularity: {words.format(f'{near:.2f} {unit}')}, at least {wanted:g} {unit} is asked for"
            found.append(motion.finding(index, Severity.WARNING, "singularity", message, value=near, limit=wanted, unit=unit))
    if margins.box is not None:
        outside = np.maximum(margins.box[0] - tips, tips - margins.box[1]).max(axis=1)
        for index in motion.worst_by_line(outside, outside > 0):
            x, y, z = 1e3 * tips[index]
            message = (
                f"the tool leaves the workspace box by {1e3 * outside[index]:.1f} mm at [{x:.1f}, {y:.1f}, {z:.1f}] mm in the base frame"
            )
            found.append(motion.finding(index, Severity.ERROR, "workspace", message, value=1e3 * outside[index], limit=0.0, unit="mm"))
    return measures, found


def _axis_findings(motion: Motion, room: FloatArray, margins: Margins) -> Iterator[Finding]:
    for axis in range(6):
        for index in motion.worst_by_line(-room[:, axis], room[:, axis] < margins.axis):
            left, wanted = np.degrees(room[index, axis]), np.degrees(margins.axis)
            message = f"axis {axis + 1} comes to {left:.2f} deg of its limit, at least {wanted:g} deg is asked for"
            severity = Severity.ERROR if left < 0 else Severity.WARNING
            yield motion.finding(index, severity, "axis-limit", message, value=left, limit=wanted, unit="deg")


def _speed_findings(motion: Motion, share: FloatArray, margins: Margins) -> Iterator[Finding]:
    """An axis at its limit in a Cartesian move makes the tool slower than programmed; a joint move always has one at its limit or none."""
    moves = [executed_move.move for executed_move in motion.run.record.moves]
    linear = np.array([isinstance(move.leg, CartesianLeg) for move in moves])[motion.move]
    for axis in range(6):
        for index in motion.worst_by_line(share[:, axis], linear & (share[:, axis] >= margins.speed)):
            used = 100 * share[index, axis]
            message = f"axis {axis + 1} runs at {used:.1f} % of its speed limit: the tool is slower than programmed"
            severity = Severity.ERROR if used > 100 else Severity.WARNING
            yield motion.finding(index, severity, "axis-speed", message, value=used, limit=100 * margins.speed, unit="%")


def _shoulder_and_elbow(model: RobotModel, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gives the wrist centre's distance (N,) in m from axis 1, and the angle (N,) in rad between straight and upper arm to wrist centre."""
    opw = model.opw
    between = model.between_links(q)
    lean, forearm = between[:, 1], between[:, 1] + between[:, 2]
    x = opw.a1 + opw.c2 * np.sin(lean) + opw.c3 * np.cos(forearm) - opw.a2 * np.sin(forearm)
    straight = math.atan2(opw.c3, -opw.a2)  # the angle at which axis 3 has the wrist centre in line with the upper arm, less 90 deg
    bend = between[:, 2] + straight
    return np.abs(x), np.abs((bend + np.pi) % (2 * np.pi) - np.pi)
