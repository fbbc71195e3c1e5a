"""How fast each interval of a path may be passed and how hard the path may be sped up in it: programmed speed, joints, drives, zones.

Speeds are limits on x = s'^2, drives limits linear in (s'', x): half-planes. Invariant: half-planes hold at both ends and in the
middle of every interval, with a margin for what lies between.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mitl.motion.bends import bend_caps, limited
from mitl.motion.dynamics import Dynamics
from mitl.motion.effort import Efforts
from mitl.motion.grid import STATIONS, Grid
from mitl.motion.legs import JointLeg, Leg
from mitl.motion.path import Path
from mitl.motion.robot_model import RobotModel
from mitl.paths import FloatArray, IndexArray

CONTROLLER_TICK = 4.032e-3
"""A zone lasts at least this long, in s (`facts/planner.md`, item 2)."""
_EVEN = 5e-4
"""Share by which the TCP may be faster than its leg's coordinate before its speed is capped by itself; rounding in `Path` is below it."""
_MARGIN = 0.99
"""Share of a joint's limit that the plan uses: half-planes hold at nodes, and between them only nearly."""
_LEAST_LEFT = 0.05
"""Share of a drive's limit that gravity never takes."""
_NO_LEVER = 1e-9
"""Least effort per m/s^2 of path that counts; a joint that does not move along the path is given it, so that nothing is divided by 0."""


@dataclass(frozen=True)
class LegSpeed:
    """What is programmed for a leg: tcp m/s, turning rad/s; or duration s, which replaces both."""

    tcp: float
    turning: float
    duration: float | None = None


@dataclass(frozen=True, eq=False)
class HalfPlanes:
    """What R drives leave for the path's acceleration u = s'' at S stations of N intervals: -down <= along u + across x <= up.

    along (not negative), across, up, down (N, S, R). ceiling (N+1,): greatest x = s'^2 at the nodes. widths (N,) m.
    """

    along: FloatArray
    across: FloatArray
    up: FloatArray
    down: FloatArray
    ceiling: FloatArray
    widths: FloatArray

    def between(self, node: int, last: int, gap: float) -> HalfPlanes:
        """Gives the half-planes from a place `gap` m before a node up to the node `last`; the interval the place lies in is cut."""
        kept = slice(node - 1, last)
        widths = self.widths[kept].copy()
        widths[0] = gap
        ceiling = self.ceiling[node - 1 : last + 1]
        return HalfPlanes(self.along[kept], self.across[kept], self.up[kept], self.down[kept], ceiling, widths)

    def halved(self, intervals: IndexArray) -> HalfPlanes:
        """Gives the half-planes with some intervals (K,) cut in their middles, where the lower of their ends' ceilings holds."""
        times = np.ones(len(self.widths), dtype=np.intp)
        times[intervals] = 2
        rows = np.repeat(np.arange(len(times)), times)
        middles = np.minimum(self.ceiling[intervals], self.ceiling[intervals + 1])
        ceiling = np.insert(self.ceiling, intervals + 1, middles)
        return HalfPlanes(self.along[rows], self.across[rows], self.up[rows], self.down[rows], ceiling, (self.widths / times)[rows])

    def even(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Gives rise, fall, lean (N, S R) for an even u in an interval with x at its begin: -fall - lean x <= u <= rise - lean x."""
        across = self.across
        along = self.along + 2 * self.widths[:, None, None] * STATIONS[:, None] * across  # x grows by 2 u a metre
        forwards = along >= 0
        lever = np.maximum(np.abs(along), _NO_LEVER)
        rise, fall = np.where(forwards, self.up, self.down) / lever, np.where(forwards, self.down, self.up) / lever
        lean = np.where(forwards, across, -across) / lever
        count = len(self.widths)
        return rise.reshape(count, -1), fall.reshape(count, -1), lean.reshape(count, -1)

    def anywhere(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gives the greatest and the least u (N,) that are allowed at all stations of every interval with x (N,)."""
        lever = np.maximum(self.along, _NO_LEVER)
        used = self.across * x[:, None, None]
        return np.asarray(((self.up - used) / lever).min(axis=(1, 2))), np.asarray(((-self.down - used) / lever).max(axis=(1, 2)))


@dataclass(frozen=True, eq=False)
class Limits:
    """The limits of a path on a grid of N intervals, but for how drives weaken with speed.

    ceiling (N+1,): greatest x by programmed speed, joint speeds and ticks. effort: at the stations, (N, S, 6) each. share (N,) of drives
    to be used; rise, fall (N,): most m/s^2 along the path of a limited TCP or by PathAccLim, in m of path. bend (N,): greatest x by the
    TCP's acceleration across the path.
    """

    grid: Grid
    model: RobotModel
    ceiling: FloatArray
    effort: Efforts
    share: FloatArray
    rise: FloatArray
    fall: FloatArray
    bend: FloatArray

    def half_planes(self, x: FloatArray) -> HalfPlanes:
        """Gives the half-planes where the drives give what they can at x (M+1,), of the first M intervals."""
        x = np.append(x, np.full(len(self.ceiling) - len(x), x[-1]))
        grid = self.grid
        between = x[:-1, None] + STATIONS * (x[1:] - x[:-1])[:, None]
        speeds = np.abs(grid.rate) * np.sqrt(between)[:, :, None] / self.model.speed
        given = _MARGIN * self.model.effort.available(speeds.reshape(-1, 6)).reshape(speeds.shape)
        least = _LEAST_LEFT * given
        up = self.share[:, None, None] * np.maximum(given - self.effort.resting, least)
        down = self.share[:, None, None] * np.maximum(given + self.effort.resting, least)
        along, across = np.abs(self.effort.along), self.effort.across
        backwards = self.effort.along < 0
        up, down, across = np.where(backwards, down, up), np.where(backwards, up, down), np.where(backwards, -across, across)
        with np.errstate(divide="ignore"):
            level = (np.where(across > 0, up, down) / np.abs(across)).min(axis=(1, 2))
        if np.isfinite(self.rise).any() or np.isfinite(self.fall).any():  # one more drive that knows nothing of joints
            wide = (*along.shape[:2], 1)
            along, across = np.concatenate([along, np.ones(wide)], axis=2), np.concatenate([across, np.zeros(wide)], axis=2)
            most, least_of_all = (np.broadcast_to(values[:, None, None], wide) for values in (self.rise, self.fall))
            up, down = np.concatenate([up, most], axis=2), np.concatenate([down, least_of_all], axis=2)
        held = self.model.zone_factor**2 * _held_through_zones(np.minimum(level, self.bend), grid.zone)
        return HalfPlanes(along, across, up, down, np.minimum(self.ceiling, _at_nodes(held)), grid.widths)


def limits_of(
    path: Path,
    grid: Grid,
    speeds: Sequence[LegSpeed],
    dynamics: Sequence[Dynamics],
    model: RobotModel,
    speed_ratio: float = 1.0,
) -> Limits:
    """Gives the limits of a path whose legs have programmed speeds, scaled by `speed_ratio`, and dynamics."""
    count = len(grid)
    programmed = speed_ratio * _programmed(path, grid, speeds)
    of_leg = np.array([(how.acceleration, how.path_acceleration, how.path_deceleration) for how in dynamics])
    share, rise, fall = of_leg[grid.leg].T
    with np.errstate(divide="ignore"):
        by_joints = _MARGIN * np.min(model.speed / np.abs(grid.rate), axis=(1, 2))
    x = np.minimum.reduce([programmed, by_joints, _tick_cap(path, grid)]) ** 2
    ceiling, bend = _at_nodes(x), np.full(count, np.inf)
    if model.tcp_limited:
        caps = bend_caps(path, grid, x, limited(path, grid, model.corner_acceleration, share), CONTROLLER_TICK)
        ceiling, bend = np.minimum(ceiling, caps), np.minimum(caps[:-1], caps[1:])
        along = limited(path, grid, model.tcp_acceleration, share)
        rise, fall = np.minimum(rise, along), np.minimum(fall, along)
    # TCP limits hold for m of path a second where the TCP travels less than the path's coordinate
    stretch = np.maximum(grid.stretch.max(axis=1), _NO_LEVER)
    flat = [np.asarray(values).reshape(-1, 6) for values in (grid.joints, grid.rate, grid.bend)]
    found = model.effort.efforts(*flat)
    shape = grid.rate.shape
    effort = Efforts(found.along.reshape(shape), found.across.reshape(shape), found.resting.reshape(shape))
    return Limits(grid, model, ceiling, effort, share, rise / stretch, fall / stretch, bend)


def _programmed(path: Path, grid: Grid, speeds: Sequence[LegSpeed]) -> FloatArray:
    """Gives the programmed speeds (N,) in m of path coordinate a second."""
    stretch = np.maximum(grid.stretch.max(axis=1), _NO_LEVER)
    of_leg = [_evenly(leg, speed) for leg, speed in zip(path.legs, speeds, strict=True)]
    even, tcp, most_stretch = np.array(of_leg)[grid.leg].T
    # Only a blend in joint space can make the TCP faster than its leg's coordinate.
    quicker = (grid.zone >= 0) & (stretch > (1 + _EVEN) * most_stretch)
    found = np.where(quicker, np.minimum(even, tcp / stretch), even)
    for index, (leg, speed) in enumerate(zip(path.legs, speeds, strict=True)):
        if (
            isinstance(leg, JointLeg) and leg.length > 0 and speed.duration is None
        ):  # its fastest place decides, so that the joints run evenly
            here = grid.leg == index
            by_tcp = speed.tcp / np.maximum(leg.fastest / leg.length, stretch[here])
            turning = np.maximum(leg.quickest / leg.length, np.maximum(grid.turning[here], _NO_LEVER))
            found[here] = np.minimum(by_tcp, speed.turning / turning)
    return np.asarray(found)


def _evenly(leg: Leg, speed: LegSpeed) -> tuple[float, float, float]:
    """Gives a leg's even speed in m of its coordinate a second, the TCP's, and m of TCP per m of coordinate; inf where nothing limits."""
    if leg.length == 0:
        return np.inf, np.inf, np.inf
    if speed.duration is not None:
        return leg.length / speed.duration, np.inf, np.inf
    even = speed.tcp * leg.length / leg.travel if leg.travel > 0 else np.inf
    if leg.turning > 0:
        even = min(even, speed.turning * leg.length / leg.turning)
    return even, speed.tcp, leg.travel / leg.length


def _held_through_zones(cap: FloatArray, zone: IndexArray) -> FloatArray:
    """Gives caps (N,) under which no interval of a zone is passed faster than any that is still to come in the same zone."""
    held = np.where(zone >= 0, cap, np.inf)
    inside = np.flatnonzero(zone >= 0)
    if len(inside) == 0:
        return held
    for run in np.split(inside, np.flatnonzero(np.diff(zone[inside])) + 1):
        held[run] = np.minimum.accumulate(held[run][::-1])[::-1]
    return np.asarray(held)


def _tick_cap(path: Path, grid: Grid) -> FloatArray:
    """Gives the speed cap (N,) that makes every zone last at least one controller tick."""
    return np.where(grid.zone >= 0, np.append(path.zone_widths(), np.inf)[grid.zone] / CONTROLLER_TICK, np.inf)


def _at_nodes(cap: FloatArray) -> FloatArray:
    """Gives caps (N+1,) at nodes: the lower of the intervals' (N,) beside them."""
    return np.asarray(np.minimum(np.append(cap, np.inf), np.append(np.inf, cap)))
