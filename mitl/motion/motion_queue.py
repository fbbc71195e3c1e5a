"""MotionQueue: the moves that a program has given and the arm has not done, planned in time; stopping, going on, putting aside.

Invariant: what lies before now plus half a filter never changes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from mitl.motion.chain import Planner
from mitl.motion.moves import PlannedMove
from mitl.motion.pace import StartTooFastError
from mitl.motion.record import MotionRecord
from mitl.motion.segments import CannotGoOnError, Queued, Rest, Segment, braked, taken_over
from mitl.motion.speed_ratios import SpeedRatios
from mitl.motion.trigger_times import PREFETCH, bend_time, passed_time, release_time, trigger_time
from mitl.paths import FloatArray
from rapid_interp.effects import Trigger

_SAME = 1e-9
_MOST_EASINGS = 4
_EASED = 0.98
"""Share of the drives that is aimed at where they were asked too much of."""
_LONG_AGO = 1.0
"""Motion that ended longer ago (s) is not looked at again."""

Happening = Callable[[float], None]


@dataclass(eq=False)
class _PathEvent:
    """Something that happens at a place of a move's path, at `time` s as far as planned. Without trigger: where the program goes on."""

    move: Queued
    trigger: Trigger | None
    happening: Happening
    time: float = math.inf


@dataclass(frozen=True, eq=False)
class _Level:
    """What StorePath puts aside."""

    moves: list[Queued]
    events: list[_PathEvent]
    rest: Rest | None
    held: bool


class MotionQueue:
    """The motion of one arm. told: called with time in s and text for the event log."""

    def __init__(self, planner: Planner, record: MotionRecord, *, now: float, told: Callable[[float, str], None]) -> None:
        self.planner = planner
        self.record = record
        self._ratios = SpeedRatios()
        self.programmed = record.joints_planned_last
        self.held = False
        self._told = told
        self._waiting: list[Queued] = []
        self._events: list[_PathEvent] = []
        self._segments: list[Segment] = []
        self._rest: Rest | None = None
        self._free = max(now, record.end)
        self._goes_on = -math.inf
        self._levels: list[_Level] = []

    # --- speed ---------------------------------------------------------------------------------------------------------------

    @property
    def ratios(self) -> SpeedRatios:
        """Gives the shares of programmed speeds that are in force."""
        return self._ratios

    def change_speed(self, ratios: SpeedRatios, now: float) -> None:
        """Puts shares of programmed speeds in force, for the motion under way too; a share of 0 lets the arm stand. Raises MotionError.

        ASSUMPTION A-261: the motion under way takes the new speed on at once, as hard as its drives can.
        """
        before, self._ratios = self._ratios.share, ratios
        if ratios.share == before:
            return
        if ratios.share == 0:
            held = self.held
            self.stop(now, self.planner.model.tcp_acceleration)
            self.held = held
        elif before == 0:
            self.plan(now)
        elif self._rest is None:  # else it is being stopped
            self._change_pace(now)

    def _change_pace(self, now: float) -> None:
        """Plans all motion that can still be changed anew, each stretch to begin where and, but for pauses, when the one before it ends."""
        time = now + self.record.half_filter
        under_way = [segment for segment in self._segments if segment.start <= time][-1:]
        changed = [segment for segment in under_way if segment.end > time] + [s for s in self._segments if s.start > time]
        ended = free = math.inf
        for segment in changed:
            waited = segment.start > ended + _SAME
            ended = segment.end + self._pause(segment)
            renewed = self._at_new_pace(segment, time, max(segment.start, free) if waited else min(segment.start, free))
            if renewed is not segment:
                self._schedule(renewed, now)
                self._ease(renewed, now)
            free = renewed.end + self._pause(renewed)

    def _at_new_pace(self, segment: Segment, time: float, begins: float) -> Segment:
        """Gives a segment with the speeds in force from `time` s on; itself where it brakes so hard already that nothing can be changed."""
        moves, begin = segment.moves, segment.begin
        try:
            if segment.start < time:
                begins, index, begin = taken_over(segment, time)
                moves = moves[index:]
            plans = [queued.plan for queued in moves]
            return Segment(begins, self.planner.plan_chain(plans, speed_ratio=self._ratios.share, start=begin), moves, begin)
        except StartTooFastError:
            return segment

    # --- what a program gives ------------------------------------------------------------------------------------------------

    def add(self, plan: PlannedMove) -> Queued:
        """Puts a move behind the others; nothing moves before `plan`."""
        queued = Queued(plan)
        self._waiting.append(queued)
        self.programmed = plan.leg.q_end
        return queued

    def at_place(self, move: Queued, trigger: Trigger | None, happening: Happening) -> None:
        """Lets something happen at a place of a move that is not planned yet; without trigger, where the program goes on past its end."""
        self._events.append(_PathEvent(move, trigger, happening))

    def on_release(self, move: Queued, happening: Happening, now: float) -> bool:
        """Lets something happen where the program goes on past a fly-by move; False if that is over, and nothing was done."""
        found = self._found(move)
        if found is None:
            if self._not_planned(move) == -math.inf:
                return False
            self.at_place(move, None, happening)
            return True
        time = found[0].start + release_time(found[0].chain, found[1])
        if time <= now:
            return False
        self._events.append(_PathEvent(move, None, happening, time))
        return True

    @property
    def waiting(self) -> int:
        """Gives how many moves wait to be planned."""
        return len(self._waiting)

    def plan(self, now: float) -> None:
        """Plans and schedules all moves given so far, to rest at the last one. Raises MotionError."""
        while self._waiting and not self.held and self._ratios.share > 0:
            fine = next((index for index, queued in enumerate(self._waiting) if queued.plan.fine), len(self._waiting) - 1)
            group = self._waiting[: fine + 1]
            segment = self._carried_on(now, group) or self._set_out(now, group)
            del self._waiting[: fine + 1]
            self._schedule(segment, now)
            self._ease(segment, now)

    # --- times ---------------------------------------------------------------------------------------------------------------

    def next_event(self) -> float:
        """Gives the time in s at which the next thing tied to a place happens."""
        return min((event.time for event in self._events), default=math.inf)

    def happen(self, now: float) -> None:
        """Lets everything happen that is due at `now` s, in its order."""
        due = sorted((event for event in self._events if event.time <= now), key=lambda event: event.time)
        self._events = [event for event in self._events if event.time > now]
        for event in due:
            event.happening(event.time)

    def goes_past(self, move: Queued) -> float:
        """Gives the time in s at which the program goes on past a fly-by move, early enough for the arm to go on without braking.

        ASSUMPTION A-132: that is PREFETCH before its zone, or as long before the zone as the arm would brake for a stop at its end.
        """
        found = self._found(move)
        if found is None:
            return self._not_planned(move)
        segment, index = found
        zone = segment.start + bend_time(segment.chain, index)
        braking = segment.end - segment.brakes_from() if index == len(segment.moves) - 1 else 0.0
        return zone - max(PREFETCH, braking) - self.record.half_filter

    def reached(self, move: Queued) -> float:
        """Gives the time in s at which the program goes on after a stop at the end of a move.

        ASSUMPTION A-133: that is half a filter before the next move's plan could begin, so that the measured pause of a fine point is kept
        and nothing moves before it is told to; the tool is .05 to .4 mm short of its place then
        (IRB 6640 and IRB 140, v50 to v1000).
        """
        found = self._found(move)
        if found is None:
            return self._not_planned(move)
        segment, index = found
        end = segment.start + passed_time(segment.chain, index)
        return end + (max(self._pause(segment) - self.record.half_filter, 0.0) if move.plan.fine else self.record.half_filter)

    def standing_from(self) -> float:
        """Gives the time in s from which on the arm stands, as far as planned."""
        return self._segments[-1].end + self.record.half_filter if self._segments else -math.inf

    # --- stopping and going on -----------------------------------------------------------------------------------------------

    def stop(self, now: float, deceleration: float) -> float:
        """Stops along the path at m/s^2; gives the time in s from which on the arm stands."""
        self.held = True
        time = now + self.record.half_filter
        while self._segments and self._segments[-1].start >= time:
            self._take_back(self._segments.pop())
        if self._segments and self._segments[-1].end > time:
            segment = self._segments[-1]
            stopped, rest = braked(segment, time, deceleration, self.planner.model.acceleration_window)
            beyond = len(segment.moves)
            if rest is not None:
                self._segments[-1], self._rest = stopped, rest
                self._waiting[:0] = rest.onward
                beyond -= len(rest.onward) - 1
            chain = replace(stopped.chain, timing=stopped.chain.timing.beyond(time - segment.start))
            self.record.schedule(time, chain, under_way=segment.leg_at(time), beyond=beyond)
        self._free = max(self._segments[-1].end if self._segments else self._free, now)
        self._time_events(now)
        return max(self.standing_from(), now)

    def go(self, now: float) -> None:
        """Lets the motion go on where it was stopped. Raises MotionError."""
        self.held = False
        self.plan(now)

    def regain(self, plan: PlannedMove, now: float) -> None:
        """Schedules a move back to where a stopped motion goes on: none of the program's, so that SpeedRefresh does not count."""
        chain = self.planner.plan_chain([plan], speed_ratio=self._ratios.operator)
        self._schedule(Segment(max(now + self.planner.model.start_latency, self._free), chain, (Queued(plan),)), now)

    def clear(self) -> None:
        """Forgets the moves that are not done; the arm must stand."""
        for queued in self._waiting:
            queued.cleared = True
        self._events = [event for event in self._events if not event.move.cleared]
        self._waiting, self._rest = [], None
        self.programmed = self.record.joints_planned_last

    def put_aside(self) -> None:
        """Puts the moves that are not done aside, so that others can be made; the arm must stand."""
        events = [event for event in self._events if event.move in self._waiting]
        self._levels.append(_Level(self._waiting, events, self._rest, self.held))
        self._events = [event for event in self._events if event not in events]
        self._waiting, self._rest, self.held = [], None, False
        self.programmed = self.record.joints_planned_last

    def take_back(self) -> bool:
        """Takes back what was put aside last, to go on with it at `go`; False if nothing was. The moves made since must be done."""
        if not self._levels:
            return False
        level = self._levels.pop()
        self._waiting, self._rest, self.held = level.moves, level.rest, level.held
        self._events += level.events
        if level.moves:
            self.programmed = level.moves[-1].plan.leg.q_end
        return True

    @property
    def resting_place(self) -> FloatArray | None:
        """Gives the joints (6,) rad at which a stopped motion goes on; None where none was stopped on its way."""
        return None if self._rest is None else self._rest.joints

    # --- planning ------------------------------------------------------------------------------------------------------------

    def _carried_on(self, now: float, group: list[Queued]) -> Segment | None:
        """Gives the segment that carries the newest one on into a group of moves; None where that ends in a stop point or has to."""
        if not self._segments or self._segments[-1].moves[-1].plan.fine or self._rest is not None:
            return None
        former = self._segments[-1]
        time = now + self.record.half_filter
        if time > former.goes_on_until() and time > former.start:
            self._fails_corner(now, former, "its successor comes too late")
            return None
        try:
            if time <= former.start:
                time, index, begin = former.start, 0, former.begin
            else:
                time, index, begin = taken_over(former, time)
            moves = (*former.moves[index:], *group)
            chain = self.planner.plan_chain([queued.plan for queued in moves], speed_ratio=self._ratios.share, start=begin)
        except CannotGoOnError as error:
            self._fails_corner(now, former, str(error))
            return None
        except StartTooFastError:
            self._fails_corner(now, former, "it cannot be passed at the speed before it")
            return None
        return Segment(time, chain, moves, begin)

    def _set_out(self, now: float, group: list[Queued]) -> Segment:
        """Gives the segment that executes a group of moves from rest."""
        rest, self._rest = self._rest, None
        moves = (*(rest.lead if rest else ()), *group)
        begin = rest.begin if rest else None
        chain = self.planner.plan_chain([queued.plan for queued in moves], speed_ratio=self._ratios.share, start=begin)
        at_once = abs(now - self._goes_on) < _SAME  # told as soon as it could be: the pause holds all that a start takes
        start = now + (self.record.half_filter if at_once else self.planner.model.start_latency)
        return Segment(max(start, self._free), chain, moves, begin)

    def _schedule(self, segment: Segment, now: float) -> None:
        self._segments = [former for former in self._segments if now - _LONG_AGO < former.end and former.start < segment.start - _SAME]
        self._segments.append(segment)
        self.record.schedule(segment.start, segment.chain, under_way=segment.under_way)
        last = segment.moves[-1].plan
        self._free = segment.end + (self._pause(segment) if last.fine else 0.0)
        self._goes_on = self._free - self.record.half_filter if last.fine else -math.inf
        self._time_events(now)

    def _ease(self, segment: Segment, now: float) -> None:
        """Plans a segment anew with less of the drives where the tool's motion, which lags behind the plan, asks too much of them.

        A plan keeps a margin for that (A-111); this is for paths that bend so suddenly that it does not do.
        """
        share = 1.0
        for _ in range(_MOST_EASINGS):
            strain = self.record.strain(segment.start)
            if strain <= 1:
                return
            share *= _EASED / strain
            plans, ratio = [queued.plan for queued in segment.moves], self._ratios.share
            try:
                chain = self.planner.plan_chain(plans, speed_ratio=ratio, start=segment.begin, share=share)
            except StartTooFastError:
                return  # what is under way is too fast already
            segment = replace(segment, chain=chain)
            self._schedule(segment, now)

    def _take_back(self, segment: Segment) -> None:
        """Takes a segment back that has not begun."""
        lead, onward = segment.moves[: segment.under_way], segment.moves[segment.under_way :]
        self.record.cancel(segment.start)
        former = self._segments[-1] if self._segments else None
        if former is not None and segment.begin is not None and segment.begin.speed > 0:  # it would have carried the former one on
            onward = tuple(queued for queued in onward if former.index_of(queued) is None)
        self._waiting[:0] = onward
        if segment.begin is not None and segment.begin.speed == 0:
            self._rest = Rest(lead, onward, segment.begin, self.record.joints_planned_last)

    def _time_events(self, now: float) -> None:
        """Finds out anew when what is tied to places happens, as far as the places lie ahead."""
        for event in self._events:
            found = self._found(event.move)
            if found is None:
                event.time = event.time if event.time <= now else math.inf
                continue
            segment, index = found
            if event.time < segment.start:
                continue  # what was planned before the segment took over still holds
            chain = segment.chain
            time = release_time(chain, index) if event.trigger is None else trigger_time(chain, index, event.trigger)
            if time > -math.inf:
                event.time = max(segment.start + time, now)

    def _found(self, move: Queued) -> tuple[Segment, int] | None:
        for segment in reversed(self._segments if not move.cleared else []):
            index = segment.index_of(move)
            if index is not None:
                return segment, index
        return None

    def _not_planned(self, move: Queued) -> float:
        """Gives when a move that no segment holds is done: long ago, or at no time yet known."""
        return math.inf if not move.cleared and move in self._waiting else -math.inf

    def _pause(self, segment: Segment) -> float:
        chain = segment.chain
        inside = chain.timing.position >= chain.path.leg_ends()[-2]
        return self.planner.model.pause_after(float(chain.timing.speed[inside].max(initial=0.0)))

    def _fails_corner(self, now: float, segment: Segment, why: str) -> None:
        at = segment.moves[-1].plan.effect.at
        self._told(now, f"50024 Corner path failure: {at.module}:{at.line} becomes a stop: {why}")
