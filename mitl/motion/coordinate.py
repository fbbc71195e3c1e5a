"""The path coordinate: how it runs beside the coordinates of the legs, over zones and between them.

Invariant: it grows with the legs' coordinate everywhere, with slope and bend continuous inside every zone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PPoly

from mitl.paths import FloatArray

_LEAST_STRETCH = 0.16
"""Least ratio of path to leg coordinate: in corners sharper than 142 deg s is more than the arc length, so that it stays regular."""


def regular(way: FloatArray) -> FloatArray:
    """Gives ways (N,) that are never less than _LEAST_STRETCH, unchanged from its double on, with an even slope."""
    return np.where(way < 2 * _LEAST_STRETCH, _LEAST_STRETCH + way**2 / (4 * _LEAST_STRETCH), way)


@dataclass(frozen=True, eq=False)
class CornerNodes:
    """Nodes over a zone: g (K,), and for the K - 1 intervals the way in s, and the slopes ds/dg and bends d2s/dg2 at both ends."""

    g: FloatArray
    way: FloatArray
    after: FloatArray
    before: FloatArray
    bend_after: FloatArray
    bend_before: FloatArray


def chain_nodes(corners: list[CornerNodes], total: float) -> CornerNodes:
    """Gives nodes of a whole path of `total` coordinate length; between zones s runs as g does."""
    even = {"after": 1.0, "before": 1.0, "bend_after": 0.0, "bend_before": 0.0}
    g: list[FloatArray] = [np.zeros(1)]
    parts: dict[str, list[FloatArray]] = {name: [] for name in ("way", *even)}
    nothing = np.empty(0)
    for corner in [*corners, CornerNodes(np.array([total]), nothing, nothing, nothing, nothing, nothing)]:
        gap = corner.g[0] - g[-1][-1]
        joined = gap < 1e-12 * max(total, 1.0)  # where two zones meet, or one begins with the path, there is no straight stretch between
        g.append(corner.g[1:] if joined else corner.g)
        for name, found in parts.items():
            values = getattr(corner, name)
            found.append(values if joined else np.append(even.get(name, gap), values))
    return CornerNodes(np.concatenate(g), **{name: np.concatenate(found) for name, found in parts.items()})


def quintic(x: FloatArray, y: FloatArray, after: FloatArray, before: FloatArray, bend_after: FloatArray, bend_before: FloatArray) -> PPoly:
    """Gives the piecewise quintic through (x, y) (N,); slopes and bends (N - 1,) after the begins and before the ends of intervals."""
    h = np.diff(x)
    rest = np.diff(y) - h * (after + h * bend_after / 2)
    slope, bend = before - after - h * bend_after, bend_before - bend_after
    c3 = 10 * rest / h**3 - 4 * slope / h**2 + bend / (2 * h)
    c4 = -15 * rest / h**4 + 7 * slope / h**3 - bend / h**2
    c5 = 6 * rest / h**5 - 3 * slope / h**4 + bend / (2 * h**3)
    return PPoly(np.stack([c5, c4, c3, bend_after / 2, after, y[:-1]]), x)
