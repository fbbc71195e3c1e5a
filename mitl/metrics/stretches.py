"""Where a recorded body stands still: the stretches of a path that say something about the tracker alone."""

from __future__ import annotations

import numpy as np

from mitl.paths import BoolArray, FloatArray, PosePath

# ASSUMPTION A-71: a body stands still where means over half a second, taken in a row, differ by less than 2.5 mm. The worst of the public
# recordings differ by 1.5 mm, creep after a stop (facts/tracker.md) by .5 mm; a robot that moves more slowly than 5 mm/s counts as drift.
_MEAN_OVER = 0.5
_SLOW = 5e-3


def still_stretches(path: PosePath, shortest: float = 0.2) -> list[PosePath]:
    """Gives the stretches of valid samples in which the body stands still, at least `shortest` s long, without the edges of motions."""
    return [part for part in _runs(path, path.valid & ~_moving(path)) if part.time[-1] - part.time[0] >= shortest * 0.999]


def _moving(path: PosePath) -> BoolArray:
    """Gives where the body moves, and half a second on either side (N,)."""
    valid = path.only_valid()
    if len(valid) < 3:
        return np.zeros(len(path), dtype=np.bool_)
    time = valid.time
    total = np.concatenate([np.zeros((1, 3)), np.cumsum(valid.position - valid.position[0], axis=0)])
    index = np.arange(len(time))
    begins = np.minimum(np.searchsorted(time, time - _MEAN_OVER), index)
    ends = np.maximum(np.searchsorted(time, time + _MEAN_OVER, side="right"), index + 1)
    before = (total[index + 1] - total[begins]) / (index + 1 - begins)[:, None]
    after = (total[ends] - total[index]) / (ends - index)[:, None]
    fast = np.linalg.norm(after - before, axis=1) > _SLOW * _MEAN_OVER
    return _widened(time, fast, path.time)


def _widened(time: FloatArray, chosen: BoolArray, at: FloatArray) -> BoolArray:
    """Gives whether a chosen time lies within half a second of each time `at` (N,)."""
    hits = time[chosen]
    if len(hits) == 0:
        return np.zeros(len(at), dtype=np.bool_)
    after = np.searchsorted(hits, at)
    nearest = np.minimum(
        np.abs(at - hits[np.minimum(after, len(hits) - 1)]),
        np.abs(at - hits[np.maximum(after - 1, 0)]),
    )
    return np.asarray(nearest <= _MEAN_OVER)


def _runs(path: PosePath, chosen: BoolArray) -> list[PosePath]:
    """Gives the runs of chosen samples without a gap of more than half a second."""
    index = np.flatnonzero(chosen)
    if len(index) == 0:
        return []
    ends = np.flatnonzero((np.diff(index) > 1) | (np.diff(path.time[index]) > _MEAN_OVER)) + 1
    return [PosePath(path.time[part], path.position[part], path.quaternion_wxyz[part], path.valid[part]) for part in np.split(index, ends)]
