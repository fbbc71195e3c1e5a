"""Dynamics: what a program says about how hard the arm may accelerate, besides its speeds (AccSet, PathAccLim).

Invariant: a default Dynamics changes nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Dynamics:
    """Settings of one move.

    acceleration: share 0..1 of the joints' limits (AccSet Acc). ramp, fine_point_ramp: shares 0..1 of the acceleration's rate of change,
    the latter before stop points (AccSet Ramp, FinePointRamp). path_acceleration, path_deceleration: most m/s^2 of the TCP along the
    path, inf where there is no limit (PathAccLim).
    """

    acceleration: float = 1.0
    ramp: float = 1.0
    fine_point_ramp: float = 1.0
    path_acceleration: float = math.inf
    path_deceleration: float = math.inf


AS_FAST_AS_IT_CAN = Dynamics()
