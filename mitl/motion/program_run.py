"""ProgramRun: RAPID tasks in time, one of them with a robot. It says when something happens next, and lets it happen.

Both the simulated controller and the oracle are this. Invariant: nothing that lies in the past of `now` ever changes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from mitl.motion.answers import Desk, Position
from mitl.motion.chain import Planner
from mitl.motion.following import ConveyorUnits
from mitl.motion.motion_queue import MotionQueue
from mitl.motion.path_actions import PathActions
from mitl.motion.record import TICK, MotionRecord
from mitl.motion.robot_effects import RobotEffects, StopKind
from mitl.motion.signals import InputChange, SignalTable
from mitl.motion.task_run import Cell, EffectFilter, TaskRun, TimedText
from mitl.motion.waits import Meetings
from mitl.paths import FloatArray
from rapid_interp import effects

LOOK = 4e-3
"""How often (s) inputs from outside are looked at for the interrupts that they may raise. ASSUMPTION A-139."""
MAIN_TASK = "T_ROB1"
_SAME = 1e-9
_MOST_ROUNDS = 10_000

TaskGenerator = Generator[effects.Effect, effects.Reply, None]


def unchanged(effect: effects.Effect) -> effects.Effect:
    """Gives the effect as it is: a controller without faults."""
    return effect


class ProgramRun:
    """A program, from joints at rest. A participant in virtual time: see `mitl.simulation.process.Process`.

    background: further tasks by name, which move nothing. inputs: changes of input signals known beforehand. live_inputs: gives inputs by
    name and time in s as they are then. desk: the operator's answers and the date. units: its conveyors.
    Raises RapidError and MotionError out of `run`.
    """

    def __init__(
        self,
        generator: TaskGenerator,
        planner: Planner,
        record: MotionRecord,
        *,
        now: float = 0.0,
        background: Mapping[str, TaskGenerator] | None = None,
        inputs: Sequence[InputChange] = (),
        live_inputs: Callable[[str, float], float] | None = None,
        desk: Desk | None = None,
        effect_filter: EffectFilter = unchanged,
        name: str = MAIN_TASK,
        units: ConveyorUnits | None = None,
    ) -> None:
        self.record = record
        self.planner = planner
        units = units or ConveyorUnits(())
        self.table = SignalTable(inputs, units.inputs(live_inputs))
        self.table.watch(units.commanded)
        tasks = frozenset(task.lower() for task in (name, *(background or ())))
        self._cell = Cell(self.table, desk or Desk(), Position(planner, record), Meetings(tasks))
        self._motion = MotionQueue(planner, record, now=now, told=self._tell)
        self._actions = PathActions(self.table, tcp_speed=self._tcp_speed, raised=self._raise, stopped=self._stop_motion)
        self._robot = RobotEffects(self._motion, triggered=self._actions.do, told=self._tell, units=units)
        others = dict(background or {})
        alone = not others
        self._main = TaskRun(name, generator, self._cell, now=now, robot=self._robot, effect_filter=effect_filter, alone=alone)
        self._tasks = [self._main]
        for other, steps in others.items():
            self._tasks.append(TaskRun(other, steps, self._cell, now=now, robot=None, effect_filter=effect_filter, alone=False))
        for task in self._tasks:
            self.table.watch(task.interrupts.changed)
        self._held: float | None = None
        self._held_motion = False
        self._looked = now

    # --- what it did ---------------------------------------------------------------------------------------------------------

    @property
    def signals(self) -> dict[str, list[tuple[float, float]]]:
        """Gives the outputs' changes so far: time in s and value by name."""
        return self.table.outputs

    @property
    def written(self) -> list[TimedText]:
        """Gives what TPWrite wrote."""
        return self._cell.written

    @property
    def events(self) -> list[TimedText]:
        """Gives the entries of the event log."""
        return self._cell.events

    @property
    def at(self) -> effects.SourceLine | None:
        """Gives where the program is."""
        return self._main.at

    @property
    def finished(self) -> bool:
        """Gives whether the program has ended, or stopped by itself: it does not go on."""
        return self._main.finished or self._main.stopped

    @property
    def going(self) -> bool:
        """Gives whether the program goes on by itself: it has not ended, not stopped itself and is not held."""
        return not self.finished and self._held is None

    @property
    def resumable(self) -> bool:
        """Gives whether the program is held, or stopped itself, and can be resumed."""
        return not self._main.finished and not self.going

    @property
    def stopped_at(self) -> effects.SourceLine | None:
        """Gives the instruction at which the program stopped by itself and may be resumed; None where it did not."""
        return self._main.at if self._main.stopped else None

    @property
    def ended(self) -> float:
        """Gives the time in s at which the program ended, its last motion included; 0 before."""
        return self._main.ended

    def value_of(self, name: str, time: float) -> float:
        """Gives an output's value at `time` s; 0 before it was first set."""
        return self.table.output_at(name, time)

    @property
    def speed_ratio(self) -> float:
        """Gives the operator's share of programmed speeds."""
        return self._motion.ratios.operator

    def set_speed_ratio(self, share: float, now: float) -> None:
        """Puts the operator's share of programmed speeds in force at `now` s, for the motion under way too. Raises MotionError."""
        self._motion.change_speed(replace(self._motion.ratios, operator=share), now)

    # --- time ----------------------------------------------------------------------------------------------------------------

    def next_event(self) -> float:
        """Gives the time in s at which something happens next; inf when nothing is to come."""
        times = [self._motion.next_event(), self._actions_due(), self.table.next_output()]
        if self._held is None and not self.finished:
            times += [self.table.next_input(), self._robot.followed.next_event()]
            if self.table.live is not None and any(task.interrupts.signals for task in self._tasks):
                times.append(self._looked + LOOK)
            for task in self._tasks:
                times += [task.next_event(), task.interrupts.next_event()]
        return min(times)

    def run(self, now: float) -> None:
        """Lets everything happen that is due at `now` s, and the program go on until it must wait for time or motion."""
        due = self.next_event()
        now = due if abs(due - now) < _SAME else now  # sums of times are rounded
        self.table.happen(now)
        self._motion.happen(now)
        self._actions.update(now)
        if self._held is not None or self._main.finished:
            return
        self._robot.followed.watch(now)
        if now >= self._looked + LOOK:
            self._looked = now
            self.table.look(set().union(*(task.interrupts.signals for task in self._tasks)), now)
        for task in self._tasks:
            task.interrupts.elapse(now)
        for _ in range(_MOST_ROUNDS):
            went_on = [task.run(now) for task in self._tasks]  # each of them, also after one that did
            if not any(went_on):
                break
            self._motion.happen(now)

    def hold(self, now: float, kind: StopKind = StopKind.PROGRAM) -> None:
        """Stops program and motion along the path at `now` s; `resume` lets both go on from there."""
        if self._held is None:
            self._held = now
            self._held_motion = self._motion.held
            self._robot.stop(now, kind)

    def resume(self, now: float) -> None:
        """Lets a program that was held, or stopped by itself, go on at `now` s, and the arm on its path. Raises MotionError."""
        held_at = now if self._held is None else self._held
        for task in self._tasks:
            task.resume(held_at, now)
        if self._held is not None:
            self._held = None
            if not self._held_motion:
                self._robot.go(now)

    def close(self, now: float) -> None:
        """Ends the program where it is and stops the arm along its path."""
        self.hold(now)
        self._robot.followed.let_go(now)
        for task in self._tasks:
            task.close()

    # -------------------------------------------------------------------------------------------------------------------------

    def _actions_due(self) -> float:
        """Gives when outputs that follow the speed are set again; after the motion's end they need not be."""
        due = self._actions.next_event()
        return due if due <= self.record.end + 2 * TICK or not self.finished else math.inf

    def _tell(self, time: float, text: str) -> None:
        self._cell.events.append(TimedText(time, text))

    def _raise(self, interrupt: int) -> None:
        self._main.interrupts.raised.append(interrupt)

    def _stop_motion(self, time: float) -> None:
        self._robot.stop(time, StopKind.PROGRAM)

    def _tcp_speed(self, time: float) -> float:
        if not self.record.chains:
            return 0.0
        return float(self.record.planned_tcp(np.array([time]))[2][0])


def joints_home() -> FloatArray:
    """Gives the joints (6,) rad at which a robot rests before it was told anything: all 0 but axis 5 at 30 deg, off its singularity."""
    return np.radians([0.0, 0.0, 0.0, 0.0, 30.0, 0.0])
