"""What still recordings of a tracker at several places say about its noise: one shape, and a gain for each place.

Invariant: only valid samples of still stretches count.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.metrics.allan import structure_function
from mitl.metrics.noise_fit import NoiseFit, fit_noise
from mitl.metrics.stillness import jitter_diameter
from mitl.metrics.stretches import still_stretches
from mitl.paths import FloatArray, PosePath

JITTER_WINDOW = 0.2
"""Length in s of the windows whose jitter tells a place's gain."""
_SHORTEST = 1.0


@dataclass(frozen=True, eq=False)
class TrackerFit:
    """Noise of a tracker, SI, rotations in rad. rate: Hz. position, turn: fits per axis for a place of gain 1.

    axis_factors: (3,), mean square 1. jitter: (K,) m, mean jitter of JITTER_WINDOW at each place. The gains' geometric mean is 1:
    a place's gain is its jitter over their geometric mean.
    """

    rate: float
    position: NoiseFit
    turn: NoiseFit
    axis_factors: FloatArray
    jitter: FloatArray

    @property
    def typical_jitter(self) -> float:
        """Gives the geometric mean of the places' jitter in m."""
        return float(np.exp(np.mean(np.log(self.jitter))))

    @property
    def gain_sd_log(self) -> float:
        """Gives the sd of the logarithm of the places' gains; 0 for one place."""
        return float(np.std(np.log(self.jitter), ddof=1)) if len(self.jitter) > 1 else 0.0


def fit_tracker(recordings: list[PosePath]) -> TrackerFit:
    """Gives the fit to still recordings, one a place. Raises ValueError where a recording has no still second."""
    longest = [max(still_stretches(path, _SHORTEST), key=len, default=None) for path in recordings]
    parts = [part for part in longest if part is not None]
    if len(parts) < len(longest) or not parts:
        number = longest.index(None) + 1 if None in longest else 1
        raise ValueError(f"recording {number} has no stretch of {_SHORTEST:g} s in which the body stands still")
    interval = float(np.median([np.median(np.diff(part.time)) for part in parts]))
    jitter = np.array([place_jitter(part) for part in parts])
    if not np.all(jitter > 0.0):
        raise ValueError(f"recording {int(np.argmin(jitter)) + 1} has no jitter at all: it is no recording of a tracker")
    gains = jitter / np.exp(np.mean(np.log(jitter)))
    lags = sorted({round(10.0**power) for power in np.arange(0.0, 5.0, 0.1) if round(10.0**power) < max(len(part) for part in parts) // 3})
    position = _mean_structure([part.position for part in parts], lags, gains)
    # orientation has no gain in the sensor model: the median place stands for all
    turn = _mean_structure([_turns(part) for part in parts], lags, np.ones(len(parts)), median=True)
    time = np.array(lags) * interval
    fits = [fit_noise(time, values.mean(axis=1)) for values in (position, turn)]
    if fits[0] is None or fits[1] is None:
        raise ValueError("the recordings are too short for a fit of their noise: expected some seconds at 100 Hz or more")
    near = (time > 0.05) & (time < 0.5)
    per_axis = np.sqrt(position[near].mean(axis=0)) if np.any(near) else np.ones(3)
    return TrackerFit(1.0 / interval, fits[0], fits[1], per_axis / np.sqrt(np.mean(per_axis**2)), jitter)


def place_jitter(path: PosePath, window: float = JITTER_WINDOW) -> float:
    """Gives the mean jitter in m of a recording's windows, one after the other."""
    count = max(2, round(window / float(np.median(np.diff(path.time)))))
    found = [jitter_diameter(path.position[first : first + count]) for first in range(0, len(path) - count + 1, count)]
    return float(np.mean(found)) if found else 0.0


def _mean_structure(values: list[FloatArray], lags: list[int], gains: FloatArray, *, median: bool = False) -> FloatArray:
    each = np.array([structure_function(rows, lags) / gain**2 for rows, gain in zip(values, gains, strict=True)])
    return np.asarray(np.nanmedian(each, axis=0) if median else np.nanmean(each, axis=0))


def _turns(path: PosePath) -> FloatArray:
    R = Rotation.from_quat(path.quaternion_wxyz, scalar_first=True)
    return (R.mean().inv() * R).as_rotvec()
