"""Bends: how fast a controller leads the TCP round the bends of a path where it limits the TCP's acceleration, tick by tick.

Such a controller sees its interpolator's points: their second difference over one tick. That is v^2 / r on arcs and in large zones, and
less in zones that it passes in a few ticks. Invariant: a cap is never below that of the place's own curvature.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mitl.motion.grid import Grid
from mitl.motion.legs import CartesianLeg
from mitl.motion.path import Path
from mitl.paths import BoolArray, FloatArray, IndexArray

_NOTHING = 1e-12
_STEPS = 8
_CLOSE = 1e-4
"""Share of x by which a cap may be wrong."""


def bend_caps(path: Path, grid: Grid, x: FloatArray, acceleration: FloatArray, tick: float) -> FloatArray:
    """Gives the greatest x = s'^2 (N+1,) at the nodes for which the TCP is accelerated across its path by at most `acceleration`.

    x (N,): the greatest in each interval by other limits; acceleration (N,) m/s^2, inf where there is no limit; tick in s.
    """
    caps = np.full(len(grid) + 1, np.inf)
    with np.errstate(divide="ignore"):
        at_point = acceleration / grid.curvature.max(axis=1)
    bent = np.flatnonzero(at_point < x)
    if len(bent) == 0:
        return caps
    tool = np.array([id(leg.X_FT) for leg in path.legs])
    for side in (0, 1):
        node = bent + side
        tighter: BoolArray = at_point[bent] < caps[node]
        np.minimum.at(caps, node[tighter], at_point[bent[tighter]])
    node = np.flatnonzero(np.isfinite(caps))
    beside = np.stack([np.maximum(node - 1, 0), np.minimum(node, len(grid) - 1)])
    most, limit = x[beside].max(axis=0), acceleration[beside].min(axis=0)

    def seen(which: IndexArray, speed: FloatArray) -> FloatArray:
        """Gives what acceleration (K,) in m/s^2 is seen at nodes (K,) passed at speeds (K,)."""
        s, step = grid.nodes[node[which]], speed * tick
        places = np.clip(np.stack([s - step, s, s + step]), 0.0, path.length)
        before, here, after = path.positions(places.ravel())[0].reshape(3, len(which), 3)
        legs = np.clip(np.searchsorted(path.leg_ends(), places, side="right") - 1, 0, len(path.legs) - 1)
        whole = (tool[legs] == tool[legs[1]]).all(axis=0) & (places[2] - places[0] > 2 * step - 1e-12)
        found = np.linalg.norm(before - 2 * here + after, axis=1) / tick**2
        return np.where(whole, found, np.inf)

    caps[node] = _fastest(seen, caps[node], most, limit)
    return caps


def _fastest(seen: Callable[[IndexArray, FloatArray], FloatArray], low: FloatArray, high: FloatArray, limit: FloatArray) -> FloatArray:
    """Gives the greatest x (K,) from `low` to `high` at which no more than `limit` (K,) is seen.

    What is seen is a power of the speed, 2 in wide bends and less in narrow ones; the power is taken from the last two speeds.
    """
    x = np.maximum(high, low)
    found = seen(np.arange(len(x)), np.sqrt(x))
    caps = np.where(np.isfinite(found), x, low)
    todo = np.flatnonzero((found > limit) & np.isfinite(found))
    over, power = found[todo] / limit[todo], np.full(len(todo), 1.0)
    for _ in range(_STEPS):
        if len(todo) == 0:
            break
        following = np.maximum(caps[todo] * over ** (-1 / power), low[todo])
        now = seen(todo, np.sqrt(following)) / limit[todo]
        moved = (following < caps[todo] * (1 - _CLOSE)) | (following > caps[todo] * (1 + _CLOSE))
        fell, slowed = np.maximum(now[moved] / over[moved], _NOTHING), following[moved] / caps[todo[moved]]
        caps[todo] = following
        todo, over, power = todo[moved], now[moved], np.clip(np.log(fell) / np.log(slowed), 0.25, 1.0)
    return caps


def limited(path: Path, grid: Grid, acceleration: float, share: FloatArray) -> FloatArray:
    """Gives the limit (N,) in m/s^2 of the TCP's acceleration: on lines and arcs, by shares (N,); inf on joint moves."""
    straight = np.array([isinstance(leg, CartesianLeg) for leg in path.legs])
    return np.where(straight[grid.leg], acceleration * share, np.inf)
