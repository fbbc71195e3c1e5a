"""Pose repeatability RP, also without the tracker's share, and the least that the tracker could have shown."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import f as fisher

from mitl.paths import FloatArray

_GUARD = 1.65
# A chi distribution with three degrees of freedom: the mean distance is 1.596 sigma and its spread .673 sigma; RP is mean + 3 spread.
PER_SIGMA = 1.596 + 3 * 0.673
"""RP of a point that scatters by 1 on every axis."""


@dataclass(frozen=True)
class Repeatability:
    """rp: as measured, m. robot: without the tracker's variance, m, 0 where the tracker explains all. uncertainty: standard, of `robot`.

    smallest: RP of a robot that would have been told from a perfect one with 95 % probability, m.
    """

    rp: float
    robot: float
    uncertainty: float
    smallest: float


def distances(points: FloatArray) -> FloatArray:
    """Gives the distance (n,) of points (n, 3) from their barycentre."""
    return np.asarray(np.linalg.norm(points - points.mean(axis=0), axis=1))


def rp(points: FloatArray) -> float:
    """Gives RP: mean distance from the barycentre and three times its spread (n - 1). Raises ValueError for fewer than three points."""
    if len(points) < 3:
        raise ValueError(f"a repeatability needs at least three cycles, got {len(points)}")
    found = distances(points)
    return float(found.mean() + 3.0 * np.std(found, ddof=1))


def repeatability(points: FloatArray, still: FloatArray) -> Repeatability:
    """Gives RP of attained points (n, 3), and of still ones (m, 3) that the tracker measured in the same way while nothing moved.

    Variances of both, mean of the axes, are subtracted; what is left scales RP. The uncertainty is that of two estimated variances, as
    half the way to the bound that 1.65 of it make. `smallest` is where the F test at 5 % finds the difference in 95 of 100.
    """
    whole, tracker = _variance(points), _variance(still)
    n, m = 3 * (len(points) - 1), 3 * (len(still) - 1)
    left = whole - tracker
    spread = float(np.sqrt(2.0 * whole**2 / n + 2.0 * tracker**2 / m))
    measured = rp(points)
    scale = measured / np.sqrt(whole) if whole > 0 else PER_SIGMA
    robot = scale * np.sqrt(max(left, 0.0))
    bound = scale * np.sqrt(max(left, 0.0) + _GUARD * spread)
    ratio = float(fisher.ppf(0.95, n, m) * fisher.ppf(0.95, m, n))
    return Repeatability(measured, float(robot), float(bound - robot) / _GUARD, PER_SIGMA * float(np.sqrt(tracker * (ratio - 1.0))))


def _variance(points: FloatArray) -> float:
    return float(np.mean(np.var(points, axis=0, ddof=1)))
