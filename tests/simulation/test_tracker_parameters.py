"""Tracker presets are read strictly: whoever mistypes a key is told file and key."""

import tomllib

import pytest

from mitl.errors import UsageError
from mitl.resources import models_folder
from mitl.simulation.tracker_parameters import load_preset, load_tracker_parameters

PRESETS = sorted(file.stem for file in (models_folder() / "trackers").glob("*.toml"))


@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_loads_under_its_name_with_a_source_for_every_number(name):
    assert load_preset(name).name == name
    lines = (models_folder() / "trackers" / f"{name}.toml").read_text().splitlines()
    numbers = [line for line in lines if "=" in line and not line.startswith(("name", "description", "#"))]
    assert numbers
    assert [line for line in numbers if "# source:" not in line] == []


def test_thesis_and_ideal_are_there():
    assert {"thesis", "ideal"} <= set(PRESETS)


def test_an_unknown_preset_is_refused_with_the_list_of_presets():
    with pytest.raises(UsageError, match=r"no tracker preset 'vive9'; there are: ideal, .*thesis"):
        load_preset("vive9")


def written(tmp_path, old, new):
    text = (models_folder() / "trackers" / "thesis.toml").read_text()
    assert old in text
    tomllib.loads(text)
    file = tmp_path / "mine.toml"
    file.write_text(text.replace(old, new, 1))
    return file


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("rate_hz = 250.0", "rate_Hz = 250.0", r"mine\.toml: unknown key 'sampling\.rate_Hz'; expected one of: rate_hz, time_jitter_s"),
        ("[drift]", "[drifting]", r"mine\.toml: unknown key 'drifting'"),
        ("size_m = 0.025", "", r"mine\.toml: key 'glitch\.size_m' is missing"),
        ("size_m = 0.025", "size_m = '25 mm'", r"glitch\.size_m must be a finite number, is '25 mm'"),
        ("size_m = 0.025", "size_m = nan", r"glitch\.size_m must be a finite number"),
        ("size_m = 0.025", "size_m = -0.025", r"glitch\.size_m must not be negative"),
        ("rate_hz = 250.0", "rate_hz = 0", r"sampling\.rate_hz must be positive"),
        ("[0.8, 1.25, 0.9]", "[0.8, 1.25]", r"position_noise\.axis_factors must be three numbers"),
        ("probability_per_stop = 0.0125", "probability_per_stop = 1.5", r"glitch\.probability_per_stop must be at most 1"),
        ('name = "thesis"', "name = 3", r"name must be text"),
        ("[drift]", "[drift", r"mine\.toml: cannot read tracker parameters"),
    ],
)
def test_a_wrong_file_is_refused_by_file_and_key(tmp_path, old, new, message):
    with pytest.raises(UsageError, match=message):
        load_tracker_parameters(written(tmp_path, old, new))


def test_a_value_in_place_of_a_table_is_refused(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text("name = 'a'\ndescription = ''\nsampling = 250\n")
    with pytest.raises(UsageError, match=r"sampling must be a table"):
        load_tracker_parameters(file)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(UsageError, match=r"cannot read tracker parameters"):
        load_tracker_parameters(tmp_path / "none.toml")
