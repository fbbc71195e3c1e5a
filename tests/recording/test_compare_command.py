"""`mitl compare` as CONTRACT.md has it."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.spatial.transform import Rotation

from mitl.cli.compare import compare_command
from mitl.errors import UsageError
from mitl.paths import PosePath
from mitl.recording import PoseTrack, Recording, write_recording, write_tum

KEYS = """position_rmse_m position_mean_m position_max_m position_p95_m rotation_rmse_deg time_offset_s scale
    speed_rmse_m_s samples""".split()  # noqa: SIM905 - as CONTRACT.md has it


@pytest.fixture
def files(tmp_path):
    t = np.arange(1500) * 0.004
    way = np.clip(t - 0.5, 0, 5)
    position = np.stack([np.cos(2 * way), np.sin(3 * way), 0.3 * np.sin(5 * way)], axis=1) * 0.3
    R = Rotation.from_rotvec(np.outer(way, [0.2, 0.1, -0.3]))
    path = PosePath(t, position, R.as_quat(scalar_first=True), np.ones(len(t), dtype=bool))
    by = Rotation.from_euler("xyz", [10, 20, 30], degrees=True)
    other = PosePath(t + 0.3, 1.0055 * by.apply(position) + 1.0, (by * R).as_quat(scalar_first=True), path.valid)
    write_tum(tmp_path / "reference.txt", path)
    write_recording(tmp_path / "measured.mcap", Recording({"/tool/measured": PoseTrack(other, "wobj", "tool")}))
    return tmp_path / "reference.txt", tmp_path / "measured.mcap"


def run(*arguments):
    result = CliRunner().invoke(compare_command, [str(a) for a in arguments], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def test_json_has_the_keys_of_the_contract(files):
    found = json.loads(run(*files, "--format", "json"))
    assert list(found) == KEYS
    assert (found["time_offset_s"], found["scale"]) == (0.0, 1.0)
    assert found["position_rmse_m"] > 0.5


def test_each_alignment_includes_the_one_before(files):
    found = {a: json.loads(run(*files, "--align", a, "--format", "json")) for a in ("none", "time", "rigid", "similarity")}
    for name in ("time", "rigid", "similarity"):
        assert found[name]["time_offset_s"] == pytest.approx(-0.3, abs=1e-4)
    assert found["rigid"]["position_rmse_m"] == pytest.approx(0.0055 * 0.3, rel=0.3)
    assert found["rigid"]["rotation_rmse_deg"] < 0.05
    assert found["similarity"]["position_rmse_m"] < 1e-5
    assert found["similarity"]["scale"] == pytest.approx(1 / 1.0055, abs=1e-5)
    assert found["similarity"]["samples"] >= 1420


def test_equal_clocks_get_no_offset_from_noise(files):
    reference, _ = files
    assert json.loads(run(reference, reference, "--align", "similarity", "--format", "json"))["time_offset_s"] == 0.0


def test_text_shows_units(files):
    text = run(*files, "--align", "similarity")
    assert "position rms" in text
    assert "mm" in text
    assert "samples" in text


def test_help_has_an_example():
    assert "Example: mitl compare oracle.csv recording.mcap" in run("--help")


def test_bad_input_is_a_usage_error(files, tmp_path):
    reference, measured = files
    (tmp_path / "late.txt").write_text("900 0 0 0 0 0 0 1\n901 0 0 0 0 0 0 1\n")
    for arguments, message in (
        ((reference, tmp_path / "nothing"), "cannot be read"),
        ((reference, tmp_path / "late.txt"), "cannot be compared: the paths have 0 valid samples in common time"),
    ):
        with pytest.raises(UsageError, match=message):
            run(*arguments)
    assert CliRunner().invoke(compare_command, [str(reference), str(measured), "--align", "sideways"]).exit_code == 2


def test_a_recording_that_was_cut_off_is_compared_with_a_warning(files):
    reference, measured = files
    content = measured.read_bytes()
    measured.write_bytes(content[:-200])
    result = CliRunner().invoke(compare_command, [str(reference), str(measured), "--format", "json"], catch_exceptions=False)
    assert json.loads(result.stdout)["samples"] > 1000
    assert "cut off" in result.stderr
