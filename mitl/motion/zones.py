"""Corner zones: how a path leaves one leg before its end and joins the next, after `facts/planner.md`, item 1.

With u the distance from the corner over the zone's radius, both legs are extended beyond the corner and blended:
x(u) = (pa + pb) / 2 + f(u) / (2 u) (pb - pa). Invariant: outside |u| < 1 nothing changes; at |u| = 1 position and direction are the leg's.
"""

from __future__ import annotations

import numpy as np

from mitl.paths import FloatArray

_A = 0.525
_B = (1 - _A) * 9 / 4
FLAT = 1 / 3
"""Share of a zone's radius about the corner in which the blend's second derivative is even."""
_K = _A + _B * (1 - FLAT)


def position_blend(u: FloatArray) -> FloatArray:
    """Gives f(u) for positions: |u| outside the zone, inside f'' = A + B (1 - max(|u|, 1/3)) with f and f' continuous."""
    w = np.abs(u)
    left = 1 - w
    outer = w + _A * left**2 / 2 + _B * left**3 / 6
    at_flat = FLAT + _A * (1 - FLAT) ** 2 / 2 + _B * (1 - FLAT) ** 3 / 6
    inner = at_flat - _K * (FLAT**2 - w**2) / 2
    return np.where(w >= 1, w, np.where(w >= FLAT, outer, inner))


def position_blend_slope(u: FloatArray) -> FloatArray:
    """Gives f'(u) of `position_blend`."""
    w = np.abs(u)
    left = 1 - w
    slope = np.where(w >= FLAT, 1 - _A * left - _B * left**2 / 2, _K * w)
    return np.asarray(np.sign(u) * np.where(w >= 1, 1.0, slope))


def orientation_blend(u: FloatArray) -> FloatArray:
    """Gives f(u) for rotation vectors: |u| outside the zone, (1 + u^2) / 2 inside."""
    w = np.abs(u)
    return np.where(w >= 1, w, (1 + w**2) / 2)


NUDGE = 1e-7
"""At u = 0 both legs meet and the blend is 0 / 0; callers move such samples by this share of the radius."""


def off_corner(u: FloatArray) -> FloatArray:
    """Gives u (N,) with values at the very corner nudged off it."""
    return np.where(np.abs(u) < NUDGE, NUDGE, u)


def blended(a: FloatArray, b: FloatArray, u: FloatArray, f: FloatArray) -> FloatArray:
    """Gives the corner curve (N, k) from two extended legs' values a and b (N, k) at u (N,), never 0; f (N,) is the blend at u."""
    return np.asarray(0.5 * (a + b) + (f / (2 * u))[:, None] * (b - a))
