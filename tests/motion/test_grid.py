"""Grids: derivatives against closed forms and against the path itself; intervals keep to their zone."""

import numpy as np
import pytest

from mitl.motion.grid import STATIONS, cut
from mitl.motion.robot_model import load_robot_model

MODEL = load_robot_model("irb140")


def grid_of(chain):
    return cut(chain.path, np.array([move.fastest for move in chain.moves]), MODEL)


@pytest.fixture(scope="module")
def cornered(rapid, moved):
    return moved(rapid.joint(450, -150, 400), rapid.line(450, 0, 400, "z20"), rapid.line(550, 0, 450)).record.chains[-1].chain


def test_a_joint_move_has_even_rates_and_no_bend(moved, rapid):
    chain = moved(rapid.axes(0, 0, 0, 0, 30, 0), rapid.axes(20, -10, 5, 0, 60, 90)).record.chains[-1].chain
    grid = grid_of(chain)
    rate = np.radians([20, -10, 5, 0, 30, 90]) / chain.path.length
    assert grid.rate == pytest.approx(np.broadcast_to(rate, grid.rate.shape), abs=1e-8)
    assert grid.bend == pytest.approx(np.zeros_like(grid.bend), abs=1e-4)


def test_on_a_line_the_tool_travels_as_far_as_the_path(cornered):
    grid = grid_of(cornered)
    assert grid.stretch[grid.zone < 0] == pytest.approx(1, abs=1e-4)


def test_the_zone_begins_and_ends_at_nodes_on_its_radius(cornered):
    grid = grid_of(cornered)
    edges = np.flatnonzero(np.diff(grid.zone) != 0) + 1
    assert np.linalg.norm(grid.sample.position[edges] - [0.45, 0.0, 0.4], axis=1) == pytest.approx([0.02, 0.02], abs=1e-7)


def test_bends_at_the_stations_are_those_of_the_path_to_a_small_share_of_what_the_drives_can_do(cornered):
    grid = grid_of(cornered)
    step = 0.05 * grid.widths[:, None] * np.array([1.0, 1.0, -1.0])  # inside the interval
    at = grid.nodes[:-1, None] + STATIONS * grid.widths[:, None]
    q = [cornered.path.sample((at + k * step).ravel()).joints.reshape(grid.bend.shape) for k in (0, 1, 2, 3)]
    bend = (2 * q[0] - 5 * q[1] + 4 * q[2] - q[3]) / step[:, :, None] ** 2
    wrong = np.abs(grid.bend - bend) * 0.3**2 / MODEL.acceleration
    assert wrong.max() < 0.02
