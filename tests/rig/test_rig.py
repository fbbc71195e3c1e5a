"""Rig files are read strictly, and the simulated rig comes from its seed alone."""

import numpy as np
import pytest

from mitl.errors import UsageError
from mitl.rig import load_rig
from mitl.rig.config import RigConfig, read_rig

GOOD = '[rig]\nkind = "simulation"\nrobot = "irb140"\ntracker = "ideal"\nfidelity = "kinematic"\n'


def written(tmp_path, text):
    file = tmp_path / "cell.toml"
    file.write_text(text, encoding="utf-8")
    return str(file)


def test_sim_is_built_in():
    assert read_rig("sim") == RigConfig()


def test_a_rig_file_names_robot_and_tracker_and_is_called_by_its_name(tmp_path):
    config = read_rig(written(tmp_path, GOOD))
    assert (config.name, config.robot, config.tracker) == ("cell", "irb140", "ideal")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (GOOD + 'trakcer = "thesis"\n', "tracker"),
        (GOOD + "[robot]\n", "robot"),
        ("robot = 'irb140'\n", "robot"),
        ("[rig\n", "TOML"),
        ("", r"\[rig\]"),
        (GOOD.replace('"irb140"', "140"), "robot must be"),
        (GOOD.replace('"simulation"', '"telepathy"'), "telepathy"),
    ],
)
def test_a_broken_rig_file_is_refused_with_file_and_key(tmp_path, text, said):
    with pytest.raises(UsageError, match=said) as caught:
        read_rig(written(tmp_path, text))
    assert "cell.toml" in str(caught.value)


@pytest.mark.parametrize(
    ("rig", "said"), [(GOOD.replace("irb140", "irb9000"), "irb9000"), (GOOD.replace('"ideal"', '"crystal-ball"'), "crystal-ball")]
)
def test_an_unknown_robot_or_preset_is_refused(tmp_path, rig, said):
    with pytest.raises(UsageError, match=said):
        load_rig(written(tmp_path, rig), 1, ())


def test_a_missing_rig_file_is_refused():
    with pytest.raises(UsageError, match=r"nowhere\.toml"):
        load_rig("nowhere.toml", 1, ())


def still(seed, case):
    rig = load_rig("sim", seed, ())
    rig.begin_case(case)
    return rig.tracker.average(0.2).position


def test_the_same_seed_and_case_give_the_same_numbers_and_others_others():
    first = still(1, "a")
    assert np.array_equal(first, still(1, "a"))
    assert not np.array_equal(first, still(1, "b"))
    assert np.linalg.norm(first - still(1, "b")) < 5e-3, "the tracker stays where it was put"
    assert np.linalg.norm(first - still(2, "a")) > 5e-2, "another seed puts it elsewhere"
