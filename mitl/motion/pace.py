"""Pace: the fastest timing of a path under half-planes in (s'', s'^2), by one pass back and one forth over its nodes.

After Pham and Pham, "A new approach to time-optimal path parameterization based on reachability analysis" (2018), with an even
acceleration in every interval. Invariant: at the nodes no ceiling is exceeded, in the intervals no half-plane is broken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mitl.errors import MitlError
from mitl.motion.limits import HalfPlanes, Limits
from mitl.motion.timing import Timing, standing
from mitl.paths import BoolArray, FloatArray, IndexArray

_MOST_NEWTON_STEPS = 50
_REACHED = 1e-12
_ALIKE = 0.02
"""Share by which x may be too great at a start: grids of the same stretch differ, and how drives weaken is known to some digits."""
_STILL = 1e-12
_ON_A_NODE = 1e-9
"""Distance in m from a node that counts as none."""
_SPLIT = 1.01
"""An interval is split into a ramp and an even part where the ramp may be so much steeper."""
_PASSES = 3
"""Drives weaken with speed: they are first taken at the greatest speed, then at what came out. Odd passes never ask too much of them."""


class StartTooFastError(MitlError):
    """A chain that begins on its way would have to be slower there than it is; the plan so far, to a stop, still holds."""


def fastest(limits: Limits, stops: Sequence[int], position: float, speed: float) -> Timing:
    """Gives the fastest timing from a path position in m and a speed in m/s there to rest at its end.

    stops: nodes in between at which it comes to rest. Raises StartTooFastError where the path cannot be gone on with at that speed.
    """
    nodes = limits.grid.nodes
    first = int(np.searchsorted(nodes, position + _ON_A_NODE))  # the first node beyond
    last = len(nodes) - 1
    if first > last:
        return standing(position)
    ahead = np.array([stop - first + 1 for stop in stops if first <= stop < last], dtype=np.intp)
    rests = np.concatenate([[0] if speed == 0 else [], ahead, [last - first + 1]]).astype(np.intp)
    tight = rests[:-1][np.diff(rests) == 1]  # from rest to rest in one interval: without a middle it would never be left
    ahead = ahead + np.searchsorted(tight, ahead)
    x = limits.ceiling[: last + 1]
    passes = 1 if limits.model.effort.even else _PASSES
    for turn in range(passes):
        planes = limits.half_planes(x).between(first, last, float(nodes[first] - position)).halved(tight)
        free = planes.ceiling
        planes = slowing(planes, speed**2)
        most = controllable(planes, ahead)
        if turn == passes - 1 and speed**2 > most[0] * (1 + _ALIKE) + _STILL:
            raise StartTooFastError(f"{speed:.6g} m/s at the start, at most {np.sqrt(most[0]):.6g} m/s is possible")
        found = reached(planes, most, speed**2)
        x = np.concatenate([limits.ceiling[: first - 1], np.delete(found, tight + np.arange(1, len(tight) + 1))])
    return timed(planes, position, found, planes.ceiling[:-1] > free[:-1])


def slowing(planes: HalfPlanes, x: float) -> HalfPlanes:
    """Gives the half-planes with ceilings raised where a path that begins at `x`, and slows down as hard as it can, is above them."""
    if x <= planes.ceiling[0]:
        return planes
    _, fall, lean = planes.even()
    twice, ceiling = 2 * planes.widths, planes.ceiling.copy()
    for node in range(len(ceiling)):
        if x <= ceiling[node]:
            break
        ceiling[node] = x
        if node < len(twice):
            x = max(x - twice[node] * float((fall[node] + lean[node] * x).min()), 0.0)
    return replace(planes, ceiling=ceiling)


def controllable(planes: HalfPlanes, stops: Sequence[int] | IndexArray = ()) -> FloatArray:
    """Gives the greatest x = s'^2 (N+1,) at the nodes from which the path can be followed to rest at its end and at nodes `stops`."""
    rise, fall, lean = planes.even()
    ceiling = planes.ceiling.copy()
    ceiling[list(stops)] = 0.0
    ceiling[-1] = 0.0
    ceiling[:-1] = np.minimum(ceiling[:-1], _feasible(rise, fall, lean, planes.widths, ceiling[:-1]))
    twice = 2 * planes.widths[:, None]
    share = 1 - twice * lean
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = np.where(share > 0, 1 / share, 0.0)
        offset = np.where(share > 0, twice * fall / share, np.inf)
    free = (slope * ceiling[1:, None] + offset).min(axis=1) >= ceiling[:-1]
    return np.array(_swept(0.0, ceiling[1:][::-1], ceiling[:-1][::-1], free[::-1], slope[::-1], offset[::-1])[::-1])


def reached(planes: HalfPlanes, most: FloatArray, x_start: float) -> FloatArray:
    """Gives the greatest x (N+1,) at the nodes that can be reached from `x_start`, never more than `most` (N+1,)."""
    rise, _, lean = planes.even()
    twice = 2 * planes.widths[:, None]
    slope, offset = 1 - twice * lean, twice * rise
    free = (slope * most[:-1, None] + offset).min(axis=1) >= most[1:]
    return np.array(_swept(x_start, most[:-1], most[1:], free, slope, offset))


def timed(planes: HalfPlanes, begin: float, x: FloatArray, too_fast: BoolArray | bool = False) -> Timing:
    """Gives the timing from a path position `begin` in m with x = s'^2 (N+1,) at the nodes.

    In an interval the acceleration is even, or as great as it may be between its ends' speeds, the greater of which is kept meanwhile;
    the lower one in the intervals too_fast (N,), which begin faster than they should.
    """
    left, right, widths = x[:-1], x[1:], planes.widths
    faster = np.maximum(left, right)
    (up_left, down_left), (up_right, down_right), (up_kept, down_kept) = (planes.anywhere(values) for values in (left, right, faster))
    up, down = np.minimum(up_left, up_right), np.maximum(down_left, down_right)
    even = (right - left) / (2 * widths)
    keeps = (up_kept >= 0) & (down_kept <= 0)
    rising, falling = keeps & (right > left) & (up > _SPLIT * even), keeps & (right < left) & (down < _SPLIT * even)
    split = rising | falling
    ramp = np.where(rising, up, np.where(falling, down, np.inf))
    ramp_width = np.where(split, (right - left) / (2 * ramp), widths)
    late = falling & ~too_fast
    kept = np.where(falling & too_fast, right, faster)
    first_width = np.where(late, widths - ramp_width, ramp_width)
    first_u, second_u = np.where(late, 0.0, np.where(split, ramp, even)), np.where(late, down, 0.0)
    index = np.repeat(np.arange(len(widths)), 1 + split)
    second = np.append(False, index[1:] == index[:-1])
    x_begin, x_end = np.where(second, kept[index], left[index]), np.where(split[index] & ~second, kept[index], right[index])
    length = np.where(second, (widths - first_width)[index], first_width[index])
    nodes = begin + np.concatenate([[0.0], np.cumsum(widths)])
    position = nodes[index] + np.where(second, first_width[index], 0.0)
    speed = np.sqrt(x_begin)
    start = np.concatenate([[0.0], np.cumsum(2 * length / (speed + np.sqrt(x_end)))])
    return Timing(start[:-1], position, speed, np.where(second, second_u[index], first_u[index]), np.zeros(len(index)), float(start[-1]))


def _swept(x: float, full: FloatArray, cap: FloatArray, free: BoolArray, slope: FloatArray, offset: FloatArray) -> list[float]:
    """Gives x over nodes, each the least of a cap (N,) and of lines (N, R) through the one before.

    free (N,): the lines do not matter where the one before is `full` (N,).
    """
    found = [x]
    for whole, most, is_free, rise, begin in zip(full.tolist(), cap.tolist(), free.tolist(), slope, offset, strict=True):
        x = most if is_free and x == whole else max(min(most, float((rise * x + begin).min())), 0.0)
        found.append(x)
    return found


def _feasible(rise: FloatArray, fall: FloatArray, lean: FloatArray, widths: FloatArray, at_most: FloatArray) -> FloatArray:
    """Gives the greatest x (N,) up to `at_most` for which some acceleration breaks no half-plane of the interval.

    The room between the lowest rise and the highest fall is concave in x, so Newton's steps from above end at its root.
    """
    stop = 0.5 / widths[:, None]  # u >= -x / (2 width): x does not fall below 0
    falls, fall_lean = np.column_stack([fall, np.zeros(len(stop))]), np.column_stack([lean, stop])
    x = at_most.copy()
    left = np.arange(len(x))
    for _ in range(_MOST_NEWTON_STEPS):
        here = x[left, None]
        highest = rise[left] - lean[left] * here
        lowest = -falls[left] - fall_lean[left] * here
        top, bottom = highest.argmin(axis=1), lowest.argmax(axis=1)
        rows = np.arange(len(left))
        room = highest[rows, top] - lowest[rows, bottom]
        slope = fall_lean[left, bottom] - lean[left, top]
        broken = (room < 0) & (slope < 0)
        left, room, slope = left[broken], room[broken], slope[broken]
        if len(left) == 0:
            break
        x[left] = np.maximum(x[left] - room / slope, 0.0) * (1 - _REACHED)
    return x
