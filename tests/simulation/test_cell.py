"""Cells are read strictly, stand where they are told to, and carry their conveyors."""

import numpy as np
import pytest
from pydrake.multibody.plant import MultibodyPlant

from mitl.errors import UsageError
from mitl.resources import models_folder
from mitl.simulation.cell import cell_names, load_cell

BOX = """<robot name="block"><link name="block"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link></robot>"""
GOOD = """[cell]
description = "a block"
model = "block.urdf"
position_mm = [500, 0, 100]
roll_pitch_yaw_deg = [0, 0, 90]
[[conveyor]]
name = "belt"
unit = "CNV1"
start_mm = [100, 0, 50]
direction_deg = 90
counts_per_m = 10000
speed_m_s = 0.2
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "block.urdf").write_text(BOX)
    (tmp_path / "cell.toml").write_text(GOOD)
    return tmp_path


@pytest.mark.parametrize("name", cell_names())
def test_every_cell_of_ours_can_be_added_to_a_plant(name):
    plant = MultibodyPlant(0.0)
    cell = load_cell(name)
    instances = cell.add_to(plant)
    plant.Finalize()
    assert plant.num_positions() == 0, "nothing in a cell moves"
    assert sum(len(plant.GetBodyIndices(instance)) for instance in instances) > 1
    assert cell.description


def test_a_cell_stands_where_its_file_says(folder):
    plant = MultibodyPlant(0.0)
    load_cell(str(folder)).add_to(plant)
    plant.Finalize()
    X_WC = plant.GetFrameByName("block").CalcPoseInWorld(plant.CreateDefaultContext())
    assert X_WC.translation() == pytest.approx([0.5, 0, 0.1])
    assert X_WC.rotation().matrix() @ [1, 0, 0] == pytest.approx([0, 1, 0])


def test_a_conveyor_moves_its_frame_by_its_encoder(folder):
    (belt,) = load_cell(str(folder)).conveyors
    assert (belt.name, belt.unit, belt.speed) == ("belt", "CNV1", 0.2)
    assert belt.frame_at(0).translation == pytest.approx([0.5, 0.1, 0.15])
    way = belt.frame_at(5000).translation - belt.frame_at(0).translation
    assert way == pytest.approx([-0.5, 0, 0]), "90 deg of the cell and 90 deg of the belt"


def test_a_single_model_file_is_a_cell_too(folder):
    cell = load_cell(str(folder / "block.urdf"))
    assert (cell.name, cell.conveyors) == ("block", ())
    assert np.array_equal(cell.X_BC.translation(), np.zeros(3))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda text: text.replace("position_mm", "positon_mm"), "unknown key 'positon_mm'"),
        (lambda text: text.replace("[500, 0, 100]", "[500, 0]"), "position_mm must be a list of 3 numbers"),
        (lambda text: text.replace("block.urdf", "nothing.urdf"), "model must be a .urdf or .sdf file in the same folder"),
        (lambda text: text.replace("10000", "0"), "counts_per_m must be positive"),
        (lambda text: text.replace("10000", '"many"'), "counts_per_m must be a number"),
        (lambda text: text.replace("unit =", "device ="), "unknown key 'device'"),
        (lambda text: text.replace("[cell]", "[sell]"), "section .cell."),
        (lambda text: text + "=", "not valid TOML"),
    ],
)
def test_a_bad_cell_file_is_refused_with_file_and_key(folder, change, said):
    (folder / "cell.toml").write_text(change(GOOD))
    with pytest.raises(UsageError, match=said) as refused:
        load_cell(str(folder))
    assert "cell.toml" in str(refused.value)


@pytest.mark.parametrize("name", ["nowhere", "nowhere.urdf"])
def test_a_cell_that_is_not_there_is_refused(name):
    with pytest.raises(UsageError, match="no cell 'nowhere"):
        load_cell(name)


def test_a_broken_model_is_refused(folder):
    (folder / "block.urdf").write_text("<robot")
    with pytest.raises(UsageError, match="cannot read cell model"):
        load_cell(str(folder)).add_to(MultibodyPlant(0.0))


def test_bench_is_the_folder_that_comes_with_mitl():
    assert (models_folder() / "cells" / "bench" / "cell.urdf").is_file()


def test_meshcat_shows_the_cell_around_the_robot():
    from mitl.motion.robot_model import load_robot_model
    from mitl.simulation.meshcat_replay import Animation, open_meshcat, publish

    meshcat = open_meshcat(None)
    still = Animation(np.array([0.0, 0.1]), [], [], load_robot_model("irb140").urdf, np.zeros((2, 6)), None, load_cell("bench"))
    publish(meshcat, still)
    for body in ("table", "fence", "belt"):
        assert meshcat.HasPath(f"visualizer/bench/{body}") or meshcat.HasPath(f"visualizer/cell/bench/{body}"), body


SDF = (
    '<sdf version="1.9"><model name="a"><static>{}</static><link name="wall"><pose>0.5 0 0.2 0 0 0</pose>'
    '<collision name="c"><geometry><box><size>0.1 1 0.1</size></box></geometry></collision></link></model></sdf>'
)


@pytest.mark.parametrize("static", ["true", "false"])
def test_an_sdf_keeps_the_poses_that_it_gives(tmp_path, static):
    (tmp_path / "wall.sdf").write_text(SDF.format(static))
    plant = MultibodyPlant(0.0)
    load_cell(str(tmp_path / "wall.sdf")).add_to(plant)
    plant.Finalize()
    assert plant.num_positions() == 0
    assert plant.GetFrameByName("wall").CalcPoseInWorld(plant.CreateDefaultContext()).translation() == pytest.approx([0.5, 0, 0.2])


def test_an_sdf_is_placed_unless_it_is_static(folder):
    (folder / "cell.toml").write_text(GOOD.replace("block.urdf", "wall.sdf"))
    (folder / "wall.sdf").write_text(SDF.format("false"))
    plant = MultibodyPlant(0.0)
    load_cell(str(folder)).add_to(plant)
    plant.Finalize()
    place = plant.GetFrameByName("wall").CalcPoseInWorld(plant.CreateDefaultContext()).translation()
    assert place == pytest.approx([0.5, 0.5, 0.3]), "turned by 90 deg and shifted"
    (folder / "wall.sdf").write_text(SDF.format("true"))
    with pytest.raises(UsageError, match="static model cannot be placed"):
        load_cell(str(folder)).add_to(MultibodyPlant(0.0))
