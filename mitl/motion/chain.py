"""From motion effects to a timed chain: legs, zones, caps and timing between two stops, with every refusal at its RAPID line.

Invariant: a chain begins and ends at rest; its legs are exactly the moves it was given, in order.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import simpson
from scipy.spatial.transform import RigidTransform

from mitl.errors import MitlError, MotionError
from mitl.motion import bridge
from mitl.motion.cells import Cells
from mitl.motion.dynamics import AS_FAST_AS_IT_CAN, Dynamics
from mitl.motion.kinematics import STRAIGHT_THROUGH, Arm
from mitl.motion.legs import Arc, CartesianLeg, GeometryError, JointLeg, Leg, Line, OrientationLaw, arc_through, evenly, line_through
from mitl.motion.limits import Grid, LegSpeed, cells_of, cut
from mitl.motion.pace import Pace
from mitl.motion.path import Corner, IndexArray, Path
from mitl.motion.robot_model import RobotModel
from mitl.motion.timing import Timing, braked, standing
from mitl.paths import BoolArray, FloatArray
from rapid_interp import data, effects

_TRACKING_STEP = 0.02
_FEWEST_STEPS = 8
_LARGEST_JUMP = 0.6
"""A joint that turns more than this (rad) over one tracking step has met a singularity or changed its solution."""
_COARSE_STEP, _FINE_STEP = 1e-3, 1e-5
"""Steps in m to which a track is refined: where axis 5 comes near 0, and where the joints then run unevenly."""
_UNEVEN = 0.05
"""Change of a joint's step in rad from one step to the next that calls for finer ones."""
_UNEVEN_THROUGH = 2 * STRAIGHT_THROUGH
"""The same for axis 4 beside a step in which axis 5 goes through 0."""
_MOST_HALVINGS = 12
_SLOWEST_SHARE = 2e-3
"""A path that must be slower than this share of its programmed speed leads through a singularity."""
_QUADRATURE = 64
_FARTHEST = 50.0
"""No arm's way is this long (m); a longer one is refused before it is followed step by step."""
_LONGEST = 4 * 3600.0
"""Moves without a stop that take longer (s) are taken for a wrong speed, and not sampled."""
_MOST_TIGHTENINGS = 40
_SLOWER = 0.999
_ROUNDED = 5e-4
"""Share by which a cap may differ from one plan to the next of the same stretch; the margin is far wider."""
_FULL = 1.001
"""Strain of a joint, as a share of its acceleration limit less the margin, that counts as within it; the margin is ten times wider."""
_SHORTEST_MOVE = 5e-7
"""A move of less length in m is none: the arm stands, and the next move begins where it stands."""
_MOSTLY_TURNING = 100.0
"""A leg whose coordinate is this many times its TCP's way counts as pure reorientation: it has no zone. ASSUMPTION A-02."""
_KINK = 1e-2
"""Share of change in dq/ds between two neighbouring cells' middles that still counts as smooth."""


@dataclass(frozen=True)
class Configuring:
    """Whether linear and joint moves must end in the programmed axis configuration (ConfL, ConfJ)."""

    linear: bool = True
    joint: bool = True


@dataclass(frozen=True, eq=False)
class PlannedMove:
    """One motion effect with its leg, its programmed speed and its zone radii in m; fine has none. dynamics: how hard it may accelerate."""

    effect: effects.Motion
    leg: Leg
    speed: LegSpeed
    zone: Corner
    X_BO: RigidTransform
    dynamics: Dynamics = AS_FAST_AS_IT_CAN

    @property
    def fine(self) -> bool:
        """Gives whether the robot stops at the end of the move."""
        return self.effect.zone.finep


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
    """Where and how fast a chain begins on its way: m of path from the beginning of leg number `leg`, m/s, no acceleration.

    ahead: distances in m from there at which the plan so far ran without acceleration, and its speeds in m/s there: it may do so again.
    """

    position: float
    speed: float
    leg: int = 0
    ahead: tuple[tuple[float, float], ...] = ()


class StartTooFastError(MitlError):
    """A chain that begins on its way would have to be slower there than it is; the plan so far, to a stop, still holds."""


class Planner:
    """Makes legs and chains for one arm. `orientation_law` is where a controller under development may turn the tool wrongly."""

    def __init__(self, model: RobotModel, *, orientation_law: OrientationLaw = evenly) -> None:
        self.model = model
        self.arm = Arm(model)
        self._law = orientation_law
        self._tools: dict[data.Pose, RigidTransform] = {}

    def plan_move(self, effect: effects.Motion, q_start: FloatArray, configuring: Configuring) -> PlannedMove:
        """Gives the leg of one instruction that begins at joints q_start (6,) rad. Raises MotionError where it cannot be moved as told."""
        if not effect.tool.robhold:
            raise _refusal(effect, "a stationary tool (robhold FALSE) is not supported yet")
        if effect.wobj.robhold or not effect.wobj.ufprog:
            raise _refusal(effect, "a work object held by a robot or moved by a mechanical unit is not supported yet")
        try:
            # One transform a tool: legs compare tools by identity.
            X_FT = self._tools.setdefault(effect.tool.tframe, bridge.tool_frame(effect.tool))
            X_BO = bridge.work_object_frame(effect.wobj)
            leg = self._leg(effect, q_start, X_FT, X_BO, configuring)
            if leg.length < _SHORTEST_MOVE:
                leg = JointLeg(q_start, q_start, X_FT, 0.0, 0.0, 0.0)
        except (GeometryError, ValueError) as error:
            raise _refusal(effect, str(error)) from error
        return PlannedMove(effect, leg, self._speed(effect), _zone(effect), X_BO)

    def plan_chain(self, moves: Sequence[PlannedMove], *, speed_ratio: float = 1.0, start: Start | None = None) -> Chain:
        """Gives the timed chain of moves, to rest, from rest at its beginning or from `start` on its way.

        Raises MotionError where a corner cannot be passed, StartTooFastError where `start` leaves no way to go on.
        """
        path = Path(self.arm, [move.leg for move in moves], [_fitted(*pair) for pair in itertools.pairwise(moves)])
        if path.length == 0:
            return Chain(tuple(moves), path, standing(0.0))
        grid = cut(path)
        self._refuse_unreachable(moves, grid)
        cells = cells_of(path, grid, [move.speed for move in moves], self.model, speed_ratio)
        self._refuse_singular(moves, grid, cells)
        stops = grid.edges[_kinks(grid)]
        begin = Start(0.0, 0.0) if start is None else Start(path.leg_ends()[start.leg] + start.position, start.speed, start.leg)
        timing = self._timing(_passable(cells.after(begin.position), begin.speed), begin, stops)
        if timing.duration > _LONGEST:
            slowest = moves[int(np.argmax(np.diff(timing.times_at(path.leg_ends()))))]
            raise _refusal(slowest.effect, f"the moves up to the next stop would take {timing.duration:.3g} s, more than {_LONGEST:g} s")
        if timing.speed[0] < begin.speed * (1 - 1e-9):
            raise StartTooFastError(f"{begin.speed:.6g} m/s at the start, at most {timing.speed[0]:.6g} m/s is possible")
        return Chain(tuple(moves), path, timing)

    def _leg(
        self, effect: effects.Motion, q_start: FloatArray, X_FT: RigidTransform, X_BO: RigidTransform, configuring: Configuring
    ) -> Leg:
        match effect:
            case effects.MoveAbsJ():
                q_end = bridge.joints_of(effect.target)
                self._refuse_beyond_limits(effect, q_end)
                return self._joint_leg(q_start, q_end, X_FT)
            case effects.MoveJ():
                X_BF = X_BO * bridge.target_frame(effect.target) * X_FT.inv()
                return self._joint_leg(q_start, self._end_of_joint_move(effect, X_BF, q_start, configuring), X_FT)
            case effects.MoveL() | effects.MoveC():
                return self._cartesian_leg(effect, q_start, X_FT, X_BO, configuring)

    def _joint_leg(self, q_start: FloatArray, q_end: FloatArray, X_FT: RigidTransform) -> JointLeg:
        """Gives the leg with the TCP's way, and its greatest speeds, by differences at both ends and in between."""
        step = 1e-4
        shares = np.linspace(0, 1 - step, _QUADRATURE + 1)[:, None]
        here, there = (self.arm.flange(q_start + s * (q_end - q_start)) * X_FT for s in (shares, shares + step))
        speeds = np.linalg.norm(there.translation - here.translation, axis=1) / step
        turns = (here.rotation.inv() * there.rotation).magnitude() / step
        travel = float(simpson(speeds, dx=1 / _QUADRATURE))
        return JointLeg(q_start, q_end, X_FT, travel, float(speeds.max()), float(turns.max()))

    def _end_of_joint_move(self, effect: effects.MoveJ, X_BF: RigidTransform, near: FloatArray, configuring: Configuring) -> FloatArray:
        if len(self.arm.solutions(X_BF)) == 0:
            raise _refusal(effect, f"target {_point(X_BF)} is out of reach")
        wanted = bridge.configuration_of(effect.target)
        q_end = self.arm.configured(X_BF, wanted) if configuring.joint else self.arm.nearest(X_BF, near)
        if q_end is not None:
            return q_end
        possible = [self.arm.turned_near(q, near) for q in self.arm.solutions(X_BF)]
        allowed = [str(self.arm.configuration(q)) for q in possible if self.arm.within_limits(q)]
        if not allowed:
            raise _refusal(effect, f"target {_point(X_BF)} can only be reached beyond an axis limit: {self._beyond(possible[0])}")
        raise _refusal(
            effect,
            f"configuration {wanted} cannot be reached at the target; possible are {', '.join(sorted(set(allowed)))} (or use ConfJ \\Off)",
        )

    def _cartesian_leg(
        self,
        effect: effects.MoveL | effects.MoveC,
        q_start: FloatArray,
        X_FT: RigidTransform,
        X_BO: RigidTransform,
        configuring: Configuring,
    ) -> CartesianLeg:
        X_BT_start = self.arm.flange(q_start) * X_FT
        X_BT_end = X_BO * bridge.target_frame(effect.target)
        start, end = X_BT_start.translation, X_BT_end.translation
        if isinstance(effect, effects.MoveC):
            curve: Line | Arc = arc_through(start, (X_BO * bridge.target_frame(effect.via)).translation, end)
        else:
            curve = line_through(start, end)
        turn = (X_BT_start.rotation.inv() * X_BT_end.rotation).as_rotvec()
        if np.linalg.norm(turn) < 1e-9:  # RAPID's rounded quaternions, not a turn
            turn = np.zeros(3)
        leg = self._followed(effect, CartesianLeg(curve, X_BT_start.rotation, turn, self._law, X_FT, np.zeros(1), q_start[None]))
        if configuring.linear and not self.arm.matches(leg.q_end, bridge.configuration_of(effect.target)):
            wanted = bridge.configuration_of(effect.target)
            raise _refusal(
                effect, f"the move ends in configuration {self.arm.configuration(leg.q_end)}, programmed is {wanted} (or use ConfL \\Off)"
            )
        return leg

    def _followed(self, effect: effects.Motion, leg: CartesianLeg) -> CartesianLeg:
        """Gives the leg with its joints followed to its end. Raises MotionError where that is impossible."""
        if not leg.length <= _FARTHEST:
            raise _refusal(effect, f"out of reach: the way is {leg.length:.3g} m long")
        steps = max(_FEWEST_STEPS, int(np.ceil(leg.length / _TRACKING_STEP)))
        leg = self._tracked(effect, leg, np.linspace(0, leg.length, steps + 1))
        for _ in range(_MOST_HALVINGS):
            close = _near_singularity(leg.marks, leg.track)
            if not close.any():
                break
            halves = 0.5 * (leg.marks[:-1] + leg.marks[1:])[close]
            leg = self._tracked(effect, leg, np.sort(np.concatenate([leg.marks, halves])))
        jumps = np.abs(np.diff(leg.track, axis=0))
        if jumps.max() > _LARGEST_JUMP:
            step, axis = np.unravel_index(int(np.argmax(jumps)), jumps.shape)
            place = _xyz(leg.position(leg.marks[[step + 1]])[0])
            raise _refusal(effect, f"singularity: axis {axis + 1} would turn {np.degrees(jumps.max()):.0f} deg at once near {place}")
        through = np.diff(np.signbit(leg.track[:, 4])) & _uneven(leg.marks, leg.track)
        if through.any():
            place = _xyz(leg.position(leg.marks[[int(np.argmax(through))]])[0])
            raise _refusal(effect, f"singularity: axes 4 and 6 would turn over at once near {place}, where axis 5 goes through 0")
        for row in leg.track[1:]:
            self._refuse_beyond_limits(effect, row)
        return leg

    def _tracked(self, effect: effects.Motion, leg: CartesianLeg, marks: FloatArray) -> CartesianLeg:
        position, rotation = leg.position(marks[1:]), leg.rotation(marks[1:])
        q = self.arm.joints(RigidTransform.from_components(position, rotation) * leg.X_FT.inv(), leg.q_start)
        lost = np.isnan(q).any(axis=1)
        if lost.any():
            raise _refusal(effect, f"out of reach at {_xyz(position[int(np.argmax(lost))])}")
        return replace(leg, marks=marks, track=np.vstack([leg.q_start, q]))

    def _refuse_beyond_limits(self, effect: effects.Motion, q: FloatArray) -> None:
        if not self.arm.within_limits(q):
            raise _refusal(effect, self._beyond(q))

    def _beyond(self, q: FloatArray) -> str:
        model = self.model
        axis = int(np.argmax(np.maximum(q - model.upper, model.lower - q)))
        limit = model.upper[axis] if q[axis] > model.upper[axis] else model.lower[axis]
        return f"axis {axis + 1} would be at {np.degrees(q[axis]):.2f} deg, its limit is {np.degrees(limit):g} deg"

    def _speed(self, effect: effects.Motion) -> LegSpeed:
        tcp = bridge.MM * (effect.speed.v_tcp if effect.tcp_speed is None else effect.tcp_speed)
        if tcp <= 0 or effect.speed.v_ori <= 0:
            raise _refusal(effect, f"speed must be positive, is {1e3 * tcp:g} mm/s and {effect.speed.v_ori:g} deg/s")
        if effect.duration is not None and effect.duration <= 0:
            raise _refusal(effect, f"\\T must be positive, is {effect.duration:g} s")
        return LegSpeed(min(tcp, self.model.vmax), np.radians(effect.speed.v_ori), effect.duration)

    def _refuse_unreachable(self, moves: Sequence[PlannedMove], grid: Grid) -> None:
        joints = grid.middle.joints
        lost: BoolArray = np.asarray(np.isnan(joints).any(axis=1))
        least, most = grid.extremes()
        low, high = least < self.model.lower - 1e-9, most > self.model.upper + 1e-9
        beyond: BoolArray = np.asarray(~lost & (low | high).any(axis=1))
        for bad in np.flatnonzero(lost | beyond):
            effect = moves[int(grid.leg[bad])].effect
            furthest = np.where(low[bad], least[bad], most[bad])
            raise _refusal(effect, f"out of reach at {_xyz(grid.middle.position[bad])}" if lost[bad] else self._beyond(furthest))

    def _refuse_singular(self, moves: Sequence[PlannedMove], grid: Grid, cells: Cells) -> None:
        for index, move in enumerate(moves):
            here = np.flatnonzero(grid.leg == index)
            caps = cells.cap[here]
            if len(here) and np.median(caps) * _SLOWEST_SHARE > caps.min() and grid.zone[here[int(np.argmin(caps))]] < 0:
                slowest = here[int(np.argmin(caps))]
                axis = int(np.argmax(np.abs(grid.rate[slowest]) / self.model.speed))
                place, axis_5 = _xyz(grid.middle.position[slowest]), np.degrees(grid.middle.joints[slowest][4])
                raise _refusal(move.effect, f"singularity: axis {axis + 1} cannot follow near {place} (axis 5 at {axis_5:.2f} deg)")

    def _timing(self, cells: Cells, start: Start, stops: FloatArray) -> Timing:
        """Gives the timing with caps lowered until no joint's acceleration limit is broken anywhere."""
        edges = [int(np.searchsorted(cells.edges, stop)) for stop in stops if stop > cells.edges[0] + 1e-9]
        if len(cells) == 0:
            return standing(float(cells.edges[0]))
        knots = {int(np.argmin(np.abs(cells.edges - (cells.edges[0] + way)))): speed for way, speed in start.ahead}
        pace = Pace(cells, self.model.acceleration_window, speed_at_start=start.speed, stops=edges, knots=knots)
        for _ in range(_MOST_TIGHTENINGS):
            timing = pace.timing()
            strain, speed = cells.strain(timing)
            if strain.max(initial=0.0) <= _FULL:
                break
            cap = np.minimum(cells.cap, _SLOWER * speed / np.sqrt(np.maximum(strain, 1.0)))
            # Where a chain begins on its way its speed is given: only the acceleration can be less.
            given = (cap < start.speed) & (cells.middle - cells.edges[0] < start.speed * self.model.acceleration_window)
            cells = replace(cells, cap=np.where(given, cells.cap, cap), ceiling=np.where(given, 0.5 * cells.ceiling, cells.ceiling))
            pace.change(cells)
        return timing


def _passable(cells: Cells, speed: float) -> Cells:
    """Gives cells whose caps do not lie under a chain's speed at its start by mere rounding."""
    close = (cells.cap < speed) & (cells.cap >= (1 - _ROUNDED) * speed)
    return replace(cells, cap=np.where(close, speed, cells.cap))


def _near_singularity(marks: FloatArray, track: FloatArray) -> BoolArray:
    """Gives which of a track's K - 1 steps are too long to see what the joints do in them.

    First axis 5 decides, which a long step may carry through 0 where the wrist really turns over; then how evenly the joints run.
    """
    step = np.diff(track, axis=0)
    width = np.diff(marks)
    wrist = np.abs(step[:, 4])
    wrist[1:] = np.maximum(wrist[1:], np.abs(step[:-1, 4]))
    wrist[:-1] = np.maximum(wrist[:-1], np.abs(step[1:, 4]))
    axis_5 = np.abs(track[:, 4])
    near = (np.minimum(axis_5[:-1], axis_5[1:]) < wrist) & (width > _COARSE_STEP)
    return np.asarray(near | (_uneven(marks, track) & (width > _FINE_STEP)))


def _uneven(marks: FloatArray, track: FloatArray) -> BoolArray:
    """Gives in which of a track's K - 1 steps the joints run unevenly; where axis 5 goes through 0, axis 4 has to lie still."""
    step, width = np.diff(track, axis=0), np.diff(marks)
    rate = step / np.maximum(width, 1e-12)[:, None]
    change = np.abs(np.diff(rate, axis=0)).max(axis=1) * np.minimum(width[1:], width[:-1])
    through = np.diff(np.signbit(track[:, 4])) & (np.abs(step[:, 4]) > 0)
    beside = through[1:] | through[:-1]
    beside[1:] |= through[:-2]
    beside[:-1] |= through[2:]
    change = np.where(beside, np.maximum(change, np.abs(step[1:, 3] - step[:-1, 3]) * _UNEVEN / _UNEVEN_THROUGH), change)
    found = np.zeros(len(step), dtype=bool)
    found[1:] |= change > _UNEVEN
    found[:-1] |= change > _UNEVEN
    return found


def _kinks(grid: Grid) -> IndexArray:
    """Gives the edges of cells at which two legs meet without a zone and not smoothly, so that the arm must stop there."""
    meets = np.flatnonzero((np.diff(grid.leg) != 0) & (grid.zone[:-1] < 0) & (grid.zone[1:] < 0))
    jump = np.abs(grid.rate[meets + 1] - grid.rate[meets]).max(axis=1, initial=0.0)
    bent = _KINK * (1.0 + np.abs(grid.rate[meets]).max(axis=1, initial=0.0))
    return np.asarray(meets[jump > bent] + 1)


def _fitted(before: PlannedMove, after: PlannedMove) -> Corner:
    """Gives the zone between two moves, each radius at most half of either leg; none beside a leg on which the TCP does not travel."""
    legs = (before.leg, after.leg)
    half = 0.5 * min(leg.travel for leg in legs)
    if half < 1e-6 or any(leg.length > _MOSTLY_TURNING * leg.travel for leg in legs):
        return Corner(0.0, 0.0)
    return Corner(min(before.zone.radius, half), min(before.zone.turn_radius, half))


def _zone(effect: effects.Motion) -> Corner:
    zone = effect.zone
    if zone.finep:
        return Corner(0.0, 0.0)
    radius = zone.pzone_tcp if effect.zone_mm is None else effect.zone_mm
    return Corner(bridge.MM * radius, bridge.MM * max(radius, zone.pzone_ori))


def _refusal(effect: effects.Motion, reason: str) -> MotionError:
    at = effect.at
    return MotionError(f"{type(effect).__name__}: {reason}", module=at.module, line=at.line, file=at.file)


def _xyz(position: FloatArray) -> str:
    x, y, z = 1e3 * position
    return f"[{x:.1f}, {y:.1f}, {z:.1f}] mm in the base frame"


def _point(X_BF: RigidTransform) -> str:
    return "with the flange at " + _xyz(X_BF.translation)
