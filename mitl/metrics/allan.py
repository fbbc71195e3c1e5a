"""How a still tracker's noise goes with time: Allan deviation and structure function, per axis.

Both take evenly spaced samples and ignore constant offsets; a random walk of s per root second has an Allan deviation of s sqrt(tau / 3).
"""

from __future__ import annotations

import numpy as np

from mitl.paths import FloatArray


def allan_deviation(values: FloatArray, counts: list[int]) -> FloatArray:
    """Gives the overlapping Allan deviation (K, d) of values (N, d): of neighbouring means over `counts` samples each, over sqrt 2.

    Not a number where 2 counts exceed N. Source: D. W. Allan, "Statistics of atomic frequency standards", Proc. IEEE 54(2), 1966.
    """
    total = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values - values.mean(axis=0), axis=0)])
    result = np.full((len(counts), values.shape[1]), np.nan)
    for row, count in enumerate(counts):
        if 0 < 2 * count <= len(values):
            means = (total[count:] - total[:-count]) / count
            result[row] = np.sqrt(0.5 * np.mean((means[count:] - means[:-count]) ** 2, axis=0))
    return result


def structure_function(values: FloatArray, lags: list[int]) -> FloatArray:
    """Gives the mean squared differences (K, d) of values (N, d) so many samples apart; not a number where there are none."""
    result = np.full((len(lags), values.shape[1]), np.nan)
    for row, lag in enumerate(lags):
        if 0 < lag < len(values):
            result[row] = np.mean((values[lag:] - values[:-lag]) ** 2, axis=0)
    return result
