"""Time offset between two clocks from one motion seen by both: coarse by speed correlation, fine by least squared distance.

Invariant: neither needs a common frame or scale; each trial offset is judged after the similarity that suits it best.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.signal import correlate, find_peaks

from mitl.paths import FloatArray, PosePath

_STEP = 5e-3  # s, grid of the coarse search
_SMOOTH = 0.04  # s over which speeds are taken for the coarse search
_CANDIDATES = 8  # coarse offsets that are refined
_MOST_SAMPLES = 20_000  # samples of `measured` used; more would not change the answer
_LEAST_TRAVEL = 12.0  # extent of the motion over its residual's sd; 20,000 samples of noise alone reach 8
_ALIKE = 1.2  # mean squared distances that noise alone may part
_ALIKE_FLOOR = 1e-10  # m^2: 10 um, what interpolation leaves of exact paths
_LEAST_OVERLAP = 0.3  # share of the shorter path that must overlap


@dataclass(frozen=True)
class TimeOffset:
    """Offset of two clocks. seconds: to add to the measured path's time to put it on the reference's clock. sigma: 1 sd in s.

    sigma is infinite, and seconds zero, where the paths do not move and so do not tell.
    """

    seconds: float
    sigma: float

    @property
    def significant(self) -> bool:
        """Gives whether the clocks differ by more than noise explains: by 4 sigma, and by 10 us (exact paths have no sigma)."""
        return abs(self.seconds) > max(4.0 * self.sigma, 1e-5)


def time_offset(reference: PosePath, measured: PosePath) -> TimeOffset:
    """Gives the time to add to `measured` so that it follows `reference`: `measured.shifted(result.seconds)`.

    The paths may be in different frames, and of different points of the tool as long as it does not rotate; only valid samples
    count. Beyond their common time nothing is assumed. Of several offsets that fit alike, because the motion repeats itself, the one
    with the most common time is taken. facts/tracker.md: sd .08 ms from 5 s at .5 m/s.
    """
    reference, measured = reference.only_valid(), measured.only_valid()
    if len(reference) < 5 or len(measured) < 5:
        return TimeOffset(0.0, np.inf)
    every = -(-len(measured) // _MOST_SAMPLES)
    time, position = measured.time[::every], measured.position[::every]
    found: list[_Candidate] = []
    for coarse in _coarse(reference, measured):
        chosen = _overlapping(reference, time + coarse)
        if chosen.sum() < 5:
            continue
        near = coarse + np.arange(-4, 5) * _STEP
        nearest = near[np.argmin([_mean_square(seconds, reference, time[chosen], position[chosen]) for seconds in near])]
        solution = minimize_scalar(
            _mean_square,
            bounds=(nearest - _STEP, nearest + _STEP),
            args=(reference, time[chosen], position[chosen]),
            method="bounded",
            options={"xatol": 1e-7},
        )
        found.append(_Candidate(float(solution.x), float(solution.fun), int(chosen.sum())))
    if not found:
        return TimeOffset(0.0, np.inf)
    # a motion that repeats itself fits at several offsets, some of them by chance a little better than the true one
    least = min(candidate.mean_square for candidate in found)
    alike = [candidate for candidate in found if candidate.mean_square <= _ALIKE * least + _ALIKE_FLOOR]
    best = max(alike, key=lambda candidate: (candidate.samples, -abs(candidate.seconds))).seconds
    chosen = _overlapping(reference, time + best)
    sigma = _sigma(reference, time[chosen], position[chosen], best)
    return TimeOffset(best, sigma) if np.isfinite(sigma) else TimeOffset(0.0, np.inf)


@dataclass(frozen=True)
class _Candidate:
    """An offset in s, the mean squared distance in m^2 that it leaves, and of how many samples."""

    seconds: float
    mean_square: float
    samples: int


def _overlapping(reference: PosePath, time: FloatArray) -> FloatArray:
    """Gives which times (N,) stay inside the reference while the fine search moves them."""
    margin = 6 * _STEP
    return np.asarray((time >= reference.time[0] + margin) & (time <= reference.time[-1] - margin))


def _speed(path: PosePath, grid: FloatArray) -> FloatArray:
    """Gives the speed at the grid's times, smoothed; zero outside the path."""
    half = _SMOOTH / 2
    ahead = np.stack([np.interp(grid + half, path.time, path.position[:, i]) for i in range(3)], axis=1)
    behind = np.stack([np.interp(grid - half, path.time, path.position[:, i]) for i in range(3)], axis=1)
    return np.asarray(np.linalg.norm(ahead - behind, axis=1) / _SMOOTH)


def _coarse(reference: PosePath, measured: PosePath) -> list[float]:
    """Gives candidate offsets, best first, from the correlation of the two speeds."""
    start = (reference.time[0], measured.time[0])
    duration = (reference.time[-1] - start[0], measured.time[-1] - start[1])
    step = max(_STEP, max(duration) / 1e6)
    speeds = [
        _speed(path, begin + np.arange(int(length / step) + 2) * step)
        for path, begin, length in zip((reference, measured), start, duration, strict=True)
    ]
    # a stop looks like the time outside the path: subtract nothing, so that standing still adds nothing
    correlation = correlate(speeds[0], speeds[1], mode="full", method="fft")
    lag = np.arange(-len(speeds[1]) + 1, len(speeds[0]))
    # normalise by what overlaps, so that a short loud piece does not win over the whole
    ones = correlate(np.ones_like(speeds[0]), np.ones_like(speeds[1]), mode="full", method="fft")
    energy = np.sqrt(
        np.maximum(correlate(speeds[0] ** 2, np.ones_like(speeds[1]), mode="full", method="fft"), 0.0)
        * np.maximum(correlate(np.ones_like(speeds[0]), speeds[1] ** 2, mode="full", method="fft"), 0.0)
    )
    enough = ones >= _LEAST_OVERLAP * min(len(s) for s in speeds)
    score = np.where(enough & (energy > 1e-9 * energy.max(initial=1e-30)), correlation / np.maximum(energy, 1e-30), 0.0)
    score = score * np.sqrt(np.maximum(ones, 0.0) / ones.max())  # among equals the longer overlap
    peaks = find_peaks(score, distance=3)[0]
    if len(peaks) == 0:
        peaks = np.array([int(np.argmax(score))])
    order = peaks[np.argsort(score[peaks])[::-1][:_CANDIDATES]]
    return [float(start[0] - start[1] + lag[i] * step) for i in order]


def _fitted(seconds: float, reference: PosePath, time: FloatArray, position: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gives reference positions at shifted times, and measured positions fitted to them, both centred: (N, 3), (N, 3).

    Rotation, translation and scale are fitted: a tracker's scale of 1.005, left in, would shift an open path by .3 ms.
    """
    target = np.stack([np.interp(time + seconds, reference.time, reference.position[:, i]) for i in range(3)], axis=1)
    target -= target.mean(axis=0)
    centred = position - position.mean(axis=0)
    left, stretch, right = np.linalg.svd(target.T @ centred)
    sign = np.array([1.0, 1.0, 1.0 if np.linalg.det(left @ right) > 0.0 else -1.0])
    square = float(np.sum(centred**2))
    scale = float(stretch @ sign) / square if square > 0.0 else 1.0
    return target, scale * centred @ (left @ np.diag(sign) @ right).T


def _mean_square(seconds: float, reference: PosePath, time: FloatArray, position: FloatArray) -> float:
    target, fitted = _fitted(seconds, reference, time, position)
    return float(np.mean(np.sum((target - fitted) ** 2, axis=1)))


def _sigma(reference: PosePath, time: FloatArray, position: FloatArray, seconds: float) -> float:
    """Gives the standard deviation from the curvature of the squared distance and the residuals' own correlation in time."""
    n = len(time)
    if n < 5:
        return float("inf")
    delta = 2e-3
    here, ahead, behind = (_mean_square(seconds + d, reference, time, position) for d in (0.0, delta, -delta))
    curvature = (ahead - 2.0 * here + behind) / delta**2 * n / 2.0  # sum of squared speeds that no similarity explains
    target, fitted = _fitted(seconds, reference, time, position)
    residual = target - fitted
    variance = float(np.mean(residual**2))
    spectrum = np.abs(np.fft.rfft(residual, n=2 * n, axis=0)) ** 2
    autocovariance = np.fft.irfft(spectrum, axis=0)[: n // 4].sum(axis=1)
    if variance > 0.0 and autocovariance[0] > 0.0:
        correlation = autocovariance / autocovariance[0]
        ends = np.flatnonzero(correlation < 0.05)
        correlated = 1.0 + 2.0 * float(correlation[1 : ends[0] if len(ends) else None].sum())
    else:
        correlated = 1.0
    travelled = float(np.max(np.ptp(target, axis=0)))
    if curvature <= 0.0 or travelled < _LEAST_TRAVEL * np.sqrt(variance):
        return float("inf")
    return float(np.sqrt(variance * correlated / curvature))
