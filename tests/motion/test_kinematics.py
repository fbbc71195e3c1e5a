"""Forward and inverse kinematics agree, and configurations are ABB's."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from mitl.motion.kinematics import CONFIGURATION_TOLERANCE, Arm, Configuration
from mitl.motion.robot_model import load_robot_model

ARMS = {name: Arm(load_robot_model(name)) for name in ("irb140", "irb6640_180_255")}
ROUNDING = 1e-9  # m and rad: two closed forms, one after the other
CLEAR = np.radians(2)


@st.composite
def joints(draw, name):
    """Joints within the limits and not at a singularity, where two solutions become one."""
    model = ARMS[name].model
    share = np.array([draw(st.floats(0.02, 0.98)) for _ in range(6)])
    q = model.lower + share * (model.upper - model.lower)
    around = [q + CLEAR * sign * np.eye(6)[axis] for sign in (-1, 1) for axis in (1, 2, 4)]
    assume(len({ARMS[name].solution_index(other) for other in around}) == 1)
    return q


@pytest.mark.parametrize("name", ARMS)
@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_every_solution_has_the_pose_and_one_of_them_is_where_the_arm_was(name, data):
    arm = ARMS[name]
    q = data.draw(joints(name))
    X_BF = arm.flange(q)
    solutions = arm.solutions(X_BF)
    for other in solutions:
        again = arm.flange(other)
        assert again.translation == pytest.approx(X_BF.translation, abs=ROUNDING)
        assert (again.rotation.inv() * X_BF.rotation).magnitude() < 1e-7  # acos near 1 halves the digits
    differences = (solutions - q + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(differences).max(axis=1).min() < 1e-6


@pytest.mark.parametrize("name", ARMS)
@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_the_joints_in_their_own_configuration_are_found_again(name, data):
    arm = ARMS[name]
    q = data.draw(joints(name))
    wanted = arm.configuration(q)
    assert arm.matches(q, wanted)
    found = arm.configured(arm.flange(q), wanted)
    assert found is not None
    assert arm.solution_index(found) == wanted.cfx
    assert found[[1, 2, 4]] == pytest.approx(q[[1, 2, 4]], abs=1e-6)


@pytest.mark.parametrize(
    ("name", "degrees", "point", "tcp_mm"),
    [
        ("irb140", (0, 0, 0, 0, 0, 0), (0, 0, 0), (515, 0, 712)),
        ("irb140", (0, 0, -90, 0, 0, 0), (0, 0, -65), (70, 0, 1092)),  # the published wrist centre
        ("irb140", (90, 0, 0, 0, 0, 0), (0, 0, 0), (0, 515, 712)),
        (
            "irb6640_180_255",
            (17.881572, 15.864548, 23.056389, 38.254369, -28.621519, -29.914229),
            (75, 0, 493.30127019),
            (2200, 500, 1000),  # from a controller's log: facts/motion.md
        ),
    ],
)
def test_known_poses(name, degrees, point, tcp_mm):
    X_BF = ARMS[name].flange(np.radians(degrees))
    assert 1e3 * X_BF.apply(np.array(point) * 1e-3) == pytest.approx(tcp_mm, abs=1e-4)  # logged joints have six decimals


@pytest.mark.parametrize(
    ("degrees", "cfx"),
    [
        ((0, 0, 0, 0, 30, 0), 0),
        ((0, 0, 0, 0, -30, 0), 1),
        ((0, 90, -200, 0, 30, 0), 2),  # forearm folded over: wrist behind the lower arm
        ((0, 90, -200, 0, -30, 0), 3),
        ((0, -85, -60, 0, 30, 0), 4),  # leant back: wrist behind axis 1
        ((0, -85, -60, 0, -30, 0), 5),
        ((0, -60, -150, 0, 30, 0), 6),
        ((0, -60, -150, 0, -30, 0), 7),
    ],
)
def test_cfx_counts_wrist_behind_axis_1_behind_the_lower_arm_and_axis_5_negative(irb140, degrees, cfx):
    assert irb140.solution_index(np.radians(degrees)) == cfx


@pytest.mark.parametrize(("angle", "quarter"), [(0, 0), (45, 0), (90, 1), (-1, -1), (-90, -1), (-91, -2), (200, 2), (-271, -4), (360, 4)])
def test_a_configuration_counts_quarter_turns(irb140, angle, quarter):
    q = np.radians([0, 0, 0, 0, 30, angle])
    assert irb140.configuration(q) == Configuration(0, 0, quarter, 0)


def test_a_configuration_is_matched_up_to_a_quarter_turn_outside(irb140):
    wanted = Configuration(0, 0, 0, 0)
    just, beyond = np.pi / 2 + CONFIGURATION_TOLERANCE - 1e-4, np.pi / 2 + CONFIGURATION_TOLERANCE + 1e-4
    assert irb140.matches(np.array([0, 0, 0, 0, 0.5, just]), wanted)
    assert not irb140.matches(np.array([0, 0, 0, 0, 0.5, beyond]), wanted)
    assert not irb140.matches(np.array([0, 0, 0, 0, -0.5, 0]), wanted), "cfx must fit exactly"


def test_axis_6_is_turned_as_configured_or_as_near_as_asked(irb140):
    q = np.radians([10, 10, 10, 20, 40, 30])
    X_BF = irb140.flange(q)
    turned = irb140.configured(X_BF, Configuration(0, 0, 4, 0))
    assert np.degrees(turned) == pytest.approx([10, 10, 10, 20, 40, 390], abs=1e-6)
    assert np.degrees(irb140.nearest(X_BF, np.radians([10, 10, 10, 20, 40, -300]))) == pytest.approx([10, 10, 10, 20, 40, -330], abs=1e-6)


def test_beyond_the_limits_there_are_no_joints(irb140):
    q = np.radians([0, 0, 0, 190, 40, 30])
    assert irb140.configured(irb140.flange(q), Configuration(0, 2, 0, 0)) is not None, "190 deg is in reach of axis 4"
    assert irb140.configured(irb140.flange(q), Configuration(0, 4, 0, 0)) is None
    assert irb140.within_limits(q)
    assert not irb140.within_limits(np.radians([0, 111, 0, 0, 0, 0]))


def test_a_batch_of_poses_is_followed_without_a_jump_over_half_a_turn(irb140):
    way = np.radians(np.linspace([0, 0, 0, -150, 40, -390], [60, 40, 20, 150, 80, 390], 400))
    found = irb140.joints(irb140.flange(way), way[0])
    assert found == pytest.approx(way, abs=1e-6)


def test_a_pose_out_of_reach_is_nan(irb140):
    far = irb140.flange(np.radians([[0, 0, 0, 0, 30, 0]] * 2))
    moved = type(far).from_components(far.translation + [[0, 0, 0], [5, 0, 0]], far.rotation)
    found = irb140.joints(moved, np.radians([0, 0, 0, 0, 30, 0]))
    assert np.isfinite(found[0]).all()
    assert np.isnan(found[1]).all()
    assert len(irb140.solutions(moved[1])) == 0
