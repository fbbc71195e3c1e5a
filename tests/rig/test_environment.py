"""A record tells robot models, tracker models and cells of one name apart."""

import shutil

import pytest

from mitl.cli import run
from mitl.resources import models_folder
from mitl.rig.environment import folder_fingerprint, text_fingerprint
from mitl.rig.load import load_rig


@pytest.fixture
def copied(tmp_path):
    shutil.copytree(models_folder() / "irb140", tmp_path / "irb140")
    return tmp_path / "irb140"


def test_a_folder_is_told_by_its_content_wherever_it_lies(copied):
    told = folder_fingerprint(copied)
    assert told == folder_fingerprint(models_folder() / "irb140")
    assert told.startswith("irb140 sha256 ")
    motion = copied / "motion.toml"
    motion.write_text(motion.read_text(encoding="utf-8") + "# another\n", encoding="utf-8")
    assert folder_fingerprint(copied) != told


def test_a_file_of_another_name_is_another_folder(copied):
    told = folder_fingerprint(copied)
    (copied / "motion.toml").rename(copied / "motion2.toml")
    assert folder_fingerprint(copied) != told


def test_a_text_is_told_by_its_content():
    assert text_fingerprint("a", "b") == text_fingerprint("a", "b") != text_fingerprint("a", "c")


def test_the_simulated_rig_says_what_it_was_made_of(tmp_path):
    known = load_rig("sim", 1, ()).versions
    assert known["robot model"] == folder_fingerprint(models_folder() / "irb140")
    assert known["cell"].startswith("line sha256 ")
    assert known["fidelity"] == "kinematic"
    assert {name for name in known if name.startswith("tracker model")} == {
        "tracker model of hand",
        "tracker model of reference",
        "tracker model of belt",
    }
    file = tmp_path / "rig.toml"
    file.write_text("[rig]\ntracker = 'ideal'\n", encoding="utf-8")
    other = load_rig(str(file), 1, ()).versions
    assert other["tracker model of hand"].startswith("ideal sha256 ")
    assert other["robot model"] == known["robot model"]


def test_a_run_is_not_resumed_with_another_tracker_model(tmp_path, capsys):
    shutil.copy(models_folder() / "trackers" / "ideal.toml", tmp_path / "mine.toml")
    (tmp_path / "rig.toml").write_text("[rig]\ntracker = 'mine.toml'\n", encoding="utf-8")
    words = ["verify", "atc-1/direction", "--rig", str(tmp_path / "rig.toml"), "--out", str(tmp_path / "run")]
    assert run(words) == 0
    assert run([*words, "--resume"]) == 0
    preset = (tmp_path / "mine.toml").read_text(encoding="utf-8")
    changed = preset.replace("rate_hz = 250.0", "rate_hz = 200.0")
    assert changed != preset
    (tmp_path / "mine.toml").write_text(changed, encoding="utf-8")
    capsys.readouterr()
    assert run([*words, "atc-1/linear", "--resume"]) == 2
    assert "tracker model of hand" in capsys.readouterr().err
