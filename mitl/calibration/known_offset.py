"""Time offset between two clocks that are already known to within a fraction of a second, from paths in one common frame.

Unlike `time_offset` it fits no rotation and no scale, so that a short straight motion suffices.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize_scalar

from mitl.calibration.time_offset import TimeOffset
from mitl.paths import FloatArray, PosePath

_STEP = 10e-3
_LEAST_MOTION = 5.0
"""The motion must be this many times as large as what no offset explains. ASSUMPTION A-70."""


def refine_offset(reference: PosePath, measured: PosePath, expected: float, *, within: float = 0.3) -> TimeOffset:
    """Gives the seconds to add to `measured`, at most `within` s from `expected`, so that it follows `reference` best.

    Both are in one frame; a constant distance between them does not count. Measured times beyond the reference count as its ends, at
    rest. Where the motion does not tell, sigma is infinite.
    """
    measured = measured.only_valid()
    trials = expected + np.arange(-within, within + _STEP, _STEP)
    if len(measured) < 5 or len(reference) < 5:
        return TimeOffset(0.0, float("inf"))

    def misfit(seconds: float) -> FloatArray:
        there = np.stack([np.interp(measured.time + seconds, reference.time, reference.position[:, i]) for i in range(3)], axis=1)
        difference = measured.position - there
        return np.asarray(difference - difference.mean(axis=0))

    def mean_square(seconds: float) -> float:
        return float(np.mean(misfit(seconds) ** 2))

    coarse = trials[int(np.argmin([mean_square(trial) for trial in trials]))]
    fine = minimize_scalar(mean_square, bounds=(coarse - _STEP, coarse + _STEP), method="bounded", options={"xatol": 1e-7})
    seconds = float(fine.x)
    delta = 2e-3
    curvature = (mean_square(seconds + delta) - 2 * mean_square(seconds) + mean_square(seconds - delta)) / delta**2
    residual = misfit(seconds)
    extent = float(np.ptp(measured.position, axis=0).max())
    if curvature <= 0 or extent < _LEAST_MOTION * float(np.sqrt(np.mean(residual**2))):
        return TimeOffset(0.0, float("inf"))
    # Residuals follow one another: the effective number of samples is that of their own correlation.
    scatter = float(np.mean(residual**2)) * _correlated(residual)
    return TimeOffset(seconds, float(np.sqrt(2 * scatter / (curvature * residual.size))))


def _correlated(residual: FloatArray) -> float:
    """Gives how many samples in a row say the same, from the residuals' first-order correlation."""
    square = float(np.sum(residual**2))
    if square <= 0:
        return 1.0
    rho = min(max(float(np.sum(residual[1:] * residual[:-1])) / square, 0.0), 0.99)
    return (1 + rho) / (1 - rho)
