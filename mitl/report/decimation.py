"""Fewer points for a plot, without losing what one looks for: the extremes of every stretch stay."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from mitl.paths import FloatArray


def keep_extremes(values: FloatArray, most: int) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Gives the increasing indices of at most `most` rows of values (N, k): of every stretch the first row, and where each column peaks.

    Columns may contain nan, which is never a peak. The first and last row are always kept. Raises ValueError for most < 2 + 4 k.
    """
    n, k = values.shape
    per_stretch = 2 * k + 1
    if most < 2 * per_stretch:
        raise ValueError(f"expected room for at least {2 * per_stretch} points of {k} columns, got {most}")
    if n <= most:
        return np.arange(n)
    edges = np.linspace(0, n, (most - 1) // per_stretch + 1).astype(np.intp)
    chosen = [edges[:-1], np.array([n - 1])]
    for column in values.T:
        low, high = np.where(np.isnan(column), np.inf, column), np.where(np.isnan(column), -np.inf, column)
        for a, b in pairwise(edges):
            chosen.append(np.array([a + np.argmin(low[a:b]), a + np.argmax(high[a:b])]))
    return np.unique(np.concatenate(chosen)).astype(np.intp)


def with_gaps(time: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gives time (N,) and values (N, k) with a row of nan where samples are missing, so that no line is drawn across."""
    if len(time) < 3:
        return time, values
    step = np.diff(time)
    after = np.flatnonzero(step > 10.0 * np.median(step)) + 1
    nan = np.full((len(after), values.shape[1]), np.nan)
    return np.insert(time, after, (time[after - 1] + time[after]) / 2.0), np.insert(values, after, nan, axis=0)
