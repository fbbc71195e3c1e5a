"""ProgramRun: one RAPID task in time. It draws effects from the interpreter, plans chains, and says when every output happens.

Both the simulated controller and the oracle are this. The program runs ahead of the motion on fly-by points and waits at fine points
(`facts/rapid.md`, semantics of motion). Invariant: nothing that lies in the past of `now` ever changes.
"""

from __future__ import annotations

import bisect
import math
from collections.abc import Callable, Generator
from dataclasses import dataclass

import numpy as np

from mitl.errors import MotionError
from mitl.motion.chain import Chain, Planner, Start, StartTooFastError
from mitl.motion.moves import PlannedMove
from mitl.motion.record import TICK, MotionRecord
from mitl.motion.refusals import refusal
from mitl.motion.settings import MoveSettings
from mitl.paths import FloatArray
from rapid_interp import effects

LOOK_AHEAD = 200
"""Fly-by moves that are planned together before the program waits for the motion to catch up. ASSUMPTION A-04."""
PREFETCH = 0.1
"""A program goes on past a fly-by point this long (s) before its zone begins. ASSUMPTION A-05."""
SHORTEST_WAIT = PREFETCH
"""A wait in a fly-by point shorter than this (s) does not stop the robot. ASSUMPTION A-05."""

_MOST_EFFECTS = 20_000
_READS_PER_TICK = 20
"""A program that polls inputs or clocks gets on in time: so many readings take one tick. ASSUMPTION A-06."""

EffectFilter = Callable[[effects.Effect], effects.Effect]


def unchanged(effect: effects.Effect) -> effects.Effect:
    """Gives the effect as it is: a controller without faults."""
    return effect


@dataclass(frozen=True)
class TimedText:
    """A line for the operator or the event log, at a time in s."""

    time: float
    text: str


@dataclass(frozen=True)
class _Output:
    """An output that the program set after `after` pending moves."""

    after: int
    effect: effects.SetSignal | effects.Write


@dataclass(frozen=True)
class _Carried:
    """A chain that is scheduled up to `time` s: there it is `start` on its way, and goes on in the next plan or, failing that, as planned.

    chain: as planned, to a stop; calm: its own time in s at that moment. leg: number of the leg it is on; begun: when that began, in s.
    """

    start: Start
    time: float
    chain: Chain
    calm: float
    leg: int
    begun: float


class ProgramRun:
    """One task, from joints at rest. A participant in virtual time: see `mitl.simulation.process.Process`.

    inputs: value of an input signal by name and time. Raises RapidError and MotionError out of `run`.
    """

    def __init__(
        self,
        generator: Generator[effects.Effect, effects.Reply, None],
        planner: Planner,
        record: MotionRecord,
        *,
        now: float = 0.0,
        inputs: Callable[[str, float], float] | None = None,
        effect_filter: EffectFilter = unchanged,
    ) -> None:
        self.record = record
        self.signals: dict[str, list[tuple[float, float]]] = {}
        self.written: list[TimedText] = []
        self.events: list[TimedText] = []
        self.speed_ratio = 1.0
        self.finished = False
        self.ended = 0.0
        self.at: effects.SourceLine | None = None
        self._generator = generator
        self.planner = planner
        self._inputs = inputs
        self._filter = effect_filter
        self._settings = MoveSettings()
        self._pending: list[PlannedMove] = []
        self._outputs: list[_Output] = []
        self._carried: _Carried | None = None
        self._programmed = record.joints_planned_last
        self._resume = now
        self._free = now
        self._reply: effects.Reply = None
        self._started = False

    def next_event(self) -> float:
        """Gives the time in s at which the program goes on; inf when it has ended or is held."""
        return math.inf if self.finished else self._resume

    def run(self, now: float) -> None:
        """Lets the program go on at `now` s until it must wait for time or motion."""
        reads = 0
        for _ in range(_MOST_EFFECTS):
            self._resume = now
            try:
                effect = self._generator.send(self._reply) if self._started else next(self._generator)
            except StopIteration:
                self.ended = self._close(now, fine=True)
                self.finished = True
                return
            self._started = True
            self._reply = None
            self.at = effect.at
            self._take(self._filter(effect), now)
            reads += isinstance(effect, effects.ReadSignal | effects.ReadClock)
            if reads >= _READS_PER_TICK and self._resume <= now:
                self._resume = now + TICK
            if self.finished or self._resume > now:
                return
        assert self.at is not None  # noqa: S101 - at least one effect was taken
        message = f"endless loop: {_MOST_EFFECTS} instructions without any motion or time"
        raise MotionError(message, module=self.at.module, line=self.at.line, file=self.at.file, column=self.at.column)

    def hold(self, now: float) -> None:
        """Stops program and motion along the path; the program cannot go on from here."""
        self.finished = True
        self._generator.close()
        if self.record.chains:
            self.record.brake(now + self.record.half_filter)

    def value_of(self, name: str, time: float) -> float:
        """Gives an output's value at `time` s; 0 before it was first set."""
        earlier = [value for set_at, value in self.signals.get(name, []) if set_at <= time]
        return earlier[-1] if earlier else 0.0

    def _take(self, effect: effects.Effect, now: float) -> None:
        match effect:
            case effects.MoveAbsJ() | effects.MoveJ() | effects.MoveL() | effects.MoveC():
                self._move(effect, now)
            case effects.SetConfiguration() | effects.SetSingularity() | effects.SetCirclePathMode() | effects.SetDisplacement():
                self._settings = self._settings.after(effect)
            case effects.SetLoad():
                self._settings = self._settings.after(effect)
            case effects.Wait():
                self._wait(effect, now)
            case effects.SetSignal() | effects.Write():
                if self._pending:
                    self._outputs.append(_Output(len(self._pending), effect))
                else:
                    self._put(effect, now)
            case effects.ReadClock():
                self._reply = now
            case effects.ReadSignal():
                self._reply = self._read(effect, now)
            case effects.StopProgram():
                self._close(now, fine=True)
                self.finished = True
            case _:
                raise refusal(effect, "not supported by this controller yet")

    def _move(self, effect: effects.Motion, now: float) -> None:
        move = self.planner.plan_move(effect, self._programmed, self._settings)
        self._programmed = move.leg.q_end
        self._pending.append(move)
        if move.fine:
            self._close(now, fine=True)
        elif len(self._pending) >= LOOK_AHEAD:
            self._go_on_halfway(now)

    def _wait(self, effect: effects.Wait, now: float) -> None:
        if self._pending and (effect.seconds >= SHORTEST_WAIT or effect.in_position):
            self._corner_failure(now, f"{effect.at.module}:{effect.at.line} waits in a fly-by point, which becomes a stop")
            reached = self._close(now, fine=effect.in_position)
            self._resume = reached + effect.seconds
        else:
            standing = self.record.end if effect.in_position else now
            self._resume = max(now, standing) + max(effect.seconds, 0.0)

    def _read(self, effect: effects.ReadSignal, now: float) -> float:
        if effect.name in self.signals:
            return self.value_of(effect.name, now)
        return self._inputs(effect.name, now) if self._inputs is not None else 0.0

    def _put(self, effect: effects.SetSignal | effects.Write, time: float) -> None:
        match effect:
            case effects.SetSignal():
                changes = self.signals.setdefault(effect.name, [])
                bisect.insort(changes, (time + effect.delay, effect.value), key=lambda change: change[0])
            case effects.Write():
                self.written.append(TimedText(time, effect.text))

    def _planned_chain(self, now: float) -> tuple[float, Chain] | None:
        """Plans the pending moves; gives the chain and its start in s, or None where a carried chain had to be brought to rest first."""
        if self._carried is not None:
            try:
                chain = self.planner.plan_chain(self._pending, speed_ratio=self.speed_ratio, start=self._carried.start)
            except StartTooFastError:
                self._end_carried(self._carried, now)
                return None
            return self._carried.time, chain
        chain = self.planner.plan_chain(self._pending, speed_ratio=self.speed_ratio)
        return max(now + self.planner.model.start_latency, self._free), chain

    def _end_carried(self, carried: _Carried, now: float) -> None:
        """Lets a carried chain come to rest where it was planned to; the moves after it begin there."""
        old = carried.chain
        rest = Chain(old.moves, old.path, old.timing.beyond(carried.calm))
        self.record.add(carried.time, rest, moves=range(carried.leg, len(old.moves)), begun=carried.begun)
        self._outputs = [_Output(output.after + carried.leg - 1, output.effect) for output in self._outputs]
        self._emit(rest, carried.time, now, len(old.moves))
        self._outputs = [_Output(output.after - len(old.moves), output.effect) for output in self._outputs]
        self._pending = self._pending[len(old.moves) - carried.leg + 1 :]
        self._carried = None
        self._free = carried.time + rest.timing.duration
        at = old.moves[-1].effect.at
        self._corner_failure(now, f"{at.module}:{at.line} cannot be passed at the speed before it, and becomes a stop")

    def _corner_failure(self, now: float, what: str) -> None:
        self.events.append(TimedText(now, f"50024 Corner path failure: {what}"))

    def _close(self, now: float, *, fine: bool) -> float:
        """Plans what is pending to a stop; gives the time in s at which the program has reached its end, and resumes it then."""
        if not self._pending:
            self._resume = now
            return now
        planned = self._planned_chain(now)
        if planned is None:
            self._resume = max(now, self._free)
            return self._close(now, fine=fine) if self._pending else self._resume
        start, chain = planned
        first, begun = (0, None) if self._carried is None else (1, self._carried.begun)
        self.record.add(start, chain, moves=range(first, len(chain.moves)), begun=begun)
        end = start + chain.timing.duration
        model = self.planner.model
        pause = model.pause_after(self._peak_of_last_leg(chain)) if fine else 0.0
        reached = end + max(pause - model.start_latency, 0.0) if fine else max(now, self._released(chain, start, len(chain.moves)))
        self._emit(chain, start, now, len(chain.moves))
        self._pending, self._carried = [], None
        self._free = end + pause
        self._resume = reached
        return reached

    def _go_on_halfway(self, now: float) -> None:
        """Schedules the first half of a long fly-by chain, up to an instant without acceleration; the rest goes into the next plan."""
        planned = self._planned_chain(now)
        if planned is None:
            return
        start, chain = planned
        timing, ends = chain.timing, chain.path.leg_ends()
        half = len(chain.moves) // 2
        calm = timing.calm_from(float(ends[half]))
        position = float(timing.at(np.array([calm]))[0][0]) if calm is not None else math.inf
        leg = int(np.searchsorted(ends, position, side="right")) - 1
        if calm is None or leg > len(chain.moves) - 2 or leg < 1:
            at = chain.moves[-1].effect.at
            self._corner_failure(now, f"no instant of even speed to go on from before {at.module}:{at.line}, which becomes a stop")
            self._close(now, fine=False)
            return
        speed = float(timing.at(np.array([calm]))[1][0])
        ahead = timing.humps_beyond(calm)
        first, begun = (0, None) if self._carried is None else (1, self._carried.begun)
        passing = start + chain.passing_times()
        self.record.add(start, Chain(chain.moves, chain.path, timing.until(calm)), moves=range(first, leg), begun=begun)
        self._emit(chain, start, now, leg)
        carried = Start(position - float(ends[leg]), speed, leg=1, ahead=ahead)
        self._carried = _Carried(carried, start + calm, chain, calm, leg, float(passing[leg]) if leg > first or begun is None else begun)
        self._pending = self._pending[leg - 1 :]
        self._outputs = [_Output(output.after - leg + 1, output.effect) for output in self._outputs]
        self._resume = max(now, start + calm - self.record.half_filter - PREFETCH)

    def _released(self, chain: Chain, start: float, after: int) -> float:
        """Gives the time in s at which the program passes the fly-by point at the end of move number `after` - 1."""
        return start + float(chain.timing.times_at(chain.path.zone_begins()[[after]])[0]) - PREFETCH

    def _emit(self, chain: Chain, start: float, now: float, before: int) -> None:
        """Puts the outputs that the program set after the first `before` moves of the chain, or fewer, at their times."""
        for output in [output for output in self._outputs if output.after <= before]:
            self._put(output.effect, max(now, self._released(chain, start, output.after)))
        self._outputs = [output for output in self._outputs if output.after > before]

    def _peak_of_last_leg(self, chain: Chain) -> float:
        inside = chain.timing.position >= chain.path.leg_ends()[-2]
        return float(chain.timing.speed[inside].max(initial=0.0))


def joints_home() -> FloatArray:
    """Gives the joints (6,) rad at which a robot rests before it was told anything: all 0 but axis 5 at 30 deg, off its singularity."""
    return np.radians([0.0, 0.0, 0.0, 0.0, 30.0, 0.0])
