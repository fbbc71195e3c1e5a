"""From motion effects to a timed chain: legs, zones, caps and timing between two stops, with every refusal at its RAPID line.

Invariant: a chain begins and ends at rest; its legs are exactly the moves it was given, in order.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mitl.motion.grid import Grid, cut
from mitl.motion.limits import Limits, limits_of
from mitl.motion.moves import MovePlanner, PlannedMove
from mitl.motion.orientation import OrientationLaw, evenly
from mitl.motion.pace import fastest
from mitl.motion.path import Corner, Path
from mitl.motion.refusals import beyond, place, refusal
from mitl.motion.robot_model import RobotModel
from mitl.motion.settings import MoveSettings
from mitl.motion.timing import Timing, braked, standing
from mitl.paths import BoolArray, FloatArray, IndexArray
from rapid_interp import effects

_SLOWEST_SHARE = 2e-3
"""A path that must be slower than this share of its programmed speed leads through a singularity."""
_LONGEST = 4 * 3600.0
"""Moves without a stop that take longer (s) are taken for a wrong speed, and not sampled."""
_MOSTLY_TURNING = 100.0
"""A leg whose coordinate is this many times its TCP's way counts as pure reorientation: it has no zone. ASSUMPTION A-02."""
_KINK = 1e-2
"""Share of change in dq/ds from one leg to the next that still counts as smooth."""


@dataclass(frozen=True, eq=False)
class Chain:
    """Moves between two stops: the path and its timing."""

    moves: tuple[PlannedMove, ...]
    path: Path
    timing: Timing

    def passing_times(self) -> FloatArray:
        """Gives times (moves + 1,) in s at which the programmed points are passed: start, middles of the corners, end."""
        return self.timing.times_at(self.path.leg_ends())

    def time_near(self, point: int, distance: float) -> float:
        """Gives the time in s at which the TCP is `distance` m along the path from a programmed point, before it if negative.

        Points count from 0, the chain's start; the middle of a corner stands for its point. Times beyond the chain are those of its ends.
        """
        leg = self.moves[point - 1 if distance < 0 else point].leg if 0 < point < len(self.moves) else self.moves[max(point - 1, 0)].leg
        stretch = leg.length / leg.travel if leg.travel > 0 else 0.0
        position = np.clip(self.path.leg_ends()[point] + distance * stretch, 0.0, self.path.length)
        return float(self.timing.times_at(np.array([position]))[0])

    def stopped(self, time: float, deceleration: float, window: float) -> Chain:
        """Gives the chain that follows this one until `time` s and then brakes along its path at m/s^2, smoothed over `window` s."""
        return replace(self, timing=braked(self.timing, time, deceleration, window))

    def start_at(self, time: float) -> tuple[int, Start]:
        """Gives how to go on from `time` s: the number of the first move to plan again, and the `start` to plan it with.

        The move before the one under way is planned again too where there is one: their corner has to stay as it is.
        """
        ends = self.path.leg_ends()
        position, speed = (float(value[0]) for value in self.timing.at(np.array([time]))[:2])
        leg = int(np.clip(np.searchsorted(ends, position, side="right") - 1, 0, len(self.moves) - 1))
        return max(leg - 1, 0), Start(position - float(ends[leg]), speed, leg=min(leg, 1))


@dataclass(frozen=True)
class Start:
    """Where and how fast a chain begins on its way: m of path from the beginning of leg number `leg`, m/s."""

    position: float
    speed: float
    leg: int = 0


class Planner:
    """Makes legs and chains for one arm. `orientation_law` is where a controller under development may turn the tool wrongly."""

    def __init__(self, model: RobotModel, *, orientation_law: OrientationLaw = evenly) -> None:
        self.model = model
        self._moves = MovePlanner(model, orientation_law=orientation_law)
        self.arm = self._moves.arm

    def plan_move(self, effect: effects.Motion, q_start: FloatArray, settings: MoveSettings) -> PlannedMove:
        """Gives the leg of one instruction that begins at joints q_start (6,) rad. Raises MotionError where it cannot be moved as told."""
        return self._moves.plan(effect, q_start, settings)

    def plan_chain(
        self, moves: Sequence[PlannedMove], *, speed_ratio: float = 1.0, start: Start | None = None, share: float = 1.0
    ) -> Chain:
        """Gives the timed chain of moves, to rest, from rest at its beginning or from `start` on its way, with a share of the drives.

        Raises MotionError where a corner cannot be passed, StartTooFastError where `start` leaves no way to go on.
        """
        path = Path(self.arm, [move.leg for move in moves], [_fitted(*pair) for pair in itertools.pairwise(moves)])
        if path.length == 0:
            return Chain(tuple(moves), path, standing(0.0))
        dynamics = [replace(move.dynamics, acceleration=share * move.dynamics.acceleration) for move in moves]
        grid = cut(path, np.array([move.fastest for move in moves]), self.model)
        self._refuse_unreachable(moves, grid)
        limits = limits_of(path, grid, [move.speed for move in moves], dynamics, self.model, speed_ratio)
        self._refuse_singular(moves, grid, limits)
        position = 0.0 if start is None else float(path.leg_ends()[start.leg]) + start.position
        timing = fastest(limits, _kinks(grid).tolist(), position, 0.0 if start is None else start.speed)
        if timing.duration > _LONGEST:
            slowest = moves[int(np.argmax(np.diff(timing.times_at(path.leg_ends()))))]
            raise refusal(slowest.effect, f"the moves up to the next stop would take {timing.duration:.3g} s, more than {_LONGEST:g} s")
        return Chain(tuple(moves), path, timing)

    def _refuse_unreachable(self, moves: Sequence[PlannedMove], grid: Grid) -> None:
        lost: BoolArray = np.asarray(np.isnan(grid.joints).any(axis=(1, 2)))
        least, most = grid.extremes()
        low, high = least < self.model.lower - 1e-9, most > self.model.upper + 1e-9
        outside: BoolArray = np.asarray(~lost & (low | high).any(axis=1))
        for bad in np.flatnonzero(lost | outside):
            effect = moves[int(grid.leg[bad])].effect
            furthest = np.where(low[bad], least[bad], most[bad])
            raise refusal(effect, f"out of reach at {place(grid.sample.position[bad])}" if lost[bad] else beyond(self.model, furthest))

    def _refuse_singular(self, moves: Sequence[PlannedMove], grid: Grid, limits: Limits) -> None:
        cap = np.sqrt(np.minimum(limits.ceiling[:-1], limits.ceiling[1:]))
        begins = np.flatnonzero(np.diff(grid.leg, prepend=-1))
        suspect = np.minimum.reduceat(cap, begins) < _SLOWEST_SHARE * np.maximum.reduceat(cap, begins)
        for index in grid.leg[begins[suspect]]:
            here = np.flatnonzero(grid.leg == index)
            slowest = here[int(np.argmin(cap[here]))]
            if np.median(cap[here]) * _SLOWEST_SHARE > cap[slowest] and grid.zone[slowest] < 0:
                axis = int(np.argmax(np.abs(grid.rate[slowest]).max(axis=0) / self.model.speed))
                near, axis_5 = place(grid.sample.position[slowest]), np.degrees(grid.sample.joints[slowest][4])
                effect = moves[int(index)].effect
                raise refusal(effect, f"singularity: axis {axis + 1} cannot follow near {near} (axis 5 at {axis_5:.2f} deg)")


def _kinks(grid: Grid) -> IndexArray:
    """Gives the nodes at which two legs meet without a zone and not smoothly, so that the arm must stop there."""
    meets = np.flatnonzero((np.diff(grid.leg) != 0) & (grid.zone[:-1] < 0) & (grid.zone[1:] < 0))
    jump = np.abs(grid.rate[meets + 1, 0] - grid.rate[meets, 1]).max(axis=1, initial=0.0)
    bent = _KINK * (1.0 + np.abs(grid.rate[meets, 1]).max(axis=1, initial=0.0))
    return np.asarray(meets[jump > bent] + 1)


def _fitted(before: PlannedMove, after: PlannedMove) -> Corner:
    """Gives the zone between two moves, each radius at most half of either leg; none beside a leg on which the TCP does not travel."""
    legs = (before.leg, after.leg)
    half = 0.5 * min(leg.travel for leg in legs)
    if half < 1e-6 or any(leg.length > _MOSTLY_TURNING * leg.travel for leg in legs):
        return Corner(0.0, 0.0)
    return Corner(min(before.zone.radius, half), min(before.zone.turn_radius, half))
