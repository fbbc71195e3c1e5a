"""An arm that follows a conveyor: closed-form expectations on an even belt, while it changes its speed, and where it cannot go on."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

import rapid_interp
from mitl.errors import MotionError
from mitl.motion.carrying import displaced
from mitl.motion.chain import Planner
from mitl.motion.conveyor import Belt, Conveyor
from mitl.motion.following import ConveyorUnits, Encoder
from mitl.motion.offline import Frame, run_until, sample
from mitl.motion.program_run import ProgramRun, joints_home
from mitl.motion.record import TICK, MotionRecord, View
from mitl.motion.robot_model import load_robot_model

MODEL = load_robot_model("irb140")
X_BU = RigidTransform.from_components([0.48, -0.25, 0.3], Rotation.from_euler("z", 90, degrees=True))
ALONG = np.array([0.0, 1.0, 0.0])
HEAD = r"""MODULE M
CONST extjoint noAxes := [9E9,9E9,9E9,9E9,9E9,9E9];
PERS tooldata tA := [TRUE,[[0,0,100],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];
PERS wobjdata onBelt := [FALSE,FALSE,"CNV1",[[0,0,0],[1,0,0,0]],[[0,0,60],[1,0,0,0]]];
CONST robtarget beside := [[400,-250,400],[0,0,1,0],[0,0,0,0],noAxes];
CONST robtarget piece := [[0,0,0],[0,0.707106781,0.707106781,0],[0,0,0,0],noAxes];
VAR bool late;
PROC main()
ConfL\Off; ConfJ\Off;
MoveJ beside,v500,fine,tA;
"""
ON = r"ActUnit CNV1; WaitWObj onBelt\RelDist:=40; MoveL piece,v200,fine,tA\WObj:=onBelt;"
FOLLOWED = 1e-6  # m: the controller's joints are interpolated between ticks
HELD = 5e-6  # m: what is left of a motion after it has settled


def belt(**options):
    return Conveyor("belt", "CNV1", X_BU, 1e4, **options)


def run_of(*lines, conveyor=None, encoder=None, until=20.0):
    """Gives a program run beside a belt at .1 m/s, or another one, and the belt."""
    task = rapid_interp.load_text(HEAD + "\n".join(lines) + "\nENDPROC\nENDMODULE\n", "m.mod").start()
    record = MotionRecord(MODEL, joints_home())
    moving = Belt(conveyor or belt(speed=0.1))
    units = ConveyorUnits([moving], horizon=record.half_filter, encoder=encoder)
    run = ProgramRun(task.run(), Planner(MODEL), record, units=units)
    run_until(run, until)
    return run, moving


def tips(run, times):
    return sample(run, times, View.TOOL, Frame.BASE).path.position


def beside_the_belt(run, moving, times):
    """Gives the tool's places (N, 3) m less the belt's way, in the frame where the encoder counts 0."""
    return (
        RigidTransform.from_translation(-moving.positions(times)[:, None] * ALONG) * RigidTransform.from_translation(tips(run, times))
    ).translation


def object_place(x, y, z=60.0):
    return (X_BU * RigidTransform.from_translation(1e-3 * np.array([x, y, z]))).translation


def test_a_tool_that_stands_on_an_even_belt_stands_beside_its_piece():
    run, moving = run_of(ON, "WaitTime 2; MoveL beside,v200,fine,tA;")
    on = run.record.moves[1].ends
    times = np.linspace(on + 0.5, on + 1.5, 50)
    assert beside_the_belt(run, moving, times) == pytest.approx(np.tile(object_place(0, 0), (50, 1)), abs=HELD)


def test_a_line_on_an_even_belt_is_the_line_on_a_standing_one_carried_along():
    line = r"MoveL Offs(piece,80,40,0),v200,fine,tA\WObj:=onBelt; MoveL beside,v200,fine,tA;"
    run, moving = run_of(ON, line)
    standing = HEAD.replace('[FALSE,FALSE,"CNV1",[[0,0,0],[1,0,0,0]]', '[FALSE,TRUE,"",[[480,-210,300],[0.707106781,0,0,0.707106781]]')
    task = rapid_interp.load_text(standing + r"MoveL piece,v200,fine,tA\WObj:=onBelt;" + line + "\nENDPROC\nENDMODULE\n", "m.mod").start()
    still = ProgramRun(task.run(), Planner(MODEL), MotionRecord(MODEL, joints_home()))
    run_until(still, 20.0)
    begins, ends = (getattr(run.record.moves[2], name) for name in ("begins", "ends"))
    later = begins - still.record.moves[2].begins
    times = np.linspace(begins + 0.25, ends - 0.05, 40)  # the motion before has settled by then
    connected = object_place(0, 0)[1] + moving.positions(times)  # the piece is where the belt has carried it
    carried = tips(still, times - later) + (connected - (-0.21))[:, None] * ALONG
    assert tips(run, times) == pytest.approx(carried, abs=1e-4), "the ticks of the two programs fall differently"
    assert ends - begins == pytest.approx(still.record.moves[2].ends - still.record.moves[2].begins, abs=1e-3)


def test_the_motion_onto_a_belt_and_off_it_has_no_jump():
    run, _ = run_of(ON, "MoveL beside,v200,fine,tA; DropWObj onBelt;")
    times = np.arange(0.0, run.record.end + 0.2, TICK)
    speed = np.diff(run.record.joints(times, View.TOOL), axis=0) / TICK
    acceleration = np.diff(speed, axis=0) / TICK
    assert np.all(np.abs(speed).max(axis=0) <= MODEL.speed)
    assert np.abs(acceleration).max() < 60.0, "joints 1 to 3 are allowed 30 to 65 rad/s^2"
    assert tips(run, times[-1:])[0] == pytest.approx([0.4, -0.25, 0.4], abs=HELD)


def test_while_a_belt_speeds_up_the_tool_is_half_a_times_the_filters_delay_squared_behind():
    conveyor = belt(speed_signal="aoBelt", acceleration=0.25)
    run, moving = run_of(
        "SetAO aoBelt,50; " + ON + "WaitTime 0.5; SetAO aoBelt,300; WaitTime 2; MoveL beside,v200,fine,tA;", conveyor=conveyor
    )
    begins = run.signals["aoBelt"][1][0]
    during = np.linspace(begins + 0.1, begins + 0.9, 20)
    behind = -0.5 * 0.25 * run.record.half_filter**2
    error = beside_the_belt(run, moving, during) - object_place(0, 0)
    assert error @ ALONG == pytest.approx(behind, abs=2e-5)
    after = np.linspace(begins + 1.2, begins + 1.6, 20)
    assert (beside_the_belt(run, moving, after) - object_place(0, 0)) @ ALONG == pytest.approx(0.0, abs=HELD)


@pytest.mark.parametrize(
    ("encoder", "error"),
    [(Encoder(gain=1.05), lambda way: 0.05 * way), (Encoder(delay=0.08), lambda _way: -0.08 * 0.1)],
    ids=["gain", "delay"],
)
def test_a_wrong_encoder_is_off_as_much_as_it_is_wrong(encoder, error):
    run, moving = run_of(ON, "WaitTime 2; MoveL beside,v200,fine,tA;", encoder=encoder)
    on = run.record.moves[1].ends
    times = np.linspace(on + 0.5, on + 1.5, 20)
    off = (beside_the_belt(run, moving, times) - object_place(0, 0)) @ ALONG
    assert off == pytest.approx([error(way) for way in moving.positions(times)], abs=HELD)


def test_a_work_object_is_waited_for_until_it_has_come_so_far():
    run, moving = run_of(
        r"ActUnit CNV1; WaitWObj onBelt\RelDist:=120; SetDO doCame,1; MoveL piece,v200,fine,tA\WObj:=onBelt; MoveL beside,v200,fine,tA;"
    )
    came = run.signals["doCame"][0][0]
    assert moving.position(came) == pytest.approx(0.12, abs=FOLLOWED)


def test_pieces_come_one_after_the_other():
    conveyor = belt(speed=0.1, pieces=(0.0, 0.5))
    off = "MoveL beside,v500,fine,tA; DropWObj onBelt;"
    run, moving = run_of(ON, off, r"WaitWObj onBelt\RelDist:=40; SetDO doCame,1;", conveyor=conveyor)
    assert moving.position(run.signals["doCame"][0][0]) == pytest.approx(0.54, abs=FOLLOWED)


def test_waiting_in_vain_ends_with_max_time():
    conveyor = belt()
    run, _ = run_of(r"ActUnit CNV1; WaitWObj onBelt\RelDist:=40\MaxTime:=2\TimeFlag:=late; IF late SetDO doLate,1;", conveyor=conveyor)
    assert run.signals["doLate"][0][1] == 1
    assert run.ended == pytest.approx(2 + run.record.moves[0].ends, abs=0.2)


def test_an_arm_whose_program_ends_on_a_belt_is_let_go():
    run, _ = run_of(ON)
    gone = tips(run, np.array([run.ended + 0.21, run.ended + 5.0]))
    assert gone[0] == pytest.approx(gone[1], abs=HELD)


@pytest.mark.parametrize(
    ("lines", "reason"),
    [
        (r"MoveL piece,v200,fine,tA\WObj:=onBelt;", "no work object of CNV1 is connected: WaitWObj comes first"),
        (r"WaitWObj onBelt\RelDist:=40;", "CNV1 is not active: ActUnit CNV1 comes first"),
        (ON + r"WaitWObj onBelt\RelDist:=40;", "connected already: DropWObj comes first"),
        (ON + "DropWObj onBelt;", "the robot still follows the work object of CNV1"),
        (ON + "MoveJ beside,v200,fine,tA;", "MoveJ cannot follow a conveyor"),
        (ON + "StorePath;", "while the robot follows a conveyor"),
        ("ActUnit CNV1; DropWObj onBelt;", "no work object of CNV1 is connected"),
        ("ActUnit CNV1; WaitWObj wobj0;", "belongs to no conveyor"),
        (ON + "WaitTime 30;", "to follow CNV1 axis 3 would have to turn at 110% of its speed limit"),
    ],
)
def test_what_cannot_be_followed_is_refused_at_its_line(lines, reason):
    with pytest.raises(MotionError) as caught:
        run_of(lines, until=60.0)
    assert reason in str(caught.value)
    assert caught.value.line == HEAD.count("\n") + 1


def test_a_piece_is_followed_no_farther_than_the_conveyor_allows():
    with pytest.raises(MotionError, match="CNV1 has carried its work object farther than 200 mm"):
        run_of(ON + "WaitTime 30;", conveyor=belt(speed=0.1, farthest=0.2))


def test_where_the_arm_cannot_be_carried_it_keeps_its_joints_and_is_said_to_be_lost():
    arm, joints = Planner(MODEL).arm, np.tile(joints_home(), (3, 1))
    found, lost = displaced(arm, joints, np.array([[0.0, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 5.0, 0.0]]))
    assert lost.tolist() == [False, False, True]
    assert found[0] == pytest.approx(joints[0])
    assert found[2] == pytest.approx(found[1])
    assert arm.flange(found[1]).translation - arm.flange(joints[1]).translation == pytest.approx([0.0, 0.1, 0.0], abs=FOLLOWED)


def test_without_its_cell_a_conveyor_is_not_known():
    task = rapid_interp.load_text(HEAD + r"WaitWObj onBelt\RelDist:=40;" + "\nENDPROC\nENDMODULE\n", "m.mod").start()
    run = ProgramRun(task.run(), Planner(MODEL), MotionRecord(MODEL, joints_home()))
    with pytest.raises(MotionError, match="there is no conveyor 'CNV1'"):
        run_until(run, 20.0)
