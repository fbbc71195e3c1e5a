"""Speed of a path: at every sample by a moving regression, and its mean over a window, with the noise it carries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mitl.metrics.deviation import window_noise
from mitl.paths import FloatArray, PosePath

Indices = NDArray[np.intp]

SMOOTHING = 0.04  # s, default window of the moving regression
_PARTS = 8  # parts of a stretch whose means tell its noise
_BLOCK = 256  # samples whose windows are summed together


@dataclass(frozen=True)
class MeanSpeed:
    """Mean speed over a window in m/s. random: standard uncertainty from position noise. duration: s. count: samples used."""

    value: float
    random: float
    duration: float
    count: int


def velocity(path: PosePath, window: float = SMOOTHING) -> FloatArray:
    """Gives the velocity (N, 3) in m/s: slope of the least-squares line through the positions within half a window of each sample.

    Two neighbours are always used, so that a window below the sampling interval gives central differences. Near the ends the window
    becomes one-sided. Raises ValueError where the path has fewer than two samples.
    """
    n = len(path)
    if n < 2:
        raise ValueError(f"a speed needs at least two samples, got {n}")
    index = np.arange(n)
    first = np.minimum(np.searchsorted(path.time, path.time - window / 2, side="left"), np.maximum(index - 1, 0))
    last = np.maximum(np.searchsorted(path.time, path.time + window / 2, side="right"), np.minimum(index + 2, n))
    out = np.empty((n, 3))
    for begin in range(0, n, _BLOCK):
        block = slice(begin, min(begin + _BLOCK, n))
        out[block] = _slopes(path.time, path.position, first[block], last[block])
    return out


def _slopes(time: FloatArray, position: FloatArray, first: Indices, last: Indices) -> FloatArray:
    """Gives the least-squares slopes (K, 3) of the samples first..last (K,) each, windows that lie close together."""
    low, high = int(first[0]), int(last[-1])
    # running sums of offsets from the block's own middle: over a whole recording their differences would lose all digits
    t = time[low:high] - time[(low + high) // 2]
    p = position[low:high] - position[(low + high) // 2]
    first, last = first - low, last - low

    def total(values: FloatArray) -> FloatArray:
        sums = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values, axis=0)])
        return np.asarray(sums[last] - sums[first])

    count = (last - first)[:, None]
    sum_t = total(t[:, None])
    spread = count * total(t[:, None] ** 2) - sum_t**2
    return np.asarray((count * total(t[:, None] * p) - sum_t * total(p)) / spread)


def speed(path: PosePath, window: float = SMOOTHING) -> FloatArray:
    """Gives the speed (N,) in m/s; see `velocity`. Noise makes it too large on average where the path is (nearly) still."""
    return np.asarray(np.linalg.norm(velocity(path, window), axis=1))


def line_speed(path: PosePath, start: float, stop: float) -> MeanSpeed:
    """Gives the mean speed along a straight piece of path between two times in s.

    The slope of one least-squares line through the valid samples: noise across the motion hardly enters, and the sum of noisy steps,
    which is always too long, is avoided. Raises ValueError where the window holds fewer than three valid samples.
    """
    piece = path.only_valid().between(start, stop)
    if len(piece) < 3:
        raise ValueError(f"expected at least 3 valid samples between {start:.3f} and {stop:.3f} s, got {len(piece)}")
    time = piece.time - piece.time.mean()
    square = float(np.sum(time**2))
    slope = time @ (piece.position - piece.position.mean(axis=0)) / square
    value = float(np.linalg.norm(slope))
    direction = slope / value if value > 0.0 else np.array([1.0, 0.0, 0.0])
    residual = (piece.position - piece.position.mean(axis=0)) @ direction - value * time
    return MeanSpeed(value, _slope_noise(residual, square), float(piece.time[-1] - piece.time[0]), len(piece))


def path_speed(path: PosePath, start: float, stop: float, window: float = SMOOTHING) -> MeanSpeed:
    """Gives the mean speed along a curved piece of path between two times in s: the mean of the moving regression's speed.

    It measures chords of the window's length: a circle of radius r at speed v reads low by (v window / r)^2 / 40 of itself.
    Raises ValueError where the window holds fewer than three valid samples.
    """
    valid = path.only_valid()
    chosen = (valid.time >= start) & (valid.time <= stop)
    if chosen.sum() < 3:
        raise ValueError(f"expected at least 3 valid samples between {start:.3f} and {stop:.3f} s, got {int(chosen.sum())}")
    speeds = speed(valid, window)[chosen]
    time = valid.time[chosen]
    duration = float(time[-1] - time[0])
    noise = window_noise(time, speeds[:, None], window)
    return MeanSpeed(float(speeds.mean()), noise / np.sqrt(max(1.0, duration / window)), duration, int(chosen.sum()))


def speed_difference(
    expected: PosePath, measured: PosePath, start: float, stop: float, *, around: float, window: float = SMOOTHING
) -> MeanSpeed:
    """Gives by how much a measured path is faster than an expected one between two times in s; both on one clock.

    The same moving regression is taken of both, so that chords, filters and corners cancel; what counts is the speed in the expected
    direction. The noise is that of the difference from `around` s before to `around` s after: a zone alone is too short to show it.
    Raises ValueError for fewer than three valid samples.
    """
    valid = measured.only_valid().between(start - around, stop + around)
    chosen = (valid.time >= start) & (valid.time <= stop)
    if chosen.sum() < 3:
        raise ValueError(f"expected at least 3 valid samples between {start:.3f} and {stop:.3f} s, got {int(chosen.sum())}")
    fields = velocity(expected, window)
    there = np.stack([np.interp(valid.time, expected.time, fields[:, axis]) for axis in range(3)], axis=1)
    quick = np.linalg.norm(there, axis=1)
    # along the expected direction: the size of a noisy velocity is too large, the more so the slower it is
    direction = there / np.maximum(quick, 1e-6)[:, None]
    difference = np.sum(velocity(valid, window) * direction, axis=1) - quick
    time = valid.time[chosen]
    duration = float(time[-1] - time[0])
    part = max(window, min(duration, float(valid.time[-1] - valid.time[0]) / _PARTS))
    noise = window_noise(valid.time, difference[:, None], part) / np.sqrt(max(1.0, duration / part))
    return MeanSpeed(float(difference[chosen].mean()), float(noise), duration, int(chosen.sum()))


def _slope_noise(residual: FloatArray, square: float) -> float:
    """Gives the standard deviation of a least-squares slope from its residuals (N,) and their correlation in time."""
    n = len(residual)
    variance = float(residual @ residual) / max(1, n - 2)
    if variance <= 0.0:
        return 0.0
    spectrum = np.abs(np.fft.rfft(residual, n=2 * n)) ** 2
    covariance = np.fft.irfft(spectrum)[: n // 4 + 1]
    correlation = covariance / covariance[0]
    ends = np.flatnonzero(correlation < 0.05)
    correlated = 1.0 + 2.0 * float(correlation[1 : ends[0] if len(ends) else None].sum())
    return float(np.sqrt(variance * correlated / square))
