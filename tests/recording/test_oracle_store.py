"""Stored oracles: written whole, read only as the index says, and what the planner makes today is what was blessed."""

from pathlib import Path

import numpy as np
import pytest

import mitl.atc
from mitl.errors import UsageError
from mitl.metrics.path import nearest_distance
from mitl.metrics.programmed import programmed_path
from mitl.motion.oracles import PlannedOracles
from mitl.motion.orders import Order, orders_of
from mitl.motion.robot_model import load_robot_model
from mitl.paths import PosePath
from mitl.protocols import ProgrammedMove
from mitl.recording.oracle_store import INDEX, Entry, Kind, difference, read_index, read_oracles, remove_oracles, thinned, write_oracles
from mitl.resources import oracles_folder
from mitl.simulation.cell import load_cell

ATC = Path(mitl.atc.__file__).parent
PROGRAMS = sorted(ATC.glob("*.mod"))
STORED = read_index(oracles_folder())
PLANNED = {entry.program: entry for entry in STORED if entry.kind is Kind.REGRESSION}
REFUSED = {"4.2", "7.2"}  # of ATC-5: beyond an axis limit, and a line to another configuration, which a controller must refuse
SAME, SAME_TIME = 2e-5, 1e-3  # m, s: rounding on another processor, with room
ROUNDED = 0.5e-3  # m: by so much the filters round lines' ends and circles at 200 mm/s (motion.md: .1 mm at 300)
SETTLES = 15  # samples at the end of which the arm still comes to its stop
ROTATION = np.array([0.0, 0.0, 1.0, 0.0])
ENTRY = Entry("a.mcap", "a.mod", "0" * 64, "irb140", Kind.REGRESSION, "a test", "to see", "2026-01-01", "", ())


def path_of(points, rate=250.0):
    points = np.asarray(points, dtype=float)
    return PosePath(np.arange(len(points)) / rate, points, np.tile(ROTATION, (len(points), 1)), np.ones(len(points), dtype=bool))


@pytest.fixture(scope="module")
def source():
    return PlannedOracles(load_robot_model("irb140"), load_cell("line").conveyors)


def test_the_index_names_every_file_and_every_file_is_as_it_says():
    assert {entry.file for entry in STORED} == {file.name for file in oracles_folder().glob("*.mcap")}
    for entry in STORED:
        assert set(read_oracles(oracles_folder(), entry)) == set(entry.orders)
        assert entry.reason
        assert entry.source
    assert {entry.kind for entry in STORED} == {Kind.INDEPENDENT, Kind.REGRESSION}


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda program: program.stem)
def test_every_order_of_every_program_is_stored(program):
    refused = REFUSED if program.name == "atc_5.mod" else set()
    assert set(PLANNED[program.name].orders) == {str(order) for order in orders_of(program)} - refused


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda program: program.stem)
def test_the_planner_makes_what_was_blessed(program, source):
    stored = read_oracles(oracles_folder(), PLANNED[program.name])
    few = [order for order, path in stored.items() if path.time[-1] < 30][:: max(1, len(stored) // 8)]
    for order in few:
        option, _, sub = order.partition(".")
        found = difference(stored[order], source.oracle([program], {"option": option, "subOption": sub}).tcp)
        assert found.distance < SAME, f"{program.name} {order}: if this is meant, mitl oracle bless"
        assert abs(found.longer) < SAME_TIME


def test_the_planner_keeps_to_lines_and_circles_in_closed_form(source):
    (entry,) = (entry for entry in STORED if entry.kind is Kind.INDEPENDENT)
    for order, exact in read_oracles(oracles_folder(), entry).items():
        option, _, sub = order.partition(".")
        oracle = source.oracle([ATC / entry.program], {"option": option, "subOption": sub})
        chosen = [move for move in oracle.moves if move.kind in ("MoveL", "MoveC")]
        planned = oracle.tcp.between(chosen[0].begins + 0.05, chosen[-1].ends)
        assert nearest_distance(exact.position, planned.position[:-SETTLES]).max() < ROUNDED
        assert nearest_distance(oracle.tcp.position, exact.position).max() < ROUNDED


def test_a_program_names_its_orders(tmp_path):
    text = (
        "MODULE M\nVAR num option; VAR num subOption;\nCONST num many{3} := [1,2,3];\n"
        'PROC main()\nTEST option\nCASE 1: inner;\nCASE 2,3: IF subOption = 4 TPWrite "";\n'
        "CASE 5: TPWrite NumToStr(many{subOption},0);\nCASE 6: WaitTime 1;\nDEFAULT: WaitTime 0.1;\nENDTEST\nENDPROC\n"
        "PROC inner()\nTEST subOption\nCASE 7: WaitTime 1;\nCASE 8,9: inner;\nENDTEST\nENDPROC\nENDMODULE\n"
    )
    (tmp_path / "m.mod").write_text(text)
    expected = ["1.7", "1.8", "1.9", "2.1", "2.4", "3.1", "3.4", "5.1", "5.2", "5.3", "6.0"]
    assert [str(order) for order in orders_of(tmp_path / "m.mod")] == expected
    assert Order(1, 2) < Order(2, 1)


def test_what_was_written_is_read_again(tmp_path):
    path = path_of([[0, 0, 0], [0.1, 0, 0], [0.2, 0, 0]])
    made = write_oracles(tmp_path, ENTRY, {"1.0": path, "2.1": path})
    assert read_index(tmp_path) == (made,)
    assert made.orders == ("1.0", "2.1")
    again = read_oracles(tmp_path, made)["2.1"]
    assert again.position == pytest.approx(path.position)
    remove_oracles(tmp_path, made)
    assert read_index(tmp_path) == ()
    assert not (tmp_path / "a.mcap").exists()


def test_a_file_that_somebody_else_wrote_is_refused(tmp_path):
    made = write_oracles(tmp_path, ENTRY, {"1.0": path_of([[0, 0, 0], [0.1, 0, 0]])})
    with (tmp_path / "a.mcap").open("ab") as file:
        file.write(b"x")
    with pytest.raises(UsageError, match="another hash"):
        read_oracles(tmp_path, made)
    (tmp_path / "a.mcap").unlink()
    with pytest.raises(UsageError, match="missing"):
        read_oracles(tmp_path, made)


@pytest.mark.parametrize("text", ["", "[]", '{"schema": 1, "oracles": [{"file": "a"}]}', '{"schema": 1, "oracles": 3}', '{"schema": 9}'])
def test_a_broken_index_is_told(tmp_path, text):
    (tmp_path / INDEX).write_text(text)
    with pytest.raises(UsageError, match=r"index\.json"):
        read_index(tmp_path)


def test_a_difference_is_the_largest_one_at_the_same_time():
    stored = path_of(np.linspace([0, 0, 0], [1, 0, 0], 251))
    late = path_of(np.linspace([-0.004, 0, 0], [1, 0, 0], 252))
    assert difference(thinned(stored), stored).distance == pytest.approx(0.0, abs=1e-12)
    found = difference(thinned(stored), late)
    assert found.distance == pytest.approx(0.004, abs=1e-5)
    assert found.longer == pytest.approx(0.004)


def test_a_thinned_path_keeps_its_ends():
    path = path_of(np.linspace([0, 0, 0], [1, 0, 0], 258))
    assert thinned(path).time[[0, -1]] == pytest.approx(path.time[[0, -1]])
    assert len(thinned(path)) == 27


def move(kind, start, end, via=None):
    poses = [None if place is None else np.concatenate([place, ROTATION]) for place in (start, via, end)]
    return ProgrammedMove(kind, poses[0], poses[1], poses[2], 0.2, 0.0, "M", 1, 0.0, 1.0)


def test_lines_and_circles_have_the_length_that_geometry_says():
    half = move("MoveC", [0.1, 0, 0], [-0.1, 0, 0], [0, -0.1, 0])
    path = programmed_path([move("MoveL", [0.4, 0, 0], [0.1, 0, 0]), half])
    assert path.time[-1] == pytest.approx((0.3 + np.pi * 0.1) / 0.2, rel=1e-4), "a polygon in the circle is a little shorter"
    arc = path.position[path.position[:, 0] < 0.1 - 1e-9]
    assert np.linalg.norm(arc, axis=1) == pytest.approx(np.full(len(arc), 0.1))
    assert arc[:-1, 1].max() < 0, "over the middle point"
    with pytest.raises(ValueError, match="lines and circles"):
        programmed_path([move("MoveJ", [0, 0, 0], [1, 0, 0])])
