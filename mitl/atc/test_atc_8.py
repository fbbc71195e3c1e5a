"""ATC-8, conveyor: a path on a work object that a belt carries, compared in the belt's frame, which a second tracked device tells."""

from __future__ import annotations

import numpy as np
import pytest

from mitl.atc.measuring import TimedRun, budget_of_path, timed
from mitl.atc.verdicts import check_position, check_turn
from mitl.engine import Bench, Check, case
from mitl.errors import RigError
from mitl.metrics.belt import belt_way, beside_belt
from mitl.metrics.deviation import largest_deviation
from mitl.metrics.glitch import without_glitches
from mitl.metrics.path import path_deviation
from mitl.paths import PosePath
from mitl.poses import transform_of

SHAPE_LIMIT, TIME_LIMIT = 5e-3, 10e-3
DEVICE, DRIVE = "belt", "aoBelt"
_BELT_SPEED = "150"
_ON_BELT = slice(2, 6)
"""The moves of the figure, after the one to its start and the one onto the belt."""
_SETTLED = 0.1
"""Seconds after its last move until the arm stands beside the belt (.08 s, facts/motion.md)."""
_CATCHES = ("conveyor-gain", "conveyor-delay")
_LIMITS = "as for standing work objects: thesis 3.4.3.3, 5 mm, and 3.4.3.5, 10 mm at the same time"


def _judge(bench: Bench, check: Check, sub_option: int) -> None:
    """Judges the figure on the belt: at the same time, as a curve, and by its orientation."""
    if DEVICE not in bench.rig.devices:
        pytest.skip(f"this rig has no tracked device {DEVICE!r} on a conveyor")
    run = timed(bench.run(1, sub_option, variables={"beltSpeed": _BELT_SPEED}, beside=(DEVICE,)))
    moves = run.run.oracle.moves[_ON_BELT]
    whole = _in_belt_frame(bench, run)
    path = whole.between(moves[0].begins, moves[-1].ends)
    deviation = path_deviation(run.run.oracle.tcp, path)
    in_time = largest_deviation(deviation.time, deviation.vector)
    fastest = max(move.tcp_speed for move in moves)
    check(
        "deviation beside the belt at the same time",
        value=1e3 * in_time.value,
        limit=1e3 * TIME_LIMIT,
        unit="mm",
        budget=budget_of_path(bench, in_time, speed=fastest, offset=run.offset),
        over_time=(deviation.time, 1e3 * deviation.distance),
    )
    check_position(bench, check, "distance from the path on the belt", path, deviation.nearest, SHAPE_LIMIT)
    rest = whole.between(moves[-1].ends + _SETTLED, run.run.oracle.moves[_ON_BELT.stop].begins)
    if not len(rest):
        raise RigError("no valid sample while the tool stands on the belt")
    standing = path_deviation(run.run.oracle.tcp, rest)
    check_position(bench, check, "place of the tool that stands on the moving belt", rest, standing.vector, SHAPE_LIMIT)
    check_turn(bench, check, "orientation on the belt", path, deviation.turn)


def _in_belt_frame(bench: Bench, run: TimedRun) -> PosePath:
    """Gives X_OT in the work object on the belt, on the oracle's clock: the tool's way less that of the device on the belt."""
    starts = run.run.oracle.signals[DRIVE][0]
    device = without_glitches(run.run.beside[DEVICE]).only_valid().shifted(run.offset.seconds)
    if not len(device):
        raise RigError(f"the tracker gave no valid pose of the device {DEVICE!r}: is it in view and awake?")
    belt = belt_way(device.time, bench.calibration.points(device), float(starts[starts > 0][0]))
    direction = transform_of(run.run.oracle.wobj).rotation.inv().apply(belt.direction)
    path = beside_belt(run.tool, belt, np.asarray(direction))
    bench.record_path(f"{DEVICE} frame", path)
    return path


@case(
    "atc-8/even",
    title="Conveyor at an even speed",
    purpose="A rectangle is drawn on a work object that a belt carries at 150 mm/s.",
    requirement="The robot follows the conveyor: on the belt the path is that of the program.",
    limit_source=_LIMITS,
    program="atc_8.mod",
    catches=_CATCHES,
    typical_s=20.0,
)
def test_even(bench: Bench, check: Check) -> None:
    """The belt runs evenly."""
    _judge(bench, check, 1)


@case(
    "atc-8/stop",
    title="Conveyor that stops and goes on",
    purpose="The same rectangle, while the belt stops on its first side and goes on on its third.",
    requirement="A conveyor's stop and start do not show in the path on the belt.",
    limit_source=_LIMITS,
    program="atc_8.mod",
    catches=_CATCHES,
    typical_s=20.0,
)
def test_stop(bench: Bench, check: Check) -> None:
    """The belt stands for a part of the figure."""
    _judge(bench, check, 2)


@case(
    "atc-8/speed-change",
    title="Conveyor that changes its speed",
    purpose="The same rectangle, while the belt doubles its speed on the first side and halves it on the third.",
    requirement="A change of the conveyor's speed does not show in the path on the belt.",
    limit_source=_LIMITS,
    program="atc_8.mod",
    catches=_CATCHES,
    typical_s=20.0,
)
def test_speed_change(bench: Bench, check: Check) -> None:
    """The belt runs at 150, 300 and 75 mm/s."""
    _judge(bench, check, 3)
