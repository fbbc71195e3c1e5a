"""Path accuracy AT (position and orientation) and path repeatability RT along a commanded line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mitl.metrics.orientation import slerp, turn_between
from mitl.paths import FloatArray, PosePath

POINTS = 20
"""Places along the path at which passes are compared; the standard asks for at least ten."""


@dataclass(frozen=True)
class PathCriteria:
    """accuracy: AT_p, m. angle: AT_a, rad. repeatability: RT_p, m. random: standard error of AT_p, m."""

    accuracy: float
    angle: float
    repeatability: float
    random: float


def path_criteria(passes: Sequence[PosePath], start: FloatArray, end: FloatArray, *, margin: float = 0.1) -> PathCriteria:
    """Gives the criteria of passes from start to end, poses (7,), at POINTS places; `margin`: share of the line left out at either end.

    At every place the pass is averaged over the way between the places, as its deviation from the line and from the even turn. Raises
    ValueError for fewer than three passes or where one has no sample at a place.
    """
    if len(passes) < 3:
        raise ValueError(f"path criteria need at least three passes, got {len(passes)}")
    edges = np.linspace(margin, 1.0 - margin, POINTS + 1)
    found = [_along(path, start, end, edges) for path in passes]
    across, turns = np.array([one[0] for one in found]), np.array([one[1] for one in found])
    mean = across.mean(axis=0)
    away = np.linalg.norm(across - mean, axis=2)
    random = float(np.median(np.std(across, axis=0, ddof=1).max(axis=1))) / np.sqrt(len(passes))
    return PathCriteria(
        float(np.linalg.norm(mean, axis=1).max()),
        float(np.linalg.norm(turns.mean(axis=0), axis=1).max()),
        float((away.mean(axis=0) + 3.0 * away.std(axis=0, ddof=1)).max()),
        random,
    )


def _along(path: PosePath, start: FloatArray, end: FloatArray, edges: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gives the deviation across the line and the turn off the even one, (POINTS, 3) each, averaged between the edges."""
    line = end[:3] - start[:3]
    share = (path.position - start[:3]) @ line / (line @ line)
    across = path.position - start[:3] - share[:, None] * line
    turn = turn_between(slerp(start[3:], end[3:], np.clip(share, 0.0, 1.0)), path.quaternion_wxyz)
    place = np.digitize(share, edges) - 1
    count = np.array([np.sum(place == number) for number in range(POINTS)])
    if count.min() == 0:
        raise ValueError("a pass has no sample at one of the places of the path")
    across, turn = (np.array([values[place == number].mean(axis=0) for number in range(POINTS)]) for values in (across, turn))
    return across, turn
