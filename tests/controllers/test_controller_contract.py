"""What every Controller does, whatever is behind it. A new implementation adds an entry to RIGS."""

from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

from mitl.errors import RigError
from mitl.protocols import Controller, ExecutionState
from mitl.rig import load_rig

from .served import remote

PROGRAM = """MODULE Contract
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST jointtarget there := [[20,10,0,0,40,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR num option := 0;
  PERS robtarget seen := [[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST num fixed := 4;
  PROC main()
    WHILE TRUE DO
      TEST option
      CASE 1:
        MoveAbsJ there, v200, fine, tool0;
        SetDO doThere, 1;
        option := 0;
      CASE 2:
        MoveAbsJ [[999,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v200, fine, tool0;
      CASE 3:
        MoveAbsJ home, v200, fine, tool0;
        EXIT;
      CASE 4:
        MoveAbsJ home, v200, fine, tool0;
        option := 0;
      DEFAULT:
        WaitTime 0.05;
      ENDTEST
    ENDWHILE
  ENDPROC
ENDMODULE
"""
RIGS = {
    "simulated": lambda _folder: nullcontext(load_rig("sim", 1, ())),
    "rws 1": lambda folder: remote("1", folder),
    "rws 2": lambda folder: remote("2", folder),
    "rws 8": lambda folder: remote("8", folder),
}


@pytest.fixture(params=RIGS)
def rig(request, tmp_path):
    (tmp_path / "contract.mod").write_text(PROGRAM, encoding="utf-8")
    with RIGS[request.param](tmp_path / "disk") as made:
        yield made, tmp_path / "contract.mod"


@pytest.fixture
def running(rig):
    made, program = rig
    made.controller.load([program])
    made.controller.start()
    made.clock.wait(0.1)
    return made


def wait_for(rig, name, literal, seconds=20.0):
    until = rig.clock.now() + seconds
    while rig.controller.read(name) != literal:
        assert rig.clock.now() < until, f"{name} did not become {literal}"
        rig.clock.wait(0.05)


def test_it_is_a_controller(rig):
    assert isinstance(rig[0].controller, Controller)


def test_nothing_runs_before_a_program_is_loaded_and_started(rig):
    made, program = rig
    assert made.controller.state() is ExecutionState.STOPPED
    with pytest.raises(RigError, match="no program"):
        made.controller.start()
    made.controller.load([program])
    assert made.controller.state() is ExecutionState.STOPPED
    made.controller.start()
    assert made.controller.state() is ExecutionState.RUNNING


def test_an_order_moves_the_arm_to_its_target_and_sets_the_output(running):
    assert running.controller.read_signal("doThere") == 0.0
    running.controller.write("option", "1")
    wait_for(running, "option", "0")
    running.clock.wait(0.2)
    assert np.degrees(running.controller.joints()) == pytest.approx([20, 10, 0, 0, 40, 0], abs=0.01)
    assert running.controller.read_signal("doThere") == 1.0


def test_the_flange_is_where_the_joints_put_it(running):
    home = running.controller.flange()
    # IRB 140: the wrist centre at (450, 712) mm, 65 mm to the flange, axis 5 at 30 deg (facts/motion.md)
    expected = np.array([0.450 + 0.065 * np.cos(np.pi / 6), 0.0, 0.712 - 0.065 * np.sin(np.pi / 6)])
    assert home[:3] == pytest.approx(expected, abs=1e-6)
    assert np.linalg.norm(home[3:]) == pytest.approx(1.0)


@pytest.mark.parametrize("literal", ["[[4,5,6],[1,0,0,0],[0,0,0,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]]"])
def test_variables_are_read_and_written_as_rapid_literals(running, literal):
    running.controller.write("seen", literal)
    assert running.controller.read("seen") == literal
    assert running.controller.read("fixed") == "4"


@pytest.mark.parametrize(("name", "literal"), [("option", "TRUE"), ("option", "1 +"), ("fixed", "5"), ("nothing", "1")])
def test_a_wrong_value_or_name_is_refused_with_its_name(running, name, literal):
    with pytest.raises(RigError, match=name):
        running.controller.write(name, literal)


def test_stop_brakes_the_arm_along_its_path_and_may_be_called_twice(running):
    running.controller.write("option", "1")
    running.clock.wait(0.3)
    running.controller.stop()
    running.controller.stop()
    running.clock.wait(0.5)
    resting = running.controller.joints()
    assert running.controller.state() is ExecutionState.STOPPED
    assert 1.0 < np.degrees(resting[0]) < 19.0
    # the joints of this move keep their ratio all the way: 20 : 10 : 10
    assert np.degrees(resting[[0, 1, 4]]) - [0, 0, 30] == pytest.approx(np.degrees(resting[0]) * np.array([1, 0.5, 0.5]), abs=0.02)
    running.clock.wait(0.5)
    assert np.array_equal(running.controller.joints(), resting)


def test_a_stopped_program_is_resumed_where_it_was(running):
    running.controller.write("option", "1")
    running.clock.wait(0.3)
    running.controller.stop()
    running.clock.wait(0.5)
    assert np.degrees(running.controller.joints())[0] < 19.0
    running.controller.start()
    wait_for(running, "option", "0")
    running.clock.wait(0.2)
    assert np.degrees(running.controller.joints()) == pytest.approx([20, 10, 0, 0, 40, 0], abs=0.01)
    assert running.controller.read_signal("doThere") == 1.0


def test_a_program_that_cannot_move_stops_by_itself_and_says_why_in_the_event_log(running):
    running.controller.write("option", "2")
    running.clock.wait(0.5)
    assert running.controller.state() is ExecutionState.STOPPED
    last = running.controller.event_log()[-1]
    assert last.level == "error"
    assert "axis 1" in last.text
    assert "limit" in last.text


def test_a_program_that_ends_leaves_the_controller_stopped(running):
    running.controller.write("option", "3")
    running.clock.wait(1.0)
    assert running.controller.state() is ExecutionState.STOPPED


def test_loading_is_refused_while_running_and_for_a_program_with_errors(running, tmp_path):
    with pytest.raises(RigError, match="executing"):
        running.controller.load([tmp_path / "contract.mod"])
    running.controller.stop()
    bad = tmp_path / "bad.mod"
    bad.write_text("MODULE Bad\n  PROC main()\n    MoveX;\n  ENDPROC\nENDMODULE\n", encoding="utf-8")
    with pytest.raises(RigError, match=r"bad\.mod:3"):
        running.controller.load([bad])
    with pytest.raises(RigError, match=r"none\.mod"):
        running.controller.load([Path("none.mod")])


def test_without_motors_nothing_starts(rig):
    made, program = rig
    made.controller.load([program])
    made.controller.set_motors(False)
    with pytest.raises(RigError, match="motors"):
        made.controller.start()
    made.controller.set_motors(True)
    made.controller.start()


def test_switching_the_motors_off_stops_the_program(running):
    running.controller.set_motors(False)
    assert running.controller.state() is ExecutionState.STOPPED


def test_the_speed_ratio_slows_what_is_planned_from_then_on(rig):
    made, program = rig
    durations = []
    for ratio in (100, 50):
        made.begin_case(f"ratio {ratio}")
        made.controller.load([program])
        made.controller.set_speed_ratio(ratio)
        made.controller.start()
        made.controller.write("option", "4")
        wait_for(made, "option", "0")
        made.controller.write("option", "1")
        began = made.clock.now()
        wait_for(made, "option", "0")
        durations.append(made.clock.now() - began)
    assert durations[1] > 1.7 * durations[0]
    with pytest.raises(RigError, match="1 to 100"):
        made.controller.set_speed_ratio(0)
