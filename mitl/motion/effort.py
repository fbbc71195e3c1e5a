"""Effort: what a motion asks of the joints' drives, in units of their limits, and how much they give at a speed.

On a path q(s) every effort is linear in (s'', s'^2): effort = along s'' + across s'^2 + resting. Invariant: nothing here knows of time
or path; a model is closed-form numpy over N places.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from mitl.paths import FloatArray


@dataclass(frozen=True, eq=False)
class Efforts:
    """Efforts at N places of a path: effort = along s'' + across s'^2 + resting, each (N, 6), in units of the limits."""

    along: FloatArray
    across: FloatArray
    resting: FloatArray


class EffortModel(Protocol):
    """What the drives of an arm are loaded with, and what they can give."""

    def efforts(self, q: FloatArray, rate: FloatArray, bend: FloatArray) -> Efforts:
        """Gives the efforts at joints q (N, 6) rad with dq/ds (N, 6) and d2q/ds2 (N, 6).

        With rate and bend taken over time, at s' = 1 and s'' = 0, `across` is the effort of a motion but for gravity.
        """
        ...

    def available(self, share: FloatArray) -> FloatArray:
        """Gives the efforts (N, 6) that the drives can give at shares (N, 6) of their greatest speeds; never more at a greater speed."""
        ...

    @property
    def even(self) -> bool:
        """Gives whether the drives can give the same at all speeds."""
        ...


@dataclass(frozen=True, eq=False)
class AxisLimits:
    """One acceleration limit (6,) rad/s^2 an axis, the same in all poses and at all speeds: for arms whose torques are not known."""

    acceleration: FloatArray

    PLANNED = 0.94
    """Share that a plan uses: where a path bends more and more, the arm, which lags, comes faster than planned. ASSUMPTION A-111."""

    def efforts(self, q: FloatArray, rate: FloatArray, bend: FloatArray) -> Efforts:
        """Gives accelerations over their limits."""
        return Efforts(rate / self.acceleration, bend / self.acceleration, np.zeros_like(q))

    def available(self, share: FloatArray) -> FloatArray:
        """Gives the same share everywhere."""
        return np.full_like(share, self.PLANNED)

    @property
    def even(self) -> bool:
        """Gives True."""
        return True


@dataclass(frozen=True, eq=False)
class FittedTorques:
    """Torques of axes 1 to 3 of an arm with a parallel forearm, fitted to a controller's logs, and acceleration limits of axes 4 to 6.

    Source: `facts/planner.md`, item 3 and Refinement. Units: torque limits and rad/s^2. swing (7,): inertia about axis 1 by monomials of
    sin q2 and of cosine and sine of q2 + q3, at least swing_least; shoulder, elbow: constant inertias about axes 2 and 3 as axis 2 feels
    them; coupling: their change with cos(q3 + fold); own: axis 3's inertia by its own drive; fling: share of the change of swing that
    axis 2 feels; gravity (2,): of axes 2 and 3, with cos(q2 + q3 - lean). wrist (3,) rad/s^2. strength: limit of axes 1 to 3 at rest;
    they weaken linearly between the shares weakens (2,) of their greatest speeds, down to weakest of the strength.
    """

    swing: FloatArray
    swing_least: float
    shoulder: float
    elbow: float
    coupling: float
    fold: float
    own: float
    fling: float
    gravity: FloatArray
    lean: float
    wrist: FloatArray
    strength: float
    weakens: FloatArray
    weakest: float

    def efforts(self, q: FloatArray, rate: FloatArray, bend: FloatArray) -> Efforts:
        """Gives torques over limits."""
        lean, forearm = q[:, 1], q[:, 1] + q[:, 2]
        s2, c2, s, c = np.sin(lean), np.cos(lean), np.sin(forearm), np.cos(forearm)
        k0, k1, k2, k3, k4, k5, k6 = self.swing
        raw = k0 + k1 * s2 + k2 * s2**2 + k3 * c + k4 * s + k5 * s2 * c + k6 * s2 * s
        by_forearm = -k3 * s + k4 * c - k5 * s2 * s + k6 * s2 * c
        by_lean = by_forearm + c2 * (k1 + 2 * k2 * s2 + k5 * c + k6 * s)
        floored = raw < self.swing_least
        swing = np.where(floored, self.swing_least, raw)
        by_lean, by_forearm = np.where(floored, 0.0, by_lean), np.where(floored, 0.0, by_forearm)
        bent, turned = np.cos(q[:, 2] + self.fold), np.sin(q[:, 2] + self.fold)
        shoulder, elbow = self.shoulder + 2 * self.coupling * bent, self.elbow + self.coupling * bent
        along, across, resting = np.empty_like(q), np.empty_like(q), np.zeros_like(q)
        along[:, 0] = swing * rate[:, 0]
        across[:, 0] = swing * bend[:, 0] + (by_lean * rate[:, 1] + by_forearm * rate[:, 2]) * rate[:, 0]
        along[:, 1] = shoulder * rate[:, 1] + elbow * rate[:, 2]
        across[:, 1] = (
            shoulder * bend[:, 1]
            + elbow * bend[:, 2]
            - self.coupling * turned * (2 * rate[:, 1] + rate[:, 2]) * rate[:, 2]
            - self.fling * by_lean * rate[:, 0] ** 2
        )
        along[:, 2], across[:, 2] = self.own * rate[:, 2], self.own * bend[:, 2]
        along[:, 3:], across[:, 3:] = rate[:, 3:] / self.wrist, bend[:, 3:] / self.wrist
        resting[:, 1:3] = self.gravity * np.cos(forearm - self.lean)[:, None]
        return Efforts(along, across, resting)

    def available(self, share: FloatArray) -> FloatArray:
        """Gives the strength, falling with speed, of axes 1 to 3, and 1 of the wrist."""
        given = np.ones_like(share)
        given[:, :3] = self.strength * np.interp(share[:, :3], self.weakens, [1.0, self.weakest])
        return given

    @property
    def even(self) -> bool:
        """Gives False."""
        return False
