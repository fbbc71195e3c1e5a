r"""Stopping and going on: by the controller, by StopMove in a trap, with StorePath; always along the path, and on from where it was."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from mitl.motion.offline import run_until, start_run
from mitl.motion.robot_effects import StopKind
from mitl.motion.robot_model import load_robot_model
from mitl.motion.signals import InputChange
from rapid_interp import load_text

EXACT = 1e-6
MODEL = load_robot_model("irb140")
START = "MoveJ [[450,-200,400],[0,0,1,0],[0,0,0,0],noAxes],v300,fine,tA;"
END = "MoveL [[450,200,400],[0,0,1,0],[0,0,0,0],noAxes],v200,fine,tA;"


@pytest.fixture(scope="module")
def prepared(rapid):
    """Gives a program run that has not begun, of RAPID lines after a move to START; `trap` runs when diGo rises."""

    def prepare(*lines, trap="", inputs=(), data=""):
        head = rapid.head.replace("PROC main()", f"VAR intnum i1;\nVAR robtarget p;\nVAR num k := 0;\n{data}\nPROC main()")
        text = head + "\n".join([START, *lines]) + f"\nENDPROC\nTRAP noted\n{trap}\nENDTRAP\nENDMODULE\n"
        return start_run(load_text(text, "test.mod").start().run(), MODEL, inputs=inputs)

    return prepare


def planned(run, *times):
    return run.record.planned_tcp(np.array(times))


def stop_and_go(run, when, kind=StopKind.PROGRAM, rest=1.0):
    run_until(run, when)
    run.hold(when, kind)
    run_until(run, when + rest)
    run.resume(when + rest)
    run_until(run, 60.0)
    return run


@pytest.mark.parametrize(("kind", "share"), [(StopKind.PROGRAM, 0.5), (StopKind.QUICK, 1.0), (StopKind.EMERGENCY, 1.0)])
def test_the_stopping_distance_is_that_of_its_deceleration(prepared, kind, share):
    run = prepared(END)
    run_until(run, 2.0)
    before = planned(run, 2.0)[0][0]
    run.hold(2.0, kind)
    speed, acceleration, window = 0.2, share * MODEL.tcp_acceleration, MODEL.acceleration_window
    # what the drives have already is carried out; then the deceleration is built up over its window, if there is time for all of it
    lasts = speed / acceleration + window if speed > acceleration * window else 2 * np.sqrt(speed * window / acceleration)
    way = speed * (run.record.half_filter + lasts / 2)
    assert planned(run, 3.0)[0][0] - before == pytest.approx([0, way, 0], abs=2e-5)
    assert planned(run, 3.0)[2][0] == pytest.approx(0, abs=1e-12)
    run_until(run, 5.0)
    assert planned(run, 5.0)[0][0][1] == pytest.approx(before[1] + way, abs=2e-5), "it stays there"


def test_a_resumed_program_goes_on_along_its_line_and_ends_where_it_should(prepared):
    run = stop_and_go(prepared(END, "SetDO doDone,1;"), 2.0)
    times = np.linspace(run.record.moves[1].begins, run.record.end, 2000)
    position, _, speed = run.record.planned_tcp(times)
    assert np.abs(position[:, [0, 2]] - [0.45, 0.4]).max() < EXACT
    assert position[-1] == pytest.approx([0.45, 0.2, 0.4], abs=EXACT)
    assert (np.diff(position[:, 1]) >= -EXACT).all(), "never backwards"
    assert speed.max() <= 0.2 + EXACT
    assert len(run.record.moves) == 2, "the move counts once"
    assert run.finished
    assert run.signals["doDone"][0][0] > 3.0


FIGURE = [
    "MoveL [[450,0,400],[0,0,1,0],[0,0,0,0],noAxes],v200,z50,tA;",
    "MoveL [[350,0,400],[0,0,1,0],[0,0,0,0],noAxes],v200,z50,tA;",
    "MoveC [[400,50,400],[0,0,1,0],[0,0,0,0],noAxes],[[350,100,400],[0,0,1,0],[0,0,0,0],noAxes],v200,z10,tA;",
    END,
]


@pytest.fixture(scope="module")
def whole(prepared):
    run = prepared(*FIGURE)
    run_until(run, 60.0)
    return run


@pytest.mark.parametrize("when", [1.6, 2.0, 2.3, 2.6, 3.1, 3.6, 4.1])
def test_wherever_it_is_stopped_also_in_zones_the_path_stays_the_same(prepared, whole, when):
    path = cKDTree(whole.record.planned_tcp(np.linspace(0, whole.record.end, 20000))[0])
    run = stop_and_go(prepared(*FIGURE), when)
    position = run.record.planned_tcp(np.linspace(0, run.record.end, 1000))[0]
    assert path.query(position)[0].max() < 1e-4, "the reference's own samples are that far apart"
    assert position[-1] == pytest.approx([0.45, 0.2, 0.4], abs=EXACT)
    assert [executed.move.effect.at.line for executed in run.record.moves] == [e.move.effect.at.line for e in whole.record.moves]
    assert run.events == []


def test_stopped_ten_times_the_path_is_the_same_and_triggers_fire_at_their_places(prepared):
    run = prepared("TriggIO t1,100\\DOp:=doT,1;", END.replace("MoveL", "TriggL").replace("fine", "t1,fine"), data="VAR triggdata t1;")
    now = 1.5
    for _ in range(10):
        now += 0.15
        run_until(run, now)
        run.hold(now)
        now += 0.5
        run_until(run, now)
        run.resume(now)
    run_until(run, 60.0)
    ((time, _),) = run.signals["doT"]
    assert planned(run, time)[0][0] == pytest.approx([0.45, 0.1, 0.4], abs=EXACT)
    assert planned(run, run.record.end)[0][0] == pytest.approx([0.45, 0.2, 0.4], abs=EXACT)


def test_a_wait_that_is_stopped_has_its_rest_left(prepared):
    run = prepared("WaitTime 2;", "SetDO doDone,1;")
    run_until(run, 60.0)
    plain = run.signals["doDone"][0][0]
    stopped = stop_and_go(prepared("WaitTime 2;", "SetDO doDone,1;"), plain - 0.5, rest=3.0)
    assert stopped.signals["doDone"][0][0] == pytest.approx(plain + 3.0, abs=EXACT)


def test_a_program_that_is_held_does_nothing_until_it_is_resumed(prepared):
    run = prepared("WHILE TRUE DO", "WaitTime 0.1;", "PulseDO doBeat;", "ENDWHILE")
    run_until(run, 3.0)
    run.hold(3.0)
    run_until(run, 10.0)
    beats = len(run.signals["doBeat"])
    assert max(time for time, _ in run.signals["doBeat"]) < 3.3, "a pulse that began ends"
    assert not run.finished
    assert run.resumable
    run.resume(10.0)
    run_until(run, 11.0)
    assert len(run.signals["doBeat"]) > beats


def test_stop_in_the_program_is_a_stop_that_can_be_resumed(prepared):
    run = prepared("Stop;", END)
    run_until(run, 60.0)
    assert run.finished
    assert run.stopped_at.line == 14
    assert len(run.record.moves) == 1
    run.resume(5.0)
    run_until(run, 60.0)
    assert len(run.record.moves) == 2
    assert run.stopped_at is None


def test_stopmove_and_startmove_in_a_trap(prepared):
    run = prepared(
        "CONNECT i1 WITH noted;", "ISignalDI diGo,1,i1;", END, 'TPWrite "there";',
        trap='StopMove; p := CRobT(\\Tool:=tA); TPWrite "y " \\Num:=p.trans.y; WaitTime 2; StartMove;',
        inputs=[InputChange("diGo", 1, 2.0)],
    )  # fmt: skip
    run_until(run, 60.0)
    told, there = run.written
    y = float(told.text[2:]) / 1e3
    standing = planned(run, told.time + 1)
    assert standing[2][0] == pytest.approx(0, abs=1e-12)
    assert standing[0][0][1] == pytest.approx(y, abs=1e-5)
    assert there.time > told.time + 2
    assert planned(run, run.record.end)[0][0] == pytest.approx([0.45, 0.2, 0.4], abs=EXACT)


def test_storepath_lets_a_trap_move_elsewhere_and_come_back(prepared):
    run = prepared(
        "CONNECT i1 WITH noted;", "ISignalDI diGo,1,i1;", END, 'TPWrite "there";',
        trap="StopMove; StorePath; p := CRobT(\\Tool:=tA); MoveL Offs(p,0,0,50),v200,fine,tA; MoveL p,v200,fine,tA; RestoPath; StartMove;",
        inputs=[InputChange("diGo", 1, 2.0)],
    )  # fmt: skip
    run_until(run, 60.0)
    position = run.record.planned_tcp(np.linspace(2.0, run.record.end, 4000))[0]
    assert position[:, 2].max() == pytest.approx(0.45, abs=1e-4)
    assert position[-1] == pytest.approx([0.45, 0.2, 0.4], abs=EXACT)
    assert [line.text for line in run.written] == ["there"]


def test_startmove_far_from_the_path_is_an_error_that_a_handler_sees(prepared):
    run = prepared(
        "CONNECT i1 WITH noted;", "ISignalDI diGo,1,i1;", END,
        trap=(
            "StopMove; StorePath; MoveAbsJ [[60,0,0,0,30,0],noAxes],v300,fine,tA; RestoPath; StartMove;\n"
            'ERROR\nIF ERRNO=ERR_PATHDIST THEN\nTPWrite "too far"; ClearPath; TRYNEXT;\nENDIF'
        ),
        inputs=[InputChange("diGo", 1, 2.0)],
    )  # fmt: skip
    run_until(run, 60.0)
    assert [line.text for line in run.written] == ["too far"]
    assert run.finished


def test_clearpath_forgets_the_rest_of_the_move(prepared):
    run = prepared(
        "CONNECT i1 WITH noted;", "ISignalDI diGo,1,i1;", END, 'TPWrite "on";', END.replace("450,200", "450,-100"),
        trap="StopMove; ClearPath; StartMove;", inputs=[InputChange("diGo", 1, 2.0)],
    )  # fmt: skip
    run_until(run, 60.0)
    position = run.record.planned_tcp(np.linspace(0, run.record.end, 4000))[0]
    assert position[2000:, 1].max() < 0.0
    assert position[-1] == pytest.approx([0.45, -0.1, 0.4], abs=EXACT)
    assert [line.text for line in run.written] == ["on"]


def test_an_interrupt_does_not_disturb_the_motion_and_a_wait_goes_on_after_it(prepared):
    inputs = [InputChange("diGo", 1, 2.0)]
    quiet = prepared(END, "WaitTime 1;", 'TPWrite "end";')
    run_until(quiet, 60.0)
    run = prepared("CONNECT i1 WITH noted;", "ISignalDI diGo,1,i1;", END, "WaitTime 1;", 'TPWrite "end";', trap="Incr k;", inputs=inputs)
    run_until(run, 60.0)
    assert run.written[-1].time == pytest.approx(quiet.written[-1].time, abs=EXACT)


def test_a_timer_raises_again_and_again_also_while_waiting(prepared):
    run = prepared("CONNECT i1 WITH noted;", "ITimer 0.5,i1;", "WaitTime 2.2;", "IDelete i1;", "WaitTime 2;", trap='TPWrite "tick";')
    run_until(run, 60.0)
    times = np.array([line.time for line in run.written])
    assert np.diff(times) == pytest.approx([0.5] * 3, abs=EXACT)


@pytest.mark.parametrize(("instruction", "at_once"), [("Break;", True), ("SystemStopAction \\Stop;", True), ("Stop;", False)])
def test_a_program_that_stops_itself_in_a_trap_stops_its_arm_at_once_or_at_the_moves_end(prepared, instruction, at_once):
    run = prepared("CONNECT i1 WITH noted;", "ISignalDI diGo,1,i1;", END, trap=instruction, inputs=[InputChange("diGo", 1, 2.5)])
    run_until(run, 20.0)
    assert run.stopped_at is not None
    end = planned(run, 20.0)[0][0][1]
    assert (end < 0.19) == at_once
    assert end == pytest.approx(0.2, abs=EXACT) or at_once
    run.resume(20.0)
    run_until(run, 40.0)
    assert run.finished
    assert planned(run, 40.0)[0][0][1] == pytest.approx(0.2, abs=EXACT)
