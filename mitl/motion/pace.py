"""How fast a path is passed: ruckig's jerk-limited profiles between the points where the speed must be low.

The path is cut into cells, each with a speed cap. Knots are placed only where a cap binds; between two knots ruckig moves from one
speed to the next with no acceleration at either (acceleration and deceleration change over there, `facts/motion.md`).
Invariant: the speed never exceeds a cell's cap, the acceleration never what the hump was given, and the path is passed once, forwards.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from ruckig import InputParameter, Ruckig, RuckigError, Trajectory

from mitl.motion.cells import Cells, IndexArray, Probes
from mitl.motion.timing import PHASES, SOLVED, Timing, joined, phases, standing
from mitl.paths import FloatArray

_CAP_SLACK = 1e-6
_BACKWARDS = 1e-9
"""Speed in m/s below which a profile counts as going back; rounding stays far under it."""
_ROOM = 1e-5
"""Share of a distance that a ramp must leave: where it just fits, ruckig's rounding may choose to go back and take a run-up."""
_MOST_LOWERINGS = 12
_SETTLED = 1e-3
"""Share by which a hump's acceleration may still be too high for the cells; the margins of the limits are wider."""


def ramp_distance(slow: float, fast: float, acceleration: float, jerk: float) -> float:
    """Gives the distance in m between two speeds with no acceleration at either end."""
    change = fast - slow
    duration = change / acceleration + acceleration / jerk if change >= acceleration**2 / jerk else 2 * np.sqrt(change / jerk)
    return float(0.5 * (slow + fast) * duration)


def fastest_from(slow: float, distance: float, acceleration: float, jerk: float, at_most: float) -> float:
    """Gives the greatest speed up to `at_most` that can be reached from `slow` within `distance`, no acceleration at either end."""
    if at_most <= slow or ramp_distance(slow, at_most, acceleration, jerk) <= distance:
        return at_most
    low, high = slow, at_most
    for _ in range(50):
        middle = 0.5 * (low + high)
        if ramp_distance(slow, middle, acceleration, jerk) <= distance:
            low = middle
        else:
            high = middle
    return low


@dataclass
class _Knot:
    """An edge index where the profile has speed `speed` and no acceleration."""

    edge: int
    speed: float


@dataclass(frozen=True, eq=False)
class _Hump:
    """A ruckig profile between two knots, and the cell where it exceeds its cap most (None if nowhere)."""

    profile: Timing
    worst_cell: int | None


_Key = tuple[int, float, int, float]


class Pace:
    """The search for the fastest timing over cells, at least one, from `speed_at_start` m/s to rest, acceleration smoothed over `window` s.

    stops: inner edges of cells at which the path must come to rest. knots: edges to begin with at which the path runs without
    acceleration, and their greatest speeds in m/s. Humps are kept by their pair of knots, and are made again, all at
    once, only where a knot or a cap changed.
    """

    def __init__(
        self,
        cells: Cells,
        window: float,
        *,
        speed_at_start: float = 0.0,
        stops: Sequence[int] = (),
        knots: Mapping[int, float] | None = None,
    ) -> None:
        self._cells = cells
        self._window = window
        self._fixed = {0: speed_at_start, **dict.fromkeys(stops, 0.0), len(cells): 0.0}
        self._knots = [_Knot(edge, speed) for edge, speed in sorted({**(knots or {}), **self._fixed}.items())]
        self._humps: dict[_Key, _Hump] = {}
        self._at_rest = cells.allowed_at_rest()
        self._least: dict[tuple[int, int], float] = {}
        self._ruckig = Ruckig(1)

    def change(self, cells: Cells) -> None:
        """Replaces the cells by the same with lower caps or ceilings."""
        changed = np.concatenate([[0], np.cumsum((cells.cap != self._cells.cap) | (cells.ceiling != self._cells.ceiling))])
        self._cells = cells
        self._at_rest = cells.allowed_at_rest()
        self._least = {span: least for span, least in self._least.items() if changed[span[0]] == changed[span[1]]}
        self._humps = {key: hump for key, hump in self._humps.items() if changed[key[0]] == changed[key[2]]}
        self._knots = [_Knot(knot.edge, self._fixed.get(knot.edge, self._cap_at(knot.edge))) for knot in self._knots]

    def timing(self) -> Timing:
        """Gives the timing with knots added until no cap is exceeded."""
        while True:
            self._make_feasible(self._knots)
            pairs = list(itertools.pairwise(self._knots))
            keys = [(left.edge, left.speed, right.edge, right.speed) for left, right in pairs]
            new = [index for index, key in enumerate(keys) if key not in self._humps]
            made = dict(zip((keys[index] for index in new), self._make([pairs[index] for index in new]), strict=True))
            self._humps = {key: made.get(key) or self._humps[key] for key in keys}
            wanted: dict[int, _Knot] = {}
            for (left, right), hump in zip(pairs, self._humps.values(), strict=True):
                if hump.worst_cell is not None:
                    wanted |= {knot.edge: knot for knot in self._knots_around(hump.worst_cell, left, right)}
            if not wanted:
                return joined([hump.profile for hump in self._humps.values()])
            self._knots = sorted([*self._knots, *wanted.values()], key=lambda knot: knot.edge)

    def _cap_at(self, edge: int) -> float:
        """Gives the lower cap in m/s beside an edge."""
        return float(self._cells.cap[max(edge - 1, 0) : edge + 1].min())

    def _knots_around(self, cell: int, left: _Knot, right: _Knot) -> list[_Knot]:
        """Gives new knots at both ends of the run of cells, around `cell` and between two knots, that share its cap."""
        cap = self._cells.cap
        low, high = cap[cell] * (1 - _CAP_SLACK), cap[cell] * (1 + _CAP_SLACK)
        first, beyond = cell, cell + 1
        while first > left.edge and low <= cap[first - 1] <= high:
            first -= 1
        while beyond < right.edge and low <= cap[beyond] <= high:
            beyond += 1
        inside = [edge for edge in (first, beyond) if left.edge < edge < right.edge]
        return [_Knot(edge, self._cap_at(edge)) for edge in inside]

    def _make_feasible(self, knots: list[_Knot]) -> None:
        """Lowers knots' speeds until each can be reached from its neighbours, forwards and backwards."""
        pairs = list(itertools.pairwise(knots))
        for one, other in [*pairs, *reversed(pairs)]:
            slow, fast = (one, other) if one.speed <= other.speed else (other, one)
            acceleration = self._least_between(one.edge, other.edge)
            distance = float(self._cells.edges[other.edge] - self._cells.edges[one.edge]) * (1 - _ROOM)
            fast.speed = fastest_from(slow.speed, distance, acceleration, acceleration / self._window, fast.speed)

    def _least_between(self, first: int, beyond: int) -> float:
        """Gives the least acceleration in m/s^2 that all cells of a span leave where the path stands still."""
        if (first, beyond) not in self._least:
            self._least[first, beyond] = float(self._at_rest[first:beyond].min())
        return self._least[first, beyond]

    def _make(self, pairs: Sequence[tuple[_Knot, _Knot]]) -> list[_Hump]:
        """Makes the profiles between pairs of knots; their accelerations are lowered to what the cells leave where they are used."""
        if not pairs:
            return []
        first, beyond = (np.array([pair[side].edge for pair in pairs]) for side in (0, 1))
        least = np.array([self._least_between(left.edge, right.edge) for left, right in pairs])
        up = np.array([self._at_rest[left.edge : right.edge].max() for left, right in pairs])
        down = up.copy()
        profiles: list[Timing] = [standing(0.0)] * len(pairs)
        active = np.arange(len(pairs))
        for _ in range(_MOST_LOWERINGS):
            for index in active.tolist():
                profiles[index] = self._profile(*pairs[index], up=float(up[index]), down=float(down[index]))
            probes = self._cells.probe(joined([profiles[index] for index in active]), first[active], beyond[active], PHASES)
            allowed = self._cells.allowed(probes.cell, probes.offset, probes.speed)
            new_up, new_down = up[active], down[active]
            for values, used in ((new_up, probes.acceleration > 0), (new_down, probes.acceleration < 0)):
                np.minimum.at(values, probes.hump[used], allowed[used])
            new_up, new_down = np.maximum(least[active], new_up), np.maximum(least[active], new_down)
            lowered = (new_up < up[active] * (1 - _SETTLED)) | (new_down < down[active] * (1 - _SETTLED))
            active = active[lowered]
            if len(active) == 0:
                break
            up[active], down[active] = np.minimum(up[active], new_up[lowered]), np.minimum(down[active], new_down[lowered])
        probes = self._cells.probe(joined(profiles), first, beyond, PHASES)
        return [_Hump(profile, cell) for profile, cell in zip(profiles, self._worst_cells(probes, first, beyond), strict=True)]

    def _worst_cells(self, probes: Probes, first: IndexArray, beyond: IndexArray) -> list[int | None]:
        """Gives for each hump the cell in which its cap is exceeded most; None if nowhere."""
        excess = np.zeros(len(self._cells))
        np.maximum.at(excess, probes.cell, probes.speed / self._cells.cap[probes.cell])
        worst = [int(low + np.argmax(excess[low:high])) for low, high in zip(first, beyond, strict=True)]
        return [cell if excess[cell] > 1 + _CAP_SLACK else None for cell in worst]

    def _profile(self, left: _Knot, right: _Knot, *, up: float, down: float) -> Timing:
        request, answer = InputParameter(1), Trajectory(1)
        edges: FloatArray = self._cells.edges
        request.current_position = [edges[left.edge]]
        request.target_position = [edges[right.edge]]
        request.current_velocity, request.target_velocity = [left.speed], [right.speed]
        request.max_velocity = [max(float(self._cells.cap[left.edge : right.edge].max()), left.speed, right.speed)]
        request.max_acceleration, request.min_acceleration = [up], [-down]
        request.max_jerk = [max(up, down) / self._window]
        try:
            solved = self._ruckig.calculate(request, answer) in SOLVED
        except RuckigError:
            solved = False
        profile = phases(answer) if solved else None
        if profile is not None and profile.speed.min() >= -_BACKWARDS:
            return profile
        return _ramp(float(edges[left.edge]), float(edges[right.edge]), left.speed, right.speed, up if right.speed > left.speed else down)


def _ramp(begin: float, end: float, first: float, last: float, acceleration: float) -> Timing:
    """Gives the ramp between two positions in m and speeds in m/s that takes all the way there is, in as many phases as ruckig's.

    It stands in for ruckig where a ramp just fits: rounding may let ruckig find nothing, or go back and take a run-up. Being symmetric it
    covers its distance exactly; up to `acceleration` in m/s^2 it is all jerk.
    """
    duration = 2 * (end - begin) / (first + last)
    change = abs(last - first)
    even = max(duration - 2 * (duration - change / acceleration), 0.0)
    jerking = (duration - even) / 2
    peak = (last - first) / (jerking + even)
    lasts = np.array([jerking, even, jerking, 0.0, 0.0, 0.0, 0.0])
    jerk = np.array([peak / jerking, 0.0, -peak / jerking, 0.0, 0.0, 0.0, 0.0])
    state, states = np.array([begin, first, 0.0]), []
    for t, j in zip(lasts, jerk, strict=True):
        states.append(state)
        position, speed, a = state
        state = np.array([position + t * (speed + t * (a / 2 + t * j / 6)), speed + t * (a + t * j / 2), a + t * j])
    position, speed, a = np.transpose(states)
    return Timing(np.append(0.0, np.cumsum(lasts)[:-1]), position, speed, a, jerk, duration)
