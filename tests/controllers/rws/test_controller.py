"""What the RWS controller does beyond the contract: it leaves a controller as it found it."""

import pytest

from mitl.controllers.rws.controller import RwsController
from mitl.controllers.virtual import start
from mitl.errors import RigError
from mitl.protocols import ExecutionState

from ..served import Served, remote, transport_to

THEIRS = "MODULE Theirs\n  PERS num precious := 5;\n  PROC main()\n    WaitTime 1000;\n  ENDPROC\nENDMODULE\n"
OURS = 'MODULE Ours\n  PERS num count := 0;\n  PERS string text := "";\n  PROC main()\n    WaitTime 1000;\n  ENDPROC\nENDMODULE\n'


@pytest.mark.parametrize("generation", ["1", "2", "8"])
def test_at_the_end_the_program_and_the_speed_are_those_that_were_found(generation, tmp_path):
    (tmp_path / "theirs.mod").write_text(THEIRS)
    (tmp_path / "ours.mod").write_text(OURS)
    cell = start.virtual_cell("irb140")
    start.load_at_start(cell, tmp_path / "theirs.mod")
    cell.set_speed_ratio("80")
    served = Served(generation, tmp_path / "disk", cell=cell)
    controller = RwsController(transport_to(served), served)
    controller.load([tmp_path / "ours.mod"])
    controller.set_speed_ratio(50)
    controller.start()
    assert [module.name for module in cell.memory.modules()] == ["Ours"]
    controller.close()
    served.wait(1.0)
    assert [module.name for module in cell.memory.modules()] == ["Theirs"]
    assert cell.speed_ratio == 80
    assert not cell.running
    assert list((tmp_path / "disk" / "HOME").iterdir()) == [], "nothing of ours is left on its disk"
    served.close()


def test_it_never_switches_the_motors_on_by_itself(tmp_path):
    (tmp_path / "ours.mod").write_text(OURS)
    with remote("1", tmp_path / "disk") as rig:
        rig.controller.set_motors(False)
        rig.controller.load([tmp_path / "ours.mod"])
        with pytest.raises(RigError, match="motors"):
            rig.controller.start()
        assert rig.controller.controller_state() == "motoroff"
        assert rig.controller.state() is ExecutionState.STOPPED


@pytest.mark.parametrize("generation", ["1", "2", "8"])
def test_texts_keep_their_spaces_brackets_and_quotes(generation, tmp_path):
    (tmp_path / "ours.mod").write_text(OURS)
    with remote(generation, tmp_path / "disk") as rig:
        rig.controller.load([tmp_path / "ours.mod"])
        rig.controller.write("text", '"a [b], ""c""; & + % é"')
        assert rig.controller.read("text") == '"a [b], ""c""; & + % é"'
        rig.controller.write("Ours:count", "3")
        assert rig.controller.read("Ours:count") == "3"


def test_two_files_of_one_name_are_refused_before_anything_is_sent(tmp_path):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "ours.mod").write_text(OURS)
    with remote("1", tmp_path / "disk") as rig, pytest.raises(RigError, match=r"two files are called ours\.mod"):
        rig.controller.load([tmp_path / "a" / "ours.mod", tmp_path / "b" / "ours.mod"])


def test_it_tells_version_options_mode_and_state(tmp_path):
    with remote("1", tmp_path / "disk") as rig:
        version, options = rig.controller.system()
        assert version.startswith("6.")
        assert any("689-1" in option for option in options)
        assert rig.controller.identity() == "virtual"
        assert (rig.controller.mode(), rig.controller.controller_state(), rig.controller.speed_ratio()) == ("AUTO", "motoron", 100.0)
