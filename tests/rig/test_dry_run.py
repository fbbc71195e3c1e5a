"""A dry run does everything to a rig but move it, and finds what would have kept the run."""

import json

import pytest

from mitl.cli import run
from mitl.controllers.virtual import start
from mitl.controllers.virtual.server import Pace
from mitl.rig.dry_run import dry_run
from mitl.rig.order_spy import Told
from mitl.rig.physical_config import read_physical

from ..controllers.served import Served
from .test_guarded import PROGRAM

OWN = 'MODULE Own\n  PROC main()\n    TPWrite "mine";\n  ENDPROC\nENDMODULE\n'


@pytest.fixture
def cell(tmp_path, monkeypatch):
    monkeypatch.setenv("MITL_RWS_PASSWORD", "robotics")
    monkeypatch.setenv("VR_OVERRIDE", str(tmp_path))  # no SteamVR here: the tracker is missing, which is told
    made = start.virtual_cell("irb140")
    (tmp_path / "own.mod").write_text(OWN, encoding="utf-8")
    start.load_at_start(made, tmp_path / "own.mod")
    served = Served("1", tmp_path / "disk", pace=Pace.REALTIME, cell=made)
    (tmp_path / "cell.toml").write_text(
        f'[rig]\nkind = "physical"\nrobot = "irb140"\n[controller]\naddress = "{served.address}"\n'
        "[safety]\nworkspace_mm = [[0, -260, 0], [1000, 260, 1500]]\n"
    )
    (tmp_path / "guarded.mod").write_text(PROGRAM, encoding="utf-8")
    yield made
    served.close()


def findings(tmp_path, *writes):
    told = [Told((tmp_path / "guarded.mod",), list(writes), started=True)]
    return {one.what: one for one in dry_run(read_physical(tmp_path / "cell.toml"), told, tmp_path, 0.5)}


def test_programs_go_onto_the_controller_and_orders_are_flown_but_nothing_moves(cell, tmp_path):
    found = findings(tmp_path, ("option", "1"))
    assert found["guarded.mod"].told == "loaded and linked, 1 tools and work objects agree"
    assert found["guarded.mod, orders"].told.startswith("1 orders pre-flown: 0.2 m")
    assert found["tracker"].state.value == "bad"
    assert [module.name for module in cell.memory.modules()] == ["Own"], "the controller's own program is back"
    assert not cell.controller.joints_at(cell.clock.now())[0]


@pytest.mark.parametrize(("writes", "said"), [([("option", "3")], "leave the workspace"), ([("angle", "999"), ("option", "1")], "limit")])
def test_an_order_that_cannot_be_flown_is_found(cell, tmp_path, writes, said):
    found = findings(tmp_path, *writes)
    assert said in found["guarded.mod, orders"].told
    assert found["guarded.mod, orders"].state.value == "bad"


def test_the_command_learns_the_orders_from_the_simulated_rig(cell, tmp_path, capsys):
    assert run(["rig", "dry-run", "--rig", str(tmp_path / "cell.toml"), "--format", "json", "--seconds", "0.5", "atc-1/direction"]) == 4
    found = {one["what"]: one for one in json.loads(capsys.readouterr().out)}
    assert {"calibration.mod", "calibration.mod, orders"} <= set(found)
    assert "pre-flown" in found["calibration.mod, orders"]["told"] or "workspace" in found["calibration.mod, orders"]["told"]
    assert {"atc_1.mod", "atc_1.mod, orders"} <= set(found)
    assert [module.name for module in cell.memory.modules()] == ["Own"]


def test_a_simulated_rig_needs_no_rehearsal(tmp_path, capsys):
    (tmp_path / "sim.toml").write_text('[rig]\nkind = "simulation"\n')
    assert run(["rig", "dry-run", "--rig", str(tmp_path / "sim.toml")]) == 2
    assert "physical" in capsys.readouterr().err
