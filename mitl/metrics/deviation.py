"""Numbers that sum up a deviation along a path, above all a sound estimate of its largest value under tracker noise."""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from mitl.paths import FloatArray

WINDOW = 0.1  # s, default averaging window of the largest deviation
_GUARD = 1.65  # the guard band's factor (metrics.decision): one-sided 95 %


@dataclass(frozen=True)
class Summary:
    """Plain numbers of a deviation: rms, mean, largest and 95th percentile of its size, as measured, noise and all."""

    rms: float
    mean: float
    max: float
    p95: float


@dataclass(frozen=True)
class LargestDeviation:
    """The largest deviation of a path, with the noise averaged down.

    value: size of the largest window mean. time: middle of that window, s. random: standard uncertainty of `value` from noise, for
    the random term of a budget. window: s. windows: how many independent windows the path has.
    """

    value: float
    time: float
    random: float
    window: float
    windows: int


def summarise(deviation: FloatArray) -> Summary:
    """Gives the plain numbers of a deviation (N,) signed, or (N, k) as vectors. Raises ValueError where it is empty."""
    size = _size(deviation)
    if len(size) == 0:
        raise ValueError("expected at least one sample of the deviation, got none")
    return Summary(float(np.sqrt(np.mean(size**2))), float(np.mean(size)), float(np.max(size)), float(np.percentile(size, 95.0)))


def largest_deviation(time: FloatArray, deviation: FloatArray, window: float = WINDOW) -> LargestDeviation:
    """Gives the largest deviation of a path, robust to noise. time: (N,) s. deviation: (N,) signed or (N, k) as vectors.

    Why not simply the maximum: the largest of N noisy samples is biased upwards by the noise, the more so the longer the recording
    (five standard deviations at a million samples), so that a longer test of a good robot would fail. Instead:

    1. The deviation is averaged over a moving window *as a signed number or vector*, before its size is taken; sizes are never
       negative, and averaging them would keep the noise. 100 ms averages 25 samples at 250 Hz and still shows any fault that lasts
       that long; a shorter one is reduced by the share of the window that it fills.
    2. The noise that remains in a window mean is measured on the path itself, from the differences of adjacent window means (as an
       Allan deviation is; see `window_noise`). Unlike sample noise over sqrt(n) it is right for correlated noise, which the
       tracker's is (facts/tracker.md: its jitter grows 1.7-fold from 200 to 500 ms). It is taken as a median, so that a few places
       where the path really bends away do not count as noise; noise slower than the window belongs to the budget's drift.
    3. Even of K independent window means the largest is too large: typically by sqrt(2 ln K) standard deviations where the true
       deviation is the same everywhere, and not at all where it has one peak. `random` is therefore so wide that 1.65 of it, the
       guard band's factor, reach the 95 % quantile of the largest noise of all windows (2 K, because they overlap). Then
       value - 1.65 random is a lower bound of the true maximum also in the first case, and value + 1.65 random an upper one in both.

    Glitches must be taken out before (`glitch.without_glitches`): 25 mm for 20 ms are 5 mm in a window of 100 ms.
    Samples are weighted equally; gaps shorten a window's content. Raises ValueError where there is no sample.
    """
    if len(time) == 0:
        raise ValueError("expected at least one sample of the deviation, got none")
    vectors = deviation[:, None] if deviation.ndim == 1 else deviation
    means = window_means(time, vectors, window)
    size = np.linalg.norm(means, axis=1)
    at = int(np.argmax(size))
    duration = float(time[-1] - time[0])
    windows = max(1, int(duration / window)) if window > 0 else len(time)
    noise = window_noise(time, vectors, window)
    return LargestDeviation(float(size[at]), float(time[at]), noise * _widening(windows), window, windows)


def window_means(time: FloatArray, values: FloatArray, window: float) -> FloatArray:
    """Gives the mean (N, k) of the values (N, k) whose time is within half a window of each sample's; windows end at the path's ends."""
    first = np.searchsorted(time, time - window / 2, side="left")
    last = np.searchsorted(time, time + window / 2, side="right")
    # sums of differences from the mean keep the rounding small for long paths
    middle = values.mean(axis=0)
    sums = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values - middle, axis=0)])
    # no window may be shorter than half of one: near an end the nearest whole window is taken
    lower = np.searchsorted(time, time[-1] - window, side="left")
    upper = np.searchsorted(time, time[0] + window, side="right")
    first = np.minimum(first, lower)
    last = np.maximum(last, upper)
    return np.asarray((sums[last] - sums[first]) / (last - first)[:, None] + middle)


def window_noise(time: FloatArray, values: FloatArray, window: float) -> float:
    """Gives the noise of a window mean per axis: robust spread of second differences of adjacent window means of values (N, k).

    Largest over the k axes. A path shorter than four windows does not show it; there the samples' own spread is taken, as if their
    noise were wholly correlated.
    """
    edges = np.arange(time[0], time[-1], window) if len(time) else np.zeros(0)
    if len(edges) < 4:
        return float(np.max(np.std(values, axis=0), initial=0.0)) if len(time) else 0.0
    first = np.searchsorted(time, edges)
    counts = np.diff(first)
    means = np.add.reduceat(values, first[:-1][counts > 0], axis=0)[: int((counts > 0).sum())]
    # reduceat's last group runs to the end of the array: take the samples past the last edge off again
    means[-1] -= values[first[-1] :].sum(axis=0)
    means /= counts[counts > 0][:, None]
    # second differences let a steady change pass; of white noise they have the variance 6, where first ones have 2
    second = means[2:] - 2.0 * means[1:-1] + means[:-2]
    if len(second) == 0:  # gaps in the recording left fewer than three windows with samples
        return float(np.max(np.std(values, axis=0), initial=0.0))
    return float(np.max(1.4826 * np.median(np.abs(second), axis=0)) / np.sqrt(6.0))


def _widening(windows: int) -> float:
    """Gives by what the noise of one window must be multiplied, so that 1.65 of it bound the largest of so many windows to 95 %."""
    if windows < 2:
        return 1.0
    return max(1.0, NormalDist().inv_cdf(1.0 - 0.05 / (2 * windows)) / _GUARD)


def _size(deviation: FloatArray) -> FloatArray:
    return np.abs(deviation) if deviation.ndim == 1 else np.asarray(np.linalg.norm(deviation, axis=1))
