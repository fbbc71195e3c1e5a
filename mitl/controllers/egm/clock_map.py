"""The controller's clock on ours, from datagrams that went one way: arrival = offset + rate * sent + a delay that is never negative.

The best line lies below all points and as near to them as it can: the edge of their lower hull under their mean (Moon, Skelly and
Towsley 1999, "Estimation and removal of clock skew from network delay measurements"). What stays unknown is the least delay of the network.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mitl.paths import FloatArray

_LEAST_SPAN = 5.0
"""Seconds below which delays would look like a drift; then the clocks are taken to run alike."""


@dataclass(frozen=True)
class ClockMap:
    """ours = ours_0 + rate * (theirs - theirs_0). delay: median in s of how much later than this line datagrams came."""

    theirs_0: float
    ours_0: float
    rate: float
    delay: float

    def ours(self, theirs: FloatArray) -> FloatArray:
        """Gives times (N,) s on our clock."""
        return self.ours_0 + self.rate * (theirs - self.theirs_0)


def clock_map(sent: FloatArray, arrived: FloatArray) -> ClockMap:
    """Gives the map from times (N,) of sending on their clock and of arrival on ours, in s. Raises ValueError for none."""
    if len(sent) == 0:
        raise ValueError("expected at least one datagram")
    x, y = sent - sent[0], arrived - arrived[0]
    if float(np.ptp(x)) < _LEAST_SPAN:
        rate, base = 1.0, float(np.min(y - x))
    else:
        order = np.argsort(x, kind="stable")
        first, second = _edge(x[order], (y - x)[order])
        slope = (second[1] - first[1]) / (second[0] - first[0])
        rate, base = 1.0 + slope, first[1] - slope * first[0]
    late = y - (base + rate * x)
    return ClockMap(float(sent[0]), float(arrived[0]) + base, rate, float(np.median(late)))


def _edge(x: FloatArray, y: FloatArray) -> tuple[tuple[float, float], tuple[float, float]]:
    """Gives the edge of the lower hull of points with x in order that lies under their mean."""
    hull: list[tuple[float, float]] = []
    for point in zip(x.tolist(), y.tolist(), strict=True):
        if hull and point[0] == hull[-1][0]:
            if point[1] >= hull[-1][1]:
                continue
            hull.pop()
        while len(hull) > 1 and _turns_down(hull[-2], hull[-1], point):
            hull.pop()
        hull.append(point)
    mean = float(np.mean(x))
    for first, second in pairwise(hull):
        if second[0] >= mean:
            return first, second
    return hull[-2], hull[-1]


def _turns_down(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> bool:
    return (b[0] - a[0]) * (c[1] - a[1]) <= (b[1] - a[1]) * (c[0] - a[0])
