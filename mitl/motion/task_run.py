"""TaskRun: one RAPID task in time. It draws effects from the interpreter, carries them out, and says until when the program waits.

Invariant: a program gets on only when its time has come; what it does among fly-by moves happens where the arm is then.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from dataclasses import dataclass, field, replace
from typing import assert_never

from mitl.errors import MotionError
from mitl.motion.answers import Desk, Position
from mitl.motion.followed_moves import FollowedMoves
from mitl.motion.interrupt_sources import InterruptSources
from mitl.motion.record import TICK
from mitl.motion.refusals import refusal
from mitl.motion.robot_effects import RobotEffects, StopKind
from mitl.motion.segments import Queued
from mitl.motion.signals import SignalTable
from mitl.motion.waits import Meetings, Waiting
from rapid_interp import data, effects

LOOK_AHEAD = 200
"""Fly-by moves that are planned together, where nothing can come between them, before the program waits for the motion. ASSUMPTION A-04."""
_MOST_EFFECTS = 20_000
_SAME = 1e-9
_READS_PER_TICK = 20
"""A program that polls inputs or clocks gets on in time: so many readings take one tick. ASSUMPTION A-06."""

EffectFilter = Callable[[effects.Effect], effects.Effect]


@dataclass(frozen=True)
class TimedText:
    """A line for the operator or the event log, at a time in s."""

    time: float
    text: str


@dataclass(eq=False)
class Cell:
    """What all tasks of a controller have in common."""

    signals: SignalTable
    desk: Desk
    position: Position
    meetings: Meetings = field(default_factory=Meetings)
    written: list[TimedText] = field(default_factory=list)
    events: list[TimedText] = field(default_factory=list)


class TaskRun:
    """One task. robot: the motion side, None for a task in the background. Raises RapidError and MotionError out of `run`."""

    def __init__(
        self,
        name: str,
        generator: Generator[effects.Effect, effects.Reply, None],
        cell: Cell,
        *,
        now: float,
        robot: RobotEffects | None,
        effect_filter: EffectFilter,
        alone: bool,
    ) -> None:
        self.name = name
        self.at: effects.SourceLine | None = None
        self.finished = False
        self.stopped = False
        self._stopped_robot = False
        self.ended = 0.0
        self.interrupts = InterruptSources()
        self._generator = generator
        self._cell = cell
        self._robot = robot
        self._filter = effect_filter
        self._alone = alone
        self._waiting = Waiting(since=now)
        self._interrupted: list[Waiting] = []
        self._last: Queued | None = None
        self._set: dict[str, float] = {}
        self._reads = 0
        self._read_at = now

    def next_event(self) -> float:
        """Gives the time in s at which the program goes on; inf when it has ended or stopped by itself."""
        if self.finished or self.stopped:
            return math.inf
        return -math.inf if self.interrupts.raised else self._waiting.until()

    def run(self, now: float) -> bool:
        """Lets the program go on at `now` s until it must wait; gives whether it got on at all."""
        for count in range(_MOST_EFFECTS):
            if self.next_event() > now:
                return count > 0
            due = self._waiting.until() <= now
            raised = tuple(self.interrupts.raised)
            self.interrupts.raised.clear()
            reply = self._waiting.reply(now) if due else None
            if not due:
                self._interrupted.append(self._waiting)
            if raised:
                assert not isinstance(reply, effects.Interrupted)  # noqa: S101 - no wait replies that
                reply = effects.Interrupted(raised, reply, finished=due)
            self._send(reply, now)
        assert self.at is not None  # noqa: S101 - at least one effect was taken
        message = f"endless loop: {_MOST_EFFECTS} instructions without any motion or time"
        raise MotionError(message, module=self.at.module, line=self.at.line, file=self.at.file, column=self.at.column)

    def resume(self, held_at: float, now: float) -> None:
        """Lets the program go on at `now` s after it was held, or stopped by itself, at `held_at` s."""
        self.stopped = False
        if self._stopped_robot and self._robot is not None:
            self._stopped_robot = False
            self._robot.go(now)
        self._waiting = self._waiting.held(held_at, now)
        self._interrupted = [waiting.held(held_at, now) for waiting in self._interrupted]

    def close(self) -> None:
        """Ends the program where it is."""
        self.finished = True
        self._generator.close()

    # -------------------------------------------------------------------------------------------------------------------------

    def _send(self, reply: effects.Reply, now: float) -> None:
        try:
            effect = self._generator.send(reply) if self.at is not None else next(self._generator)
        except StopIteration:
            self.ended, self.finished = self._end_of_motion(now), True
            if self._robot is not None:
                self._robot.followed.let_go(self.ended)
            return
        self.at = effect.at
        if isinstance(effect, effects.Resume):
            self._waiting = self._interrupted.pop()
            return
        effect = self._filter(effect)
        if isinstance(effect, effects.TriggerMove):
            move = self._filter(effect.move)
            assert isinstance(move, effects.MoveAbsJ | effects.MoveJ | effects.MoveL | effects.MoveC)  # noqa: S101 - filters keep the kind
            effect = replace(effect, move=move)
        self._waiting = self._taken(effect, now)

    def _taken(self, effect: effects.Effect, now: float) -> Waiting:
        """Begins to carry an effect out; gives what the program then waits for."""
        signals = self._cell.signals
        match effect:
            case effects.MoveAbsJ() | effects.MoveJ() | effects.MoveL() | effects.MoveC():
                return self._moved(effect, (), now)
            case effects.TriggerMove():
                return self._moved(effect.move, effect.triggers, now)
            case effects.SetSignal():
                self._set[effect.name.lower()] = effect.value
                self._on_path(lambda time: self._put(effect, time), now)
                return Waiting()
            case effects.Write():
                self._on_path(lambda time: self._cell.written.append(TimedText(time, effect.text)), now)
                return Waiting()
            case effects.Wait():
                event = self._end(now) if effect.in_position else self._here(now)
                return Waiting(since=now, event=event, seconds=max(effect.seconds, 0.0))
            case effects.ReadSignal():
                return self._reading(now, lambda time: self._set.get(effect.name.lower(), signals.value(effect.name, time)))
            case effects.ReadClock():
                return self._reading(now, lambda time: time)
            case effects.ReadDate():
                return self._reading(now, self._cell.desk.date)
            case effects.ReadTarget() | effects.ReadJoints() | effects.SolveForward() | effects.SolveInverse():
                return self._reading(now, lambda time: self._position(effect, time))
            case effects.ReadTool():
                last = self._robot.last if self._robot else None
                return Waiting(reply=lambda _: last.tool if last else data.ToolData())
            case effects.ReadWorkObject():
                last = self._robot.last if self._robot else None
                return Waiting(reply=lambda _: last.wobj if last else data.WObjData())
            case effects.AskOperator():
                return self._asked(effect, now)
            case effects.Subscribe():
                return Waiting(since=now, event=self._here(now), reply=lambda time: self.interrupts.subscribe(effect, time))
            case effects.Unsubscribe():
                return Waiting(since=now, event=self._here(now), reply=lambda _: self.interrupts.unsubscribe(effect.interrupt))
            case effects.WaitForTasks():
                return self._met(effect, now)
            case effects.StopProgram():
                return self._stopping(effect, now)
            case effects.Resume():
                raise refusal(effect, "nothing was interrupted")
            case effects.SuperviseZone() | effects.SwitchZone() | effects.FreeZone() | effects.MoveUnits() | effects.CorrectPath():
                raise refusal(effect, f"{type(effect).__name__} is not supported by this controller")
            case effects.SetUpGuidance() | effects.StreamPositions() | effects.StopGuidance():
                return Waiting()  # to stream moves nothing; whoever serves the positions does (mitl serve --egm)
            case effects.ActivateGuidance() | effects.RunGuidance():
                raise refusal(effect, "externally guided motion is not supported by this controller")
            case effects.GuidedMove() | effects.ReadGuidanceState():
                raise refusal(effect, "externally guided motion is not supported by this controller")
            case effects.ReadSpeedOverride():
                ratios = self._robot_of(effect).motion.ratios
                return self._reading(now, lambda _: 100 * ratios.operator)
            case effects.ReadSystem() | effects.ReadEvent():
                raise refusal(effect, f"{type(effect).__name__} is not supported by this controller")
            case _:
                return self._motion_changed(effect, now)

    # --- motion --------------------------------------------------------------------------------------------------------------

    def _robot_of(self, effect: effects.Effect) -> RobotEffects:
        if self._robot is None:
            raise refusal(effect, f"the task {self.name} runs in the background and has no robot")
        return self._robot

    def _moved(self, effect: effects.Motion, triggers: tuple[effects.Trigger, ...], now: float) -> Waiting:
        robot = self._robot_of(effect)
        motion = robot.motion
        queued = self._last = robot.add(effect, triggers, now)
        if queued.plan.fine:
            motion.plan(now)
            return Waiting(since=now, event=lambda: motion.reached(queued))
        observed = self.interrupts.active or not self._alone or any(map(_raises, triggers))
        if observed or motion.waiting >= LOOK_AHEAD:
            motion.plan(now)
            return Waiting(since=now, event=lambda: motion.goes_past(queued))
        return Waiting()

    def _motion_changed(self, effect: effects.Setting | effects.SetConfiguration, now: float) -> Waiting:
        robot = self._robot_of(effect)
        motion = robot.motion
        if robot.set(effect, now):
            return Waiting()
        if isinstance(effect, effects.ClearMotion | effects.StoreMotion) and robot.followed.follows:
            raise refusal(effect, "the path cannot be cleared or put aside while the robot follows a conveyor")
        match effect:
            case effects.RefreshSpeed():
                return Waiting(since=now, event=self._here(now), reply=lambda time: robot.refresh_speed(effect, time))
            case effects.WaitWorkObject():
                return self._work_object_awaited(robot.followed, effect, now)
            case effects.DropWorkObject():
                robot.followed.drop(effect)
                return Waiting()
            case effects.StopMotion():
                standing = robot.stop(now, StopKind.QUICK if effect.quick else StopKind.PROGRAM)
                return Waiting(since=standing)
            case effects.StartMotion():
                failed = robot.go(now)
                return Waiting(reply=lambda _: failed)
            case effects.ClearMotion():
                return Waiting(since=robot.brought_to_rest(now), reply=lambda _: motion.clear())
            case effects.StoreMotion():
                return Waiting(since=robot.brought_to_rest(now), reply=lambda _: motion.put_aside())
            case effects.RestoreMotion():
                motion.plan(now)
                return Waiting(since=now, event=motion.standing_from, reply=robot.take_back)
            case _:
                raise refusal(effect, "not supported by this controller yet")

    def _work_object_awaited(self, followed: FollowedMoves, effect: effects.WaitWorkObject, now: float) -> Waiting:
        followed.expect(effect)
        here = self._here(now)
        latest = math.inf if effect.max_time is None else now + effect.max_time

        def comes() -> float:
            since = max(here(), now)
            return followed.arrives(effect, since) if math.isfinite(since) else math.inf

        def reply(time: float) -> effects.Reply:
            if comes() > time + _SAME:
                return effects.Failed("ERR_WAIT_MAXTIME", f"no work object of {effect.wobj.ufmec} came within {effect.max_time:g} s")
            followed.connect(effect, time)
            return None

        return Waiting(since=now, event=comes, latest=latest, reply=reply)

    def _here(self, now: float) -> Callable[[], float]:
        """Gives the event that the program has got to where it is: with fly-by moves before it, that the arm is near enough."""
        last = self._last
        if last is None or last.plan.fine or self._interrupted or self._robot is None:
            return lambda: -math.inf
        motion = self._robot.motion
        motion.plan(now)
        return lambda: motion.goes_past(last)

    def _end(self, now: float) -> Callable[[], float]:
        """Gives the event that the arm stands at the end of all moves given so far."""
        if self._robot is None:
            return lambda: -math.inf
        motion, last = self._robot.motion, self._last
        motion.plan(now)
        return (lambda: motion.reached(last)) if last is not None else motion.standing_from

    def _end_of_motion(self, now: float) -> float:
        ends = self._end(now)()
        return max(now, ends) if math.isfinite(ends) else now

    def _on_path(self, happening: Callable[[float], None], now: float) -> None:
        """Lets something happen where the program is on the path: at once, unless it runs ahead of a fly-by point."""
        last = self._last
        if (
            last is None
            or last.plan.fine
            or self._interrupted
            or self._robot is None
            or not self._robot.motion.on_release(last, happening, now)
        ):
            happening(now)

    # --- the rest ------------------------------------------------------------------------------------------------------------

    def _put(self, effect: effects.SetSignal, time: float) -> None:
        self._set.pop(effect.name.lower(), None)
        self._cell.signals.put(effect.name, effect.value, time, effect.delay)

    def _reading(self, now: float, reply: Callable[[float], effects.Reply]) -> Waiting:
        self._reads = self._reads + 1 if now == self._read_at else 1
        self._read_at = now
        if self._reads >= _READS_PER_TICK:
            return Waiting(since=now, event=self._here(now), seconds=TICK, reply=reply)
        return Waiting(since=now, event=self._here(now), reply=reply)

    def _position(
        self, effect: effects.ReadTarget | effects.ReadJoints | effects.SolveForward | effects.SolveInverse, time: float
    ) -> effects.Answer:
        robot = self._robot_of(effect)
        return self._cell.position.answer(effect, time, robot.last, robot.settings.displacement)

    def _asked(self, effect: effects.AskOperator, now: float) -> Waiting:
        try:
            answer = self._cell.desk.answer(effect)
        except ValueError as error:
            raise refusal(effect, str(error)) from error
        if answer is not None:
            return Waiting(since=now, event=self._here(now), reply=lambda _: answer)
        if effect.max_time is None:
            raise refusal(effect, f"nobody answers {effect.text!r}: give the operator's answers beforehand (mitl oracle --answer)")
        failed = effects.Failed("ERR_TP_MAXTIME", f"nobody answered within {effect.max_time:g} s")
        return Waiting(since=now, event=self._here(now), seconds=effect.max_time, reply=lambda _: failed)

    def _met(self, effect: effects.WaitForTasks, now: float) -> Waiting:
        standing = self._end(now) if effect.in_position else self._here(now)
        if effect.time_out is None and (absent := self._cell.meetings.absent(effect)):
            reason = f"waits without end for {', '.join(absent)}: no such task runs here, and no \\TimeOut was given"
            raise refusal(effect, reason, "WaitSyncTask")
        meeting = self._cell.meetings.join(effect, self.name, now)
        latest = math.inf if effect.time_out is None else now + effect.time_out

        def reply(time: float) -> effects.Reply:
            if max(meeting.met, standing()) <= time:
                return None
            meeting.waiting.discard(self.name.lower())
            return effects.Failed("ERR_WAITSYNCTASK", f"not all of {', '.join(effect.tasks)} came within {effect.time_out:g} s")

        return Waiting(since=now, event=lambda: max(meeting.met, standing()), latest=latest, reply=reply)

    def _stopping(self, effect: effects.StopProgram, now: float) -> Waiting:
        if effect.at_once and self._robot is not None:
            self._robot.stop(now, StopKind.PROGRAM)
            self._stopped_robot = True
        self.ended = self._end_of_motion(now)
        if effect.exits:
            self.close()
        else:
            self.stopped = True
        return Waiting(since=now, event=self._end(now))


def _raises(trigger: effects.Trigger) -> bool:
    match trigger.action:
        case effects.RaiseInterrupt() | effects.CheckSignal():
            return True
        case effects.SetOutput() | effects.FollowSpeed() | effects.RampOutput():
            return False
        case _:
            assert_never(trigger.action)
