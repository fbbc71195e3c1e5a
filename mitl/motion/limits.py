"""How fast each stretch of a path may be passed: programmed speed, joint speed and acceleration, curvature, zones.

Invariant: passing the path under these caps, with no tangential acceleration, breaks no limit of the robot model.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mitl.motion.cells import Cells
from mitl.motion.legs import CartesianLeg, JointLeg, Leg
from mitl.motion.path import IndexArray, Path, Sample
from mitl.motion.robot_model import RobotModel
from mitl.paths import BoolArray, FloatArray

CONTROLLER_TICK = 4.032e-3
"""A zone lasts at least this long, in s (`facts/planner.md`, item 2)."""
_LONGEST_CELL = 0.02
_CELLS_IN_ZONE_PIECE = 4
_CELLS_PER_PIECE = 4
_MOST_CELLS = 60
_CLOSEST_MARK = 1e-6
_EVEN = 5e-4
"""Share by which the TCP may be faster than its leg's coordinate before its speed is capped by itself; rounding in `Path` is below it."""
_MARGIN = 0.99
"""Share of a joint's limit that the plan uses: in a cell its derivatives are known to third order only."""


@dataclass(frozen=True)
class LegSpeed:
    """What is programmed for a leg: tcp m/s, turning rad/s; or duration s, which replaces both."""

    tcp: float
    turning: float
    duration: float | None = None


@dataclass(frozen=True, eq=False)
class Grid:
    """A path cut into N cells, with its derivatives at their middles.

    edges (N+1,) in s; leg (N,) of each cell; zone (N,): the corner in whose TCP zone it lies, or -1.
    rate, bend, twist (N, 6): dq/ds, d2q/ds2, d3q/ds3. stretch (N,): TCP m per m of s;
    curl (N,): m/m^2 of the TCP; turning (N,) rad per m of s.
    """

    edges: FloatArray
    leg: IndexArray
    zone: IndexArray
    rate: FloatArray
    bend: FloatArray
    twist: FloatArray
    stretch: FloatArray
    curl: FloatArray
    turning: FloatArray
    middle: Sample

    @property
    def middles(self) -> FloatArray:
        """Gives the middles (N,) of the cells in s."""
        return np.asarray(0.5 * (self.edges[:-1] + self.edges[1:]))

    def extremes(self) -> tuple[FloatArray, FloatArray]:
        """Gives the least and the greatest joint angles (N, 6) rad in the cells, to second order."""
        half = 0.5 * np.diff(self.edges)[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            turns_at = np.nan_to_num(-self.rate / self.bend)
        offsets = (-half, half, np.clip(turns_at, -half, half))
        values = [self.middle.joints + away * (self.rate + 0.5 * away * self.bend) for away in offsets]
        return np.minimum.reduce(values), np.maximum.reduce(values)


def cut(path: Path) -> Grid:
    """Gives the path cut into cells that resolve its zones, with derivatives by central differences."""
    pieces = path.pieces()
    edges = pieces.edges
    in_zone = _CELLS_IN_ZONE_PIECE * np.ceil(1 + 1.5 * np.append(path.unevenness(), 0.0)[pieces.zone])
    counts = np.where(pieces.zone >= 0, in_zone, np.clip(np.ceil(np.diff(edges) / _LONGEST_CELL), _CELLS_PER_PIECE, _MOST_CELLS)).astype(
        int
    )
    fine_edges = np.concatenate(
        [np.linspace(low, high, n, endpoint=False) for low, high, n in zip(edges[:-1], edges[1:], counts, strict=True)]
    )
    fine_edges = _with(np.append(fine_edges, edges[-1]), path.close_marks())
    widths = np.diff(fine_edges)
    middles = 0.5 * (fine_edges[:-1] + fine_edges[1:])
    piece = np.clip(np.searchsorted(edges, middles, side="right") - 1, 0, len(counts) - 1)
    h = np.minimum(0.45 * widths, 2e-4)
    asked = np.stack([middles - h, middles, middles + h], axis=1).ravel()
    sample = path.sample(asked)
    q = sample.joints.reshape(-1, 3, 6)
    p = sample.position.reshape(-1, 3, 3)
    turn = (sample.rotation[0::3].inv() * sample.rotation[2::3]).magnitude()
    bend = (q[:, 2] - 2 * q[:, 1] + q[:, 0]) / (h**2)[:, None]
    return Grid(
        edges=fine_edges,
        leg=pieces.leg[piece],
        zone=pieces.zone[piece],
        rate=(q[:, 2] - q[:, 0]) / (2 * h)[:, None],
        bend=bend,
        twist=_slopes(bend, middles, piece),
        stretch=np.linalg.norm(p[:, 2] - p[:, 0], axis=1) / (2 * h),
        curl=np.linalg.norm(p[:, 2] - 2 * p[:, 1] + p[:, 0], axis=1) / h**2,
        turning=turn / (2 * h),
        middle=Sample(p[:, 1], sample.rotation[1::3], q[:, 1], sample.leg[1::3]),
    )


def cells_of(path: Path, grid: Grid, speeds: Sequence[LegSpeed], model: RobotModel, speed_ratio: float = 1.0) -> Cells:
    """Gives the cells with their caps; `speed_ratio` scales the programmed speeds."""
    piece = np.flatnonzero(np.diff(grid.leg, prepend=-1) | np.diff(grid.zone, prepend=-2))
    half = 0.5 * np.diff(grid.edges)
    slope = _slopes(grid.stretch[:, None], grid.middles, np.searchsorted(piece, np.arange(len(grid.leg)), side="right"))[:, 0]
    fastest = np.maximum(grid.stretch + half * np.abs(slope), 1e-9)
    programmed = np.empty(len(grid.leg))
    ceiling = np.empty(len(grid.leg))
    for index, (leg, speed) in enumerate(zip(path.legs, speeds, strict=True)):
        here = grid.leg == index
        programmed[here] = speed_ratio * _programmed_cap(grid, here, leg, speed, fastest[here])
        straight = isinstance(leg, CartesianLeg) and leg.travel > 0
        ceiling[here] = model.tcp_acceleration * leg.length / leg.travel if straight else np.inf
    quickest = np.abs(grid.rate) + half[:, None] * np.abs(grid.bend)
    most_bent = np.abs(grid.bend) + half[:, None] * np.abs(grid.twist)
    with np.errstate(divide="ignore"):
        by_speed = _MARGIN * np.min(model.speed / quickest, axis=1)
        by_acceleration = np.sqrt(np.min(_MARGIN * model.acceleration / most_bent, axis=1))
        by_curl = np.sqrt(model.corner_acceleration / grid.curl)
    dynamic = _held_through_zones(np.minimum(by_acceleration, by_curl), grid.zone)
    cap = np.minimum.reduce([programmed, by_speed, dynamic, _tick_cap(path, grid)])
    return Cells(grid.edges, grid.middles, cap, grid.rate, grid.bend, grid.twist, _MARGIN * model.acceleration, ceiling)


def _with(edges: FloatArray, marks: FloatArray) -> FloatArray:
    """Gives edges (N + 1,) with further marks (M,) between them, where they are not too close to any."""
    if len(marks) == 0:
        return edges
    near = np.minimum(np.searchsorted(edges, marks), len(edges) - 1)
    apart = np.minimum(np.abs(edges[near] - marks), np.abs(edges[np.maximum(near - 1, 0)] - marks))
    return np.sort(np.concatenate([edges, marks[apart > _CLOSEST_MARK]]))


def _slopes(values: FloatArray, places: FloatArray, piece: IndexArray) -> FloatArray:
    """Gives the derivatives (N, 6) of values (N, 6) at places (N,), from the neighbours in the same piece of path."""
    inside = piece[1:] == piece[:-1]
    slope = np.where(inside[:, None], np.diff(values, axis=0) / np.diff(places)[:, None], 0.0)
    total, count = np.zeros_like(values), np.zeros(len(values))
    for side in (slice(None, -1), slice(1, None)):
        total[side] += slope
        count[side] += inside
    return np.asarray(total / np.maximum(count, 1.0)[:, None])


def _programmed_cap(grid: Grid, here: BoolArray, leg: Leg, speed: LegSpeed, fastest: FloatArray) -> float | FloatArray:
    """Gives the programmed speed in m of path coordinate a second; one value for a leg outside joint-space corners.

    fastest: the greatest TCP m per m of path in each of the leg's cells.
    """
    if leg.length == 0:
        return speed.tcp  # no cell is in it
    if speed.duration is not None:
        return leg.length / speed.duration
    if isinstance(leg, JointLeg):  # its fastest place decides, so that the joints run evenly
        stretch = max(leg.fastest / leg.length, float(fastest.max(initial=1e-9)))
        turning = max(leg.quickest / leg.length, float(grid.turning[here].max(initial=1e-9)))
        return min(speed.tcp / stretch, speed.turning / turning)
    even = speed.tcp * leg.length / leg.travel if leg.travel > 0 else np.inf
    if leg.turning > 0:
        even = min(even, speed.turning * leg.length / leg.turning)
    # Only a blend in joint space can make the TCP faster than its leg's coordinate.
    quicker = (grid.zone[here] >= 0) & (fastest > (1 + _EVEN) * leg.travel / leg.length)
    return np.where(quicker, np.minimum(even, speed.tcp / fastest), even)


def _held_through_zones(cap: FloatArray, zone: IndexArray) -> FloatArray:
    """Gives caps under which no point of a zone is passed faster than the slowest that is still to come in the same zone."""
    held = cap.copy()
    for index in range(len(held) - 2, -1, -1):
        if zone[index] >= 0 and zone[index] == zone[index + 1]:
            held[index] = min(held[index], held[index + 1])
    return held


def _tick_cap(path: Path, grid: Grid) -> FloatArray:
    """Gives the cap (N,) that makes every zone last at least one controller tick."""
    widths = np.array([2 * corner.radius for corner in path.corners] + [np.inf])
    return np.where(grid.zone >= 0, widths[grid.zone] / CONTROLLER_TICK, np.inf)
