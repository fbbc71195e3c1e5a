"""When something that is tied to a place of a path happens, on the time base of the plan.

The arm follows the plan without delay, through filters that look as far ahead as back, so that the tool is at that place then.
Invariant: nothing tied to a move happens before that move begins.
"""

from __future__ import annotations

import math

import numpy as np

from mitl.motion.bridge import MM
from mitl.motion.chain import Chain
from rapid_interp.effects import Trigger

PREFETCH = 0.1
"""A program goes on past a fly-by point this long (s) before its zone begins. ASSUMPTION A-05."""
_HERE = 1e-12
"""Way in m by which a chain that was stopped at a place may seem to end before it: rounding."""


def trigger_time(chain: Chain, index: int, trigger: Trigger) -> float:
    """Gives the time in s on the chain at which a trigger of its move number `index` happens; inf if the chain stops before its place.

    ASSUMPTION A-130: distances count along the programmed line, arc or joint move, from its programmed ends; within a zone they go on as
    the corner's own coordinate does, so that the middle of the corner stands for the programmed point. Without distance it is that middle.
    ASSUMPTION A-131: what would lie before the move's beginning (the middle of the corner before) happens there.
    """
    ends = chain.path.leg_ends()
    begin = _passed(chain, float(ends[index]))
    if trigger.seconds is not None:
        time = _passed(chain, float(ends[index + 1])) - trigger.seconds
    elif trigger.distance_mm is None:
        time = _passed(chain, float(ends[index + 1]))
    else:
        way = MM * trigger.distance_mm
        travel = chain.moves[index].leg.travel
        time = _passed(chain, chain.path.coordinate(index, min(max(way if trigger.from_start else travel - way, 0.0), travel)))
    return max(time - trigger.lag, begin)


def release_time(chain: Chain, index: int) -> float:
    """Gives the time in s on the chain at which the program goes on past the fly-by point at the end of its move number `index`."""
    return zone_time(chain, index) - PREFETCH


def zone_time(chain: Chain, index: int) -> float:
    """Gives the time in s on the chain at which the zone at the end of its move number `index` begins, or would with a move behind it."""
    move = chain.moves[index]
    if index < len(chain.moves) - 1 or move.fine:
        return _passed(chain, float(chain.path.zone_begins()[index + 1]))
    return _passed(chain, chain.path.last_zone_begin(move.zone.radius))


def bend_time(chain: Chain, index: int) -> float:
    """Gives the time in s on the chain at which its move number `index` leaves its own course: its zone or its orientation zone begins."""
    move = chain.moves[index]
    if index < len(chain.moves) - 1 or move.fine:
        return zone_time(chain, index)
    return _passed(chain, chain.path.last_zone_begin(max(move.zone.radius, move.zone.turn_radius)))


def passed_time(chain: Chain, index: int) -> float:
    """Gives the time in s on the chain at which its move number `index` ends: the middle of its corner, or its stop."""
    return _passed(chain, float(chain.path.leg_ends()[index + 1]))


def _passed(chain: Chain, position: float) -> float:
    last = float(chain.timing.at(np.array([chain.timing.duration]))[0][0])
    if position > last + _HERE:
        return math.inf
    if position > last - _HERE:
        return chain.timing.duration
    return float(chain.timing.times_at(np.array([position]))[0])
