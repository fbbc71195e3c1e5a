"""Lag: the path coordinate that is really followed trails the planned one with a first-order lag, in closed form.

Invariant: on every piece of a timing, s, its lagged copy and the way between them satisfy the lag's equation exactly.
"""

from __future__ import annotations

import numpy as np

from mitl.motion.timing import Timing
from mitl.paths import FloatArray


def behind_at(timing: Timing, lag: float, behind: float, time: FloatArray) -> FloatArray:
    """Gives how far (N,) in m the lagged coordinate is behind at times (N,) from 0 s on; at 0 it is `behind` m.

    lag: time constant in s, 0 for none. After the timing's duration the way behind decays.
    """
    if lag <= 0:
        return np.zeros(len(time))
    lasts = timing.lengths
    begins, ends = _steady(timing, lag, np.zeros(len(lasts))), _steady(timing, lag, lasts)
    kept = np.exp(-lasts / lag)
    rest = [behind - begins[0] if len(begins) else behind]
    for k, begin, end in zip(kept[:-1].tolist(), begins[1:].tolist(), ends[:-1].tolist(), strict=True):
        rest.append(rest[-1] * k + end - begin)
    transient = np.array(rest)
    clipped = np.clip(time, 0.0, timing.duration)
    piece = np.clip(np.searchsorted(timing.start, clipped, side="right") - 1, 0, len(lasts) - 1)
    since = clipped - timing.start[piece]
    found = _steady(timing, lag, since, piece) + transient[piece] * np.exp(-since / lag)
    return np.asarray(found * np.exp(-np.maximum(time - timing.duration, 0.0) / lag))


def _steady(timing: Timing, lag: float, since: FloatArray, piece: np.ndarray | slice = slice(None)) -> FloatArray:
    """Gives the way behind in m without its transient, `since` s after the begins of pieces."""
    v, a, j = timing.speed[piece], timing.acceleration[piece], timing.jerk[piece]
    return np.asarray(lag * (v + since * (a + since * j / 2)) - lag**2 * (a + since * j) + lag**3 * j)
