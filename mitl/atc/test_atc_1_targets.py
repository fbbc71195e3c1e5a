"""ATC-1, targets against a joint position: what is wrong with a target, a frame or a tool shows as a difference, with no drift in it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.atc.measuring import TimedRun, budget_of_turn, timed
from mitl.engine import Bench, Check, case
from mitl.errors import RigError
from mitl.metrics.orientation import turn_between
from mitl.metrics.path_queries import average
from mitl.metrics.uncertainty import Budget, Term
from mitl.paths import FloatArray, IndexArray, PosePath
from mitl.protocols import ProgrammedMove

PLACE_LIMIT = 0.7e-3
TURN_LIMIT = float(np.radians(0.15))
CREEP_TAU, CREEP = 0.7, 0.15e-3
"""Time constant in s of the tracker's creep after a stop (facts/tracker.md), and what of it in m its fit leaves. ASSUMPTION A-334."""
_FROM, _UNTIL = 0.08, 0.48
"""Seconds after a stop between which the tool's pose is taken: the arm has settled, and the program waits for half a second."""
_AROUND = 0.2
"""Seconds about a move in which the middle of its way is looked for."""


@case(
    "atc-1/from-joints",
    title="Targets against a joint position",
    purpose="Six times from a joint position to two targets 60 and 72 mm away and back: the way and the turn between them.",
    requirement="A target is where its frames, its tool and the arm's kinematics put it.",
    limit_source="ours: .7 mm and .15 deg, the least that the thesis's tracker can decide (facts/tracker.md)",
    program="atc_1.mod",
    catches=("target-offset", "target-turn", "wrong-work-object", "wrong-tool"),
    typical_s=45.0,
)
def test_from_joints(bench: Bench, check: Check) -> None:
    """MoveAbsJ knows neither work object nor target, so that the difference is theirs; drift and most of the calibration fall out of it."""
    run = timed(bench.run(6, variables={"speed": "50"}, name="to and fro"))
    stops = run.run.oracle.moves[:-1]
    poses = _rests(run, stops)
    base = np.array([move.end for move in stops])
    for number, name in enumerate(("first target", "second target")):
        there = np.arange(1 + 2 * number, len(stops), 4)
        found, known = _steps(poses, there), _steps(base, there)
        away = found[:, :3] - known[:, :3]
        turns = found[:, 3:] - known[:, 3:]
        way = float(np.linalg.norm(known[0, :3]))
        check(
            f"{name}, place",
            value=1e3 * float(np.linalg.norm(away.mean(axis=0))),
            limit=1e3 * PLACE_LIMIT,
            unit="mm",
            budget=_budget(bench, away, way),
        )
        check(
            f"{name}, turn",
            value=float(np.degrees(np.linalg.norm(turns.mean(axis=0)))),
            limit=float(np.degrees(TURN_LIMIT)),
            unit="deg",
            budget=budget_of_turn(bench, _of_mean(turns)),
        )


def _rests(run: TimedRun, moves: Sequence[ProgrammedMove]) -> FloatArray:
    """Gives the poses X_OT (N, 7) at which the tool came to rest after each move.

    Wrong targets make other ways, which take other times: each stop is looked for after the middle of its way.
    """
    late, found = 0.0, []
    for move in moves:
        middle = _middle(run.tool, move, late)
        late = middle - _middle(run.run.oracle.tcp, move, 0.0) if np.isfinite(middle) else late
        stopped = move.ends + late
        found.append(_rest(run.tool.between(stopped + _FROM, stopped + _UNTIL), stopped))
    return np.array(found)


def _middle(path: PosePath, move: ProgrammedMove, late: float) -> float:
    """Gives when the path passes the middle between both ends of a move that is `late` s late; infinite where it does not."""
    during = path.between(move.begins + late - _AROUND, move.ends + late + _AROUND).only_valid()
    way = move.end[:3] - move.start[:3]
    progress = (during.position - move.start[:3]) @ way / (way @ way)
    beyond = np.flatnonzero(progress >= 0.5)
    return float(during.time[beyond[0]]) if len(beyond) else np.inf


def _rest(path: PosePath, stopped: float) -> FloatArray:
    """Gives the pose (7,) at which the tool came to rest: its creep since then is fitted, and taken off."""
    if not path.valid.any():
        raise RigError(f"the tracker was out of sight after the stop at {stopped:.2f} s of the run")
    mean = average(path)
    crept = 1.0 - np.exp(-(path.time - stopped) / CREEP_TAU)
    fitted = np.polyfit(crept[path.valid], path.position[path.valid], 1)[-1]
    return np.concatenate([fitted, mean.quaternion_wxyz])


def _steps(poses: FloatArray, there: IndexArray) -> FloatArray:
    """Gives from the joint position before to each stop of `there`: the way in m and the turn in rad, (N, 6), in the frame's axes."""
    before, after = poses[there - 1], poses[there]
    turn = turn_between(before[:, 3:], after[:, 3:])
    return np.hstack([after[:, :3] - before[:, :3], Rotation.from_quat(before[:, 3:], scalar_first=True).apply(turn)])


def _budget(bench: Bench, away: FloatArray, way: float) -> Budget:
    """Gives the budget in m of a mean step, repeats `away` (N, 3), on a way of so many m: drift and the frames' place are not in it."""
    calibration = bench.calibration
    scale = np.sqrt(np.diag(calibration.covariance)[12:]).max(initial=0.0)
    relative = float(np.hypot(calibration.rotation_uncertainty(), scale))
    return Budget(
        (
            Term("random", _of_mean(away), "scatter of the repeats"),
            Term("registration", relative * way, f"turn and scale of the calibration, on a way of {1e3 * way:.0f} mm"),
            Term("creep", CREEP, "the tracker's creep after a stop, what is left of it"),
        )
    )


def _of_mean(repeats: FloatArray) -> float:
    """Gives the standard uncertainty of the mean of repeats (N, 3) on the worst axis."""
    return float(np.std(repeats, axis=0, ddof=1).max()) / float(np.sqrt(len(repeats)))
