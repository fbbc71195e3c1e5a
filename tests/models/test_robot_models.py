"""The robot models: URDF, motion.toml and provenance.toml of each robot say the same."""

import math
import tomllib

import numpy as np
import pytest
from py_opw_kinematics import KinematicModel, Robot
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder
from scipy.spatial.transform import Rotation

from mitl.poses import IDENTITY
from mitl.resources import models_folder
from mitl.simulation.arm import load_plant

ROBOTS = ["irb140", "irb6640_180_255"]
MASS_KG = {"irb140": 98.0, "irb6640_180_255": 1310.0}
STATUSES = {"measured", "published", "fitted", "scaled", "guess"}
EXACT = 1e-9  # m and in matrix elements: two ways to compute the same, apart from rounding


def motion(robot):
    return tomllib.loads((models_folder() / robot / "motion.toml").read_text())


def opw(robot):
    table = motion(robot)["opw"]
    offsets = tuple(math.radians(angle) for angle in table["offsets_deg"])
    flips = tuple(sign < 0 for sign in table["signs"])
    lengths = [table[key] for key in ("a1", "a2", "b", "c1", "c2", "c3", "c4")]
    return Robot(KinematicModel(*lengths, offsets=offsets, flip_axes=flips), degrees=False)


def flange_in_base(robot, q):
    plant = load_plant(models_folder() / robot / "robot.urdf", IDENTITY)
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, q)
    return plant.GetFrameByName("flange").CalcPoseInWorld(context), plant.GetFrameByName("tool0").CalcPoseInWorld(context)


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_urdf_has_the_same_forward_kinematics_as_the_closed_form(robot):
    joints = motion(robot)["joints"]
    lower, upper = np.radians(joints["lower_deg"]), np.radians(joints["upper_deg"])
    generator = np.random.default_rng(1)
    arm = opw(robot)
    for _ in range(50):
        q = generator.uniform(lower, upper)
        X_BF, X_B_tool0 = flange_in_base(robot, q)
        expected = arm.forward(tuple(q))
        assert np.abs(X_BF.translation() - expected.translation).max() < EXACT
        assert np.abs(X_BF.rotation().matrix() - expected.rotation.as_matrix()).max() < EXACT
        assert X_B_tool0.IsExactlyEqualTo(X_BF)


@pytest.mark.parametrize(
    ("robot", "joints_deg", "position_mm"),
    [
        ("irb140", [0, 0, 0, 0, 0, 0], [515, 0, 712]),
        ("irb6640_180_255", [0, 0, 0, 0, 0, 0], [1662.5, 0, 2055]),
        # Forearm up: the flange is c4 above the published wrist centre (70, 0, 1092).
        ("irb140", [0, 0, -90, 0, 0, 0], [70, 0, 1092 + 65]),
    ],
)
def test_the_flange_is_where_the_specification_has_it(robot, joints_deg, position_mm):
    X_BF, _ = flange_in_base(robot, np.radians(joints_deg))
    assert X_BF.translation() * 1e3 == pytest.approx(position_mm, abs=1e-6)


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_tool_axis_points_along_the_base_x_axis_at_zero(robot):
    X_BF, _ = flange_in_base(robot, np.zeros(6))
    assert X_BF.rotation().ToQuaternion().wxyz() == pytest.approx([math.sqrt(0.5), 0, math.sqrt(0.5), 0])


def test_the_irb_6640_starts_the_logged_corner_program_where_the_logs_say():
    """Real logs, so this fixes the signs of all joints: facts/motion.md, the calibration program."""
    q = np.radians([17.881572, 15.864548, 23.056389, 38.254369, -28.621519, -29.914229])
    X_BF, _ = flange_in_base("irb6640_180_255", q)
    tcp = X_BF.multiply([0.075, 0, 0.49330127019])
    assert tcp * 1e3 == pytest.approx([2200, 500, 1000], abs=1e-4)  # the log's joints have six decimals


def test_positive_j2_leans_forward_and_positive_j3_lowers_the_forearm():
    home, _ = flange_in_base("irb140", np.zeros(6))
    leant, _ = flange_in_base("irb140", np.radians([0, 10, 0, 0, 0, 0]))
    lowered, _ = flange_in_base("irb140", np.radians([0, 0, 10, 0, 0, 0]))
    assert leant.translation()[0] > home.translation()[0]
    assert lowered.translation()[2] < home.translation()[2]


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_urdf_has_the_limits_of_the_motion_file_and_an_actuator_a_joint(robot):
    joints = motion(robot)["joints"]
    plant = load_plant(models_folder() / robot / "robot.urdf", IDENTITY)
    assert np.degrees(plant.GetPositionLowerLimits()) == pytest.approx(joints["lower_deg"])
    assert np.degrees(plant.GetPositionUpperLimits()) == pytest.approx(joints["upper_deg"])
    assert np.degrees(plant.GetVelocityUpperLimits()) == pytest.approx(joints["speed_deg_s"])
    assert plant.num_actuators() == plant.num_positions() == 6
    assert all(limit > 0 for limit in plant.GetEffortUpperLimits())


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_links_weigh_what_the_robot_weighs_and_their_inertias_are_possible(robot):
    plant = load_plant(models_folder() / robot / "robot.urdf", IDENTITY)
    context = plant.CreateDefaultContext()
    assert plant.CalcTotalMass(context) == pytest.approx(MASS_KG[robot])
    assert np.linalg.eigvalsh(plant.CalcMassMatrix(context)).min() > 0
    for index in range(1, 7):
        assert plant.GetBodyByName(f"link_{index}").CalcSpatialInertiaInBodyFrame(context).IsPhysicallyValid()


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_arm_does_not_touch_itself_at_zero(robot):
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
    Parser(plant).AddModels(models_folder() / robot / "robot.urdf")
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base_link"))
    plant.Finalize()
    diagram = builder.Build()
    query = scene_graph.get_query_output_port().Eval(scene_graph.GetMyContextFromRoot(diagram.CreateDefaultContext()))
    assert query.inspector().num_geometries() > 6
    assert not query.ComputePointPairPenetration()


@pytest.mark.parametrize("robot", ROBOTS)
def test_every_number_of_the_motion_file_has_its_provenance(robot):
    provenance = tomllib.loads((models_folder() / robot / "provenance.toml").read_text())
    covered = [key for entry in provenance["entry"] for key in entry["covers"]]
    needed = [f"{group}.{key}" for group, table in motion(robot).items() for key in table]
    assert sorted(covered) == sorted([*needed, "urdf.mass", "urdf.inertia", "urdf.effort", "urdf.shape"])
    for entry in provenance["entry"]:
        assert set(entry) == {"covers", "status", "source", "note"}
        assert entry["status"] in STATUSES
        assert entry["source"]


def test_the_flange_turns_about_the_tool_axis_with_j6():
    X_BF, _ = flange_in_base("irb140", np.zeros(6))
    X_BF6, _ = flange_in_base("irb140", np.radians([0, 0, 0, 0, 0, 30]))
    turn = Rotation.from_matrix(X_BF.rotation().matrix().T @ X_BF6.rotation().matrix())
    assert turn.as_rotvec(degrees=True) == pytest.approx([0, 0, 30])
