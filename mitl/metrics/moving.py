"""From when to when a path is in motion, to cut the standing parts off both ends."""

from __future__ import annotations

import numpy as np

from mitl.metrics.deviation import window_means
from mitl.metrics.glitch import without_glitches
from mitl.paths import FloatArray, PosePath

THRESHOLD = 2e-3  # m; above the tracker's jitter and its creep after a stop (facts/tracker.md: 1.2 mm and .5 mm)
_REST = 0.1  # s at either end over which the rest position is averaged
_SMOOTH = 0.04  # s, against single noisy samples
# ASSUMPTION A-65: motion began where the smoothed distance last was below this share of the threshold. From rest the way grows at
# least with the square of time, so that the moment is late by less than sqrt(.25) of the time it takes to travel the threshold.
_BACK = 0.25


def moving_interval(path: PosePath, threshold: float = THRESHOLD) -> tuple[float, float] | None:
    """Gives the times in s at which the path leaves its first rest position and reaches its last, or None where it never moves.

    Motion is a departure by more than `threshold` m of the smoothed valid positions, glitches left out; standing parts in between
    belong to the motion.
    A path that is in motion from its first sample starts there. At 50 mm/s the times are within some 20 ms, at 5 mm/s within 0.2 s.
    """
    valid = without_glitches(path).only_valid()
    if len(valid) < 2:
        return None
    smooth = window_means(valid.time, valid.position, _SMOOTH)
    start = _departure(valid.time, smooth, threshold)
    if start is None:
        return None
    stop = _departure(-valid.time[::-1], smooth[::-1], threshold)
    if stop is None or -stop <= start:
        return None
    return start, -stop


def _departure(time: FloatArray, position: FloatArray, threshold: float) -> float | None:
    """Gives when the positions (N, 3) leave the place where they begin."""
    resting = time <= time[0] + _REST
    rest = position[resting]
    if np.ptp(rest, axis=0).max() > threshold:  # already in motion
        return float(time[0])
    distance = np.linalg.norm(position - np.median(rest, axis=0), axis=1)
    away = np.flatnonzero(distance > threshold)
    if len(away) == 0:
        return None
    # where the noise of rest itself passes a quarter of the threshold, what counts is what it reaches
    level = max(_BACK * threshold, 1.5 * float(np.max(distance[resting])))
    near = np.flatnonzero(distance[: away[0]] <= level)
    return float(time[near[-1]]) if len(near) else float(time[0])
