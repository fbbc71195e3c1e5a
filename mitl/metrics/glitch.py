"""Glitches: short excursions of the tracker that no robot can make. They are marked invalid before anything is judged."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.ndimage import binary_dilation, median_filter

from mitl.paths import FloatArray, PosePath

# ASSUMPTION A-68: an excursion of 10 mm and back within 40 ms is the tracker's. An arm would need 100 m/s^2 for it; in a sharp reversal
# at 20 m/s^2 it strays 4 mm from the running median. facts/tracker.md: glitches are of 25 mm, about one in 80 windows.
SIZE = 10e-3
LONGEST = 0.04
PULSE = 0.024
"""Seconds: a glitch in motion lasts 20 ms (A-58), too small mostly for the size above."""


def without_glitches(path: PosePath, size: float = SIZE, longest: float = LONGEST) -> PosePath:
    """Gives the path with glitches marked invalid, and the sample on either side of each.

    A glitch is where a valid position is more than `size` m from the running median of the valid positions around it; excursions
    longer than `longest` s stay, because a robot may have made them.
    """
    index = np.flatnonzero(path.valid)
    if len(index) < 3:
        return path
    interval = float(np.median(np.diff(path.time[index])))
    window = min(2 * round(longest / interval) + 1, len(index))
    if window < 3:
        return path
    position = path.position[index]
    centre = np.stack([median_filter(position[:, i], size=window, mode="nearest") for i in range(3)], axis=1)
    glitch = binary_dilation(np.linalg.norm(position - centre, axis=1) > size)
    valid = path.valid.copy()
    valid[index[glitch]] = False
    return replace(path, valid=valid)


def without_pulses(time: FloatArray, deviation: FloatArray, longest: float = PULSE) -> FloatArray:
    """Gives the running median (N,) of a deviation (N,) over a window in which pulses of at most `longest` s are the minority.

    For deviations from the expected motion, whose own motion is taken off: a step stays a step where it is, a pulse is gone, however
    small. time: (N,) in s.
    """
    if len(time) < 3:
        return deviation
    window = min(2 * round(longest / float(np.median(np.diff(time)))) + 1, len(time))
    return np.asarray(median_filter(deviation, size=window, mode="nearest"))
