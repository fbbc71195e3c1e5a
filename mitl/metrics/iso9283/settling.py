"""Pose stabilisation time and overshoot at a stop."""

from __future__ import annotations

import numpy as np

from mitl.metrics.deviation import window_means
from mitl.paths import FloatArray

_SMOOTH = 0.03  # s, against single noisy samples


def stabilisation(time: FloatArray, position: FloatArray, rest: FloatArray, band: float) -> tuple[float, float]:
    """Gives the time in s from the first entry of the band of `band` m about the place of rest until it is left no more, and the overshoot.

    The overshoot in m is the largest excursion past the place of rest after the first entry, 0 where the band is not left again.
    time: (N,), position: (N, 3), from before the stop until after it. The band is entered along the approach, where the tool passes the
    plane `band` before the place of rest: a fast tool can cross a sphere between two samples, and noise across its way make it miss it.
    Raises ValueError where the path is within the band throughout, or at its end not.
    """
    offset = window_means(time, position, _SMOOTH) - rest
    away = np.linalg.norm(offset, axis=1)
    outside = np.flatnonzero(away > band)
    if len(outside) == 0 or outside[-1] == len(away) - 1:
        raise ValueError(f"the band of {1e3 * band:g} mm about the place of rest is {'not kept' if len(outside) else 'never left'}")
    before = offset[outside[0]]
    along = -(offset @ before) / np.linalg.norm(before)
    entered = int(np.flatnonzero(along >= -band)[0])
    if outside[-1] < entered:
        return 0.0, 0.0
    return float(time[outside[-1] + 1] - time[entered]), max(float(along[entered:].max()), 0.0)
