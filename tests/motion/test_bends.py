"""An arm whose TCP is limited keeps its acceleration along and across lines and arcs, as its controller sees them tick by tick."""

import dataclasses

import numpy as np
import pytest

import rapid_interp
from mitl.motion.chain import Planner
from mitl.motion.effort import AxisLimits
from mitl.motion.limits import CONTROLLER_TICK
from mitl.motion.offline import Frame, run_until, sample, start_run
from mitl.motion.record import View
from mitl.motion.robot_model import load_robot_model

ARM = load_robot_model("irb140")
MODEL = dataclasses.replace(ARM, acceleration=3 * ARM.acceleration, effort=AxisLimits(3 * ARM.acceleration))
"""An IRB 140 with drives so strong that they limit nothing here."""
LIMIT = MODEL.corner_acceleration
CLOSE = 2e-3  # caps hold at the grid's nodes, and between them nearly


def ran(rapid, *lines, model=MODEL):
    run = start_run(rapid_interp.load_text(rapid.program(*lines), "m.mod").start().run(), model, planner=Planner(model))
    run_until(run, 60.0)
    return run


def seen(run):
    """Gives the second differences (N, 3) in m/s^2 of the interpolator's points at ticks, and their speeds (N,) m/s."""
    chain = run.record.chains[-1]
    samples = sample(run, np.arange(chain.start, chain.end, CONTROLLER_TICK), View.PLANNED, Frame.WORLD)
    return np.diff(samples.path.position, 2, axis=0) / CONTROLLER_TICK**2, samples.speed[1:-1]


def test_an_arc_is_passed_as_fast_as_its_radius_allows(rapid):
    start, radius = np.array([400.0, 0.0, 400.0]), 20.0
    run = ran(
        rapid,
        rapid.joint(*start),
        rapid.arc(start + [radius, radius, 0], start + [0, 2 * radius, 0], speed="v1000"),
    )
    _, speed = seen(run)
    assert speed.max() == pytest.approx(np.sqrt(LIMIT * 1e-3 * radius), rel=CLOSE)


@pytest.mark.parametrize(("zone", "narrow"), [("z1", True), ("z5", False), ("z20", False), ("z50", False)])
def test_a_corner_is_passed_as_fast_as_the_ticks_allow(rapid, zone, narrow):
    """At an even speed the points that a controller's ticks make about the middle of a corner show the limit, for zones of any size."""
    corner = rapid.line(400, 0, 400, zone=zone, speed="v1000")
    chain = ran(rapid, rapid.joint(400, -310, 400), corner, rapid.line(650, 0, 400, speed="v1000")).record.chains[-1].chain
    middle = chain.path.leg_ends()[1]
    speed = chain.timing.at(chain.passing_times()[1:2])[1][0]
    points, _ = chain.path.positions(middle + speed * CONTROLLER_TICK * np.array([-1.0, 0.0, 1.0]))
    assert np.linalg.norm(points[0] - 2 * points[1] + points[2]) / CONTROLLER_TICK**2 == pytest.approx(LIMIT, rel=CLOSE)
    radius = 0.571e-3 * float(zone[1:])  # the blend's least radius at 90 deg
    assert (speed**2 / radius > 1.05 * LIMIT) == narrow


def test_a_line_is_sped_up_by_no_more_than_the_limit(rapid):
    run = ran(rapid, rapid.joint(400, -200, 400), rapid.line(400, 200, 400, speed="v1000"))
    acceleration, _ = seen(run)
    assert np.abs(acceleration[:, 1]).max() == pytest.approx(MODEL.tcp_acceleration, rel=1e-6)


def test_accset_halves_the_limit(rapid):
    run = ran(rapid, "AccSet 50,100;", rapid.joint(400, -200, 400), rapid.line(400, 200, 400, speed="v1000"))
    acceleration, _ = seen(run)
    assert np.abs(acceleration[:, 1]).max() == pytest.approx(MODEL.tcp_acceleration / 2, rel=1e-6)


def test_without_the_limit_only_the_drives_matter(rapid):
    lines = rapid.joint(400, -200, 400), rapid.line(400, 200, 400, speed="v1000")
    free, limited = (ran(rapid, *lines, model=dataclasses.replace(MODEL, tcp_limited=value)) for value in (False, True))
    assert free.record.chains[-1].chain.timing.duration < limited.record.chains[-1].chain.timing.duration - 0.02


def test_joint_moves_know_no_limit_of_the_tcp(rapid):
    run = ran(rapid, rapid.joint(400, -200, 400), rapid.joint(400, 200, 400, speed="v2500"))
    acceleration, _ = seen(run)
    assert np.linalg.norm(acceleration, axis=1).max() > 1.05 * MODEL.tcp_acceleration
