"""A zone between any two kinds of moves: where it begins and ends, that nothing jumps in it, and that the arm does not stop."""

import numpy as np
import pytest

from mitl.motion.legs import CartesianLeg, JointLeg
from mitl.motion.record import View

EXACT = 1e-6  # m
ZONE = 0.02
TILTED = "[0,0.3826834324,0.9238795325,0]"
TURNED = "[0,0.1305261922,0.9914448614,0]"


def to_middle(rapid, kind, zone="z20", **more):
    """A move to (450, 0, 400) mm from (450, -120, 400)."""
    match kind:
        case "L":
            return rapid.line(450, 0, 400, zone, **more)
        case "J":
            return rapid.joint(450, 0, 400, zone, **more)
        case "C":
            return rapid.arc((470, -60, 400), (450, 0, 400), zone, **more)
        case "AbsJ":
            return rapid.axes(0, 8, 12, 0, 60, 0, zone=zone, **more)


def from_middle(rapid, kind, **more):
    match kind:
        case "L":
            return rapid.line(350, 40, 420, **more)
        case "J":
            return rapid.joint(350, 40, 420, **more)
        case "C":
            return rapid.arc((410, 50, 400), (350, 40, 400), **more)
        case "AbsJ":
            return rapid.axes(12, 0, 10, 10, 60, 10, **more)


KINDS = ("L", "C", "J", "AbsJ")
PAIRS = [(first, second) for first in KINDS for second in KINDS]


def corner_of(rapid, moved, first, second, **more):
    motion = moved(rapid.joint(450, -120, 400), to_middle(rapid, first), from_middle(rapid, second, **more))
    return motion, motion.record.chains[-1].chain


@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_the_way_leaves_its_leg_where_the_zone_begins_and_joins_the_next_where_it_ends(rapid, moved, first, second):
    _, chain = corner_of(rapid, moved, first, second)
    path = chain.path
    (corner,) = path.corners
    assert corner.radius == pytest.approx(ZONE, rel=1e-9)
    legs = path.legs
    s = np.linspace(0, path.length, 4001)
    sample = path.sample(s)
    for index, leg in enumerate(legs):
        far = s < path.zone_begins()[1] - 1e-9 if index == 0 else s > 2 * path.leg_ends()[1] - path.zone_begins()[1] + 0.004
        here = np.flatnonzero((sample.leg == index) & far)
        assert len(here) > 100
        if isinstance(leg, JointLeg):
            way = leg.q_end - leg.q_start
            share = (sample.joints[here] - leg.q_start) @ way / (way @ way)
            off = np.abs(sample.joints[here] - leg.q_start - share[:, None] * way).max()
            assert off < 1e-6, "on the straight line in joint space"
        else:
            assert isinstance(leg, CartesianLeg)
            assert _off_curve(leg, sample.position[here]) < EXACT


def _off_curve(leg, position):
    curve = leg.curve
    if hasattr(curve, "radius"):
        return np.abs(np.linalg.norm(position - curve.centre, axis=1) - curve.radius).max()
    along = (position - curve.p_start) @ curve.direction
    return np.linalg.norm(position - curve.p_start - along[:, None] * curve.direction, axis=1).max()


@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_nothing_jumps_in_the_zone_no_limit_breaks_and_the_arm_does_not_stop(rapid, moved, first, second):
    motion, chain = corner_of(rapid, moved, first, second)
    path = chain.path
    s = np.linspace(0, path.length, 6001)
    sample = path.sample(s)
    step = np.abs(np.diff(sample.joints, axis=0))
    assert step.max() < 5e-3
    bend = np.abs(np.diff(sample.joints, 2, axis=0)).max(axis=1)
    assert bend.max() < 0.05 * step.max() + 1e-5, "the direction in joint space turns evenly"
    passing = chain.passing_times()
    assert chain.timing.at(passing[[1]])[1][0] > 0.02
    for view in View:
        worst = motion.audit(view)
        assert worst.speed <= 1
        assert worst.acceleration <= 1
        assert worst.beyond_deg <= 0


@pytest.mark.parametrize(("first", "second"), [("L", "L"), ("L", "C"), ("C", "L"), ("C", "C")])
def test_the_tool_turns_smoothly_through_a_zone_with_reorientation_on_both_sides(rapid, moved, first, second):
    motion = moved(rapid.joint(450, -120, 400), to_middle(rapid, first, rot=TILTED), from_middle(rapid, second, rot=TURNED))
    path = motion.record.chains[-1].chain.path
    rotation = path.positions(np.linspace(0, path.length, 4001))[1]
    turn = (rotation[:-1].inv() * rotation[1:]).as_rotvec()
    assert np.linalg.norm(turn, axis=1).max() < 1e-3
    assert np.abs(np.diff(turn, axis=0)).max() < 5e-5, "the turning speed does not jump"
    assert motion.audit(View.PLANNED).acceleration <= 1


@pytest.mark.parametrize("second", ["L", "J"])
def test_a_change_of_work_object_in_a_corner_changes_nothing_where_the_target_is_the_same_place(rapid, moved, irb140, second):
    shifted = r'PERS wobjdata wShift := [FALSE,TRUE,"",[[100,50,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];'
    same = "MoveL" if second == "L" else "MoveJ"
    moves = [
        f"{same} {rapid.target(350, 40, 420)},v300,fine,tA;",
        f"{same} {rapid.target(250, -10, 420)},v300,fine,tA\\WObj:=wShift;",
    ]
    ends = []
    for move in moves:
        program = rapid.program(rapid.joint(450, -120, 400), to_middle(rapid, "L"), move)
        motion = moved(program.replace("PERS tooldata tA", shifted + "\nPERS tooldata tA", 1))
        chain = motion.record.chains[-1].chain
        assert len(chain.moves) == 2
        ends.append(chain.path.sample(np.linspace(0, chain.path.length, 200)).position)
    assert ends[1] == pytest.approx(ends[0], abs=EXACT)


def test_a_change_of_tool_in_a_corner_is_passed_in_joint_space_without_a_stop(rapid, moved):
    motion = moved(rapid.joint(450, -120, 400), to_middle(rapid, "L"), from_middle(rapid, "L", tool="tB"))
    chain = motion.record.chains[-1].chain
    assert len(chain.moves) == 2
    joints = chain.path.sample(np.linspace(0, chain.path.length, 6001)).joints
    assert np.abs(np.diff(joints, 2, axis=0)).max() < 1e-4
    assert chain.timing.at(chain.passing_times()[[1]])[1][0] > 0.02


@pytest.mark.parametrize("zone", ["z1", "z10", "z50"])
def test_a_reversal_comes_to_rest_within_its_zone_and_goes_back(rapid, moved, zone):
    motion = moved(rapid.joint(450, -120, 400), rapid.line(450, 0, 400, zone), rapid.line(450, -120, 400))
    samples = motion.samples()
    position = samples.path.position[samples.move >= 1]
    assert position[:, 0] == pytest.approx(0.45, abs=2e-4)
    furthest = position[:, 1].max()
    assert -0.05 < furthest <= EXACT
    assert position[-1] == pytest.approx([0.45, -0.12, 0.4], abs=EXACT)
    assert motion.audit(View.PLANNED).acceleration <= 1


@pytest.mark.parametrize(("axis", "degrees"), [(4, 300.0), (6, 700.0)])
def test_axes_4_and_6_turn_more_than_once_and_lines_go_on_from_there(rapid, moved, axis, degrees):
    """An IRB 4600 turns axes 4 and 6 by +-400 deg; a line after that keeps the turns."""
    start = [0.0, 10.0, 10.0, 0.0, 40.0, 0.0]
    start[axis - 1] = -390.0
    end = list(start)
    end[axis - 1] += degrees
    motion = moved(
        rapid.axes(*start, tool="tool0"),
        rapid.axes(*end, tool="tool0"),
        "MoveL RelTool(CRobT(\\Tool:=tool0\\WObj:=wobj0),0,0,20),v100,fine,tool0;",
        robot="irb4600_40_255",
    )
    turned = np.degrees([executed.move.leg.q_end[axis - 1] for executed in motion.record.moves])
    assert turned[0] == pytest.approx(-390)
    assert turned[1:] == pytest.approx([degrees - 390] * 2, abs=5)
    assert motion.audit(View.PLANNED).beyond_deg <= 0
