"""The closed form of a known solution gives what the library gives, or nothing."""

import numpy as np
import pytest
from py_opw_kinematics import KinematicModel, Robot

from mitl.motion.closed_form import ClosedForm
from mitl.motion.kinematics import Arm
from mitl.motion.robot_model import load_robot_model, robot_names

WINDOW = 0.02
CLOSE = 1e-12  # rad


def straight(rng, model, count=20, size=0.02):
    """Gives joints on a short straight way from anywhere within the limits."""
    start = rng.uniform(model.lower, model.upper)
    return start + np.linspace(0.0, 1.0, count)[:, None] * rng.normal(scale=size, size=6)


@pytest.mark.parametrize("name", robot_names())
def test_it_follows_any_way_that_stays_in_one_solution(name):
    model = load_robot_model(name)
    arm, form, rng = Arm(model), ClosedForm(model.opw), np.random.default_rng(1)
    followed = 0
    for _ in range(200):
        q = straight(rng, model)
        X_BF = arm.flange(q)
        found = form.joints(X_BF.translation, X_BF.rotation.as_matrix(), model.between_links(q[0]), WINDOW)
        if found is not None:
            followed += 1
            np.testing.assert_allclose(model.from_links(found), q, atol=CLOSE)
    assert followed > 150


def test_an_elbow_to_either_side_and_a_wrist_behind_axis_1_are_followed():
    form = ClosedForm(load_robot_model("irb6640_180_255").opw)
    arm = Arm(load_robot_model("irb6640_180_255"))
    for degrees in ([10, -60, -170, 20, 40, 0], [10, 80, 60, 20, -40, 0], [10, -65, -20, 200, 40, 300]):
        q = np.radians(degrees) + np.linspace(0, 0.01, 5)[:, None]
        X_BF = arm.flange(q)
        np.testing.assert_allclose(form.joints(X_BF.translation, X_BF.rotation.as_matrix(), q[0], WINDOW), q, atol=CLOSE)


@pytest.mark.parametrize(
    "degrees",
    [[0, 0, 0, 10, 0.5, 0], [0, 30, -89.5, 0, 50, 0], [0, -62, 12.71, 0, 40, 0]],
    ids=["wrist straight", "elbow stretched", "wrist over axis 1"],
)
def test_near_a_singularity_it_leaves_it_to_the_library(degrees):
    model = load_robot_model("irb140")
    arm, form, q = Arm(model), ClosedForm(model.opw), np.radians([degrees])
    X_BF = arm.flange(q)
    assert form.joints(X_BF.translation, X_BF.rotation.as_matrix(), q[0], WINDOW) is None


def test_out_of_reach_and_a_jump_give_nothing():
    model = load_robot_model("irb140")
    arm, form, q = Arm(model), ClosedForm(model.opw), np.radians([[10, 20, 10, 30, 40, 50], [60, 20, 10, 30, 40, 50]])
    X_BF = arm.flange(q)
    assert form.joints(X_BF.translation, X_BF.rotation.as_matrix(), q[0], WINDOW) is None
    assert form.joints(np.array([[2.0, 0.0, 0.5]]), np.eye(3)[None], q[0], WINDOW) is None


def test_the_arm_gives_the_library_s_joints_with_and_without_it():
    model = load_robot_model("irb140")
    arm, opw = Arm(model), model.opw
    library = Robot(
        KinematicModel(opw.a1, opw.a2, opw.b, opw.c1, opw.c2, opw.c3, opw.c4, offsets=tuple(opw.offsets.tolist()), flip_axes=(False,) * 6),
        degrees=False,
    )
    q = np.radians([10, 20, 10, 30, 40, 350]) + np.linspace(0, 0.2, 30)[:, None] * np.array([1, -1, 1, 0.5, 0.5, 1])
    X_BF = arm.flange(q)
    np.testing.assert_allclose(arm.joints(X_BF, q[0]), q, atol=CLOSE)
    theirs = np.asarray(library.batch_inverse(X_BF, tuple(q[0])))
    np.testing.assert_allclose((theirs - q + np.pi) % (2 * np.pi) - np.pi, 0, atol=1e-9)


@pytest.mark.parametrize("name", robot_names())
def test_forward_kinematics_are_the_library_s(name):
    model = load_robot_model(name)
    arm, q = Arm(model), np.random.default_rng(2).uniform(model.lower, model.upper, (200, 6))
    X_BF, (position, R_BF) = arm.flange(q), arm.flange_places(q)
    np.testing.assert_allclose(position, X_BF.translation, atol=CLOSE)
    np.testing.assert_allclose(R_BF, X_BF.rotation.as_matrix(), atol=CLOSE)
