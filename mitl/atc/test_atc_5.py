"""ATC-5, interpolation: the predefined zones, circles of several sizes, reorientation, axis limits, the speed kept through all of them."""

from __future__ import annotations

import numpy as np

from mitl.atc.measuring import budget_of_path, budget_of_point, timed
from mitl.atc.test_atc_4 import judged_moves
from mitl.atc.verdicts import check_position, check_speed, check_turn
from mitl.engine import Bench, Check, case
from mitl.metrics.circle import circle_deviation, circle_through
from mitl.metrics.deviation import LargestDeviation, largest_deviation, window_noise
from mitl.metrics.line import line_deviation
from mitl.metrics.path import interpolate, path_deviation
from mitl.metrics.speed import speed_difference

CORNER_LIMIT = 5e-3
CIRCLE_LIMIT = 5e-3
LINE_LIMIT = 5e-3
PATH_LIMIT = 10e-3
SPEED_LIMIT = 5e-3
STILL_LIMIT = 5e-3
ZONES = {
    1: ("z0", "z1", "z5", "z10", "z15", "z20"),
    2: ("z30", "z40", "z50"),
    3: ("z60", "z80", "z100"),
    4: ("z150",),
    5: ("z200",),
}
"""Predefined zones by subOption, in the order of their corners."""
_SINGULARITY = {1: "Wrist", 2: "Off"}
_RADII = {1: 20, 2: 50, 3: 100}
_AROUND = 0.05
"""Seconds on either side of a corner's middle that are averaged."""


@case(
    "atc-5/zones",
    title="Every predefined zone",
    purpose="Every zone from z0 to z200 cuts its corner as far as the oracle says.",
    requirement="A corner is left and joined again at the zone's border, on the path between them that is the controller's.",
    limit_source="thesis 3.4.3.3: 5 mm",
    program="atc_5.mod",
    catches=("zone-size", "zone-as-fine"),
    typical_s=40.0,
)
def test_zones(bench: Bench, check: Check) -> None:
    """In the middle of each corner: how much farther from the programmed point than the oracle, towards the inside of the corner."""
    for number, zones in ZONES.items():
        run = timed(bench.run(1, number, variables={"speed": "150" if number == 1 else "200"}, name=f"zones {number}"))
        oracle = run.run.oracle.tcp
        for zone, move in zip(zones, run.moves("MoveL"), strict=False):
            near = oracle.between(move.ends - 0.5, move.ends + 0.5)
            distance = np.linalg.norm(near.position - move.end[:3], axis=1)
            middle = float(near.time[int(np.argmin(distance))])
            inwards = near.position[int(np.argmin(distance))] - move.end[:3]
            if np.linalg.norm(inwards) < 1e-5:  # a zone too small to have an inside: the bisector of its legs
                before, after = interpolate(oracle, np.array([middle - 0.2, middle + 0.2])).position - move.end[:3]
                inwards = before / np.linalg.norm(before) + after / np.linalg.norm(after)
            inwards = inwards / np.linalg.norm(inwards)
            path = run.tool.between(middle - _AROUND, middle + _AROUND)
            deviation = path_deviation(oracle, path).vector @ inwards
            around = run.tool.between(middle - 0.3, middle + 0.3)
            noise = window_noise(around.time, path_deviation(oracle, around).vector, 2 * _AROUND)
            value = float(deviation.mean())
            largest = LargestDeviation(abs(value), middle, noise, 2 * _AROUND, 1)
            check(
                f"corner of {zone}, farther than expected",
                value=1e3 * value,
                limit=1e3 * CORNER_LIMIT,
                unit="mm",
                budget=budget_of_path(bench, largest),
            )


@case(
    "atc-5/circles",
    title="Circles of several sizes",
    purpose="Circles of 20, 50 and 100 mm radius in four arcs are round, the right way round.",
    requirement="MoveC runs on the circle through its three points, over the middle one.",
    limit_source="thesis 3.4.3.4: 5 mm; 10 mm at the same time as 3.4.3.5",
    program="atc_5.mod",
    catches=("wrong-arc", "circle-radius"),
    typical_s=30.0,
)
def test_circles(bench: Bench, check: Check) -> None:
    """Deviation in the plane and out of it, and from the oracle at the same time, which tells the right way round."""
    for number, radius in _RADII.items():
        with check.subtest(f"radius {radius} mm"):
            run = timed(bench.run(2, number, variables={"speed": "100"}, name=f"radius {radius} mm"))
            arcs = run.moves("MoveC")
            first, last = arcs[0], arcs[-1]
            assert first.via is not None
            path = run.during(first, last)
            deviation = circle_deviation(path.position, circle_through(first.start[:3], first.via[:3], first.end[:3]))
            check_position(bench, check, "deviation in its plane", path, deviation.in_plane, CIRCLE_LIMIT)
            check_position(bench, check, "deviation out of its plane", path, deviation.out_of_plane, CIRCLE_LIMIT)
            in_time = largest_deviation(path.time, path_deviation(run.run.oracle.tcp, path).vector)
            check(
                "deviation at the same time",
                value=1e3 * in_time.value,
                limit=1e3 * PATH_LIMIT,
                unit="mm",
                budget=budget_of_path(bench, in_time, speed=first.tcp_speed, offset=run.offset),
            )


@case(
    "atc-5/reorientation",
    title="Reorientation",
    purpose="Turns about the tool's point keep the point; turns on a line go on evenly.",
    requirement="The orientation is interpolated in step with the way, or with time where there is none.",
    limit_source="thesis 3.4.3.2: 5 deg; 5 mm as 3.4.3.3",
    program="atc_5.mod",
    catches=("orientation-not-interpolated", "wrong-tool"),
    typical_s=20.0,
)
def test_reorientation(bench: Bench, check: Check) -> None:
    """Orientation at the same time, and distance of the point from its path."""
    run = timed(bench.run(3, variables={"speed": "100"}, name="turns"))
    for name, move in zip(("about Z", "about X", "on a line"), run.moves("MoveL"), strict=True):
        path = run.during(move)
        deviation = path_deviation(run.run.oracle.tcp, path)
        check_turn(bench, check, f"orientation, turning {name}", path, deviation.turn)
        check_position(bench, check, f"distance of the point from its path, turning {name}", path, deviation.nearest, CIRCLE_LIMIT)


@case(
    "atc-5/joint-limit",
    title="Axis limits",
    purpose="A motion beyond the range of axis 5 is refused before it begins.",
    requirement="The controller stops with an error and does not move.",
    limit_source="ours: the tool stays within 5 mm, as ATC-0",
    program="atc_5.mod",
    catches=("joint-limit-ignored",),
    typical_s=10.0,
)
def test_joint_limit(bench: Bench, check: Check) -> None:
    """The tool's way between before the order and after the controller has stopped by itself."""
    _check_refused(bench, check, 4, 2)


@case(
    "atc-5/singularity",
    title="Near a singularity",
    purpose="A line on which axis 5 comes within 2 deg of zero, with SingArea \\Wrist and with \\Off, at 300 mm/s.",
    requirement="\\Wrist keeps the line and the speed and gives way in the orientation; \\Off keeps both and slows down.",
    limit_source="thesis 3.4.3.3: 5 mm; 10 mm at the same time and 5 deg as 3.4.3.5 and 3.4.3.2",
    program="atc_5.mod",
    catches=("sing-area-ignored",),
    typical_s=15.0,
)
def test_singularity(bench: Bench, check: Check) -> None:
    """Distance from the line, from the oracle at the same time, and orientation."""
    for number, mode in _SINGULARITY.items():
        with check.subtest(mode):
            run = timed(bench.run(6, number, variables={"speed": "300"}, name=f"SingArea {mode}"))
            (move,) = run.moves("MoveL")
            path = run.during(move)
            across = line_deviation(path.position, move.start[:3], move.end[:3]).across
            check_position(bench, check, "distance from the line", path, across, LINE_LIMIT)
            deviation = path_deviation(run.run.oracle.tcp, path)
            in_time = largest_deviation(deviation.time, deviation.vector)
            check(
                "deviation at the same time",
                value=1e3 * in_time.value,
                limit=1e3 * PATH_LIMIT,
                unit="mm",
                budget=budget_of_path(bench, in_time, speed=move.tcp_speed, offset=run.offset),
            )
            check_turn(bench, check, "orientation", path, deviation.turn)


@case(
    "atc-5/configuration",
    title="Configurations",
    purpose="Joint moves to targets in their configuration (ConfJ \\On); a line that would end with the wrist turned over (ConfL \\On).",
    requirement="Joint moves end in the programmed configuration; a line that cannot is refused before it begins.",
    limit_source="thesis 3.4.3.5: 10 mm at the same time; 5 mm as ATC-0 where nothing may move",
    program="atc_5.mod",
    catches=("wrong-configuration", "configuration-ignored"),
    typical_s=15.0,
)
def test_configuration(bench: Bench, check: Check) -> None:
    """The wrong wrist ends at the same pose, but on another way: what counts is the way there."""
    with check.subtest("ConfJ"):
        run = timed(bench.run(7, 1, variables={"speed": "100"}, name="ConfJ"))
        moves = run.moves("MoveJ")[1:]
        path = run.during(moves[0], moves[-1])
        deviation = path_deviation(run.run.oracle.tcp, path)
        in_time = largest_deviation(deviation.time, deviation.vector)
        check(
            "deviation at the same time",
            value=1e3 * in_time.value,
            limit=1e3 * PATH_LIMIT,
            unit="mm",
            budget=budget_of_path(bench, in_time, speed=moves[0].tcp_speed, offset=run.offset),
        )
        check_turn(bench, check, "orientation", path, deviation.turn)
    with check.subtest("ConfL"):
        _check_refused(bench, check, 7, 2)


@case(
    "atc-5/speed-kept",
    title="Speed kept through zones and circles",
    purpose="A path of lines, an arc and zones is passed at 300 mm/s throughout.",
    requirement="The speed is kept from a line into an arc and through zones.",
    limit_source="thesis 3.4.4.3: 5 mm/s",
    program="atc_5.mod",
    catches=("speed", "zone-as-fine"),
    typical_s=15.0,
)
def test_speed_kept(bench: Bench, check: Check) -> None:
    """Mean speeds against the oracle's by the same estimator: of the arc, and of the whole."""
    run = timed(bench.run(5, variables={"speed": "300"}, name="speed kept"))
    (arc,) = run.moves("MoveC")
    first, last = judged_moves(run)
    for name, start, stop in (("along the arc", arc.begins, arc.ends), ("along the whole path", first.begins + 0.2, last.ends - 0.2)):
        found = speed_difference(run.run.oracle.tcp, run.tool, start, stop, around=0.2)
        check_speed(bench, check, f"speed {name}", faster=found.value, at=arc.tcp_speed, random=found.random, limit=SPEED_LIMIT)


def _check_refused(bench: Bench, check: Check, option: int, sub_option: int) -> None:
    """Judges how far the tool is moved from its home by an order that must be refused."""
    bench.go(4, 1, settle=0.2)
    before = bench.still_point()
    events = bench.provoke(option, sub_option, variables={"speed": "200"}, timeout=5.0)
    after = bench.still_point()
    way = float(np.linalg.norm(after.tool[:3] - before.tool[:3]))
    check("way of the tool", value=1e3 * way, limit=1e3 * STILL_LIMIT, unit="mm", budget=budget_of_point(bench, after))
    for event in events:
        check.message("info", f"event log: {event.number} {event.text}")
