"""The fastest timing against closed forms: trapezoids of one axis, AccSet and PathAccLim along a line."""

import numpy as np
import pytest

from mitl.motion.effort import AxisLimits
from mitl.motion.limits import HalfPlanes
from mitl.motion.pace import controllable, reached, timed
from mitl.motion.robot_model import load_robot_model

MODEL = load_robot_model("irb140")
JOINT_SHARE = 0.99 * AxisLimits.PLANNED
"""What a plan uses of an acceleration limit."""


def straight(length, speed, rise, fall, intervals=40):
    """Gives the half-planes of one drive on a straight path."""
    shape = (intervals, 3, 1)
    ceiling, widths = np.full(intervals + 1, speed**2), np.full(intervals, length / intervals)
    return HalfPlanes(np.ones(shape), np.zeros(shape), np.full(shape, rise), np.full(shape, fall), ceiling, widths)


def passed(planes):
    most = controllable(planes)
    return timed(planes, 0.0, reached(planes, most, 0.0))


@pytest.mark.parametrize(("speed", "rise", "fall"), [(1.0, 4.0, 4.0), (0.5, 2.0, 1.0), (0.777, 3.3, 9.1)])
def test_one_drive_on_a_straight_path_makes_a_trapezoid(speed, rise, fall):
    timing = passed(straight(1.0, speed, rise, fall))
    assert timing.duration == pytest.approx(1.0 / speed + speed / (2 * rise) + speed / (2 * fall), rel=1e-9)
    t = np.linspace(0, timing.duration, 501)
    expected = np.minimum.reduce([rise * t, np.full(501, speed), fall * (timing.duration - t)])
    assert timing.at(t)[1] == pytest.approx(expected, abs=1e-9)


def test_a_way_too_short_for_the_speed_makes_a_triangle():
    assert passed(straight(0.1, 5.0, 4.0, 4.0)).duration == pytest.approx(2 * np.sqrt(0.1 / 4.0), rel=1e-9)


def test_a_stop_in_the_middle_makes_two_trapezoids():
    planes = straight(1.0, 0.5, 4.0, 4.0)
    most = controllable(planes, [20])
    assert timed(planes, 0.0, reached(planes, most, 0.0)).duration == pytest.approx(2 * (0.5 / 0.5 + 0.5 / 4.0), rel=1e-9)


def test_an_effort_of_curvature_takes_its_share_of_the_acceleration():
    """|u + c x| <= a from rest: x = a / c (1 - exp(-2 c s))."""
    bend, limit, length = 3.0, 2.0, 0.4
    shape = (400, 3, 1)
    planes = HalfPlanes(
        np.ones(shape), np.full(shape, bend), np.full(shape, limit), np.full(shape, 1e6), np.full(401, 100.0), np.full(400, length / 400)
    )
    found = reached(planes, np.full(401, 100.0), 0.0)
    s = np.linspace(0, length, 401)
    assert found == pytest.approx(limit / bend * (1 - np.exp(-2 * bend * s)), rel=5e-3, abs=1e-9)
    assert (found <= limit / bend).all()


def turn_of_axis_1(moved, rapid, *settings):
    motion = moved(rapid.axes(-40, 0, 0, 0, 30, 0), *settings, rapid.axes(40, 0, 0, 0, 30, 0, speed="vmax"))
    return motion.record.chains[-1].chain.timing.duration


def trapezoid(way, speed, rise, fall):
    return way / speed + speed / (2 * rise) + speed / (2 * fall)


@pytest.mark.parametrize("share", [1.0, 0.5, 0.2])
def test_accset_takes_its_share_of_an_axis_acceleration(moved, rapid, share):
    limit = share * JOINT_SHARE * MODEL.acceleration[0]
    expected = trapezoid(np.radians(80), 0.99 * MODEL.speed[0], limit, limit)
    assert turn_of_axis_1(moved, rapid, f"AccSet {100 * share:.0f},100;") == pytest.approx(expected, rel=2e-3)


def test_pathacclim_makes_a_trapezoid_of_its_two_limits(moved, rapid):
    motion = moved(
        rapid.joint(450, -150, 400),
        r"PathAccLim TRUE\AccMax:=2,TRUE\DecelMax:=1;",
        rapid.line(450, 150, 400, speed="v500"),
    )
    assert motion.record.chains[-1].chain.timing.duration == pytest.approx(trapezoid(0.3, 0.5, 2, 1), rel=1e-3)
