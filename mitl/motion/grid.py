"""Grid: a path cut into intervals, with the derivatives of joints and TCP at three stations of each, taken from inside it.

Invariant: no interval reaches over a place where the path's second derivatives jump; one inverse kinematics solution a node.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mitl.motion.path import Path, Sample
from mitl.motion.robot_model import RobotModel
from mitl.paths import FloatArray, IndexArray

_INTERVALS = 4
"""Intervals in a piece of path: the fewest that five-point differences need."""
_LONGEST = 0.02
_MOST = 60
_CLOSEST_MARK = 1e-6
_ERROR = 0.02
"""Share of a joint's acceleration limit by which bends may be wrong; the measure errs on the safe side."""
_MOST_REFINEMENTS = 4


STATIONS = np.array([0.0, 0.5, 1.0])
"""Shares of an interval at which the path's derivatives are known: its ends and its middle."""


def _difference_weights(at: float) -> FloatArray:
    """Gives weights (3, 5) of five values at unit steps for the value, the first and the second derivative at a place in steps."""
    powers = np.stack([np.arange(5.0) ** k for k in range(5)])
    wanted = [[at**k for k in range(5)], [0, 1, 2 * at, 3 * at**2, 4 * at**3], [0, 0, 2, 6 * at, 12 * at**2]]
    return np.asarray(np.linalg.solve(powers, np.array(wanted).T).T)


_WEIGHTS = np.stack([_difference_weights(half / 2) for half in range(9)])


@dataclass(frozen=True, eq=False)
class Grid:
    """N intervals of a path, N + 1 nodes.

    nodes (N+1,) m of path; leg (N,) of each interval; zone (N,): the corner in whose TCP zone it lies, or -1; sample: the path at the
    nodes. At the stations of each interval, axis 1: joints, rate, bend (N, 3, 6): q, dq/ds, d2q/ds2; stretch (N, 3): TCP m per m of path;
    curvature (N, 3): across it, m/s^2 at 1 m/s of path; turning (N,): rad per m of path.
    """

    nodes: FloatArray
    leg: IndexArray
    zone: IndexArray
    sample: Sample
    joints: FloatArray
    rate: FloatArray
    bend: FloatArray
    stretch: FloatArray
    curvature: FloatArray
    turning: FloatArray

    def __len__(self) -> int:
        return len(self.leg)

    @property
    def widths(self) -> FloatArray:
        """Gives the intervals' lengths (N,) in m of path."""
        return np.asarray(np.diff(self.nodes))

    def extremes(self) -> tuple[FloatArray, FloatArray]:
        """Gives the least and the greatest joint angles (N, 6) rad in the intervals, to second order."""
        ends = self.sample.joints[:-1], self.sample.joints[1:]
        bend = self.bend.mean(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            turns_after = np.nan_to_num(-self.rate[:, 0] / bend, posinf=0.0, neginf=0.0)
        turns_after = np.clip(turns_after, 0.0, self.widths[:, None])
        vertex = ends[0] + turns_after * (self.rate[:, 0] + 0.5 * turns_after * bend)
        return np.minimum.reduce([*ends, vertex]), np.maximum.reduce([*ends, vertex])


def cut(path: Path, speed: FloatArray, model: RobotModel) -> Grid:
    """Gives the path cut into intervals that resolve its zones and how its joints run at up to `speed` (legs,) m/s."""
    pieces = path.pieces()
    edges = _with(pieces.edges, path.close_marks())
    of_piece = np.clip(np.searchsorted(pieces.edges, 0.5 * (edges[:-1] + edges[1:]), side="right") - 1, 0, len(pieces.leg) - 1)
    zone = pieces.zone[of_piece]
    uneven = np.ceil(0.7 + 1.5 * np.append(path.unevenness(), 0.0)[zone])
    counts = (np.clip(np.ceil(np.diff(edges) / _LONGEST), _INTERVALS, _MOST) * np.where(zone >= 0, uneven, 1)).astype(np.intp)
    for _ in range(_MOST_REFINEMENTS):
        cutting = _Cutting.evenly(path, edges, counts)
        rough = cutting.error(speed[pieces.leg[of_piece]], model) > _ERROR
        if not rough.any():
            break
        counts = np.where(rough, 2 * counts, counts)
    return cutting.grid(path, pieces.leg[of_piece], zone)


@dataclass(frozen=True, eq=False)
class _Cutting:
    """A path cut at N + 1 nodes: piece (N,) of each interval, its place (N,) in the piece, counts (K,) a piece; step (N,) in m."""

    nodes: FloatArray
    piece: IndexArray
    within: IndexArray
    counts: IndexArray
    step: FloatArray
    sample: Sample

    @staticmethod
    def evenly(path: Path, edges: FloatArray, counts: IndexArray) -> _Cutting:
        """Gives a path whose pieces between edges (K + 1,) are cut into counts (K,) even intervals."""
        piece = np.repeat(np.arange(len(counts)), counts)
        within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        step = np.diff(edges)[piece] / counts[piece]
        nodes = np.append(edges[piece] + within * step, edges[-1])
        return _Cutting(nodes, piece, within, counts, step, path.sample(nodes))

    def error(self, speed: FloatArray, model: RobotModel) -> FloatArray:
        """Gives for each piece (K,) by what share of a joint's acceleration limit its bends may be wrong at up to speeds (K,) m/s."""
        begins = np.cumsum(self.counts) - self.counts
        q = self.sample.joints
        last = np.minimum(np.arange(len(self.piece)), (begins + self.counts - 4)[self.piece])
        five = q[last[:, None] + np.arange(5)]
        step = self.step[:, None]
        rate, bend = np.abs(five[:, 3] - five[:, 1]) / (2 * step), np.abs(five[:, 3] - 2 * five[:, 2] + five[:, 1]) / step**2
        wrong = np.abs(np.einsum("k,nkj->nj", np.array([1.0, -4.0, 6.0, -4.0, 1.0]), five)) / step**2
        with np.errstate(divide="ignore", invalid="ignore"):
            fastest = np.minimum.reduceat(np.nanmin(model.speed / rate, axis=1) ** 2, begins)
            bendable = np.minimum.reduceat(np.nanmin(model.acceleration / bend, axis=1), begins)
        x = np.minimum.reduce([speed**2, fastest, bendable])
        return np.asarray(x * np.maximum.reduceat((wrong / model.acceleration).max(axis=1), begins))

    def grid(self, path: Path, leg: IndexArray, zone: IndexArray) -> Grid:
        """Gives the grid; leg and zone (K,) of the pieces."""
        before_change: dict[int, FloatArray] = {}
        for node in np.flatnonzero(np.diff(leg[self.piece])) + 1:
            old, new = path.legs[leg[self.piece[node - 1]]], path.legs[leg[self.piece[node]]]
            if old.X_FT is not new.X_FT:
                before_change[int(node)] = (path.arm.flange(self.sample.joints[node]) * old.X_FT).translation
        values = np.concatenate([self.sample.joints, self.sample.position], axis=1)
        found = np.empty((len(self.piece), len(STATIONS), 3, 9))
        for station, share in enumerate(STATIONS):
            first = np.clip(self.within - 2 + int(share == 1), 0, self.counts[self.piece] - 4)  # the five nodes lie about the station
            taken = (first - self.within + np.arange(len(self.piece)))[:, None] + np.arange(5)
            five = values[taken]
            for (
                change,
                p_BT,
            ) in before_change.items():  # the node at a change of tool has the new tool's place, the interval before it the old
                five[(taken == change) & (np.arange(len(taken)) < change)[:, None], 6:] = p_BT
            found[:, station] = np.einsum("nik,nkj->nij", _WEIGHTS[2 * (self.within - first) + int(2 * share)], five)
        step = self.step[:, None, None]
        tangent, curving = found[:, :, 1, 6:] / step, found[:, :, 2, 6:] / step**2
        stretch = np.linalg.norm(tangent, axis=2)
        along = np.sum(tangent * curving, axis=2) / np.maximum(stretch, 1e-12)
        turned = (self.sample.rotation[:-1].inv() * self.sample.rotation[1:]).magnitude()
        return Grid(
            nodes=self.nodes,
            leg=leg[self.piece],
            zone=zone[self.piece],
            sample=self.sample,
            joints=found[:, :, 0, :6],
            rate=found[:, :, 1, :6] / step,
            bend=found[:, :, 2, :6] / step**2,
            stretch=stretch,
            curvature=np.sqrt(np.maximum(np.sum(curving**2, axis=2) - along**2, 0.0)),
            turning=turned / self.step,
        )


def _with(edges: FloatArray, marks: FloatArray) -> FloatArray:
    """Gives edges (N + 1,) with further marks (M,) between them, where they are not too close to any."""
    if len(marks) == 0:
        return edges
    near = np.minimum(np.searchsorted(edges, marks), len(edges) - 1)
    apart = np.minimum(np.abs(edges[near] - marks), np.abs(edges[np.maximum(near - 1, 0)] - marks))
    return np.sort(np.concatenate([edges, marks[apart > _CLOSEST_MARK]]))
