"""A physical rig's file is read strictly."""

from pathlib import Path

import pytest

from mitl.errors import UsageError
from mitl.rig import load_rig
from mitl.rig.physical_config import is_physical, read_physical

GOOD = '[rig]\nkind = "physical"\nrobot = "irb140"\n[controller]\naddress = "http://192.168.125.1"\n'
EXAMPLES = sorted((Path(__file__).resolve().parents[2] / "docs" / "examples").glob("*rig*.toml"))


def written(tmp_path, text):
    file = tmp_path / "cell.toml"
    file.write_text(text, encoding="utf-8")
    return file


def test_what_is_not_said_is_the_careful_default(tmp_path):
    found = read_physical(written(tmp_path, GOOD))
    assert not found.safety.unattended
    assert found.safety.first_speed == 25.0
    assert (found.tracker.rate_hz, found.tracker.universe) == (250.0, "raw")


@pytest.mark.parametrize("file", EXAMPLES, ids=lambda file: file.name)
def test_every_example_can_be_read(file):
    assert is_physical(str(file))
    assert read_physical(file).robot


def test_there_are_examples_for_each_generation():
    assert {read_physical(file).controller.generation for file in EXAMPLES} == {"1", "2", "8"}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (GOOD + "adress = 1\n", r"\[controller\] unknown key 'adress'; did you mean address"),
        (GOOD + "[saftey]\n", "did you mean safety"),
        (GOOD + "[safety]\nunattended = 1\n", "true or false"),
        (GOOD + "[safety]\ncorridor_mm = 0\n", "corridor_mm = 0: expected 1 to 1000"),
        (GOOD + '[safety]\nspeed = "fast"\n', "must be a number"),
        (GOOD + "[safety]\nworkspace_mm = [[0, 0], [1, 1]]\n", "workspace_mm"),
        (GOOD + "[egm]\nport = 6510.5\n", r"\[egm\] port = 6510.5: expected a whole number"),
        (GOOD + "[egm]\nport = 0\n", "port = 0: expected 1 to 65535"),
        (GOOD + 'generation = "3"\n', "generation = '3': expected 1 or 2 or 8"),
        (GOOD + 'generation = "8"\n', "GUID"),
        (GOOD + 'fingerprint = "abc"\n', "64 hex digits"),
        (GOOD.replace("http://", "http://user:secret@"), "environment or the keyring"),
        (GOOD.replace("http://192.168.125.1", "192.168.125.1"), "http:// or https://"),
        ('[rig]\nkind = "physical"\nrobot = "irb140"\n', r"\[controller\]"),
        ('[rig]\nkind = "physical"\nrobot = "irb140"\n[controller]\n', "address is missing"),
        (GOOD + 'password = "x"\n', "unknown key 'password'"),
    ],
)
def test_a_broken_file_is_refused_with_section_and_key(tmp_path, text, said):
    with pytest.raises(UsageError, match=said) as caught:
        read_physical(written(tmp_path, text))
    assert "cell.toml" in str(caught.value)
    assert "secret" not in str(caught.value)


def test_faults_are_for_simulated_controllers(tmp_path):
    with pytest.raises(UsageError, match="mitl serve --fault"):
        load_rig(str(written(tmp_path, GOOD)), 1, ("speed=5",))
