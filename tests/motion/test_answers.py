r"""What a program is told about its robot, its operator and the date, what its settings do, and how tasks meet."""

import numpy as np
import pytest

from mitl.errors import MotionError
from mitl.motion.answers import Desk
from mitl.motion.chain import Planner
from mitl.motion.offline import run_until
from mitl.motion.program_run import ProgramRun, joints_home
from mitl.motion.record import MotionRecord
from mitl.motion.robot_model import load_robot_model
from mitl.motion.signals import InputChange
from rapid_interp import load_text, start_tasks

MODEL = load_robot_model("irb140")
START = "MoveJ [[450,-200,400],[0,0,1,0],[0,0,0,0],noAxes],v300,fine,tA;"
END = "MoveL [[450,200,400],[0,0,1,0],[0,0,0,0],noAxes],v200,fine,tA;"
HERE = r'TPWrite "y " \Num:=p.trans.y;'


@pytest.fixture(scope="module")
def told(rapid):
    """Runs lines and gives what TPWrite wrote, and the run."""

    def run_lines(*lines, answers=(), inputs=(), data="", more=""):
        head = rapid.head.replace("PROC main()", f"VAR robtarget p;\nVAR jointtarget j;\nVAR num k;\n{data}\nPROC main()")
        text = head + "\n".join(lines) + f"\nENDPROC\n{more}\nENDMODULE\n"
        run = ProgramRun(
            load_text(text, "test.mod").start().run(),
            Planner(MODEL),
            MotionRecord(MODEL, joints_home()),
            inputs=inputs,
            desk=Desk(answers=list(answers)),
        )
        run_until(run, 600.0)
        return [line.text for line in run.written], run

    return run_lines


def test_crobt_gives_where_the_tool_is_and_moving_there_moves_nothing(told):
    written, run = told(START, r"p := CRobT(\Tool:=tA);", HERE, "MoveL p,v100,fine,tA;")
    assert float(written[0][2:]) == pytest.approx(-200, abs=0.01)
    assert np.abs(run.record.moves[1].move.leg.q_end - run.record.moves[1].move.leg.q_start).max() < 1e-5


def test_after_a_fly_by_move_crobt_tells_where_the_arm_is_then(told):
    written, run = told(START, END.replace("fine", "z50"), r"p := CRobT(\Tool:=tA);", HERE, END.replace("450,200", "300,200"))
    y = float(written[0][2:])
    assert 50 < y < 150, "before the zone, not at the programmed point"
    assert run.events == []
    times = np.linspace(run.record.moves[1].begins + 0.5, run.record.moves[2].ends - 0.5, 500)
    assert run.record.planned_tcp(times)[2].min() > 0.1, "asking does not slow the arm down"


def test_calcrobt_and_calcjointt_are_inverse_to_each_other(told):
    written, _ = told(
        START,
        "j := CJointT();",
        "p := CalcRobT(j,tA);",
        HERE,
        r"j := CalcJointT(p,tA);",
        r'TPWrite "j2 " \Num:=j.robax.rax_2;',
        "j := CJointT();",
        r'TPWrite "j2 " \Num:=j.robax.rax_2;',
    )
    assert float(written[0][2:]) == pytest.approx(-200, abs=0.01)
    assert float(written[1][3:]) == pytest.approx(float(written[2][3:]), abs=1e-3)


@pytest.mark.parametrize(("x", "error"), [(3000, "ERR_OUTSIDE_REACH")])
def test_calcjointt_fails_with_an_error_that_a_handler_sees(told, x, error):
    written, _ = told(
        f"j := CalcJointT([[{x},0,400],[0,0,1,0],[0,0,0,0],noAxes],tA);",
        'TPWrite "not here";',
        f'ERROR\nIF ERRNO={error} THEN\nTPWrite "refused";\nENDIF\nRETURN;',
    )
    assert written == ["refused"]


def test_the_operator_answers_in_order_and_a_missing_answer_is_told_with_its_line(told):
    lines = [r'TPReadNum k, "how many";', r'TPWrite "k " \Num:=k;', r'TPReadFK k, "go?", "yes", "no", stEmpty, stEmpty, stEmpty;']
    written, _ = told(*lines, r'TPWrite "key " \Num:=k;', answers=["7", "no"])
    assert written == ["k 7", "key 2"]
    with pytest.raises(MotionError, match="nobody answers") as refused:
        told(*lines, answers=["7"])
    assert refused.value.line == 15
    with pytest.raises(MotionError, match="'seven'"):
        told(*lines, answers=["seven"])


def test_the_date_is_virtual(told):
    written, _ = told("WaitTime 61;", "TPWrite CDate();", "TPWrite CTime();")
    assert written == ["2000-01-01", "00:01:01"]


def test_velset_slows_and_limits_the_moves_after_it(told):
    for setting, fastest in (("VelSet 50,5000;", 0.1), ("VelSet 100,120;", 0.12)):
        _, run = told(START, setting, END)
        speed = run.record.planned_tcp(np.linspace(run.record.moves[1].begins, run.record.end, 2000))[2]
        assert speed.max() == pytest.approx(fastest, rel=1e-5)


def test_speedrefresh_holds_for_the_moves_after_it(told):
    _, run = told(START, "SpeedRefresh 25;", END)
    speed = run.record.planned_tcp(np.linspace(run.record.moves[1].begins, run.record.end, 2000))[2]
    assert speed.max() == pytest.approx(0.05, rel=1e-5)


def test_accset_and_pathacclim_go_with_the_moves(told):
    _, run = told(START, "AccSet 50,60;", r"PathAccLim TRUE\AccMax:=2,TRUE\DecelMax:=1;", END)
    before, after = (executed.move.dynamics for executed in run.record.moves)
    assert (before.acceleration, before.path_acceleration) == (1, np.inf)
    assert (after.acceleration, after.path_acceleration, after.path_deceleration) == (0.5, 2, 1)


def test_waitdi_in_time_and_too_late(told):
    inputs = [InputChange("diGo", 1, 3.0)]
    written, run = told("WaitDI diGo,1;", 'TPWrite "went";', inputs=inputs)
    assert written == ["went"]
    assert run.written[0].time == pytest.approx(3.0, abs=0.011)
    written, run = told(
        r"WaitDI diGo,1\MaxTime:=2;", 'ERROR\nIF ERRNO=ERR_WAIT_MAXTIME THEN\nTPWrite "late";\nENDIF\nRETURN;', inputs=inputs
    )
    assert written == ["late"]
    assert run.written[0].time == pytest.approx(2.0, abs=0.02)


def test_what_is_not_simulated_is_told_once(told):
    _, run = told(START, "SoftAct 3,20;", "SoftAct 4,20;", END)
    assert ["soft servo" in event.text for event in run.events] == [True]
    moved = END.replace("noAxes]", "[100,9E9,9E9,9E9,9E9,9E9]]")
    _, run = told(START, moved, moved)
    assert ["eax_a" in event.text for event in run.events] == [True]


def test_a_meeting_with_a_task_that_does_not_run_is_an_error_unless_it_times_out(told):
    declarations = 'PERS tasks both{2} := [["T_ROB1"],["T_BACK"]];\nVAR syncident meet;'
    with pytest.raises(MotionError, match="waits without end for T_BACK: no such task runs here"):
        told(START, "WaitSyncTask meet,both;", END, data=declarations)


def test_tasks_meet_and_share_data_while_the_arm_moves():
    robot = """MODULE R
  PERS num count := 0;
  PERS tasks both{2} := [["T_ROB1"],["T_BACK"]];
  VAR syncident meet;
  PROC main()
    MoveAbsJ [[20,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v100,fine,tool0;
    WaitSyncTask meet,both;
    TPWrite "robot " \\Num:=count;
  ENDPROC
ENDMODULE
"""
    back = """MODULE B
  PERS num count := 0;
  PERS tasks both{2} := [["T_ROB1"],["T_BACK"]];
  VAR syncident meet;
  PROC main()
    WHILE count < 5 DO
      WaitTime 0.1;
      count := count + 1;
    ENDWHILE
    TPWrite "counted";
    WaitSyncTask meet,both;
    TPWrite "met";
  ENDPROC
ENDMODULE
"""
    tasks = start_tasks({"T_ROB1": load_text(robot, "r.mod"), "T_BACK": load_text(back, "b.mod")})
    record = MotionRecord(MODEL, joints_home())
    run = ProgramRun(tasks["T_ROB1"].run(), Planner(MODEL), record, background={"T_BACK": tasks["T_BACK"].run()})
    run_until(run, 60.0)
    texts = {line.text: line.time for line in run.written}
    assert set(texts) == {"counted", "robot 5", "met"}
    assert texts["counted"] == pytest.approx(0.5, abs=1e-9)
    assert texts["counted"] < record.moves[0].ends < texts["robot 5"] == texts["met"]
