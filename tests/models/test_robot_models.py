"""The robot models: URDF, motion.toml and provenance.toml of each robot say the same."""

import math
import re
import tomllib

import numpy as np
import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder
from scipy.spatial.transform import Rotation

from mitl.cli import run
from mitl.motion.kinematics import Arm
from mitl.motion.robot_model import load_robot_model, robot_names
from mitl.poses import IDENTITY
from mitl.resources import models_folder
from mitl.simulation.arm import load_plant

ROBOTS = robot_names()
"""Every folder in models/ with a motion.toml: adding a robot needs no change here."""
STATUSES = {"measured", "published", "fitted", "scaled", "guess"}
EXACT = 1e-9  # m and in matrix elements: two ways to compute the same, apart from rounding


def motion(robot):
    return tomllib.loads((models_folder() / robot / "motion.toml").read_text())


def provenance(robot):
    return tomllib.loads((models_folder() / robot / "provenance.toml").read_text())["entry"]


def plant_of(robot):
    return load_plant(models_folder() / robot / "robot.urdf", IDENTITY)


def flange_in_base(robot, q, plant=None):
    """Gives X_BF and X_B tool0 from the URDF, for RAPID's joints."""
    plant = plant or plant_of(robot)
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, load_robot_model(robot).between_links(q))
    return plant.GetFrameByName("flange").CalcPoseInWorld(context), plant.GetFrameByName("tool0").CalcPoseInWorld(context)


def within_limits(robot, count):
    model = load_robot_model(robot)
    return np.random.default_rng(1).uniform(model.lower, model.upper, (count, 6))


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_urdf_has_the_same_forward_kinematics_as_the_closed_form(robot):
    arm, plant = Arm(load_robot_model(robot)), plant_of(robot)
    for q in within_limits(robot, 50):
        X_BF, X_B_tool0 = flange_in_base(robot, q, plant)
        expected = arm.flange(q)
        assert np.abs(X_BF.translation() - expected.translation).max() < EXACT
        assert np.abs(X_BF.rotation().matrix() - expected.rotation.as_matrix()).max() < EXACT
        assert X_B_tool0.IsExactlyEqualTo(X_BF)


@pytest.mark.parametrize("robot", ROBOTS)
def test_every_inverse_solution_puts_the_urdfs_flange_where_it_was_asked(robot):
    arm, plant = Arm(load_robot_model(robot)), plant_of(robot)
    for q in within_limits(robot, 30):
        X_BF = arm.flange(q)
        solutions = arm.solutions(X_BF)
        assert np.abs((solutions - q + np.pi) % (2 * np.pi) - np.pi).max(axis=1).min() < 1e-5  # near a singularity digits are lost
        for other in solutions:
            again, _ = flange_in_base(robot, other, plant)
            assert again.translation() == pytest.approx(X_BF.translation, abs=1e-7)
            assert again.rotation().matrix() == pytest.approx(X_BF.rotation.as_matrix(), abs=1e-6)


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_robots_figures_are_those_of_an_arm(robot):
    """Wrong units or a slipped column show here: no figure of a real six-axis arm lies outside these ranges."""
    model = load_robot_model(robot)
    assert np.all(model.lower < 0)
    assert np.all(model.upper > 0)
    assert np.all(np.abs([model.lower, model.upper]) <= 2 * np.pi * 1.2)
    assert np.all((model.speed > 1) & (model.speed < 12))
    time_to_full_speed = model.speed / model.acceleration
    assert np.all((time_to_full_speed > 0.02) & (time_to_full_speed < 0.5))
    assert 1 < model.vmax < 10
    assert np.all((model.controller_windows > 0.01) & (model.controller_windows < 0.15))
    assert 0.02 < model.start_latency < 0.1


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_program_runs_on_the_robot(robot, tmp_path, capsys):
    arm = Arm(load_robot_model(robot))
    start, *corners = (arm.flange(np.radians([angle, 10, 5, 0, 40, 0])) for angle in (0, 8, 16))
    w, x, y, z = start.rotation.as_quat(scalar_first=True)
    moves = ["MoveAbsJ [[0,10,5,0,40,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v200,fine,tool0;"]
    for instruction, zone, X_BF in (("MoveL", "z10", corners[0]), ("MoveJ", "fine", corners[1]), ("MoveL", "fine", start)):
        place = ",".join(f"{value:.4f}" for value in 1e3 * X_BF.translation)
        moves.append(f"{instruction} [[{place}],[{w:.8f},{x:.8f},{y:.8f},{z:.8f}],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v200,{zone},tool0;")
    file = tmp_path / "tour.mod"
    file.write_text("MODULE M\nPROC main()\nConfL\\Off;\nConfJ\\Off;\n" + "\n".join(moves) + "\nENDPROC\nENDMODULE\n")
    assert run(["oracle", str(file), "--robot", robot, "--output", str(tmp_path / "tour.csv")]) == 0
    assert "moves         4" in capsys.readouterr().out
    last = (tmp_path / "tour.csv").read_text().splitlines()[-1].split(",")
    assert np.array(last[1:4], dtype=float) == pytest.approx(1e3 * start.translation, abs=1e-3)


def test_the_forearm_on_a_parallel_rod_keeps_its_slope_when_axis_2_turns():
    upright, leant = (flange_in_base("irb2400", np.radians([0, lean, 0, 0, 0, 0]))[0] for lean in (0, 30))
    assert leant.rotation().matrix() == pytest.approx(upright.rotation().matrix())
    arm = Arm(load_robot_model("irb2400"))
    assert arm.configuration(np.radians([0, 30, 20, 0, 40, 0])).cfx == 0
    assert arm.solution_index(np.radians([0, 100, -60, 0, 40, 0])) == 2, "the wrist is behind the upper arm"


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
    plant, model = plant_of(robot), load_robot_model(robot)
    rod = np.eye(6)  # least and greatest angles between the links, and speeds, by RAPID's joints
    rod[2, 1] = -1.0 if model.parallel_rod else 0.0
    middle, half = 0.5 * (model.upper + model.lower), 0.5 * (model.upper - model.lower)
    assert plant.GetPositionLowerLimits() == pytest.approx(rod @ middle - np.abs(rod) @ half)
    assert plant.GetPositionUpperLimits() == pytest.approx(rod @ middle + np.abs(rod) @ half)
    assert plant.GetVelocityUpperLimits() == pytest.approx(np.abs(rod) @ model.speed)
    assert plant.num_actuators() == plant.num_positions() == 6
    assert all(limit > 0 for limit in plant.GetEffortUpperLimits())


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_links_weigh_what_the_robot_weighs_and_their_inertias_are_possible(robot):
    plant = plant_of(robot)
    context = plant.CreateDefaultContext()
    (mass,) = (entry["source"] for entry in provenance(robot) if "urdf.mass" in entry["covers"])
    assert plant.CalcTotalMass(context) == pytest.approx(float(re.match(r"[\d.]+(?= kg in all)", mass)[0]))
    assert np.linalg.eigvalsh(plant.CalcMassMatrix(context)).min() > 0
    for index in range(1, 7):
        assert plant.GetBodyByName(f"link_{index}").CalcSpatialInertiaInBodyFrame(context).IsPhysicallyValid()


def touching(robot, joints):
    """Gives the pairs of links that touch in any of the poses."""
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
    Parser(plant).AddModels(models_folder() / robot / "robot.urdf")
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base_link"))
    plant.Finalize()
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    pairs = set()
    for q in joints:
        plant.SetPositions(plant.GetMyMutableContextFromRoot(context), load_robot_model(robot).between_links(q))
        query = scene_graph.get_query_output_port().Eval(scene_graph.GetMyContextFromRoot(context))
        assert query.inspector().num_geometries() > 6
        for found in query.ComputePointPairPenetration():
            frames = (query.inspector().GetFrameId(geometry) for geometry in (found.id_A, found.id_B))
            pairs.add(tuple(sorted(plant.GetBodyFromFrameId(frame).name() for frame in frames)))
    return pairs


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_arm_does_not_touch_itself_at_zero_nor_wherever_the_wrist_turns(robot):
    model = load_robot_model(robot)
    wrist = [np.array([0, 0, 0, 0, angle, 0]) for angle in np.linspace(model.lower[4], model.upper[4], 25)]
    assert touching(robot, [np.zeros(6), *wrist]) == set()


@pytest.mark.parametrize("robot", ROBOTS)
def test_every_number_of_the_motion_file_has_its_provenance(robot):
    covered = [key for entry in provenance(robot) for key in entry["covers"]]
    needed = [f"{group}.{key}" for group, table in motion(robot).items() for key in table]
    assert sorted(covered) == sorted([*needed, "urdf.mass", "urdf.inertia", "urdf.effort", "urdf.shape"])
    for entry in provenance(robot):
        assert set(entry) == {"covers", "status", "source", "note"}
        assert entry["status"] in STATUSES
        assert entry["source"]


def test_the_flange_turns_about_the_tool_axis_with_j6():
    X_BF, _ = flange_in_base("irb140", np.zeros(6))
    X_BF6, _ = flange_in_base("irb140", np.radians([0, 0, 0, 0, 0, 30]))
    turn = Rotation.from_matrix(X_BF.rotation().matrix().T @ X_BF6.rotation().matrix())
    assert turn.as_rotvec(degrees=True) == pytest.approx([0, 0, 30])
