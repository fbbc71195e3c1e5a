"""`mitl init`: what it writes runs, passes on a sound controller, and fails on a broken one."""

import subprocess
import sys

import pytest

from mitl.cli import run


def test_a_new_case_passes_and_fails_for_a_fault_that_it_names(tmp_path):
    assert run(["init", "my-case/reach", "--out", str(tmp_path / "cases")]) == 0
    assert run(["check", str(tmp_path / "cases" / "reach.mod")]) == 0
    verify = [sys.executable, "-m", "mitl", "verify", "--tests", str(tmp_path / "cases"), "--out", str(tmp_path / "run")]
    sound = subprocess.run(verify, capture_output=True, text=True, check=False)
    assert sound.returncode == 0, sound.stdout + sound.stderr
    broken = subprocess.run([*verify, "--fault", "target-offset=20"], capture_output=True, text=True, check=False)
    assert broken.returncode == 1, broken.stdout + broken.stderr


def test_nothing_is_overwritten(tmp_path, capsys):
    assert run(["init", "reach", "--out", str(tmp_path)]) == 0
    assert run(["init", "other/reach", "--out", str(tmp_path)]) == 2
    assert "exist already" in capsys.readouterr().err


@pytest.mark.parametrize("case", ["Reach", "a//b", "../x"])
def test_a_malformed_id_is_refused(case, tmp_path, capsys):
    assert run(["init", case, "--out", str(tmp_path)]) == 2
    assert "lower-case words" in capsys.readouterr().err
