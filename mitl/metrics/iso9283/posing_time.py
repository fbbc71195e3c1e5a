"""Minimum posing time: from leaving one pose until the next is reached and kept."""

from __future__ import annotations

import numpy as np

from mitl.metrics.deviation import window_means
from mitl.paths import FloatArray

_SMOOTH = 0.03  # s


def posing_time(time: FloatArray, position: FloatArray, start: FloatArray, end: FloatArray, band: float) -> float:
    """Gives the time in s from the last moment within `band` m of the start to the first from which on the path stays so near its end.

    start, end: (3,), the places of rest as measured. Raises ValueError where the path is at neither.
    """
    smooth = window_means(time, position, _SMOOTH)
    at_start = np.linalg.norm(smooth - start, axis=1) <= band
    away_from_end = np.linalg.norm(smooth - end, axis=1) > band
    if not at_start.any() or away_from_end[-1] or not away_from_end.any():
        raise ValueError(f"the path does not lead from the start to the end, to within {1e3 * band:g} mm")
    return float(time[np.flatnonzero(away_from_end)[-1] + 1] - time[np.flatnonzero(at_start)[-1]])
