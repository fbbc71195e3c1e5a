"""How late a tool passes the places of its oracle, at single instants: a path's own timing, to be told from that of what happens on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mitl.metrics.path import interpolate
from mitl.paths import FloatArray, IndexArray, PosePath

WINDOW = 0.2
"""Seconds about an instant whose samples tell the lateness there: 50 samples, over which the tracker's noise is averaged."""


@dataclass(frozen=True, eq=False)
class Lateness:
    """How many s a tool is late at K instants, and how fast it is there.

    seconds, random (K,) s: lateness and its own noise, as standard uncertainty; speed (K,) m/s: the oracle's, root mean square over the
    window. Where the tool stands or no sample is valid, seconds is not a number and random infinite.
    """

    seconds: FloatArray
    random: FloatArray
    speed: FloatArray


def lateness(reference: PosePath, measured: PosePath, times: FloatArray, window: float = WINDOW) -> Lateness:
    """Gives how late `measured` is at times (K,) s of `reference`, both in one frame and on one clock.

    Within the window the distance between the two, taken along the way, is speed times lateness; across the way nothing counts. It is
    for small lateness: what the speed changes over it is neglected. The noise is that of the samples about the fit, of which five in a row
    count as one (tracker noise is correlated, facts/tracker.md).
    """
    measured = measured.only_valid()
    step = 1e-3
    found = np.full((3, len(times)), np.nan)
    found[1], found[2] = np.inf, 0.0
    for number, time in enumerate(times.tolist()):
        here: IndexArray = np.flatnonzero(np.abs(measured.time - time) <= window / 2)
        at = measured.time[here]
        inside = (at > reference.time[0] + step) & (at < reference.time[-1] - step)
        here, at = here[inside], at[inside]
        if len(here) < 5:
            continue
        before, there, after = (interpolate(reference, at + shift).position for shift in (-step, 0.0, step))
        velocity = (after - before) / (2 * step)
        square = float(np.sum(velocity**2))
        speed = float(np.sqrt(square / len(here)))
        if speed < 1e-3:
            continue
        behind = there - measured.position[here]
        late = float(np.sum(velocity * behind)) / square
        left = np.sum((behind - late * velocity) * velocity, axis=1) / np.linalg.norm(velocity, axis=1).clip(1e-6)
        noise = float(np.sqrt(np.mean(left**2) * 5 / len(here)))
        found[:, number] = late, noise / speed, speed
    return Lateness(found[0], found[1], found[2])
