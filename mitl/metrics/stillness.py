"""Jitter: how far apart the samples of a still point are."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull, QhullError
from scipy.spatial.distance import pdist

from mitl.paths import FloatArray, PosePath

_DIRECTLY = 1500  # points of which all pairs are compared


def jitter_diameter(position: FloatArray) -> float:
    """Gives the diameter in m of the cloud of points (N, 3): the largest distance between two. Zero for fewer than two.

    facts/tracker.md reads the thesis's jitter as this.
    """
    if len(position) < 2:
        return 0.0
    if len(position) > _DIRECTLY:
        try:
            position = position[ConvexHull(position).vertices]
        except QhullError:  # all in one plane or on one line: the two farthest lie among the extremes of many directions
            directions = np.random.default_rng(0).normal(size=(500, 3))
            projected = position @ directions.T
            position = position[np.unique(np.concatenate([projected.argmin(axis=0), projected.argmax(axis=0)]))]
    return float(pdist(position).max()) if len(position) > 1 else 0.0


def is_still(path: PosePath, limit: float) -> bool:
    """Gives whether the valid samples stay within a cloud of diameter `limit` in m; a path without valid samples is not still."""
    valid = path.only_valid()
    return len(valid) > 0 and jitter_diameter(valid.position) < limit


def standstill_after(path: PosePath, called: float, *, within: float = 25e-3, limit: float = 2e-3) -> float:
    """Gives the seconds from `called` to where the path stands still: from there on it moves less than `limit` m in any `within` s.

    facts/atc.md, ATC-6: under 2 mm in 25 ms. Infinite where it does not come to rest. Raises ValueError without valid samples after it.
    """
    valid = path.only_valid()
    after = valid.between(called, np.inf)
    if len(after) < 2:
        raise ValueError(f"the path has no valid samples after {called:.3f} s")
    later = np.stack([np.interp(after.time + within, after.time, after.position[:, axis]) for axis in range(3)], axis=1)
    inside = after.time + within <= after.time[-1]
    moving = np.flatnonzero((np.linalg.norm(later - after.position, axis=1) >= limit) & inside)
    if len(moving) and moving[-1] == np.flatnonzero(inside)[-1]:
        return float("inf")
    return float(after.time[moving[-1]] - called) if len(moving) else 0.0


def overrun(path: PosePath, called: float, *, before: float = 0.12, rest: tuple[float, float] = (0.2, 0.4)) -> float:
    """Gives for how many s at its former speed a path went on after `called`: way from there to rest over speed.

    The path must run straight and evenly for `before` s up to `called`, and rest from rest[0] to rest[1] s after it. A moment of
    standstill is read off where the path hardly moves any more; this is read off where it moves fast, and is as much less noisy.
    Raises ValueError without valid samples in both.
    """
    valid = path.only_valid()
    running, resting = valid.between(called - before, called), valid.between(called + rest[0], called + rest[1])
    if len(running) < 2 or len(resting) == 0:
        raise ValueError(f"the path has too few valid samples about {called:.3f} s")
    velocity, at = np.polyfit(running.time - called, running.position, 1)
    return float((resting.position.mean(axis=0) - at) @ velocity / (velocity @ velocity))
