"""The path that a program's own points give in closed form: straight lines and circles, from one programmed point to the next.

Invariant: no planner is asked; speed is the programmed one throughout, without acceleration and without zones.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mitl.metrics.circle import arc_angle, circle_through
from mitl.paths import FloatArray, PosePath
from mitl.protocols import ProgrammedMove

STEP = 2e-3
"""Way in m between two points."""


def programmed_path(moves: Sequence[ProgrammedMove]) -> PosePath:
    """Gives the path X_OT of MoveL and MoveC in a row; the orientation is that of each move's start.

    Raises ValueError for other moves and where there is none.
    """
    if not moves or any(move.kind not in ("MoveL", "MoveC") for move in moves):
        raise ValueError("expected lines and circles, one at least")
    points, times, turns, time = [moves[0].start[None, :3]], [np.zeros(1)], [moves[0].start[None, 3:]], 0.0
    for move in moves:
        way = _circle(move) if move.kind == "MoveC" else _line(move)
        length = np.cumsum(np.linalg.norm(np.diff(np.vstack([move.start[None, :3], way]), axis=0), axis=1))
        points.append(way)
        times.append(time + length / move.tcp_speed)
        turns.append(np.repeat(move.start[None, 3:], len(way), axis=0))
        time += float(length[-1]) / move.tcp_speed
    position = np.vstack(points)
    return PosePath(np.concatenate(times), position, np.vstack(turns), np.ones(len(position), dtype=bool))


def _line(move: ProgrammedMove) -> FloatArray:
    start, end = move.start[:3], move.end[:3]
    count = max(int(np.ceil(np.linalg.norm(end - start) / STEP)), 1)
    return np.asarray(start + np.linspace(0.0, 1.0, count + 1)[1:, None] * (end - start))


def _circle(move: ProgrammedMove) -> FloatArray:
    assert move.via is not None  # noqa: S101 - a MoveC has one
    circle = circle_through(move.start[:3], move.via[:3], move.end[:3])
    out = (move.start[:3] - circle.centre) / circle.radius
    across = np.cross(circle.normal, out)
    turn = arc_angle(circle, move.end[:3])
    count = max(int(np.ceil(turn * circle.radius / STEP)), 1)
    angle = np.linspace(0.0, turn, count + 1)[1:, None]
    return np.asarray(circle.centre + circle.radius * (np.cos(angle) * out + np.sin(angle) * across))
