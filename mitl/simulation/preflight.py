"""Pre-flight: a program's executed motion looked over for everything that would stop or hurt a robot, collisions included.

Invariant: the arm is compared with itself and its cell at every tick of the executed motion at which it moves (4 ms); between two ticks
nothing is looked at, and the report says how far the tool goes from one to the next.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mitl.errors import MotionError, UsageError
from mitl.motion.expected_findings import set_apart
from mitl.motion.flown_orders import fly, run_until_idle, waits_for
from mitl.motion.offline import run_until, start_run
from mitl.motion.preflight import Finding, ForgivingPlanner, Margins, Measures, Motion, Severity, executed, look_over, of_error, refusals
from mitl.motion.program_run import ProgramRun
from mitl.motion.robot_model import RobotModel
from mitl.motion.signals import InputChange
from mitl.simulation.cell import Cell
from mitl.simulation.clearance import Clearance, Gap
from rapid_interp import Diagnostic, Order, RapidError, Task

_FAR = 0.3
"""Gaps in m beyond which nobody asks how far."""
_SAME = 1e-4
"""Change of a gap in m that is none."""
_EVERY = 250
_LONGEST = 600.0


@dataclass(frozen=True)
class Nearest:
    """The smallest gap of the motion: distance in m, between which bodies, when in s and at which line."""

    distance: float
    bodies: tuple[str, str]
    time_s: float
    module: str
    line: int


@dataclass(frozen=True, eq=False)
class Report:
    """What a pre-flight saw. itself, cell: the nearest that the arm came to itself and to the cell; None if never within 0.3 m.

    Left out is what says nothing of the program: gaps within the wrist and its tool, and gaps that never change. Whether they touch is a
    finding all the same. expected: findings that a comment of the program expects. orders: those that were flown to their end.
    """

    robot: str
    duration_s: float
    samples: int
    measures: Measures
    itself: Nearest | None
    cell: Nearest | None
    findings: tuple[Finding, ...]
    expected: tuple[Finding, ...] = ()
    orders: tuple[Order, ...] = ()

    @property
    def errors(self) -> int:
        """Gives the number of findings that forbid to run the program."""
        return sum(finding.severity is Severity.ERROR for finding in self.findings)


@dataclass(frozen=True, eq=False)
class Surroundings:
    """What the arm may touch: its cell, a model of the tool in place of a capsule, and the least distance in m to keep from the cell."""

    cell: Cell | None = None
    tool: Path | None = None
    clearance: float = 0.0


def preflight(
    task: Task,
    model: RobotModel,
    *,
    margins: Margins,
    around: Surroundings,
    inputs: list[InputChange],
    orders: Sequence[Order] = (),
    max_time: float | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Report:
    """Gives what is found about a task's motion. Never raises for what the program does: that is a finding.

    orders: given one after the other where the program waits for orders (see `rapid_interp.orders`). max_time: cut the program off there,
    in s of its own time; without it a start or an order that takes longer than 600 s is a finding.
    """
    planner = ForgivingPlanner(model)
    conveyors = around.cell.conveyors if around.cell is not None else ()
    run = start_run(task.run(), model, inputs=inputs, planner=planner, conveyors=conveyors)
    flight = _Flight(task, run, math.inf if max_time is None else max_time, progress)
    try:
        flight.fly(orders)
    except MotionError as error:
        flight.ended.append(of_error(error))
    except RapidError as error:
        flight.ended.append(Finding(Severity.ERROR, error.code, error.message, error.file, error.module, error.line, error.column))
    motion = executed(run)
    measures, found = look_over(motion, margins)
    nearest, touching = _gaps(motion, model, around, progress)
    findings, expected = set_apart([*refusals(planner), *flight.ended, *touching, *found], task.program.comments)
    duration = float(run.record.end)
    return Report(
        model.name,
        duration,
        len(motion.time),
        measures,
        nearest[False],
        nearest[True],
        _in_order(findings),
        _in_order(expected),
        tuple(flight.done),
    )


class _Flight:
    """Runs a program: to its end, or order by order. ended: what stopped it before."""

    def __init__(self, task: Task, run: ProgramRun, until: float, progress: Callable[[str], None]) -> None:
        self._task, self._run, self._until, self._progress = task, run, until, progress
        self.ended: list[Finding] = []
        self.done: list[Order] = []

    def fly(self, orders: Sequence[Order]) -> None:
        """Lets the program run, and gives it orders where it waits for them. Raises MotionError and RapidError."""
        first = min(_LONGEST, self._until)
        if not orders:
            run_until(self._run, first, progress=self._told("the program"))
        elif run_until_idle(self._run, first, self._told("the start")) and not self._run.finished and waits_for(self._task, orders):
            self._fly_each(orders)
            return
        if not self._run.finished and self._until > _LONGEST:
            run_until(self._run, first, progress=self._told("the program"))
            self._endless(f"the program is still running after {_LONGEST:g} s of the robot's time; cut it off with --max-time")

    def _fly_each(self, orders: Sequence[Order]) -> None:
        for number, order in enumerate(orders, 1):
            longest = min(_LONGEST, self._until - self._run.next_event())
            if not fly(self._run, self._task, order, longest, self._told(f"order {number} of {len(orders)}: {order}")):
                if longest == _LONGEST and not self._run.finished:
                    self._endless(f"the order {order} is not done after {_LONGEST:g} s of the robot's time")
                return
            self.done.append(order)

    def _endless(self, message: str) -> None:
        if not self._run.finished and (at := self._run.at) is not None:
            self.ended.append(Finding(Severity.WARNING, "endless", message, at.file, at.module, at.line, at.column))

    def _told(self, what: str) -> Callable[[float], None]:
        return lambda now: self._progress(f"{what}, {now:.1f} s of the robot's time")


def _in_order(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    return tuple(sorted(findings, key=lambda finding: (finding.file, finding.line, finding.column, finding.severity is Severity.WARNING)))


def unread(robot: str, diagnostics: Sequence[Diagnostic]) -> Report:
    """Gives the report of a program that cannot be run at all: what is wrong with its text."""
    findings = (Finding(Severity(at.severity.value), at.code, at.message, at.file, "", at.line, at.column) for at in diagnostics)
    return Report(robot, 0.0, 0, Measures(), None, None, tuple(findings))


def _gaps(
    motion: Motion, model: RobotModel, around: Surroundings, progress: Callable[[str], None]
) -> tuple[dict[bool, Nearest | None], list[Finding]]:
    """Gives the nearest gaps, of the arm to itself and (True) to the cell, and the findings."""
    pairs: dict[tuple[str, str], _Pair] = {}
    worst: dict[tuple[str, int, int, tuple[str, str]], tuple[int, Gap]] = {}
    moves = [executed_move.move for executed_move in motion.run.record.moves]
    between = model.between_links(motion.joints)
    scenes: dict[tuple[float, ...], Clearance] = {}
    for index in range(len(motion.time)):
        if index % _EVERY == 0:
            progress(f"clearance at {motion.time[index]:.1f} s")
        p_FT = np.asarray(moves[int(motion.move[index])].leg.X_FT.translation)
        key = tuple(np.round(p_FT, 9).tolist())
        if key not in scenes:
            scenes[key] = Clearance(model.urdf, p_FT, cell=around.cell, tool=around.tool)
        at = motion.at(index)
        for gap in scenes[key].gaps(between[index], max(_FAR, around.clearance)):
            pairs.setdefault(gap.bodies, _Pair(gap, index)).take(gap, index)
            if gap.distance < (around.clearance if gap.with_cell else 0.0) or gap.distance <= 0:
                place = at.module, at.line, at.column, gap.bodies
                if place not in worst or gap.distance < worst[place][1].distance:
                    worst[place] = index, gap
    telling = [pair for pair in pairs.values() if not pair.least.within_wrist and not pair.constant(len(motion.time))]
    nearest = {of_cell: _nearest(motion, [pair for pair in telling if pair.least.with_cell == of_cell]) for of_cell in (False, True)}
    return nearest, [_collision(motion, index, gap, around.clearance) for index, gap in worst.values()]


@dataclass
class _Pair:
    """The gaps of two bodies so far."""

    least: Gap
    index: int
    most: float = -math.inf
    seen: int = 0

    def take(self, gap: Gap, index: int) -> None:
        """Takes a gap at a sample into account."""
        if gap.distance < self.least.distance:
            self.least, self.index = gap, index
        self.most, self.seen = max(self.most, gap.distance), self.seen + 1

    def constant(self, samples: int) -> bool:
        """Gives whether the gap is the same all along: of how the arm is built, and not of the program."""
        return self.seen == samples and self.most - self.least.distance < _SAME


def _nearest(motion: Motion, pairs: list[_Pair]) -> Nearest | None:
    if not pairs:
        return None
    pair = min(pairs, key=lambda pair: pair.least.distance)
    at = motion.at(pair.index)
    return Nearest(pair.least.distance, pair.least.bodies, float(motion.time[pair.index]), at.module, at.line)


def _collision(motion: Motion, index: int, gap: Gap, clearance: float) -> Finding:
    first, second = (name.replace("_", " ") for name in gap.bodies)
    distance = 1e3 * gap.distance
    limit = 1e3 * clearance if gap.with_cell else 0.0
    if gap.distance <= 0:
        message, code = f"{first} runs into {second}, {-distance:.1f} mm deep, at {motion.time[index]:.2f} s", "collision"
    else:
        message, code = f"{first} comes to {distance:.1f} mm of {second}, at least {limit:g} mm is asked for", "clearance"
    return motion.finding(index, Severity.ERROR, code, message, value=distance, limit=limit, unit="mm")


def read_box(text: str) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Gives the box (2, 3) m of `XMIN,XMAX,YMIN,YMAX,ZMIN,ZMAX` in mm. Raises UsageError."""
    try:
        values = np.array([float(part) for part in text.split(",")])
    except ValueError:
        values = np.empty(0)
    if values.shape != (6,) or not np.isfinite(values).all() or np.any(values[::2] >= values[1::2]):
        raise UsageError(f"box {text!r}: expected XMIN,XMAX,YMIN,YMAX,ZMIN,ZMAX in mm, each least below its greatest")
    return np.asarray(1e-3 * values.reshape(3, 2).T)
