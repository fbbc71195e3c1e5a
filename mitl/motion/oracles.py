"""PlannedOracles: oracles computed on the spot from the RAPID source, by the nominal planner. Implements `protocols.OracleSource`.

A program that loops around `TEST option` is first brought to where it waits for orders; the oracle begins when the order is given.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform

import rapid_interp
from mitl.errors import MitlError
from mitl.motion.accuracy import ModelAccuracy, load_accuracy
from mitl.motion.bounds import bounds_at
from mitl.motion.conveyor import Conveyor
from mitl.motion.offline import fixed_tool_path, programmed_moves, run_until, start_run
from mitl.motion.program_run import ProgramRun
from mitl.motion.robot_model import RobotModel
from mitl.paths import FloatArray
from mitl.poses import pose_of
from mitl.protocols import Oracle
from rapid_interp import effects

RATE = 250.0
"""Samples per second of an oracle."""
_ORDER = "option"
_IDLE = 1.0
_LONGEST = 600.0


class PlannedOracles:
    """Oracles for one robot model among conveyors, which are at home when an order is given. The same request is answered from memory."""

    def __init__(self, model: RobotModel, conveyors: Sequence[Conveyor] = ()) -> None:
        self._model = model
        self._conveyors = tuple(conveyors)
        self._accuracy = load_accuracy(model.folder)
        self._known: dict[tuple[tuple[Path, ...], tuple[tuple[str, str], ...]], Oracle] = {}

    def oracle(self, sources: Sequence[Path], variables: Mapping[str, str]) -> Oracle:
        """Gives what the program does, with RAPID variables preset to literals, until it ends or waits for orders again.

        Raises RapidErrors or RapidError for a bad program, MotionError where it cannot move as told.
        """
        key = (tuple(sources), tuple(sorted(variables.items())))
        if key not in self._known:
            self._known[key] = self._compute(sources, variables)
        return self._known[key]

    def _compute(self, sources: Sequence[Path], variables: Mapping[str, str]) -> Oracle:
        task = rapid_interp.load(sources).start()
        run = start_run(task.run(), self._model, conveyors=self._conveyors)
        looping = any(name.lower() == _ORDER for name in variables)
        begins = _bring_to_rest(run) if looping else 0.0
        for name, literal in variables.items():
            task.set(name, literal)
        reached = run_until(run, begins + _LONGEST, done=lambda _: looping and run.next_event() > begins and task.get(_ORDER) == 0)
        if not run.finished and reached >= begins + _LONGEST - _IDLE:
            raise MitlError(f"{sources[0]}: not done after {_LONGEST:g} s of the robot's time with {dict(variables)}")
        return _cut(run, begins, self._accuracy)


def _bring_to_rest(run: ProgramRun) -> float:
    """Lets a looping program run until it has stood still for a while; gives that time in s, at which an order may be given."""
    run_until(run, math.inf, done=lambda following: following > run.record.end + _IDLE or following > _LONGEST)
    return run.next_event()


def _cut(run: ProgramRun, begins: float, accuracy: ModelAccuracy) -> Oracle:
    """Gives the oracle of what a run did from `begins` s on.

    Tool and work object are those of its first move with a work object, or of the first one whose work object a conveyor carries.
    """
    moves = [executed for executed in run.record.moves if executed.begins >= begins]
    linear = [executed.move for executed in moves if not isinstance(executed.move.effect, effects.MoveAbsJ)]
    carried = [move for move in linear if move.following is not None and move.following.end > 0]
    chosen = next(iter(carried or linear or [executed.move for executed in moves[-1:]]), None)
    X_BO, X_FT = (chosen.X_BO, chosen.leg.X_FT) if chosen is not None else (RigidTransform.identity(), RigidTransform.identity())
    times = begins + np.arange(math.floor(max(run.record.end - begins, 0.0) * RATE) + 2) / RATE
    return Oracle(
        tcp=fixed_tool_path(run, times, X_FT, X_BO, chosen.following if chosen is not None else None).shifted(-begins),
        tool=pose_of(X_FT),
        wobj=pose_of(X_BO),
        moves=programmed_moves(run, moves, begins),
        signals={name: _changes(changes, begins) for name, changes in run.signals.items()},
        accuracy=accuracy.overall,
        bounds=bounds_at(run.record, run.planner.arm, accuracy, times),
    )


def _changes(changes: Sequence[tuple[float, float]], begins: float) -> tuple[FloatArray, FloatArray]:
    """Gives an output's changes from `begins` s on as times and values, beginning with its value then."""
    before = [value for time, value in changes if time < begins]
    later = [(time - begins, value) for time, value in changes if time >= begins]
    known = [(0.0, before[-1] if before else 0.0), *later]
    return np.array([time for time, _ in known]), np.array([value for _, value in known])
