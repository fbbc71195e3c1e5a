"""Cells: a path cut into short stretches, with what the joints do to third order in each, so that limits hold everywhere in a cell.

Invariant: rates and bends are continued from a cell's middle to its edges; a limit is never only looked at in the middle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mitl.motion.timing import Timing
from mitl.paths import FloatArray

IndexArray = NDArray[np.intp]

_IN_CELL = np.array([0.0, 0.5, 1.0])
_IN_PHASE = np.array([0.0, 1 / 3, 2 / 3, 1.0])
_LEAST_LEFT = 0.05
"""Share of a joint's acceleration limit always left for acceleration along the path; the caller lowers caps where it is too much."""


@dataclass(frozen=True, eq=False)
class Probes:
    """M instants of a timing: the cell (M,) each lies in, the hump (M,) it belongs to, offset (M,) m from the cell's middle, m/s, m/s^2."""

    cell: IndexArray
    hump: IndexArray
    offset: FloatArray
    speed: FloatArray
    acceleration: FloatArray


@dataclass(frozen=True, eq=False)
class Cells:
    """A path cut into N cells. edges (N+1,), middle (N,) m of path; cap (N,) m/s.

    rate (N, 6) dq/ds, bend (N, 6) d2q/ds2, twist (N, 6) d3q/ds3 at the middles; limit (6,) rad/s^2; ceiling (N,) m/s^2, the greatest
    acceleration along the path.
    """

    edges: FloatArray
    middle: FloatArray
    cap: FloatArray
    rate: FloatArray
    bend: FloatArray
    twist: FloatArray
    limit: FloatArray
    ceiling: FloatArray

    def __len__(self) -> int:
        return len(self.cap)

    def allowed(self, cell: IndexArray, offset: FloatArray, speed: FloatArray) -> FloatArray:
        """Gives the acceleration (M,) in m/s^2 along the path that the joints leave at places and speeds (M,)."""
        rate, bend = self._at(cell, offset)
        left = np.maximum(self.limit - np.abs(bend) * speed[:, None] ** 2, _LEAST_LEFT * self.limit)
        return np.asarray(np.minimum(self.ceiling[cell], np.min(left / np.maximum(np.abs(rate), 1e-12), axis=1)))

    def allowed_at_rest(self) -> FloatArray:
        """Gives the least acceleration (N,) in m/s^2 that the joints leave anywhere in each cell where the path stands still."""
        cell, still = np.arange(len(self)), np.zeros(len(self))
        return np.asarray(np.minimum.reduce([self.allowed(cell, edge - self.middle, still) for edge in (self.edges[:-1], self.edges[1:])]))

    def probe(self, timing: Timing, first: IndexArray, beyond: IndexArray, phases: int) -> Probes:
        """Gives a timing's instants in all cells of H humps, from cell first (H,) to before cell beyond (H,), and in all its phases.

        The timing has `phases` phases a hump.
        """
        counts = beyond - first
        owner = np.repeat(np.arange(len(first)), counts)
        cell = np.arange(counts.sum()) + np.repeat(first - np.cumsum(counts) + counts, counts)
        low, width = self.edges[cell], self.edges[cell + 1] - self.edges[cell]
        asked = (low[:, None] + width[:, None] * _IN_CELL).ravel()
        lengths = timing.lengths
        moving = np.flatnonzero(lengths > 0)
        # ruckig may pass from accelerating to braking within one phase: the speed is greatest where the acceleration is zero
        jerk = np.where(timing.jerk == 0, np.inf, timing.jerk)[moving]
        summit = np.clip(-timing.acceleration[moving] / jerk, 0.0, lengths[moving])
        since = np.concatenate([lengths[moving, None] * _IN_PHASE, summit[:, None]], axis=1)
        in_phase = (timing.start[moving, None] + since).ravel()
        hump_of_phase = np.repeat(moving // phases, since.shape[1])
        position, speed, acceleration = timing.at(np.concatenate([timing.times_at(asked), in_phase]))
        in_hump = np.concatenate([np.repeat(owner, len(_IN_CELL)), hump_of_phase])
        found = np.searchsorted(self.edges, position[len(asked) :], side="right") - 1
        found = np.clip(found, first[hump_of_phase], beyond[hump_of_phase] - 1)
        cells = np.concatenate([np.repeat(cell, len(_IN_CELL)), found])
        return Probes(cells, in_hump, position - self.middle[cells], speed, acceleration)

    def strain(self, timing: Timing) -> tuple[FloatArray, FloatArray]:
        """Gives per cell (N,) the greatest share of a joint's acceleration limit that a timing over the whole path uses.

        With it the least speed (N,) in m/s at which the limit is broken there, inf where it is not.
        """
        probes = self.probe(timing, np.array([0]), np.array([len(self)]), len(timing.start))
        rate, bend = self._at(probes.cell, probes.offset)
        joints = rate * probes.acceleration[:, None] + bend * probes.speed[:, None] ** 2
        share = np.max(np.abs(joints) / self.limit, axis=1)
        worst, speed = np.zeros(len(self)), np.full(len(self), np.inf)
        np.maximum.at(worst, probes.cell, share)
        broken = share > 1
        np.minimum.at(speed, probes.cell[broken], probes.speed[broken])
        return worst, speed

    def after(self, position: float) -> Cells:
        """Gives the cells from a path position in m on; the one it lies in is cut."""
        first = int(np.clip(np.searchsorted(self.edges, position, side="right") - 1, 0, len(self)))
        edges = np.concatenate([[position], self.edges[first + 1 :]])
        kept = {name: getattr(self, name)[first:] for name in ("middle", "cap", "rate", "bend", "twist", "ceiling")}
        return Cells(edges=edges, limit=self.limit, **kept)

    def _at(self, cell: IndexArray, offset: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gives dq/ds and d2q/ds2 (M, 6) at offsets (M,) from the middles of cells (M,)."""
        away = offset[:, None]
        return self.rate[cell] + away * (self.bend[cell] + away / 2 * self.twist[cell]), self.bend[cell] + away * self.twist[cell]
