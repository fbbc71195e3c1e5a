r"""Speed ratio and SpeedRefresh act on the motion under way: along the same path, triggers at their places."""

import numpy as np
import pytest

from mitl.motion.offline import run_until, start_run
from mitl.motion.record import View
from mitl.motion.robot_model import load_robot_model
from mitl.motion.signals import InputChange
from rapid_interp import load_text

EXACT = 1e-6
MODEL = load_robot_model("irb140")
TARGET = "[[{},{},400],[0,0,1,0],[0,0,0,0],noAxes]".format
START = f"MoveJ {TARGET(450, -200)},v300,fine,tA;"
LINE = f"MoveL {TARGET(450, 200)},v200,fine,tA;"
CORNERS = [
    f"MoveL {TARGET(450, 0)},v200,z50,tA;",
    f"MoveL {TARGET(350, 0)},v200,z50,tA;",
    f"MoveC {TARGET(400, 50)},{TARGET(350, 100)},v200,z10,tA;",
    LINE,
]


@pytest.fixture(scope="module")
def prepared(rapid):
    """Gives a program run that has not begun, of RAPID lines after a move to START; `trap` runs when diGo rises."""

    def prepare(*lines, trap="", inputs=(), data=""):
        head = rapid.head.replace("PROC main()", f"VAR intnum i1;\nVAR triggdata t1;\n{data}\nPROC main()")
        text = head + "\n".join([START, *lines]) + f"\nENDPROC\nTRAP noted\n{trap}\nENDTRAP\nENDMODULE\n"
        return start_run(load_text(text, "test.mod").start().run(), MODEL, inputs=inputs)

    return prepare


def speeds(run, *times):
    return run.record.planned_tcp(np.array(times))[2]


def ratio_at(run, when, share):
    run_until(run, when)
    run.set_speed_ratio(share, when)
    run_until(run, 60.0)
    return run


@pytest.mark.parametrize("share", [0.5, 0.1])
def test_a_speed_ratio_slows_the_line_under_way_after_half_a_filter_as_hard_as_it_may_brake(prepared, share):
    run = ratio_at(prepared(LINE), 2.0, share)
    told = 2.0 + run.record.half_filter
    lasts = (1 - share) * 0.2 / MODEL.tcp_acceleration  # the path's own limit; the joints' are wider here
    assert speeds(run, told, told + lasts / 2, told + lasts) == pytest.approx([0.2, (1 + share) * 0.1, share * 0.2], abs=2e-5)
    left = 0.2 - run.record.planned_tcp(np.array([told + lasts]))[0][0][1]
    braking = share * 0.2 / MODEL.tcp_acceleration
    assert run.record.chains[-1].end == pytest.approx(told + lasts + left / (share * 0.2) + braking / 2, abs=1e-5)
    assert run.record.planned_tcp(np.array([run.record.end]))[0][0] == pytest.approx([0.45, 0.2, 0.4], abs=EXACT)
    assert len(run.record.moves) == 2


def test_a_speed_ratio_that_is_raised_speeds_the_line_under_way_up(prepared):
    run = prepared(LINE)
    run.set_speed_ratio(0.25, 0.0)
    run = ratio_at(run, 6.0, 1.0)
    told = 6.0 + run.record.half_filter
    assert speeds(run, told, told + 0.05) == pytest.approx([0.05, 0.2], abs=1e-5)


@pytest.mark.parametrize("when", [1.35, 1.9, 2.6, 3.5, 4.3])
def test_wherever_the_ratio_changes_also_in_zones_the_path_stays_and_limits_hold(prepared, moved, when):
    whole = ratio_at(prepared(*CORNERS), 60.0, 1.0)
    run = prepared(*CORNERS)
    for step, share in enumerate((0.4, 0.8, 0.2, 1.0)):
        run_until(run, when + 0.1 * step)
        run.set_speed_ratio(share, when + 0.1 * step)
    run_until(run, 60.0)
    reference = whole.record.planned_tcp(np.linspace(0, whole.record.end, 20000))[0]
    position = run.record.planned_tcp(np.linspace(0, run.record.end, 600))[0]
    off = np.array([np.linalg.norm(reference - point, axis=1).min() for point in position])
    assert off.max() < 1e-4, "the reference's own samples are that far apart"
    assert position[-1] == pytest.approx([0.45, 0.2, 0.4], abs=EXACT)
    audit = type(moved(START))(run)
    assert audit.holds(View.PLANNED)
    assert audit.holds(View.TOOL)
    assert [executed.move.effect.at.line for executed in run.record.moves] == [e.move.effect.at.line for e in whole.record.moves]
    assert run.events == []


def test_what_is_tied_to_a_place_still_happens_there(prepared):
    trigger = LINE.replace("MoveL", "TriggL").replace("fine", "t1,fine")
    run = ratio_at(prepared("TriggIO t1,100\\DOp:=doT,1;", trigger), 2.0, 0.3)
    ((time, _),) = run.signals["doT"]
    assert run.record.planned_tcp(np.array([time]))[0][0] == pytest.approx([0.45, 0.1, 0.4], abs=EXACT)


def test_speedrefresh_in_a_trap_slows_the_motion_under_way(prepared):
    run = prepared(
        "CONNECT i1 WITH noted;", "ISignalDI diGo,1,i1;", LINE, trap="SpeedRefresh 25;", inputs=[InputChange("diGo", 1, 2.0)]
    )  # fmt: skip
    run_until(run, 60.0)
    told = 2.0 + run.record.half_filter
    assert speeds(run, told, told + 0.1) == pytest.approx([0.2, 0.05], abs=1e-5)


def test_speedrefresh_between_fly_by_moves_acts_where_the_program_is_then(prepared):
    plain = prepared(*CORNERS)
    run = prepared(CORNERS[0], "SpeedRefresh 50;", *CORNERS[1:])
    for each in (plain, run):
        run_until(each, 60.0)
    zone = plain.record.moves[1].ends - 0.25  # 50 mm before the corner at 200 mm/s
    assert speeds(run, zone - 0.3, plain.record.moves[1].ends + 0.3) == pytest.approx([0.2, 0.1], abs=1e-3)
    assert run.events == []


def test_speedrefresh_0_lets_the_arm_stand_on_its_path_until_it_is_raised(prepared):
    trap = "SpeedRefresh 0; WaitTime 1; SpeedRefresh 100;"
    run = prepared(
        "CONNECT i1 WITH noted;", "ISignalDI diGo,1,i1;", LINE, "SetDO doDone,1;", trap=trap, inputs=[InputChange("diGo", 1, 2.0)]
    )
    run_until(run, 60.0)
    standing, plain = run.record.planned_tcp(np.linspace(2.3, 3.0, 50)), prepared(LINE)
    run_until(plain, 60.0)
    assert standing[2] == pytest.approx(0, abs=1e-12)
    assert np.ptp(standing[0], axis=0) == pytest.approx(0, abs=1e-12)
    assert run.record.planned_tcp(np.array([run.record.end]))[0][0] == pytest.approx([0.45, 0.2, 0.4], abs=EXACT)
    assert plain.record.end + 0.95 < run.record.end < plain.record.end + 1.2
    assert run.finished


def test_a_motion_that_is_being_stopped_is_not_carried_on_by_a_change_of_speed(prepared):
    run = prepared(LINE)
    run_until(run, 2.0)
    run.hold(2.0)
    run.set_speed_ratio(0.5, 2.01)
    run_until(run, 5.0)
    assert speeds(run, 4.0)[0] == pytest.approx(0, abs=1e-12)
    run.resume(5.0)
    run_until(run, 60.0)
    assert speeds(run, 5.5)[0] == pytest.approx(0.1, abs=1e-5)
    assert run.record.planned_tcp(np.array([run.record.end]))[0][0] == pytest.approx([0.45, 0.2, 0.4], abs=EXACT)


def test_the_program_reads_the_operators_speed_override(prepared):
    run = prepared(LINE, 'TPWrite "override" \\Num:=CSpeedOverride();')
    run.set_speed_ratio(0.4, 0.0)
    run_until(run, 60.0)
    assert run.written[0].text == "override40"
