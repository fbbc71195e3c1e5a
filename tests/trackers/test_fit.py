"""Presets fitted to recordings: what went in comes out, half of the recordings predicts the other half, the file can be loaded."""

import json
from dataclasses import replace

import numpy as np
import pytest

from mitl.cli import run
from mitl.metrics.tracker_fit import fit_tracker, place_jitter
from mitl.paths import PosePath
from mitl.recording import write_tum
from mitl.simulation.tracker_model import TrackerModel
from mitl.simulation.tracker_parameters import load_preset, load_tracker_parameters
from mitl.trackers.fit import fitted_preset, predicted_jitter, preset_text

LIGHTHOUSE2 = load_preset("lighthouse2")
ROOM = replace(LIGHTHOUSE2, location=replace(LIGHTHOUSE2.location, gain_sd_log=0.15))


def recordings(count, seconds=4.0):
    samples = round(seconds / ROOM.period)
    times = np.arange(samples) * ROOM.period
    places = np.random.default_rng(3).uniform(-2, 2, (count, 3))
    return [
        TrackerModel(ROOM, 100 + seed).measure(times, np.tile(place, (samples, 1)), np.tile([1.0, 0, 0, 0], (samples, 1)))
        for seed, place in enumerate(places)
    ]


RECORDINGS = recordings(12)


def test_the_fit_finds_the_noise_that_went_in():
    fit = fit_tracker(RECORDINGS)
    assert fit.rate == pytest.approx(250.0)
    assert fit.position.fast_tau == pytest.approx(0.0102, rel=0.3)
    assert fit.position.fast_sd == pytest.approx(1.2 * 0.152e-3, rel=0.15)  # the typical gain is 1.2
    assert np.degrees(fit.turn.fast_sd) == pytest.approx(0.034, rel=0.3)
    assert fit.gain_sd_log == pytest.approx(0.15, abs=0.08)
    assert fit.axis_factors == pytest.approx([1.0] * 3, abs=0.1)


@pytest.mark.parametrize("window", [0.2, 0.5])
def test_half_of_the_recordings_predicts_the_jitter_of_the_other_half_within_20_per_cent(window):
    preset = fitted_preset(fit_tracker(RECORDINGS[::2]), "half")
    held_back = np.mean([place_jitter(path, window) for path in RECORDINGS[1::2]])
    assert np.mean(predicted_jitter(preset, window)) == pytest.approx(held_back, rel=0.2)


def test_the_presets_text_loads_again_with_the_numbers_and_a_source_for_each(tmp_path):
    preset = fitted_preset(fit_tracker(RECORDINGS[:3]), "mine")
    file = tmp_path / "mine.toml"
    file.write_text(preset_text(preset, "lighthouse2", "fit to 3 recordings"))
    again = load_tracker_parameters(file)
    assert again.name == "mine"
    assert again.position_noise.fast_sd_m == pytest.approx(preset.position_noise.fast_sd_m, rel=1e-5)
    assert again.location.gain_sd_log == pytest.approx(preset.location.gain_sd_log, rel=1e-5)
    assert again.distortion == LIGHTHOUSE2.distortion
    for line in file.read_text().splitlines():
        if " = " in line and not line.startswith(("name", "description", "mode")):
            assert "# source: " in line, line


def test_the_command_fits_checks_and_writes(tmp_path, capsys):
    files = []
    for number, path in enumerate(RECORDINGS[:6]):
        files.append(str(tmp_path / f"{number}.tum"))
        write_tum(tmp_path / f"{number}.tum", path)
    held = [word for file in files[4:] for word in ("--check", file)]
    output = tmp_path / "fitted.toml"
    assert run(["fit-tracker", *files[:4], *held, "--output", str(output), "--format", "json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["recordings"] == 4
    assert told["jitter"][0]["predicted_m"] == pytest.approx(told["jitter"][0]["held_back_m"], rel=0.4)
    assert load_tracker_parameters(output).name == "fitted"
    assert run(["fit-tracker", files[0], "--base", "none"]) == 2
    assert "no tracker preset 'none'" in capsys.readouterr().err


def test_a_recording_without_rest_is_refused(tmp_path, capsys):
    moving = RECORDINGS[0]
    moved = PosePath(moving.time, moving.position + moving.time[:, None] * 0.1, moving.quaternion_wxyz, moving.valid)
    write_tum(tmp_path / "moving.tum", moved)
    assert run(["fit-tracker", str(tmp_path / "moving.tum")]) == 2
    assert "recording 1 has no stretch of 1 s in which the body stands still" in capsys.readouterr().err
