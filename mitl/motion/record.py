"""MotionRecord: what an arm has been told to do so far, in time: planned, and as the arm and the controller's report follow it.

The views but the plan are made at ticks from 0 on: the path coordinate lags, then joints pass the filters. The plan's clock runs late
by the lag, so that at an even speed the arm is where the plan is. Invariant: what has been recorded up to (the newest chain's start -
half a filter) never changes again.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from mitl.motion.carrying import displaced, shifts
from mitl.motion.chain import Chain
from mitl.motion.filters import motor_side, moving_average
from mitl.motion.moves import PlannedMove
from mitl.motion.robot_model import RobotModel
from mitl.motion.scheduled import ScheduledChain
from mitl.paths import FloatArray, IndexArray

TICK = 4e-3
"""Spacing in s of the joint samples behind every view; the plan itself is exact at any time."""
_SAME_TIME = 1e-9


class View(Enum):
    """The three views of a motion: where the tool goes, what the controller reports, what was planned."""

    TOOL = "tool"
    CONTROLLER = "controller"
    PLANNED = "planned"


_SETTLED = 1e-6
"""Way in m that the lagged path coordinate may still be short of a stop for the arm to count as standing."""
_TAIL = 16.0
"""Time constants of the lag after which nothing is left of it."""


@dataclass(frozen=True, eq=False)
class ExecutedMove:
    """A motion instruction with the times in s at which the plan passes its start and its end (the middles of corners)."""

    move: PlannedMove
    begins: float
    ends: float


class MotionRecord:
    """The motion of one arm from rest at joints `q_start` (6,) rad at time 0."""

    def __init__(self, model: RobotModel, q_start: FloatArray) -> None:
        self.model = model
        self.chains: list[ScheduledChain] = []
        self.moves: list[ExecutedMove] = []
        self._q_start = q_start
        self._carried = False
        self._followed = q_start[None, :].copy()
        self._tool = self._report = self._followed
        self._reported = 1
        """Ticks of the controller's report that hold; the rest is computed when somebody asks."""

    @property
    def half_filter(self) -> float:
        """Gives how long in s the arm moves before the plan does: half its filters and the lag, by which the plan's clock runs late."""
        return float(self.model.arm_windows.sum() / 2) + self.model.path_lag

    @property
    def end(self) -> float:
        """Gives the time in s from which on nothing moves any more, to within _SETTLED."""
        if not self.chains:
            return 0.0
        newest, lag = self.chains[-1], self.model.path_lag
        left = float(newest.behind_at(np.array([newest.end]), lag)[0])
        return newest.end + lag * max(math.log(max(left, 1e-300) / _SETTLED) - 2, -1.0) + self.half_filter

    @property
    def joints_planned_last(self) -> FloatArray:
        """Gives the joints (6,) rad at which the plan comes to rest."""
        if not self.chains:
            return self._q_start
        newest = self.chains[-1]
        return np.asarray(_joints(newest, np.array([newest.last]))[0])

    def schedule(self, start: float, chain: Chain, *, under_way: int = 0, beyond: int | None = None) -> None:
        """Moves along a chain from `start` s on; what was scheduled from then on is dropped.

        under_way: index in the chain of the move with which it begins; that keeps the time at which it was first begun. beyond: index
        after the last move that it executes.
        """
        self._drop_from(start)
        self._carried = self._carried or any(move.following is not None for move in chain.moves)
        moves = chain.moves[under_way:beyond]
        passing = start + chain.passing_times()[under_way:]
        begun = next((index for index in range(len(self.moves) - 1, -1, -1) if moves and self.moves[index].move is moves[0]), None)
        known = math.inf if begun is None else self.moves[begun].begins
        del self.moves[len(self.moves) if begun is None else begun :]
        for index, move in enumerate(moves):
            begins = float(passing[index])
            self.moves.append(ExecutedMove(move, min(known, begins) if index == 0 else begins, float(passing[index + 1])))
        behind = float(self.chains[-1].behind_at(np.array([start]), self.model.path_lag)[0]) if self.chains else 0.0
        self.chains.append(ScheduledChain(start, chain, behind))
        self._extend(self.chains[-1])

    def cancel(self, start: float) -> None:
        """Drops what was scheduled from `start` s on, where the arm stands."""
        self._drop_from(start)
        self.moves = [executed for executed in self.moves if executed.begins < start - _SAME_TIME]
        if self.chains:
            self._extend(self.chains[-1])
        else:
            self._filter_from(0, self._hold)

    def _drop_from(self, start: float) -> None:
        while self.chains and self.chains[-1].start >= start - _SAME_TIME:
            self.chains.pop()
        if self.chains and self.chains[-1].end > start:
            cut = self.chains[-1]
            self.chains[-1] = replace(cut, chain=replace(cut.chain, timing=cut.chain.timing.until(start - cut.start)))
        self._followed = self._followed[: max(self._first_tick(start - self.model.path_lag), 1)]

    def joints_at(self, time: float, view: View = View.TOOL) -> FloatArray:
        """Gives the joints (6,) rad at `time` s as the arm follows, by cubic interpolation between ticks."""
        joints = self._joints_at(time, view)
        return joints if not self._carried else self._along(np.array([time]), joints[None])[0]

    def _joints_at(self, time: float, view: View) -> FloatArray:
        values = self.ticks(view)
        place = min(max(time / TICK, 0.0), len(values) - 1.0)
        k = min(int(place), len(values) - 2)
        if k < 0:
            return np.asarray(values[0])
        u = place - k
        before, left, right, after = values[max(k - 1, 0)], values[k], values[k + 1], values[min(k + 2, len(values) - 1)]
        c0, c1 = -0.5 * u * (1 - u) ** 2, 1 + u * u * (1.5 * u - 2.5)
        c2, c3 = u * (0.5 + u * (2 - 1.5 * u)), -0.5 * u * u * (1 - u)
        return np.asarray(c0 * before + c1 * left + c2 * right + c3 * after)

    def ticks(self, view: View) -> FloatArray:
        """Gives the joints (K, 6) rad of a view every TICK from 0 s until nothing moves any more, as if all belts stood."""
        match view:
            case View.PLANNED:
                return self._planned(TICK * np.arange(len(self._followed), dtype=np.float64))
            case View.TOOL:
                return self._tool
            case View.CONTROLLER:
                if self._reported < len(self._tool):
                    self._report_from(self._reported)
                return self._report

    def joints_of_ticks(self, tick: IndexArray, view: View) -> FloatArray:
        """Gives joints (N, 6) rad at ticks (N,) in a view; they rest before 0 and after the end."""
        values = self.ticks(view)
        return self._along(TICK * tick.astype(np.float64), values[np.clip(tick, 0, len(values) - 1)])

    def joints(self, time: FloatArray, view: View) -> FloatArray:
        """Gives joints (N, 6) rad at times (N,) s in a view; they rest before 0 and after the end."""
        return self._along(time, self._standing(time, view))

    def _standing(self, time: FloatArray, view: View) -> FloatArray:
        """Gives joints (N, 6) rad at times (N,) s in a view as if all belts stood."""
        if view is View.PLANNED:
            return self._planned(time)
        ticks = self.ticks(view)
        if len(ticks) < 2:
            return np.repeat(ticks, len(time), axis=0)
        return np.asarray(CubicSpline(TICK * np.arange(len(ticks)), ticks)(np.clip(time, 0.0, TICK * (len(ticks) - 1))))

    def shift_at(self, time: FloatArray) -> FloatArray:
        """Gives by how much (N, 3) in m conveyor belts carry the arm at times (N,) s, in the base."""
        return shifts(self.chains, time) if self._carried else np.zeros((len(time), 3))

    def out_of_reach_at(self, time: float) -> bool:
        """Gives whether a belt has carried the arm to where it cannot be at `time` s."""
        if not self._carried:
            return False
        _, lost = displaced(self.chains[-1].chain.path.arm, self._joints_at(time, View.TOOL)[None], self.shift_at(np.array([time])))
        return bool(lost[0])

    def _along(self, time: FloatArray, joints: FloatArray) -> FloatArray:
        """Gives joints (N, 6) rad at times (N,) s, carried along with the belts that are followed."""
        if not self._carried or not self.chains:
            return joints
        return displaced(self.chains[-1].chain.path.arm, joints, self.shift_at(time))[0]

    def joint_speeds(self, view: View) -> FloatArray:
        """Gives joint speeds (M, 6) rad/s at all ticks of a view."""
        ticks = self.joints_of_ticks(np.arange(len(self.ticks(view))), view)
        return np.asarray(np.gradient(ticks, TICK, axis=0)) if len(ticks) > 1 else np.zeros_like(ticks)

    def strain(self, since: float) -> float:
        """Gives the greatest share of an axis' speed or acceleration limit that the tool takes where a plan from `since` s shapes it.

        0 for arms whose drives are known by more than such limits.
        """
        ticks = self._tool[max(self._first_tick(since - self.half_filter) - 1, 0) :]
        if not self.model.effort.even or len(ticks) < 3:
            return 0.0
        steps = np.diff(ticks, axis=0)
        speed, acceleration = np.abs(steps) / self.model.speed, np.abs(np.diff(steps, axis=0)) / self.model.acceleration
        return max(float(speed.max()) / TICK, float(acceleration.max()) / TICK**2)

    def move_at(self, time: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
        """Gives the index (N,) of the executed move at times (N,) s; it keeps its value while standing, and is 0 before the first."""
        begins = np.array([executed.begins for executed in self.moves])
        return np.maximum(np.searchsorted(begins, time, side="right") - 1, 0)

    def tool_indices(self) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
        """Gives for each executed move (M,) the index of the first move with the same tool."""
        first: dict[int, int] = {}
        return np.array([first.setdefault(id(executed.move.leg.X_FT), index) for index, executed in enumerate(self.moves)], dtype=np.intp)

    def planned_tcp(self, time: FloatArray) -> tuple[FloatArray, Rotation, FloatArray]:
        """Gives position (N, 3) m, rotation, speed (N,) m/s of the active TCP in the base frame, exactly as planned, at ascending times.

        Where a belt is followed, the speed is that beside the belt.
        """
        position, quaternion, speed = np.empty((len(time), 3)), np.empty((len(time), 4)), np.zeros(len(time))
        starts = np.array([scheduled.start for scheduled in self.chains])
        chain_of = np.clip(np.searchsorted(starts, time, side="right") - 1, 0, None)
        for index in np.unique(chain_of):
            here = np.flatnonzero(chain_of == index)
            scheduled = self.chains[index]
            path = scheduled.chain.path
            s, v, _ = scheduled.chain.timing.at(time[here] - scheduled.start)
            position[here], rotation = path.positions(s)
            quaternion[here] = rotation.as_quat()
            h = 1e-6
            low, high = np.clip(s - h, 0, path.length), np.clip(s + h, 0, path.length)
            moved = np.linalg.norm(path.positions(high)[0] - path.positions(low)[0], axis=1)
            speed[here] = v * moved / np.maximum(high - low, 1e-12)
        position += self.shift_at(time)
        return position, Rotation.from_quat(quaternion), speed

    @property
    def _hold(self) -> int:
        """Gives how many ticks past the lagged plan's end the views go on changing."""
        return int(np.ceil(max(self.model.arm_windows.sum(), self.model.controller_windows.max()) / 2 / TICK)) + 2

    def _planned(self, time: FloatArray) -> FloatArray:
        """Gives the joints (N, 6) rad exactly as planned at times (N,) s."""
        joints = np.repeat(self._q_start[None], len(time), axis=0)
        chain_of = np.searchsorted([scheduled.start for scheduled in self.chains], time, side="right") - 1
        for index in np.unique(chain_of[chain_of >= 0]):
            here = np.flatnonzero(chain_of == index)
            order = here[np.argsort(time[here], kind="stable")]
            scheduled = self.chains[index]
            joints[order] = _joints(scheduled, scheduled.chain.timing.at(time[order] - scheduled.start)[0])
        return joints

    def _first_tick(self, time: float) -> int:
        return int(np.ceil(time / TICK - 1e-9))

    def _extend(self, scheduled: ScheduledChain) -> None:
        """Samples a chain at the ticks along the lagged path, the former one's rest before it, and filters what has become new."""
        lag = self.model.path_lag
        first, beyond = self._first_tick(scheduled.start - lag), self._first_tick(scheduled.end + _TAIL * lag) + 1
        rest = np.repeat(self._followed[-1:], max(first - len(self._followed), 0), axis=0)
        ticks: FloatArray = TICK * np.arange(first, beyond, dtype=np.float64)
        s = scheduled.chain.timing.at(ticks + lag - scheduled.start)[0] - scheduled.behind_at(ticks + lag, lag)
        sampled = np.empty((len(s), 6))
        todo, index = np.arange(len(s)), len(self.chains) - 1
        while len(todo):  # what lags may still be on the path of former chains
            here, before = self.chains[index], index > 0
            own = s[todo] >= here.first if before else np.ones(len(todo), dtype=bool)
            sampled[todo[own]] = _joints(here, np.maximum(s[todo[own]], here.first))
            todo = todo[~own]
            if before:
                s[todo] += self.chains[index - 1].last - here.first
            index -= 1
        sampled[-1] = self.joints_planned_last
        known = min(len(self._followed), first)
        self._followed = np.concatenate([self._followed[:first], rest, sampled])
        self._filter_from(max(known - 2 * self._hold, 0), self._hold)

    def _filter_from(self, tick: int, hold: int) -> None:
        """Computes the tool's view anew from a tick on, `hold` ticks past the plan's end; the controller's when it is asked for."""
        margin = min(2 * hold, tick)
        arm = self._held(tick - margin)
        for width in self.model.arm_windows:
            arm = moving_average(arm, TICK, [width] * 6)
        self._tool = np.concatenate([self._tool[:tick], arm[margin:]])
        self._reported = min(self._reported, tick)

    def _report_from(self, tick: int) -> None:
        """Computes the controller's view anew from a tick on."""
        margin = min(2 * self._hold, tick)
        if self.model.elasticity is not None:
            report = motor_side(self.model, self._tool[tick - margin :], TICK)
        else:
            report = moving_average(self._held(tick - margin), TICK, self.model.controller_windows)
        self._report = np.concatenate([self._report[:tick], report[margin:]])
        self._reported = len(self._report)

    def _held(self, tick: int) -> FloatArray:
        """Gives the joints along the lagged path from a tick on, until all filters have passed its end."""
        return np.concatenate([self._followed[tick:], np.repeat(self._followed[-1:], self._hold, axis=0)])


def _joints(scheduled: ScheduledChain, s: FloatArray) -> FloatArray:
    """Gives the joints (N, 6) rad at ascending coordinates (N,) of a chain's path."""
    path = scheduled.chain.path
    return path.sample(s).joints if path.length > 0 else np.repeat(path.legs[0].q_start[None], len(s), axis=0)
