"""Clearance of folded poses, of tools and of cells, against distances that are known."""

from itertools import pairwise

import numpy as np
import pytest

from mitl.motion.robot_model import load_robot_model, robot_names
from mitl.simulation.cell import load_cell
from mitl.simulation.clearance import TOOL_RADIUS, Clearance

NEAR = 1e-4  # m; distances of cylinders are found by iteration
ROD = np.array([0.0, 0.0, 0.2])


def touching(robot, degrees, p_FT=ROD):
    model = load_robot_model(robot)
    gaps = Clearance(model.urdf, p_FT).gaps(model.between_links(np.radians(degrees)), 0.0)
    return {gap.bodies for gap in gaps if gap.distance < 0}


@pytest.mark.parametrize(
    ("robot", "folded", "where"),
    [
        ("irb140", (0, -60, 50, 0, 100, 0), "link_1"),
        ("irb140", (0, 110, 50, 0, 0, 0), "base_link"),
        ("irb120", (0, 20, 70, 0, 60, 0), "link_1"),
        ("irb1200_5_90", (0, -20, 70, 0, 90, 0), "link_2"),
        ("irb2400", (0, -30, 65, 0, 60, 0), "link_2"),
        ("irb4600_40_255", (0, 70, 75, 0, 30, 0), "base_link"),
        ("irb6640_180_255", (0, 60, 70, 0, 60, 0), "base_link"),
    ],
)
def test_an_arm_folded_into_itself_is_found(robot, folded, where):
    model = load_robot_model(robot)
    assert np.all(np.radians(folded) <= model.upper + 1e-9)
    assert np.all(np.radians(folded) >= model.lower - 1e-9)
    assert any(where in pair for pair in touching(robot, folded)), touching(robot, folded)


@pytest.mark.parametrize("robot", robot_names())
def test_an_arm_held_out_touches_nothing(robot):
    for degrees in ((0, 0, 0, 0, 30, 0), (90, 20, 10, 40, -60, 100)):
        assert touching(robot, degrees) == set()


def test_neighbours_of_the_same_joint_never_count_but_every_other_pair_does():
    pairs = set()
    model = load_robot_model("irb140")
    scene = Clearance(model.urdf, ROD)
    for q in np.random.default_rng(3).uniform(model.lower, model.upper, (400, 6)):
        pairs |= {gap.bodies for gap in scene.gaps(q, 0.3)}
    links = ["base_link", *(f"link_{number}" for number in range(1, 7))]
    neighbours = {frozenset(pair) for pair in pairwise(links)}
    seen = {frozenset(pair) for pair in pairs}
    assert not neighbours & seen
    assert frozenset(("link_6", "tool")) not in seen
    others = {frozenset((a, b)) for index, a in enumerate(links) for b in links[index + 2 :]}
    assert others - seen == set()
    assert {frozenset(("tool", link)) for link in links[:6]} - seen == set()


def test_a_tools_tip_is_as_far_from_a_table_as_it_is(tmp_path):
    (tmp_path / "table.urdf").write_text(
        '<robot name="table"><link name="table"><collision><origin xyz="0.5 0 -0.05"/>'
        '<geometry><box size="0.6 0.6 0.1"/></geometry></collision></link></robot>'
    )
    model = load_robot_model("irb140")
    from mitl.motion.kinematics import Arm

    arm = Arm(model)
    q = np.radians([0, 20, 20, 0, 50, 0])
    scene = Clearance(model.urdf, ROD, cell=load_cell(str(tmp_path / "table.urdf")))
    tip = arm.flange(q).apply(ROD)
    assert arm.flange(q).rotation.apply([0, 0, 1]) == pytest.approx([0, 0, -1]), "it points down"
    (nearest, *_) = [gap for gap in scene.gaps(q, 1.0) if gap.with_cell]
    assert nearest.bodies == ("tool", "table")
    assert nearest.distance == pytest.approx(tip[2], abs=NEAR)


def test_a_tool_model_takes_the_place_of_the_rod(tmp_path):
    (tmp_path / "plate.urdf").write_text(
        '<robot name="plate"><link name="plate"><collision><origin xyz="0 0 0.3"/>'
        '<geometry><box size="0.5 0.5 0.01"/></geometry></collision></link></robot>'
    )
    model = load_robot_model("irb140")
    q = np.radians([0, -30, 30, 0, 100, 0])
    rod = {gap.bodies for gap in Clearance(model.urdf, ROD).gaps(q, 0.0)}
    plate = {gap.bodies for gap in Clearance(model.urdf, ROD, tool=tmp_path / "plate.urdf").gaps(q, 0.0)}
    assert not any("tool" in pair for pair in rod)
    assert any("plate" in pair for pair in plate), plate


@pytest.mark.parametrize("length", [0.0, 0.01, 0.05, 0.3])
def test_tools_of_any_length_have_a_shape_that_does_not_touch_the_wrist(length):
    model = load_robot_model("irb140")
    gaps = Clearance(model.urdf, np.array([0.0, 0.0, length])).gaps(np.radians([0, 0, 0, 0, 30, 0]), 0.1)
    assert all(gap.distance > 0 for gap in gaps)
    assert any("tool" in gap.bodies for gap in gaps) == (length > 0)
    assert TOOL_RADIUS < 0.05
