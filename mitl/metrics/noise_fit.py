"""What a still tracker's noise is made of: a fast Ornstein-Uhlenbeck process and a random walk, fitted to its structure function."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from mitl.paths import FloatArray

_FIT_UP_TO = 1.0  # s: beyond, a few slow wanderings of a short recording decide
_LEAST = 1e-9  # m: exact data must not give the logarithm of zero


@dataclass(frozen=True)
class NoiseFit:
    """Mean squared difference over a time t per axis: 2 fast_sd^2 (1 - exp(-t / fast_tau)) + walk^2 t.

    fast_sd: m. fast_tau: s. walk: m per root second.
    """

    fast_sd: float
    fast_tau: float
    walk: float

    def structure(self, time: FloatArray) -> FloatArray:
        """Gives the mean squared difference (K,) in m^2 over times (K,) in s."""
        return 2.0 * self.fast_sd**2 * (1.0 - np.exp(-time / self.fast_tau)) + self.walk**2 * time


def fit_noise(time: FloatArray, structure: FloatArray) -> NoiseFit | None:
    """Gives the model nearest to mean squared differences (K,) over times (K,) in s, in the logarithm; None for fewer than four."""
    usable = np.isfinite(structure) & (structure > 0.0) & (time <= _FIT_UP_TO)
    if np.count_nonzero(usable) < 4:
        return None
    t, root = time[usable], np.sqrt(structure[usable])
    start = np.log([max(float(root.max()) / np.sqrt(2.0), _LEAST), max(2.0 * float(t[0]), 1e-3), max(0.1 * float(root.max()), _LEAST)])

    def misfit(logs: FloatArray) -> FloatArray:
        model = NoiseFit(*(float(value) for value in np.exp(logs)))
        return np.asarray(0.5 * np.log(model.structure(t)) - np.log(root))

    bounds = (np.log([_LEAST, 0.1 * float(t[0]), _LEAST]), np.log([1.0, 10.0, 1.0]))
    solution = least_squares(misfit, np.clip(start, bounds[0] + 1e-6, bounds[1] - 1e-6), bounds=bounds)
    return NoiseFit(*(float(value) for value in np.exp(solution.x)))
