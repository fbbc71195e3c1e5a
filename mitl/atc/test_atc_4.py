"""ATC-4, smooth movement: stop points without overshoot, figures, even motion without hiccups, the same figure around the robot."""

from __future__ import annotations

import numpy as np

from mitl.atc.measuring import TimedRun, budget_of_path, timed
from mitl.atc.verdicts import check_position
from mitl.engine import Bench, Check, case
from mitl.metrics.deviation import largest_deviation, window_means, window_noise
from mitl.metrics.glitch import without_pulses
from mitl.metrics.path import path_deviation
from mitl.metrics.uncertainty import Budget, Term
from mitl.protocols import ProgrammedMove

OVERSHOOT_LIMIT = 2e-3
PATH_LIMIT = 5e-3
HICCUP_LIMIT = 10e-3
_WINDOW = 0.04
"""Seconds over which a short excursion is averaged."""
_FIGURES = {1: "triangle", 2: "slot", 3: "eight"}
_PLACES = (-50, 0, 50)


@case(
    "atc-4/overshoot",
    title="Stop points without overshoot",
    purpose="From three directions at 500 mm/s the tool stops at a point and does not run past it.",
    requirement="A fine point is approached without overshoot.",
    limit_source="ATC-6's standstill of 2 mm (facts/atc.md), ours",
    program="atc_4.mod",
    catches=("overshoot",),
    typical_s=20.0,
)
def test_overshoot(bench: Bench, check: Check) -> None:
    """The way beyond the place of rest in the direction of the approach, within .2 s of the stop, against where the tool rests then."""
    run = timed(bench.run(1, variables={"speed": "500"}, name="stops"))
    for name, move in zip(("+X", "+Y", "-Z"), run.moves("MoveL")[::2], strict=True):
        direction = (move.end[:3] - move.start[:3]) / np.linalg.norm(move.end[:3] - move.start[:3])
        settling = run.tool.between(move.ends - 0.05, move.ends + 0.2)
        rest = run.tool.between(move.ends + 0.2, move.ends + 0.4)
        beyond = (settling.position - rest.position.mean(axis=0)) @ direction
        means = window_means(settling.time, without_pulses(settling.time, beyond)[:, None], _WINDOW)[:, 0]
        noise = window_noise(rest.time, rest.position, _WINDOW)
        # the tracker creeps by .78 mm/s after a stop (facts/tracker.md): over the .2 s between the two that is .16 mm
        budget = Budget((Term("random", noise, "noise at rest"), Term("creep", 0.16e-3, "tracker's creep after a stop")))
        check(
            f"overshoot along {name}",
            value=1e3 * max(float(means.max()), 0.0),
            limit=1e3 * OVERSHOOT_LIMIT,
            unit="mm",
            budget=budget,
            over_time=(settling.time, 1e3 * beyond),
        )


@case(
    "atc-4/figures",
    title="Path accuracy of figures",
    purpose="A triangle with stop points, a slot of lines and half circles, and an eight are drawn as programmed.",
    requirement="The path of lines, arcs and zones is that of the program.",
    limit_source="thesis 3.4.3.3: 5 mm",
    program="atc_4.mod",
    catches=("circle-radius", "target-offset", "wrong-arc", "joint-drift"),
    typical_s=40.0,
)
def test_figures(bench: Bench, check: Check) -> None:
    """Distance of every sample from the oracle's path as a curve, whatever the time."""
    for number, name in _FIGURES.items():
        with check.subtest(name):
            run = timed(bench.run(2, number, variables={"speed": "150"}, name=name))
            _check_curve(bench, check, run, "distance from the figure")


@case(
    "atc-4/hiccups",
    title="Even motion without hiccups",
    purpose="Long lines and arcs at 300 mm/s run evenly.",
    requirement="There is no stop or jerk within a motion.",
    limit_source="ours: the way may not jump by more than 10 ms of the motion",
    program="atc_4.mod",
    catches=("hiccup",),
    typical_s=15.0,
)
def test_hiccups(bench: Bench, check: Check) -> None:
    """How far the tool is behind or ahead of its own mean, in ms: a constant delay and a slow change of it are no hiccup."""
    run = timed(bench.run(3, variables={"speed": "300"}, name="even"))
    moves = run.run.oracle.moves
    for name, first, last in (("line", moves[2], moves[2]), ("line back", moves[3], moves[3]), ("circle", moves[4], moves[5])):
        path = run.during(first, last)
        deviation = path_deviation(run.run.oracle.tcp, path)
        direction = np.gradient(path.position, path.time, axis=0)
        direction = window_means(path.time, direction, 0.1)
        direction /= np.linalg.norm(direction, axis=1)[:, None]
        lag = np.sum(deviation.vector * direction, axis=1) / first.tcp_speed
        trend = np.polynomial.Polynomial.fit(path.time, lag, 2)
        ripple = without_pulses(path.time, lag - trend(path.time))
        largest = largest_deviation(path.time, ripple, _WINDOW)
        budget = Budget((Term("random", largest.random, "noise of the recording"),))
        check(
            f"jump of the time along the {name}",
            value=1e3 * largest.value,
            limit=1e3 * HICCUP_LIMIT,
            unit="ms",
            budget=budget,
            over_time=(path.time, 1e3 * ripple),
        )


@case(
    "atc-4/around",
    title="The same figure around the robot",
    purpose="One figure in the same work object, turned about the robot, comes out the same everywhere.",
    requirement="Where the work object lies makes no difference.",
    limit_source="thesis 3.4.3.3: 5 mm",
    program="atc_4.mod",
    catches=("joint-drift", "work-object-ignored"),
    typical_s=40.0,
)
def test_around(bench: Bench, check: Check) -> None:
    """Distance from the oracle's path in each place."""
    for place in _PLACES:
        with check.subtest(f"{place:+d} deg" if place else "0 deg"):
            run = timed(bench.run(4, variables={"speed": "150", "place": str(place)}, name=f"{place} deg"))
            _check_curve(bench, check, run, "distance from the figure")


def _check_curve(bench: Bench, check: Check, run: TimedRun, name: str) -> None:
    """Judges the distance from the oracle's path between the start and the end of the judged moves."""
    first, last = judged_moves(run)
    path = run.during(first, last)
    deviation = path_deviation(run.run.oracle.tcp, path)
    check_position(bench, check, name, path, deviation.nearest, PATH_LIMIT)
    in_time = largest_deviation(deviation.time, deviation.vector)
    check(
        f"{name} at the same time",
        value=1e3 * in_time.value,
        limit=2e3 * PATH_LIMIT,
        unit="mm",
        budget=budget_of_path(bench, in_time, speed=first.tcp_speed, offset=run.offset),
    )


def judged_moves(run: TimedRun) -> tuple[ProgrammedMove, ProgrammedMove]:
    """Gives the first and the last linear or circular move of a run: what comes before and after is the way there and home."""
    judged = [move for move in run.run.oracle.moves if move.kind in {"MoveL", "MoveC"}]
    return judged[0], judged[-1]
