"""Dynamics: what a program says about how hard the arm may accelerate, besides its speeds (AccSet, PathAccLim).

Invariant: a default Dynamics changes nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Dynamics:
    """Settings of one move.

    acceleration: share 0..1 of the joints' limits (AccSet Acc). path_acceleration, path_deceleration: most m/s^2 of the TCP along the
    path, inf where there is no limit (PathAccLim). AccSet's Ramp and FinePointRamp change nothing: the plan has no limit on jerk that
    they could take a share of, the filters behind it make the ramps. ASSUMPTION A-116.
    """

    acceleration: float = 1.0
    path_acceleration: float = math.inf
    path_deceleration: float = math.inf


AS_FAST_AS_IT_CAN = Dynamics()
