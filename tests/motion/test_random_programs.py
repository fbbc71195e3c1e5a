"""Any valid program keeps every limit of the arm, in every view, and its lines, arcs and triggers to the micrometre and microsecond.

MITL_RANDOM_PROGRAMS sets how many are tried; 10,000 were (docs/motion_limits_and_speed.md).
"""

import os

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mitl.errors import MotionError
from mitl.motion import task_run
from mitl.motion.legs import CartesianLeg, Line
from mitl.motion.record import View

EXAMPLES = int(os.environ.get("MITL_RANDOM_PROGRAMS", "25"))
SPEEDS = ("v20", "v50", "v100", "v300", "v500", "v1000", "v2500", "vmax")
ZONES = ("fine", "z0", "z1", "z5", "z10", "z20", "z50", "z100", "z200")
STEPS_MM = (0.0, 0.001, 0.05, 1.0, 5.0, 30.0, 100.0, 250.0)
TRIGGERS = 3
DECLARED = "".join(f"VAR triggdata t{index};\n" for index in range(TRIGGERS))
ON_CURVE = 1e-7  # m; a tenth of a micrometre, by forward kinematics of joints that inverse kinematics found
ON_TIME = 1e-6  # s


@st.composite
def orientations(draw):
    """Tools that point down, tilted by up to 40 deg and turned by up to 90 deg."""
    tilt = Rotation.from_euler("xyz", [draw(st.integers(-40, 40)), draw(st.integers(-40, 40)), draw(st.integers(-90, 90))], degrees=True)
    w, x, y, z = (tilt * Rotation.from_quat([0, 1, 0, 0])).as_quat(scalar_first=True)
    return f"[{w:.9f},{x:.9f},{y:.9f},{z:.9f}]"


@st.composite
def bodies(draw):
    """Motion instructions in a box before the robot: long and tiny, turning on the spot, with two tools, straight, round and by joints."""
    place, rot, lines, triggers = np.array([430.0, 0.0, 400.0]), "[0,0,1,0]", [], 0
    for index in range(draw(st.integers(1, 8))):
        kind = draw(st.sampled_from(["MoveL", "MoveL", "MoveL", "MoveJ", "MoveC", "MoveAbsJ", "turn"]))
        speed = draw(st.sampled_from(SPEEDS))
        zone = draw(st.sampled_from(ZONES))
        tool = draw(st.sampled_from(["tA", "tA", "tA", "tB"]))
        if draw(st.integers(0, 2)) == 0 or kind == "turn":
            rot = draw(orientations())
        if kind == "MoveAbsJ":
            limits = ((-60, 60), (-30, 40), (-40, 20), (-120, 120), (20, 90), (-300, 300))
            axes = ",".join(str(draw(st.integers(*limit))) for limit in limits)
            lines.append(f"MoveAbsJ [[{axes}],noAxes],{speed},{zone},{tool};")
            continue
        way = np.zeros(3)
        if kind != "turn":
            direction = Rotation.from_euler("zy", [draw(st.integers(0, 359)), draw(st.integers(-90, 90))], degrees=True).apply([1, 0, 0])
            way = draw(st.sampled_from(STEPS_MM)) * direction
        start, place = place, np.clip(place + way, [330, -250, 250], [520, 250, 550])
        target = f"[[{place[0]:.6f},{place[1]:.6f},{place[2]:.6f}],{rot},[0,0,0,0],noAxes]"
        name, trigger = "Move", ""
        if kind != "turn" and index > 0 and triggers < TRIGGERS and draw(st.integers(0, 3)) == 0:
            name, trigger = "Trigg", f",t{triggers}"
            start_or_end = draw(st.sampled_from(["", "\\Start"]))
            lines.append(f"TriggIO t{triggers},{draw(st.sampled_from([0, 0.5, 7, 60]))}{start_or_end}\\DOp:=do{triggers},1;")
            triggers += 1
        if kind == "MoveC":
            chord = place - start
            aside = np.cross(chord, [0.3, 0.5, 0.8]) * draw(st.sampled_from([0.2, 0.5, 1.0]))
            via = 0.5 * (start + place) + aside
            over = f"[[{via[0]:.6f},{via[1]:.6f},{via[2]:.6f}],{rot},[0,0,0,0],noAxes]"
            lines.append(f"{name}C {over},{target},{speed}{trigger},{zone},{tool};")
        else:
            lines.append(f"{name}{'L' if kind == 'turn' else kind[-1]} {target},{speed}{trigger},{zone},{tool};")
        if index == 0:
            lines[-1] = f"MoveJ {target},{speed},{zone},{tool};"
    return lines


def along(leg, position):
    """Gives how far (N,) in m positions (N, 3) are along a Cartesian leg, and how far (N,) they are off its line or circle."""
    curve = leg.curve
    if isinstance(curve, Line):
        way = (position - curve.p_start) @ curve.direction
    else:
        angle = np.arctan2((position - curve.centre) @ curve.v, (position - curve.centre) @ curve.u)
        way = curve.radius * ((angle + 0.5) % (2 * np.pi) - 0.5)  # arcs turn by 240 deg at most
    return way, np.linalg.norm(position - curve.position(way), axis=1)


def assert_exact_outside_zones(motion, step=2e-3):
    """The tip of the tool, by forward kinematics of the planned joints, is on the programmed line or circle."""
    for scheduled in motion.record.chains:
        path, timing = scheduled.chain.path, scheduled.chain.timing
        if path.length == 0:
            continue
        pieces = path.pieces()
        s = timing.at(np.arange(0.0, timing.duration, step))[0]
        of = np.clip(np.searchsorted(pieces.edges, s, side="right") - 1, 0, len(pieces.leg) - 1)
        joints = path.sample(s).joints
        for index, leg in enumerate(path.legs):
            here = (pieces.leg[of] == index) & (pieces.zone[of] < 0)
            if isinstance(leg, CartesianLeg) and leg.travel > ON_CURVE and here.any():
                _, off = along(leg, (motion.run.planner.arm.flange(joints[here]) * leg.X_FT).translation)
                assert off.max() < ON_CURVE


def assert_triggers_on_time(motion, lines):
    """Outside zones an output is set when the tip, as planned, is at its distance along the line or circle."""
    for index in range(TRIGGERS):
        defined = next((line for line in lines if line.startswith(f"TriggIO t{index},")), "")
        times = [time for time, value in motion.run.signals.get(f"do{index}", []) if value]
        if not defined or not times:
            continue
        distance = 1e-3 * float(defined.split(",")[1].split("\\")[0])
        moves = [line for line in lines if not line.startswith("TriggIO")]
        move = motion.record.moves[next(number for number, line in enumerate(moves) if f",t{index}," in line)].move
        leg = move.leg
        if not isinstance(leg, CartesianLeg) or leg.travel < distance:
            continue
        scheduled = next(s for s in reversed(motion.record.chains) if s.start <= times[0] + ON_TIME and move in s.chain.moves)
        path = scheduled.chain.path
        s, speed, _ = (float(value[0]) for value in scheduled.chain.timing.at(np.array([times[0] - scheduled.start])))
        pieces = path.pieces()
        of = int(np.clip(np.searchsorted(pieces.edges, s, side="right") - 1, 0, len(pieces.leg) - 1))
        if pieces.zone[of] >= 0 or path.legs[pieces.leg[of]] is not leg:
            continue
        way, _ = along(leg, path.positions(np.array([s]))[0])
        wanted = distance if "\\Start" in defined else leg.travel - distance
        assert abs(float(way[0]) - wanted) < speed * ON_TIME + 1e-9


@pytest.mark.parametrize("look_ahead", [200, 4])
@settings(max_examples=EXAMPLES, deadline=None, derandomize=EXAMPLES <= 25, suppress_health_check=list(HealthCheck))
@given(lines=bodies())
def test_a_valid_program_exceeds_no_limit_and_runs_forwards_without_a_jump(moved, rapid, look_ahead, lines):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(task_run, "LOOK_AHEAD", look_ahead)
        try:
            motion = moved(rapid.program(*lines).replace("PROC main()", DECLARED + "PROC main()"))
        except MotionError:
            return  # unreachable, singular, or a limit: refused, as it should be
    assert_sound(motion, lines)


def assert_sound(motion, lines):
    """Asserts all that holds of any motion; `lines` are those of its program."""
    if not motion.record.chains or motion.record.end == 0:
        return
    for view in View:
        assert motion.holds(view)
    for scheduled in motion.record.chains:
        timing = scheduled.chain.timing
        assert np.all(np.diff(timing.position) >= -1e-12)  # rounding
        assert timing.speed.min() >= -1e-9
    starts, ends = [s.start for s in motion.record.chains], [s.end for s in motion.record.chains]
    assert all(end <= start + 1e-9 for end, start in zip(ends[:-1], starts[1:], strict=True))
    passed = [(executed.begins, executed.ends) for executed in motion.record.moves]
    assert all(begins <= ends + 1e-9 for begins, ends in passed)
    assert_exact_outside_zones(motion)
    assert_triggers_on_time(motion, lines)


def test_a_motion_is_taken_over_before_the_zone_at_the_end_of_a_joint_move(moved, monkeypatch):
    """The TCP is slower at the end of this joint move than on average, so that its zone takes more of the move than its radius suggests."""
    monkeypatch.setattr(task_run, "LOOK_AHEAD", 4)
    target = "[[{}],[{}],[0,0,0,0],noAxes]".format
    motion = moved(
        f"MoveJ {target('430.655959,0.017452,399.245405', '0,0,1,0')},v500,z0,tA;",
        f"MoveL {target('430.468661,-4.650450,401.027429', '0,0,1,0')},v20,z50,tA;",
        f"MoveL {target('400.242238,-96.004995,373.811436', '-0.301147288,-0.425338505,0.841190202,-0.144209958')},v20,z200,tB;",
        "MoveAbsJ [[51,5,-13,-112,53,-277],noAxes],v300,z100,tA;",
        f"MoveL {target('400.062447,-95.285656,374.482424', '-0.335426452,-0.111513891,0.924215263,0.144498770')},v300,fine,tA;",
    )
    assert len(motion.record.chains) == 2
    assert motion.holds(View.PLANNED)


def test_a_motion_is_taken_over_before_the_orientation_zone(moved, monkeypatch):
    """z5 turns the tool from 8 mm before the corner on."""
    monkeypatch.setattr(task_run, "LOOK_AHEAD", 2)
    target = "[[{}],[{}],[0,0,0,0],noAxes]".format
    motion = moved(
        f"MoveJ {target('430,0,400', '0,0,1,0')},v500,fine,tA;",
        f"MoveL {target('430,30,400', '-0.067846078,0.555472659,0.827875618,-0.038327497')},v20,z5,tA;",
        f"MoveL {target('430,30,430', '0,0,1,0')},v20,z5,tA;",
        f"MoveL {target('460,30,430', '-0.067846078,0.555472659,0.827875618,-0.038327497')},v20,z5,tA;",
        f"MoveL {target('460,60,430', '0,0,1,0')},v20,fine,tA;",
    )
    assert len(motion.record.chains) == 3
    assert motion.holds(View.PLANNED)


def test_a_tiny_arc_on_which_the_tool_turns_far_asks_no_more_of_the_drives_than_they_can(moved):
    """The path bends so suddenly that the arm, which lags, would come 9 % too hard round it (found by a random program)."""
    turned = "[0.034619878,-0.170162139,0.965037446,-0.196339088],[0,0,0,0],noAxes]"
    motion = moved(
        "MoveJ [[430,0,400],[-0.276693927,-0.360594546,0.860199180,-0.231234546],[0,0,0,0],noAxes],v2500,z20,tA;",
        f"MoveC [[429.868304,-0.436646,400.284696],{turned},[[430.109830,-0.891007,400.440505],{turned},v2500,z50,tA;",
    )
    assert motion.holds(View.TOOL)


@pytest.mark.parametrize("after", [0.0, 20.0, 60.0])
def test_an_output_is_set_on_time_where_a_new_plan_takes_over_just_behind_its_place(moved, rapid, monkeypatch, after):
    """The program knows of a new plan half a filter before that takes over; what lies between keeps its time."""
    monkeypatch.setattr(task_run, "LOOK_AHEAD", 2)
    lines = [
        rapid.joint(430, -150, 400),
        rapid.line(430, -100, 400, zone="z1", speed="v500"),
        *(line for k in range(12) for line in (
            f"TriggIO t{k % 3},{4 * k % 20 + 1}\\Start\\DOp:=do{k},1;",
            f"TriggL {rapid.target(430, -100 + 20 * (k + 1), 400 + after * (k % 2) / 10)},v500,t{k % 3},z1,tA;",
        )),
        rapid.line(430, 160, 400, speed="v500"),
    ]  # fmt: skip
    motion = moved(rapid.program(*lines).replace("PROC main()", DECLARED + "PROC main()"))
    assert len(motion.record.chains) > 4
    for k in range(12):
        (time,) = [time for time, value in motion.run.signals[f"do{k}"] if value]
        move = motion.record.moves[k + 2].move
        (way,), (off,) = along(move.leg, motion.record.planned_tcp(np.array([time]))[0])
        distance = 1e-3 * (4 * k % 20 + 1)
        if 1e-3 < distance < move.leg.travel - 1e-3:
            assert way == pytest.approx(distance, abs=1e-6)
            assert off < ON_CURVE
