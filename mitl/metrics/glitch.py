"""Glitches: short excursions of the tracker that no robot can make. They are marked invalid before anything is judged."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.ndimage import binary_dilation, median_filter

from mitl.paths import PosePath

# ASSUMPTION A-68: an excursion of 10 mm and back within 40 ms is the tracker's. An arm would need 100 m/s^2 for it; in a sharp reversal
# at 20 m/s^2 it strays 4 mm from the running median. facts/tracker.md: glitches are of 25 mm, about one in 80 windows.
SIZE = 10e-3
LONGEST = 0.04


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
