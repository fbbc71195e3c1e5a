r"""Triggers at their exact place and time: TriggIO, TriggEquip, TriggInt, TriggSpeed, TriggRampAO, TriggCheckIO, MoveLDO and their kind.

Expectations are closed forms: on a line at constant speed place is speed times time.
"""

import numpy as np
import pytest

from mitl.motion.record import View

EXACT = 1e-6
"""m, and s: must-show 4 of the issue."""
SPEED = 0.2
START = "[[450,-200,400],[0,0,1,0],[0,0,0,0],noAxes]"
END = "[[450,200,400],[0,0,1,0],[0,0,0,0],noAxes]"
DECLARED = "VAR triggdata t1; VAR triggdata t2; VAR triggdata t3; VAR intnum i1; VAR num seen := 0;"


@pytest.fixture(scope="module")
def triggered(rapid, moved):
    """Runs definitions and moves after a move to START; declares t1..t3, i1, seen and the trap `noted`."""

    def run(*lines, trap='TPWrite "trap";', **words):
        head = rapid.head.replace("PROC main()", f"{DECLARED}\nPROC main()")
        to_start = f"MoveJ {START},v300,fine,tA;"
        text = head + "\n".join([to_start, *lines]) + f"\nENDPROC\nTRAP noted\n{trap}\nENDTRAP\nENDMODULE\n"
        return moved(text, **words)

    return run


def place(motion, time):
    return motion.record.planned_tcp(np.array([time]))[0][0]


def fired(motion, name="doT"):
    return [time for time, value in motion.run.signals[name] if value]


@pytest.mark.parametrize("distance", [5, 100, 390])
def test_triggio_fires_at_its_distance_before_the_end(triggered, distance):
    motion = triggered(f"TriggIO t1,{distance}\\DOp:=doT,1;", f"TriggL {END},v200,t1,fine,tA;")
    (time,) = fired(motion)
    assert place(motion, time) == pytest.approx([0.45, 0.2 - 1e-3 * distance, 0.4], abs=EXACT)


def test_triggio_from_the_start_and_by_time_before_the_end(triggered):
    motion = triggered("TriggIO t1,150\\Start\\DOp:=doT,1;", "TriggIO t2,0.25\\Time\\DOp:=doU,1;", f"TriggL {END},v200,t1\\T2:=t2,fine,tA;")
    assert place(motion, fired(motion)[0])[1] == pytest.approx(-0.05, abs=EXACT)
    assert fired(motion, "doU")[0] == pytest.approx(motion.record.chains[-1].end - 0.25, abs=EXACT)


@pytest.mark.parametrize("lag", [0.1, -0.1, 0.0])
def test_equipment_lag_moves_the_output_along_a_line_at_constant_speed(triggered, lag):
    motion = triggered(f"TriggEquip t1,200,{lag}\\DOp:=doT,1;", f"TriggL {END},v200,t1,fine,tA;")
    assert place(motion, fired(motion)[0])[1] == pytest.approx(-SPEED * lag, abs=EXACT)


def test_equipment_lag_in_a_zone_counts_from_the_place_in_the_corner(triggered):
    on_time, early = (
        triggered(
            f"TriggEquip t1,10,{lag}\\DOp:=doT,1;",
            f"TriggL {END},v100,t1,z50,tA;",
            "MoveL [[250,200,400],[0,0,1,0],[0,0,0,0],noAxes],v100,fine,tA;",
        )
        for lag in (0, 0.05)
    )
    (there,), (before,) = fired(on_time), fired(early)
    assert there - before == pytest.approx(0.05, abs=EXACT)
    # the corner is symmetrical about the bisector: the place 10 mm before its middle mirrors the one 10 mm after it
    x, y, _ = place(on_time, there)
    assert (x - 0.45) > -(0.2 - y)
    assert place(on_time, there)[1] < 0.2 - 0.01 + 0.011


def test_outside_the_zone_distances_count_from_the_programmed_point(triggered):
    motion = triggered(
        "TriggIO t1,60\\DOp:=doT,1;",
        "TriggIO t2,70\\Start\\DOp:=doU,1;",
        f"TriggL {END},v200,t1,z50,tA;",
        "TriggL [[250,200,400],[0,0,1,0],[0,0,0,0],noAxes],v200,t2,fine,tA;",
    )
    assert place(motion, fired(motion)[0]) == pytest.approx([0.45, 0.14, 0.4], abs=EXACT)
    assert place(motion, fired(motion, "doU")[0]) == pytest.approx([0.38, 0.2, 0.4], abs=EXACT)


def test_what_lies_before_the_move_happens_at_its_beginning(triggered):
    motion = triggered("TriggIO t1,900\\DOp:=doT,1;", "TriggEquip t2,390,5\\DOp:=doU,1;", f"TriggL {END},v200,t1\\T2:=t2,fine,tA;")
    assert fired(motion) == fired(motion, "doU") == [pytest.approx(motion.record.chains[-1].start, abs=EXACT)]


def test_several_triggers_of_a_move_fire_in_the_order_of_their_places(triggered):
    motion = triggered(
        *(f"TriggIO t{index},{distance}\\DOp:=do{index},1;" for index, distance in ((1, 50), (2, 350), (3, 200))),
        f"TriggL {END},v200,t1\\T2:=t2\\T3:=t3,fine,tA;",
    )
    times = [fired(motion, f"do{index}")[0] for index in (2, 3, 1)]
    assert times == sorted(times)
    assert [place(motion, time)[1] for time in times] == pytest.approx([-0.15, 0.0, 0.15], abs=EXACT)


def test_on_an_arc_distance_is_along_the_arc(triggered):
    motion = triggered(
        "TriggIO t1,100\\DOp:=doT,1;",
        "TriggC [[350,-100,400],[0,0,1,0],[0,0,0,0],noAxes],[[450,0,400],[0,0,1,0],[0,0,0,0],noAxes],v200,t1,fine,tA;",
    )
    angle = 0.1 / 0.1  # rad before the end of a circle of 100 mm about (450, -100)
    expected = [0.45 - 0.1 * np.sin(angle), -0.1 + 0.1 * np.cos(angle), 0.4]
    assert place(motion, fired(motion)[0]) == pytest.approx(expected, abs=EXACT)


def test_on_a_joint_move_distance_is_along_the_way_of_the_tcp(triggered):
    motion = triggered("TriggIO t1,100\\DOp:=doT,1;", f"TriggJ {END},v200,t1,fine,tA;")
    times = np.linspace(fired(motion)[0], motion.record.chains[-1].end, 4001)
    way = np.linalg.norm(np.diff(motion.record.planned_tcp(times)[0], axis=0), axis=1).sum()
    assert way == pytest.approx(0.1, abs=EXACT)


@pytest.mark.parametrize("kind", ["DO", "GO", "AO"])
def test_moveldo_acts_in_the_middle_of_the_corner(triggered, kind):
    signal = f"{kind.lower()}T"
    motion = triggered(f"MoveL{kind} {END},v200,z50,tA,{signal},1;", "MoveL [[250,200,400],[0,0,1,0],[0,0,0,0],noAxes],v200,fine,tA;")
    x, y, _ = place(motion, fired(motion, signal)[0])
    assert 0.45 - x == pytest.approx(0.2 - y, abs=EXACT), "on the bisector"
    assert fired(motion, signal)[0] == pytest.approx(motion.record.moves[1].ends, abs=EXACT)


def test_at_a_stop_point_moveldo_acts_at_the_end(triggered):
    motion = triggered(f"MoveLDO {END},v200,fine,tA,doT,1;")
    assert fired(motion)[0] == pytest.approx(motion.record.chains[-1].end, abs=EXACT)


def test_a_delay_of_the_output_counts_after_the_place(triggered):
    motion = triggered("TriggIO t1,200\\DOp:=doT,1\\DODelay:=0.3;", f"TriggL {END},v200,t1,fine,tA;")
    assert place(motion, fired(motion)[0])[1] == pytest.approx(0.06, abs=EXACT)


def test_triggint_runs_its_trap_while_the_arm_moves_on(triggered):
    motion = triggered(
        "CONNECT i1 WITH noted;", "TriggInt t1,200,i1;", f"TriggL {END},v200,t1,fine,tA;", 'TPWrite "there";', trap='TPWrite "trap";'
    )
    trap, there = motion.run.written
    assert place(motion, trap.time)[1] == pytest.approx(0.0, abs=EXACT)
    assert (trap.text, there.text) == ("trap", "there")
    assert motion.record.planned_tcp(np.array([trap.time + 0.1]))[2][0] == pytest.approx(SPEED, rel=1e-6), "nothing slows down"


def test_triggspeed_follows_the_speed_of_the_tcp(triggered):
    motion = triggered("TriggSpeed t1,200,0,aoV,0.5;", f"TriggL {END},v200,t1,fine,tA;")
    changes = motion.run.signals["aoV"]
    begin = changes[0][0]
    assert place(motion, begin)[1] == pytest.approx(0.0, abs=EXACT)
    assert changes[0][1] == pytest.approx(100.0, rel=1e-5), "half of 200 mm/s"
    assert changes[-1][1] == pytest.approx(0.0, abs=1e-6), "it ends at rest"


def test_triggrampao_ramps_over_its_length_of_path(triggered):
    motion = triggered("TriggRampAO t1,250,0,aoV,10,100;", f"TriggL {END},v200,t1,fine,tA;")
    changes = motion.run.signals["aoV"]
    for time, value in changes:
        gone = place(motion, time)[1] + 0.05
        assert value == pytest.approx(min(10 * gone / 0.1, 10), abs=0.1)
    assert changes[-1][1] == 10


@pytest.mark.parametrize(("value", "trap"), [(1, []), (0, ["trap"])])
def test_triggcheckio_raises_only_if_the_condition_does_not_hold(triggered, value, trap):
    motion = triggered(
        "CONNECT i1 WITH noted;", f"SetDO doReady,{value};", "TriggCheckIO t1,200,doReady,EQ,1,i1;", f"TriggL {END},v200,t1,fine,tA;"
    )
    assert [line.text for line in motion.run.written] == trap


def test_triggcheckio_with_stopmove_stops_the_arm_until_startmove(triggered):
    motion = triggered(
        "CONNECT i1 WITH noted;",
        "TriggCheckIO t1,200,doReady,EQ,1\\StopMove,i1;",
        f"TriggL {END},v200,t1,fine,tA;",
        trap='TPWrite "stopped"; WaitTime 1; StartMove;',
    )
    stopped = motion.run.written[0].time
    position, _, speed = motion.record.planned_tcp(np.linspace(stopped + 0.3, stopped + 0.9, 50))
    assert speed.max() == pytest.approx(0, abs=1e-9)
    model = motion.model
    way = SPEED * (motion.record.half_filter + model.acceleration_window / 2) + SPEED**2 / model.tcp_acceleration
    assert position[0][1] == pytest.approx(way, abs=1e-5)
    assert motion.samples().path.position[-1] == pytest.approx([0.45, 0.2, 0.4], abs=EXACT)


def test_the_tool_is_at_the_place_when_the_output_fires(triggered):
    """The other views follow the plan: on a line at constant speed without any way between them."""
    motion = triggered("TriggIO t1,200\\DOp:=doT,1;", f"TriggL {END},v200,t1,fine,tA;")
    joints = motion.record.joints(np.array(fired(motion)), View.TOOL)
    tool = motion.run.planner.arm.flange(joints) * motion.record.moves[-1].move.leg.X_FT
    assert tool.translation[0][1] == pytest.approx(0.0, abs=2e-5)
