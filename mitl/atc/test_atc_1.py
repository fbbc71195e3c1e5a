"""ATC-1, general movement: lines, circles, orientations and a longer path, against their programmed geometry and the oracle."""

from __future__ import annotations

import numpy as np

from mitl.atc.measuring import budget_of_path, budget_of_point, budget_of_turn, still_point, timed
from mitl.atc.verdicts import TURN_LIMIT, check_position, check_turn
from mitl.engine import Bench, Check, case
from mitl.metrics.circle import arc_angle, circle_deviation, circle_through
from mitl.metrics.deviation import largest_deviation, window_means, window_noise
from mitl.metrics.line import line_deviation
from mitl.metrics.orientation import angle_between, orientation_deviation
from mitl.metrics.path import path_deviation
from mitl.metrics.uncertainty import Budget, Term
from mitl.paths import FloatArray, PosePath
from mitl.protocols import ProgrammedMove

END_LIMIT = 4e-3
LINE_LIMIT = 5e-3
CIRCLE_LIMIT = 5e-3
PATH_LIMIT = 10e-3
SHAPE_LIMIT = 5e-3
_FIXED_AND_TURNING = {1: "fixed orientation", 2: "turning"}
_ORIENTATIONS = 4
_STEP = 0.1
"""Seconds between two positions of a growing motion."""


@case(
    "atc-1/direction",
    title="Direction and position",
    purpose="MoveJ along +X, +Y and +Z of a work object shared out between user and object frame moves that way and ends there.",
    requirement="User frame, object frame and tool are combined rightly; positive is positive.",
    limit_source="thesis 3.4.3.1: position every 100 ms must grow; 4 mm at the end positions",
    program="atc_1.mod",
    catches=("axis-sign", "frame-order", "object-frame-inverted", "tool-inverted", "work-object-ignored", "target-offset"),
    typical_s=20.0,
)
def test_direction(bench: Bench, check: Check) -> None:
    """The steps between positions 100 ms apart, each averaged over as long, and the place where every motion ends."""
    run = timed(bench.run(5, variables={"speed": "50"}, name="direction"))
    for axis, move in zip("XYZ", run.moves("MoveJ"), strict=True):
        path = run.during(move)
        marks = np.arange(path.time[0] + _STEP / 2, path.time[-1] - _STEP / 2, _STEP)
        means = window_means(path.time, path.position, _STEP)
        steps = np.diff(np.interp(marks, path.time, means[:, "XYZ".index(axis)]))
        noise = window_noise(path.time, path.position, _STEP) * np.sqrt(2.0)
        check(
            f"least step along +{axis} in 100 ms",
            value=1e3 * float(steps.min()),
            limit=0.0,
            unit="mm",
            at_least=True,
            budget=Budget((Term("random", noise, "noise of the recording"),)),
        )
        rest = run.tool.between(move.ends + 0.2, move.ends + 0.45)
        check_position(bench, check, f"end of the way along +{axis}", rest, rest.position - move.end[:3], END_LIMIT)


@case(
    "atc-1/linear",
    title="Straight lines",
    purpose="MoveL along Y with fixed and with turning orientation stays on its line and turns evenly.",
    requirement="MoveL interpolates position and orientation linearly between two targets.",
    limit_source="thesis 3.4.3.3: 5 mm; orientation 5 deg as 3.4.3.2",
    program="atc_1.mod",
    catches=("wrong-work-object", "target-offset", "orientation-not-interpolated", "orientation-late"),
    typical_s=30.0,
)
def test_linear(bench: Bench, check: Check) -> None:
    """Distance from the programmed line, orientation along it, and the place where it ends."""
    for number, name in _FIXED_AND_TURNING.items():
        run = timed(bench.run(1, number, name=name))
        move = run.moves("MoveL")[0]
        path = run.during(move)
        deviation = line_deviation(path.position, move.start[:3], move.end[:3])
        check_position(bench, check, f"line deviation, {name}", path, deviation.across, LINE_LIMIT)
        progress = deviation.along / np.linalg.norm(move.end[:3] - move.start[:3])
        turn = orientation_deviation(path.quaternion_wxyz, move.start[3:], move.end[3:], progress)
        check_turn(bench, check, f"orientation along the line, {name}", path, turn)
        rest = run.tool.between(move.ends + 0.2, move.ends + 0.45)
        check_position(bench, check, f"end of the line, {name}", rest, rest.position - move.end[:3], LINE_LIMIT)


@case(
    "atc-1/circular",
    title="Circles",
    purpose="Two MoveC in the YZ plane, with fixed and with turning orientation, stay on one circle.",
    requirement="MoveC runs on the circle through its three points.",
    limit_source="thesis 3.4.3.4: 5 mm; orientation 5 deg as 3.4.3.2",
    program="atc_1.mod",
    catches=("circle-radius", "wrong-work-object", "target-offset"),
    typical_s=40.0,
)
def test_circular(bench: Bench, check: Check) -> None:
    """Distance from the programmed circle in its plane and out of it, and orientation along it."""
    for number, name in _FIXED_AND_TURNING.items():
        run = timed(bench.run(2, number, name=name))
        first, last = run.moves("MoveC")
        assert first.via is not None
        circle = circle_through(first.start[:3], first.via[:3], first.end[:3])
        path = run.during(first, last)
        deviation = circle_deviation(path.position, circle)
        check_position(bench, check, f"deviation in the circle's plane, {name}", path, deviation.in_plane, CIRCLE_LIMIT)
        check_position(bench, check, f"deviation out of the circle's plane, {name}", path, deviation.out_of_plane, CIRCLE_LIMIT)
        turn = _turn_from_arcs(path, deviation.angle, first, last, arc_angle(circle, first.end[:3]))
        check_turn(bench, check, f"orientation along the circle, {name}", path, turn)


@case(
    "atc-1/orientation",
    title="Orientations of targets",
    purpose="Four targets at one point with different orientations are reached in their orientation.",
    requirement="The tool takes the programmed orientation.",
    limit_source="thesis 3.4.3.2: 5 deg; position 5 mm as 3.4.2.3",
    program="atc_1.mod",
    catches=("wrong-work-object", "target-offset"),
    typical_s=25.0,
)
def test_orientation(bench: Bench, check: Check) -> None:
    """Angle between the averaged and the programmed orientation; the thesis never got this to pass, because of its calibration."""
    for number in range(1, _ORIENTATIONS + 1):
        point, programmed = still_point(bench, 3, number)
        angle = float(angle_between(programmed[3:], point.tool[3:]))
        budget = budget_of_turn(bench, bench.calibration.rotation_sigma)
        check(
            f"orientation of target {number}",
            value=float(np.degrees(angle)),
            limit=float(np.degrees(TURN_LIMIT)),
            unit="deg",
            budget=budget,
        )
        distance = float(np.linalg.norm(point.tool[:3] - programmed[:3]))
        check(f"position of target {number}", value=1e3 * distance, limit=1e3 * LINE_LIMIT, unit="mm", budget=budget_of_point(bench, point))


@case(
    "atc-1/path",
    title="A longer path against its oracle",
    purpose="Lines, an arc and a joint move with zones are run as the oracle says, point by point in time.",
    requirement="Path, zones, speeds and orientation are those of the program.",
    limit_source="thesis 3.4.3.5: 10 mm at the same time; 5 mm from the path as in 3.4.3.3",
    program="atc_1.mod",
    catches=("zone-as-fine", "zone-size", "speed", "orientation-not-interpolated", "target-offset", "wrong-work-object", "circle-radius"),
    typical_s=40.0,
)
def test_path(bench: Bench, check: Check) -> None:
    """Deviation at the same time, from the path as a curve, and of the orientation. A constant delay of the robot is not seen."""
    run = timed(bench.run(4))
    moves = run.run.oracle.moves
    path = run.during(moves[1], moves[-2])
    oracle = run.run.oracle.tcp
    deviation = path_deviation(oracle, path)
    fastest = max(move.tcp_speed for move in moves[1:-1])
    in_time = largest_deviation(deviation.time, deviation.vector)
    check(
        "path deviation at the same time",
        value=1e3 * in_time.value,
        limit=1e3 * PATH_LIMIT,
        unit="mm",
        budget=budget_of_path(bench, in_time, speed=fastest, offset=run.offset),
        over_time=(deviation.time, 1e3 * deviation.distance),
    )
    check_position(bench, check, "distance from the path", path, deviation.nearest, SHAPE_LIMIT)
    check_turn(bench, check, "orientation along the path", path, deviation.turn)
    check.message("info", f"clocks' offset {run.offset.seconds:.4f} s, known to {1e3 * run.offset.sigma:.2f} ms")


def _turn_from_arcs(path: PosePath, angle: FloatArray, first: ProgrammedMove, last: ProgrammedMove, middle: float) -> FloatArray:
    """Gives the rotation vectors (N, 3) in rad from the even turns of two arcs of a whole circle that meet at the angle `middle`."""
    on_first = orientation_deviation(path.quaternion_wxyz, first.start[3:], first.end[3:], angle / middle)
    on_last = orientation_deviation(path.quaternion_wxyz, last.start[3:], last.end[3:], (angle - middle) / (2 * np.pi - middle))
    return np.where((angle < middle)[:, None], on_first, on_last)
