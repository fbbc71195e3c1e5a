"""The record of a motion: its views agree with each other, and the past never changes."""

import numpy as np
import pytest

from mitl.motion.chain import Planner
from mitl.motion.offline import start_run
from mitl.motion.program_run import ProgramRun, joints_home
from mitl.motion.record import TICK, MotionRecord, View
from mitl.motion.robot_model import load_robot_model
from rapid_interp import load_text

BETWEEN_TICKS = 2e-5  # rad: two cubics through the same ticks, at the greatest acceleration; the fourth difference over 100
RINGING = 2e-8  # rad: of the spline through ticks on which the averages are taken
MODEL = load_robot_model("irb140")


@pytest.fixture
def corner(rapid, moved):
    return moved(rapid.joint(450, 0, 400), rapid.line(450, 100, 400, "z20"), rapid.line(350, 100, 400))


def test_joints_at_a_time_agree_with_joints_at_many(corner):
    times = np.linspace(-0.1, corner.record.end + 0.2, 777)
    for view in (View.TOOL, View.CONTROLLER):
        one_by_one = np.array([corner.record.joints_at(time, view) for time in times])
        assert one_by_one == pytest.approx(corner.record.joints(times, view), abs=BETWEEN_TICKS)


def test_on_ticks_the_planned_view_is_the_plan_itself(corner):
    ticks = TICK * np.arange(1, int(corner.record.chains[-1].end / TICK))
    assert corner.record.joints(ticks, View.PLANNED) == pytest.approx(corner.planned_joints(ticks), abs=1e-9)


def test_all_views_begin_and_end_together_in_the_same_places(corner):
    for view in View:
        begin, end = corner.record.joints(np.array([0.0, corner.record.end + 0.1]), view)
        assert begin == pytest.approx(joints_home(), abs=RINGING)
        assert end == pytest.approx(corner.record.joints_planned_last, abs=1e-9)


def test_the_tool_moves_before_and_after_the_plan_by_half_the_filter(corner):
    start = corner.record.chains[0].start
    half = corner.record.half_filter
    assert half == pytest.approx(MODEL.arm_windows.sum() / 2 + MODEL.path_lag)
    home = joints_home()
    early, moving = corner.record.joints(np.array([start - half - TICK, start - half / 4]), View.TOOL)
    assert np.abs(early - home).max() < RINGING
    assert np.abs(moving - home).max() > 1e-9


def test_what_has_been_recorded_stays_when_more_is_recorded(rapid):
    """Every instant that lies in the past of the program keeps its joints, for good."""
    lines = [rapid.joint(450, 0, 400), *[rapid.line(450, y, 400, "fine" if y % 40 else "z10") for y in range(10, 130, 10)]]
    run = start_run(load_text(rapid.program(*lines)).start().run(), MODEL)
    seen = []
    while not run.finished:
        now = run.next_event()
        run.run(now)
        for time, joints in seen:
            assert run.record.joints_at(time) == pytest.approx(joints, abs=1e-12)
        seen.append((now, run.record.joints_at(now)))
    assert len(seen) > 5


def test_an_arm_that_was_told_nothing_rests():
    record = MotionRecord(MODEL, joints_home())
    assert record.end == 0
    assert record.joints_at(5.0) == pytest.approx(joints_home())
    assert record.joints(np.array([0.0, 1.0]), View.PLANNED) == pytest.approx(np.tile(joints_home(), (2, 1)))
    assert record.joint_speeds(View.TOOL).max() == 0


def test_the_same_program_gives_the_same_numbers(rapid):
    text = rapid.program(
        rapid.joint(450, 0, 400), rapid.line(450, 100, 400, "z20"), rapid.joint(350, 100, 400, "z5"), rapid.line(350, 0, 400)
    )

    def joints():
        run = ProgramRun(load_text(text).start().run(), Planner(MODEL), MotionRecord(MODEL, joints_home()))
        while not run.finished:
            run.run(run.next_event())
        return run.record.joints(np.linspace(0, run.record.end, 500), View.TOOL)

    np.testing.assert_array_equal(joints(), joints())
