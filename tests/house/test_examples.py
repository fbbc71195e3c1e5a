"""The examples are free of errors and move as they say."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mitl.cli import run
from mitl.recording.csv_file import read_csv

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def oracle(source, folder, capsys):
    assert run(["check", str(source)]) == 0, capsys.readouterr().out
    output = folder / "path.csv"
    assert run(["oracle", str(source), "--frame", "wobj", "--output", str(output)]) == 0, capsys.readouterr()
    return read_csv(output)


def test_the_drawing_is_a_house_of_100_mm_with_the_pen_down(tmp_path, capsys):
    table = oracle(EXAMPLES / "drawing" / "figure.mod", tmp_path, capsys)
    drawn = 1e3 * table.path.position[table.signals["doPen"] > 0.5]
    assert np.allclose(np.ptp(drawn, axis=0)[:2], 100.0, atol=1.0)
    assert np.abs(drawn[:, 2]).max() < 1.0
    assert "the house is drawn" in capsys.readouterr().out


def test_pick_and_place_grips_four_parts(tmp_path, capsys):
    table = oracle(EXAMPLES / "pick_and_place" / "cell.mod", tmp_path, capsys)
    assert int((np.diff(table.signals["doGrip"]) > 0.5).sum()) == 4
    assert "parts: 4" in capsys.readouterr().out


def test_the_seam_is_welded_at_its_speed_where_the_torch_burns(tmp_path, capsys):
    made = tmp_path / "seam.mod"
    script = EXAMPLES / "welding_seam" / "seam_to_rapid.py"
    subprocess.run([sys.executable, script, EXAMPLES / "welding_seam" / "seam.csv", made], check=True)
    table = oracle(made, tmp_path, capsys)
    burning = table.signals["doTorch"] > 0.5
    assert np.median(1e3 * table.speed[burning]) == pytest.approx(12.0, abs=0.5)
    position = 1e3 * table.path.position[burning]
    assert np.abs(np.hypot(position[:, 0], position[:, 1] - 120.0) - 120.0).max() < 1.0  # an arc of 120 mm, chords 15.7 mm
