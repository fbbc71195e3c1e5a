"""What drives are loaded with: falling torque, gravity, and the fitted arm's terms against differences of its own inertia."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mitl.motion.effort import AxisLimits
from mitl.motion.robot_model import load_robot_model

FITTED = load_robot_model("irb6640_180_255").effort
STEP = 1e-6
angle = st.floats(-1.0, 1.0)


def pose(lean, forearm):
    return np.array([[0.3, lean, forearm, 0.1, 0.2, 0.3]])


def swing(q):
    """Gives axis 1's effort a rad/s^2 of its own."""
    return FITTED.efforts(q, np.eye(6)[:1], np.zeros((1, 6))).along[0, 0]


def test_the_strength_is_full_at_rest_and_falls_linearly_between_two_speeds():
    slow, fast = FITTED.weakens
    shares = np.array([0.0, slow, 0.5 * (slow + fast), fast, 1.0])
    given = FITTED.available(np.repeat(shares[:, None], 6, axis=1))
    full, least = FITTED.strength, FITTED.strength * FITTED.weakest
    assert given[:, 0] == pytest.approx([full, full, 0.5 * (full + least), least, least])
    assert (given[:, 3:] == 1).all()


def test_gravity_loads_axes_2_and_3_with_the_cosine_of_the_forearm():
    lying, rising = (
        FITTED.efforts(pose(0.0, FITTED.lean + turn), np.zeros((1, 6)), np.zeros((1, 6))).resting[0] for turn in (0, np.pi / 3)
    )
    assert lying[1:3] == pytest.approx(FITTED.gravity)
    assert rising == pytest.approx(0.5 * lying)


@given(angle, angle)
def test_what_axis_1_feels_of_a_changing_reach_is_its_inertias_change(lean, forearm):
    q, rate = pose(lean, forearm), np.array([[0.7, 0.4, -0.9, 0, 0, 0]])
    change = (swing(q + STEP * rate) - swing(q - STEP * rate)) / (2 * STEP)
    found = FITTED.efforts(q, rate, np.zeros((1, 6))).across[0, 0]
    if swing(q) > FITTED.swing_least + 1e-4:
        assert found == pytest.approx(change * rate[0, 0], abs=1e-6)


@given(angle, angle)
def test_what_axis_2_feels_of_axis_1_turning_is_a_share_of_the_inertias_change_with_axis_2(lean, forearm):
    q, turn = pose(lean, forearm), np.eye(6)[:1]
    along_2 = STEP * np.eye(6)[1:2]
    change = (swing(q + along_2) - swing(q - along_2)) / (2 * STEP)
    if swing(q) > FITTED.swing_least + 1e-4:
        assert FITTED.efforts(q, turn, np.zeros((1, 6))).across[0, 1] == pytest.approx(-FITTED.fling * change, abs=1e-6)


def test_axis_limits_count_accelerations_in_units_of_the_limits():
    limits = AxisLimits(np.array([10.0, 20, 30, 40, 50, 60]))
    rate, bend = np.arange(6.0)[None], np.arange(6.0, 12)[None]
    efforts = limits.efforts(np.zeros((1, 6)), rate, bend)
    assert efforts.along == pytest.approx(rate / limits.acceleration)
    assert efforts.across == pytest.approx(bend / limits.acceleration)
    assert not efforts.resting.any()
