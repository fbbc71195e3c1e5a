"""Tests of the tracker and of the rig as a whole: how soon a motion is seen, and how still points drift."""

from __future__ import annotations

import numpy as np

from mitl.atc.measuring import DRIFT_SD, DRIFT_TAU, SETTLING, budget_of_point
from mitl.engine import Bench, Check, case
from mitl.engine.bench import STILL
from mitl.metrics.deviation import window_means
from mitl.metrics.uncertainty import Budget, Term, drift_sigma
from mitl.paths import FloatArray

REACTION_LIMIT = 0.2
DRIFT_LIMIT = 5e-3
RUNS = 20
PLACES = 23
INTERVAL = 300.0
"""Seconds from round to round (facts/atc.md: five minutes)."""
SHORT, LONG = 3, 192
"""Rounds: three show a fault that grows within minutes; 192 are 16 hours."""
AWAKE = 2.5
"""Seconds after which a tracker that slept and was moved tracks again (facts/tracker.md: 1.5 to 2 s)."""
_FAR = 1e-3
_SMOOTH = 0.012


@case(
    "tracker/reaction",
    title="Reaction time",
    purpose="From an order to the first millimetre of motion, 20 times.",
    requirement="The robot reacts, and the tracker shows it, within the time that stop and trigger tests allow.",
    limit_source="ATC-6's 200 ms (facts/atc.md)",
    program="tracker.mod",
    catches=("late-start",),
    typical_s=60.0,
)
def test_reaction(bench: Bench, check: Check) -> None:
    """The longest of the reaction times; their mean and spread are told."""
    bench.go(2, settle=SETTLING)
    times = []
    for number in range(1, RUNS + 1):
        run = bench.run(3, variables={"speed": "200"}, name=f"hop {number}")
        called = run.given
        rest = run.tool.between(called - STILL, called)
        smooth = window_means(run.tool.time, run.tool.position, _SMOOTH)
        away = np.linalg.norm(smooth - rest.position.mean(axis=0), axis=1) > _FAR
        moved = run.tool.time[away & (run.tool.time > called)]
        times.append(float(moved[0]) - called if len(moved) else np.inf)
    sampled = Budget((Term("sampling", 4e-3 / np.sqrt(12), "one sample of 4 ms"), Term("noise", 2e-3, "noise at 1 mm of motion")))
    check("longest reaction", value=1e3 * max(times), limit=1e3 * REACTION_LIMIT, unit="ms", budget=sampled)
    check.message(
        "info",
        f"reaction {1e3 * np.mean(times):.0f} ms on average, sd {1e3 * np.std(times, ddof=1):.0f} ms, least {1e3 * min(times):.0f} ms",
    )


@case(
    "tracker/drift",
    title="Drift over minutes",
    purpose="23 still points are measured again after five and ten minutes.",
    requirement="Neither robot nor tracker drifts by more than the cases allow for.",
    limit_source="thesis 3.4.2.3: 5 mm",
    program="tracker.mod",
    catches=("joint-drift",),
    typical_s=400.0,
)
def test_drift(bench: Bench, check: Check) -> None:
    """The mean change of the points from round to round; the tracker sleeps in between, and its frame may jump as it wakes."""
    _drift(bench, check, SHORT)


@case(
    "tracker/drift-16-h",
    title="Drift over 16 hours",
    purpose="23 still points are measured every five minutes for 16 hours.",
    requirement="Neither robot nor tracker drifts by more than the cases allow for.",
    limit_source="thesis 3.4.2.3: 5 mm; its table 4.3 has 1.3 to 4.2 mm of range in 5 h",
    program="tracker.mod",
    catches=("joint-drift",),
    typical_s=57_600.0,
    long=True,
)
def test_drift_16_h(bench: Bench, check: Check) -> None:
    """The same over 192 rounds; how far the points range on each axis is told, to compare with the thesis's table 4.3."""
    rounds = _drift(bench, check, LONG)
    ranges = 1e3 * np.ptp(rounds, axis=0)
    for axis, name in enumerate("XYZ"):
        check.message("info", f"range of {name}: {ranges[:, axis].min():.2f} to {ranges[:, axis].max():.2f} mm over {PLACES} points")


def _drift(bench: Bench, check: Check, count: int) -> FloatArray:
    """Gives the points (rounds, places, 3) in m in the work object, and judges how far they move as a whole from round to round.

    Half of the changes may be larger than the one that is judged: a jump of the tracker's frame on waking is not the robot's drift.
    """
    rounds, noise = [], []
    for number in range(count):
        begun = bench.clock.now()
        for place in (PLACES, 1):
            bench.go(1, place, variables={"speed": "500"})
        bench.clock.wait(AWAKE)
        points = []
        for place in range(1, PLACES + 1):
            bench.go(1, place, variables={"speed": "500"}, settle=SETTLING)
            point = bench.still_point()
            points.append(point.tool[:3])
            noise.append(budget_of_point(bench, point).terms[0].value)
        rounds.append(points)
        if number + 1 < count:
            bench.clock.wait(max(0.0, begun + INTERVAL - bench.clock.now()))
    found = np.array(rounds)
    moved = np.sort(np.linalg.norm(np.diff(found, axis=0).mean(axis=1), axis=1))
    typical = float(moved[(len(moved) - 1) // 2])
    random = float(np.mean(noise)) * np.sqrt(2.0 / PLACES)
    budget = Budget(
        (Term("random", random, "still points"), Term("drift", drift_sigma(DRIFT_SD, DRIFT_TAU, INTERVAL), "tracker, facts/tracker.md"))
    )
    check("change of all points in five minutes", value=1e3 * typical, limit=1e3 * DRIFT_LIMIT, unit="mm", budget=budget)
    check.message("info", f"largest change between two rounds {1e3 * moved[-1]:.2f} mm")
    return found
