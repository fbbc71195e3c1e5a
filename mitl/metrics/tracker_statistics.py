"""What a tracker's recording says about the tracker: rate, dropouts, jitter by window, Allan deviation, noise, drift.

Invariant: noise figures come from stretches in which the body stands still, and say nothing where there is none.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.metrics.allan import allan_deviation, structure_function
from mitl.metrics.noise_fit import NoiseFit, fit_noise
from mitl.metrics.stillness import jitter_diameter
from mitl.metrics.stretches import still_stretches
from mitl.paths import FloatArray, PosePath

WINDOWS = (0.1, 0.2, 0.5, 1.0, 2.0)
"""Lengths in s of the windows in which jitter is told; facts/tracker.md gives .2 and .5 s."""
MEANS = 0.5
"""Length in s of the windows whose means' spread is told (facts/tracker.md)."""
_MOST_WINDOWS = 400  # windows of one length that are looked at, evenly spread; more would only cost time
_MINUTE = 60.0
_LATE = 1.5  # an interval of so many usual ones lacks a sample


@dataclass(frozen=True)
class Jitter:
    """Diameters of the point clouds in windows of `window` s, m: their mean, sd, median, smallest and largest; of how many windows."""

    window: float
    mean: float
    sd: float
    median: float
    smallest: float
    largest: float
    windows: int


@dataclass(frozen=True, eq=False)
class Drift:
    """Means over a minute of the longest still stretch: (3,) sd and range in m, and the slope of a line in m/s, by axis."""

    duration: float
    sd: FloatArray
    range: FloatArray
    slope: FloatArray


@dataclass(frozen=True, eq=False)
class TrackerStatistics:
    """Statistics of one recording. SI; rotations in rad.

    rate: Hz, of the usual interval. interval_sd: s. missing: samples that gaps lack. longest_gap: s. invalid: samples not valid, in
    `losses` stretches. frozen: samples with exactly the pose before. still: s of still stretches. jitter: by window, shortest first.
    mean_sd, mean_turn_sd: (3,) sd of neighbouring half-second means about their stretch's mean, m and rad.
    allan_time: (K,) s, allan: (K, 3) m. noise: fit over all axes. drift: of stretches of three minutes or more.
    """

    samples: int
    duration: float
    rate: float
    interval_sd: float
    missing: int
    longest_gap: float
    invalid: int
    losses: int
    frozen: int
    still: float
    jitter: tuple[Jitter, ...]
    mean_sd: FloatArray | None
    mean_turn_sd: FloatArray | None
    allan_time: FloatArray
    allan: FloatArray
    structure_time: FloatArray
    structure: FloatArray
    noise: NoiseFit | None
    drift: Drift | None


def tracker_statistics(path: PosePath) -> TrackerStatistics:
    """Gives the statistics of a recording. Raises ValueError for fewer than three samples."""
    if len(path) < 3:
        raise ValueError(f"expected at least three samples, got {len(path)}")
    intervals = np.diff(path.time)
    usual = float(np.median(intervals))
    gaps = intervals > _LATE * usual
    lost = ~path.valid
    repeated = np.all(np.diff(path.position, axis=0) == 0.0, axis=1) & path.valid[1:] & path.valid[:-1]
    still = still_stretches(path)
    longest = max(still, key=len, default=None)
    mean_sd, mean_turn_sd = _spread_of_means(still)
    allan_time, allan = _pooled(still, usual, allan_deviation, half=True)
    structure_time, structure = _pooled(still, usual, structure_function, half=False)
    return TrackerStatistics(
        samples=len(path),
        duration=float(path.time[-1] - path.time[0]),
        rate=1.0 / usual,
        interval_sd=float(np.std(intervals[~gaps])) if not np.all(gaps) else 0.0,
        missing=int(np.sum(np.rint(intervals[gaps] / usual) - 1.0)),
        longest_gap=float(intervals.max()),
        invalid=int(np.count_nonzero(lost)),
        losses=int(np.count_nonzero(lost & ~np.concatenate([[False], lost[:-1]]))),
        frozen=int(np.count_nonzero(repeated)),
        still=float(sum(part.time[-1] - part.time[0] for part in still)),
        jitter=tuple(found for window in WINDOWS if (found := _jitter(still, window, usual)) is not None),
        mean_sd=mean_sd,
        mean_turn_sd=mean_turn_sd,
        allan_time=allan_time,
        allan=allan,
        structure_time=structure_time,
        structure=structure,
        noise=fit_noise(structure_time, structure.mean(axis=1)) if len(structure) else None,
        drift=_drift(longest) if longest is not None else None,
    )


def _windows(path: PosePath, seconds: float, interval: float) -> list[slice]:
    """Gives the windows of a still stretch, one after the other; none where a window would hold fewer than 5 samples."""
    count = round(seconds / interval)
    if count < 5 or len(path) < count:
        return []
    return [slice(first, first + count) for first in range(0, len(path) - count + 1, count)]


def _jitter(still: list[PosePath], seconds: float, interval: float) -> Jitter | None:
    windows = [(part, window) for part in still for window in _windows(part, seconds, interval)]
    if not windows:
        return None
    chosen = np.unique(np.linspace(0, len(windows) - 1, min(len(windows), _MOST_WINDOWS)).astype(int))
    found = np.array([jitter_diameter(windows[i][0].position[windows[i][1]]) for i in chosen])
    return Jitter(
        seconds,
        mean=float(found.mean()),
        sd=float(found.std(ddof=1)) if len(found) > 1 else 0.0,
        median=float(np.median(found)),
        smallest=float(found.min()),
        largest=float(found.max()),
        windows=len(found),
    )


def _spread_of_means(still: list[PosePath]) -> tuple[FloatArray | None, FloatArray | None]:
    """Gives the sd (3,) in m and (3,) in rad of half-second means about the mean of their stretch."""
    position, turn, freedom = np.zeros(3), np.zeros(3), 0
    for part in still:
        windows = _windows(part, MEANS, float(np.median(np.diff(part.time))) if len(part) > 1 else math.inf)
        if len(windows) < 2:
            continue
        means = np.array([part.position[window].mean(axis=0) for window in windows])
        R = Rotation.from_quat(part.quaternion_wxyz, scalar_first=True)
        vectors = (R.mean().inv() * R).as_rotvec()
        turns = np.array([vectors[window].mean(axis=0) for window in windows])
        position += np.sum((means - means.mean(axis=0)) ** 2, axis=0)
        turn += np.sum((turns - turns.mean(axis=0)) ** 2, axis=0)
        freedom += len(windows) - 1
    if freedom == 0:
        return None, None
    return np.sqrt(position / freedom), np.sqrt(turn / freedom)


def _pooled(
    still: list[PosePath], interval: float, function: Callable[[FloatArray, list[int]], FloatArray], *, half: bool
) -> tuple[FloatArray, FloatArray]:
    """Gives times (K,) in s and a function of position (K, 3) over them, the squares averaged over stretches by their length."""
    longest = max((len(part) for part in still), default=0) // (2 if half else 1)
    counts = sorted({round(10.0**power) for power in np.arange(0.0, 7.0, 1.0 / 6.0) if round(10.0**power) < max(longest, 1)})
    if not counts:
        return np.zeros(0), np.zeros((0, 3))
    weights, total = np.zeros(len(counts)), np.zeros((len(counts), 3))
    for part in still:
        found = function(part.position, counts) ** (2 if half else 1)
        there = np.isfinite(found[:, 0])
        total[there] += found[there] * len(part)
        weights[there] += len(part)
    known = weights > 0
    mean = total[known] / weights[known][:, None]
    return np.array(counts)[known] * interval, np.sqrt(mean) if half else mean


def _drift(part: PosePath) -> Drift | None:
    duration = float(part.time[-1] - part.time[0])
    if duration < 3 * _MINUTE:
        return None
    minute = np.floor((part.time - part.time[0]) / _MINUTE).astype(int)
    whole = minute < int(duration / _MINUTE)
    counts = np.bincount(minute[whole])
    means = np.stack([np.bincount(minute[whole], part.position[whole, axis])[counts > 0] / counts[counts > 0] for axis in range(3)], axis=1)
    times = np.flatnonzero(counts > 0) * _MINUTE
    if len(means) < 3:
        return None
    slope = np.polyfit(times, means - means.mean(axis=0), 1)[0]
    return Drift(duration, means.std(axis=0, ddof=1), np.ptp(means, axis=0), slope)
