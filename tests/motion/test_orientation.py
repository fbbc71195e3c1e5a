"""How the tool turns along lines and arcs: CirPathMode and SingArea, by RAPID and by closed form."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from mitl.errors import MotionError
from mitl.motion.orientation import even_turn, evenly, path_frame_turn, turn_through
from mitl.motion.record import View

EXACT = 1e-9
DOWN = Rotation.from_quat([0, 1, 0, 0])
TILTED = DOWN * Rotation.from_euler("x", 30, degrees=True)
SHARES = np.linspace(0, 1, 41)
Z = np.array([0.0, 0.0, 1.0])


def apart(a, b):
    return np.degrees((a.inv() * b).magnitude())


def angles_from(rotations, other):
    return np.degrees((other.inv() * rotations).magnitude())


@pytest.mark.parametrize(
    "turn",
    [
        even_turn(DOWN, TILTED, evenly),
        path_frame_turn(DOWN, TILTED, Z, 2.0, evenly),
        turn_through(DOWN, DOWN * Rotation.from_euler("y", 10, degrees=True), TILTED, 0.4, evenly),
    ],
)
def test_every_law_begins_and_ends_as_programmed(turn):
    ends = turn.rotation(np.array([0.0, 1.0]))
    assert apart(ends[0], DOWN) == pytest.approx(0, abs=1e-5)
    assert apart(ends[1], TILTED) == pytest.approx(0, abs=1e-5)


def test_a_tool_that_turns_with_the_arc_keeps_its_angle_to_the_path():
    """From 0 to 120 deg round a circle, the tool turned by as much: in the path's frame it does not turn at all."""
    end = Rotation.from_rotvec(np.radians(120) * Z) * TILTED
    turn = path_frame_turn(TILTED, end, Z, np.radians(120), evenly)
    assert np.linalg.norm(turn.relative.turn) == pytest.approx(0, abs=EXACT)
    halfway = turn.rotation(np.array([0.5]))[0]
    assert apart(halfway, Rotation.from_rotvec(np.radians(60) * Z) * TILTED) == pytest.approx(0, abs=1e-5)


@pytest.mark.parametrize("angle_deg", [30, 90, 179, 200, 239])
def test_a_tool_programmed_not_to_turn_does_not_turn_whichever_way_the_arc_goes(angle_deg):
    for axis in (Z, -Z):
        turn = path_frame_turn(TILTED, TILTED, axis, np.radians(angle_deg), evenly)
        assert angles_from(turn.rotation(SHARES), TILTED).max() == pytest.approx(0, abs=1e-4)
        assert turn.turning == pytest.approx(0, abs=1e-6)


def test_the_middle_point_is_passed_in_its_orientation_and_smoothly():
    via = DOWN * Rotation.from_euler("y", 20, degrees=True)
    turn = turn_through(DOWN, via, TILTED, 0.3, evenly)
    assert apart(turn.rotation(np.array([0.3]))[0], via) == pytest.approx(0, abs=1e-5)
    fine = turn.rotation(np.linspace(0, 1, 2001))
    speed = np.degrees((fine[:-1].inv() * fine[1:]).magnitude()) * 2000
    assert np.abs(np.diff(speed)).max() < 0.01 * speed.max(), "no jump of the turning speed at the middle point"
    assert turn.turning == pytest.approx(np.radians(speed.max()), rel=0.05)


def quaternion(rotation):
    return "[" + ",".join(f"{value:.9f}" for value in rotation.as_quat(scalar_first=True)) + "]"


def arc_in_mode(rapid, moved, mode, end=TILTED):
    """A half circle about (450, 0, 400) mm, from DOWN to `end`, with the middle point tilted the other way."""
    via = DOWN * Rotation.from_euler("x", -10, degrees=True)
    arc = f"MoveC {rapid.target(500, 50, 400, quaternion(via))},{rapid.target(450, 100, 400, quaternion(end))},v100,fine,tA;"
    return moved(rapid.joint(450, 0, 400, rot=quaternion(DOWN)), mode, arc), via


def planned_rotation(motion, share):
    path = motion.record.chains[-1].chain.path
    return path.positions(share * path.length)[1]


def test_circle_modes_lead_the_tool_over_the_middle_point_only_when_asked_to(rapid, moved):
    for mode, over_via in (("CirPathMode \\CirPointOri;", True), ("CirPathMode \\ObjectFrame;", False), ("", False)):
        motion, via = arc_in_mode(rapid, moved, mode)
        rotations = planned_rotation(motion, SHARES)
        assert apart(rotations[-1], TILTED) == pytest.approx(0, abs=1e-3)
        assert (apart(rotations[20], via) < 1e-3) == over_via, mode
        assert motion.audit(View.PLANNED).acceleration <= 1


def test_in_the_object_frame_the_tool_turns_about_one_axis_and_in_the_path_frame_it_does_not(rapid, moved):
    in_object = planned_rotation(arc_in_mode(rapid, moved, "CirPathMode \\ObjectFrame;")[0], SHARES)
    in_path = planned_rotation(arc_in_mode(rapid, moved, "")[0], SHARES)
    assert apart(in_object[20], DOWN * Rotation.from_euler("x", 15, degrees=True)) == pytest.approx(0, abs=1e-3)
    assert apart(in_path[20], DOWN * Rotation.from_euler("x", 15, degrees=True)) > 1


@pytest.mark.parametrize("mode", ["Wrist45", "Wrist46", "Wrist56"])
def test_modes_for_cutting_are_refused_at_the_arc(rapid, moved, mode):
    with pytest.raises(MotionError, match=f"CirPathMode .{mode} is not supported"):
        arc_in_mode(rapid, moved, f"CirPathMode \\{mode};")


def through_the_wrists_singularity(rapid, arm, aside_deg=5.0, zone="fine"):
    """Two lines on which axis 5 goes from 20 to -20 deg beside 0: the wrist would have to turn over."""
    start, end = np.radians([0, 0, 0, aside_deg, 20, 0]), np.radians([0, 8, -5, -aside_deg, -20, 0])
    X_end = arm.flange(end)
    middle = arm.flange(np.radians([12, 4, -2, 0, 10, 0]))
    lines = []
    for X_BF, stop in ((middle, zone), (X_end, "fine")):
        lines.append(rapid.line(*(1e3 * X_BF.translation), rot=quaternion(X_BF.rotation), tool="tool0", zone=stop))
    return rapid.axes(*np.degrees(start), tool="tool0"), lines


def axis_4_turned(motion):
    """Gives how far in deg axis 4 turned after the first move."""
    axis_4 = np.degrees(
        np.concatenate([c.chain.path.sample(np.linspace(0, c.chain.path.length, 500)).joints for c in motion.record.chains[1:]])[:, 3]
    )
    return np.ptp(axis_4)


@pytest.mark.parametrize("zone", ["fine", "z20"])
def test_with_a_joint_interpolated_wrist_the_tip_keeps_to_its_line_through_the_singularity(rapid, moved, irb140, zone):
    begin, (first, second) = through_the_wrists_singularity(rapid, irb140, zone=zone)
    free = moved(begin, first, second)
    motion = moved(begin, "SingArea \\Wrist;", first, second)
    assert axis_4_turned(free) > 100
    assert axis_4_turned(motion) == pytest.approx(10, abs=0.1)
    chains = [scheduled.chain for scheduled in motion.record.chains[1:]]
    samples = [chain.path.sample(np.linspace(0, chain.path.length, 500)) for chain in chains]
    joints = np.vstack([sample.joints for sample in samples])
    assert joints[0, 4] > 0 > joints[-1, 4]
    assert np.abs(np.diff(joints, axis=0)).max() < np.radians(2)
    for sample, chain in zip(samples, chains, strict=True):
        X_BF = irb140.flange(sample.joints)
        assert sample.position == pytest.approx(X_BF.translation, abs=EXACT), "tool0"
        for index, leg in enumerate(chain.path.legs):
            away = [corner.radius for corner in (*chain.path.corners, *chain.path.corners)]
            along = (sample.position - leg.curve.p_start) @ leg.curve.direction
            free = (sample.leg == index) & (along > max(away, default=0)) & (along < leg.travel - max(away, default=0))
            off = (sample.position - leg.curve.p_start) - along[:, None] * leg.curve.direction
            assert free.sum() > 50
            assert np.linalg.norm(off[free], axis=1).max() < EXACT
    for view in View:
        worst = motion.audit(view)
        assert worst.speed <= 1
        assert worst.acceleration <= 1


def test_a_joint_interpolated_wrist_ends_in_the_programmed_orientation(rapid, moved, irb140):
    begin, (first, _) = through_the_wrists_singularity(rapid, irb140)
    motion = moved(begin, "SingArea \\Wrist;", first)
    last = motion.samples().path
    X_end = irb140.flange(np.radians([12, 4, -2, 0, 10, 0]))
    assert last.position[-1] == pytest.approx(X_end.translation, abs=1e-7)
    assert apart(Rotation.from_quat(last.quaternion_wxyz[-1], scalar_first=True), X_end.rotation) == pytest.approx(0, abs=1e-4)


def test_an_arc_with_a_joint_interpolated_wrist_stays_on_its_circle(rapid, moved):
    motion = moved(
        rapid.joint(450, 0, 400),
        "SingArea \\Wrist;",
        rapid.arc((500, 50, 400), (450, 100, 400), "z10"),
        rapid.line(350, 100, 400),
    )
    path = motion.record.chains[-1].chain.path
    sample = path.sample(np.linspace(0, path.legs[0].length - 0.01, 300))
    assert np.linalg.norm(sample.position - [0.45, 0.05, 0.4], axis=1) == pytest.approx(0.05, abs=EXACT)
    assert motion.audit(View.PLANNED).acceleration <= 1


def test_axis_4_is_locked_where_it_can_be_and_refused_where_not(rapid, moved, irb140):
    begin, (first, _) = through_the_wrists_singularity(rapid, irb140, aside_deg=0.0)
    motion = moved(begin, "SingArea \\LockAxis4;", first)
    path = motion.record.chains[-1].chain.path
    assert np.degrees(path.sample(np.linspace(0, path.length, 100)).joints[:, 3]) == pytest.approx(0, abs=1e-5)
    turned = through_the_wrists_singularity(rapid, irb140, aside_deg=30.0)
    with pytest.raises(MotionError, match="LockAxis4 wants axis 4 at 0"):
        moved(turned[0], "SingArea \\LockAxis4;", turned[1][0])


def test_a_corner_between_interpolated_and_free_wrist_is_passed_within_limits(rapid, moved):
    motion = moved(
        rapid.joint(450, 0, 400),
        rapid.line(450, 100, 400, "z20"),
        "SingArea \\Wrist;",
        rapid.line(350, 100, 400, "z20"),
        "SingArea \\Off;",
        rapid.line(350, 0, 400),
    )
    assert len(motion.record.chains) == 2
    for view in View:
        assert motion.audit(view).acceleration <= 1


def test_the_tip_is_brought_to_a_place_with_the_wrist_given(irb140):
    random = np.random.default_rng(2)
    q = np.radians([20, 10, -5, 30, 40, 10]) + random.uniform(-0.4, 0.4, (50, 6))
    X_FT = RigidTransform.from_components([0.05, 0.02, 0.15], Rotation.from_euler("y", 40, degrees=True))
    found = irb140.joints_with_wrist((irb140.flange(q) * X_FT).translation, q[:, 3:], X_FT, q[:, :3] + 0.1)
    assert found == pytest.approx(q, abs=1e-8)
    beyond = irb140.joints_with_wrist(np.array([[2.0, 0, 0.4]]), q[:1, 3:], X_FT, q[:1, :3])
    assert np.isnan(beyond).any()
