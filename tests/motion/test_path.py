"""Where a path goes: exactly on its lines and circles outside zones, off them just inside, in one piece everywhere."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import RigidTransform, Rotation

from mitl.motion.kinematics import Arm
from mitl.motion.legs import CartesianLeg, JointLeg, arc_through, line_through
from mitl.motion.orientation import EvenTurn
from mitl.motion.path import Corner, Path
from mitl.motion.robot_model import load_robot_model

EXACT = 1e-9  # m: well below the micrometre that is promised
ARM = Arm(load_robot_model("irb140"))
FLANGE = RigidTransform.identity()
DOWN = Rotation.from_quat([0, 1, 0, 0])
START = np.array([0.45, 0.0, 0.4])


def leg(curve, turn=(0, 0, 0), rotation=DOWN):
    places = np.linspace(0, curve.travel, 9)
    made = CartesianLeg(curve, EvenTurn(rotation, np.array(turn, dtype=float)), FLANGE, np.zeros(1), np.zeros((1, 6)))
    marks = np.linspace(0, made.length, len(places))
    X_BT = RigidTransform.from_components(made.position(marks), made.rotation(marks))
    first = ARM.nearest(X_BT[0], np.radians([0, 0, 0, 0, 60, 0]))
    return CartesianLeg(curve, made.turn, FLANGE, marks, np.vstack([first, ARM.joints(X_BT[1:], first)]))


def corner_of(angle_deg, zone, first=0.1, second=0.1, turn_zone=None):
    """Gives a path over a corner, and the corner's point and directions."""
    u1 = np.array([0.0, 1.0, 0.0])
    u2 = Rotation.from_euler("z", -angle_deg, degrees=True).apply(u1)
    corner = START + first * u1
    legs = [leg(line_through(START, corner)), leg(line_through(corner, corner + second * u2))]
    return Path(ARM, legs, [Corner(zone, zone if turn_zone is None else turn_zone)]), corner, u1, u2


@pytest.mark.parametrize("angle_deg", [5, 30, 60, 90, 120, 150])
@pytest.mark.parametrize("zone", [0.0003, 0.001, 0.01, 0.05])
def test_the_path_leaves_the_line_at_exactly_the_radius(angle_deg, zone):
    path, corner, u1, _ = corner_of(angle_deg, zone)
    edge = 0.1 - zone
    off = np.linalg.norm(np.cross(path.positions(np.array([0, 0.5 * edge, edge - 1e-9]))[0] - START, u1), axis=1)
    assert off.max() < EXACT
    just_inside = path.positions(np.array([edge + 0.02 * zone]))[0][0]
    assert np.linalg.norm(np.cross(just_inside - START, u1)) > 1e-6 * zone, "inside it has left the line"
    assert np.linalg.norm(just_inside - corner) < zone


@settings(max_examples=40, deadline=None)
@given(st.floats(5, 140), st.floats(0.001, 0.05))
def test_a_corner_is_cut_as_deep_as_measured(angle_deg, zone):
    path, corner, u1, u2 = corner_of(angle_deg, zone)
    middle = path.positions(np.array([path.leg_ends()[1]]))[0][0]
    share = np.linalg.norm(middle - corner) / (zone * np.linalg.norm(u2 - u1))
    assert 0.2166 <= share <= 0.2171


@settings(max_examples=30, deadline=None)
@given(st.floats(0, 140), st.floats(0.0003, 0.05), st.floats(-1.5, 1.5), st.floats(-1.5, 1.5))
def test_the_path_coordinate_is_the_arc_length_and_nothing_jumps(angle_deg, zone, turn_before, turn_after):
    u1 = np.array([0.0, 1.0, 0.0])
    u2 = Rotation.from_euler("z", -angle_deg, degrees=True).apply(u1)
    corner = START + 0.1 * u1
    first = leg(line_through(START, corner), (0, 0, turn_before))
    second = leg(line_through(corner, corner + 0.1 * u2), (0, 0, turn_after), DOWN * Rotation.from_rotvec([0, 0, turn_before]))
    path = Path(ARM, [first, second], [Corner(zone, min(1.5 * zone, 0.05))])
    s = np.linspace(*np.clip(path.leg_ends()[1] + np.array([-2, 2]) * zone, 0, path.length), 4001)
    sample = path.sample(s)
    steps = np.linalg.norm(np.diff(sample.position, axis=0), axis=1) / (s[1] - s[0])
    if abs(turn_before) < 1 and abs(turn_after) < 1:  # else the coordinate is stretched beside the TCP's way
        assert steps == pytest.approx(1, abs=2e-3)
    speeds = np.diff(sample.joints, axis=0) / (s[1] - s[0])
    # the joints' rates must change gently everywhere: curvature is at most some 3 / zone, a kink would be of the order of the rate
    # itself within one step
    allowed = 0.02 * np.abs(speeds).max() + 20 * (s[1] - s[0]) / zone
    assert np.abs(np.diff(speeds, axis=0)).max() < allowed
    turned = (sample.rotation[:-1].inv() * sample.rotation[1:]).magnitude()
    assert turned.max() < 4 * 1.5 * (s[1] - s[0]) / 0.1


def test_two_zones_that_meet_in_the_middle_of_a_leg_leave_one_point_on_it():
    places = [START, START + [0, 0.05, 0], START + [-0.05, 0.05, 0], START + [-0.05, 0, 0]]
    legs = [leg(line_through(a, b)) for a, b in zip(places, places[1:], strict=False)]
    path = Path(ARM, legs, [Corner(0.025, 0.025), Corner(0.025, 0.025)])
    middle = 0.5 * (path.leg_ends()[1] + path.leg_ends()[2])
    assert path.positions(np.array([middle]))[0][0] == pytest.approx(START + [-0.025, 0.05, 0], abs=EXACT)


def test_a_line_runs_smoothly_into_an_arc_that_it_touches():
    centre, radius = START + [-0.05, 0.1, 0], 0.05
    arc = arc_through(
        centre + [radius, 0, 0],
        centre + radius * np.array([np.cos(1), np.sin(1), 0]),
        centre + radius * np.array([np.cos(2), np.sin(2), 0]),
    )
    path = Path(ARM, [leg(line_through(START, centre + [radius, 0, 0])), leg(arc)], [Corner(0.02, 0.02)])
    outside = np.linspace(path.leg_ends()[1] + 0.021, path.length, 50)
    on_arc = np.linalg.norm(path.positions(outside)[0] - centre, axis=1)
    assert on_arc == pytest.approx(radius, abs=EXACT)
    inside = np.linalg.norm(path.positions(np.linspace(path.leg_ends()[1] - 0.019, path.leg_ends()[1] + 0.019, 99))[0] - centre, axis=1)
    assert inside.min() > radius - 1e-3, "a tangent joint is hardly cut"


def test_a_corner_between_joint_legs_is_a_blend_of_joints():
    q = np.radians([[0, 0, 0, 0, 60, 0], [20, 10, 0, 0, 60, 0], [0, 20, 10, 0, 60, 30]])
    legs = [JointLeg(a, b, FLANGE, 0.2, 0.2, 1.0) for a, b in zip(q, q[1:], strict=False)]
    path = Path(ARM, legs, [Corner(0.05, 0.05)])
    joints = path.sample(np.array([0.0, 0.15 - 1e-9, 0.2, 0.25 + 1e-9, 0.4])).joints
    assert joints[0] == pytest.approx(q[0])
    assert joints[1] == pytest.approx(q[0] + 0.75 * (q[1] - q[0]), abs=1e-7)
    assert joints[3] == pytest.approx(q[1] + 0.25 * (q[2] - q[1]), abs=1e-7)
    assert joints[4] == pytest.approx(q[2])
    cut = np.linalg.norm(joints[2] - q[1]) / np.linalg.norm(0.25 * (q[2] - q[1]) - 0.25 * (q[1] - q[0]))
    assert 0.2166 <= cut <= 0.2171


def test_the_orientation_is_slerp_in_the_share_of_the_path():
    turned = leg(line_through(START, START + [0, 0.1, 0]), (0, 0.4, 0.3))
    path = Path(ARM, [turned], [])
    rotation = path.positions(np.linspace(0, path.length, 5))[1]
    assert (DOWN.inv() * rotation).as_rotvec() == pytest.approx(np.linspace(0, 1, 5)[:, None] * [0, 0.4, 0.3], abs=1e-9)


def test_a_path_to_where_the_arm_stands_has_no_length():
    assert Path(ARM, [leg(line_through(START, START))], []).length == 0
