"""What the README tells a newcomer to do works, word for word."""

import re
from pathlib import Path

import pytest

from mitl.cli import run

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def block(language: str, number: int = 0) -> str:
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)[number]


def test_the_first_two_commands_are_those_that_ci_runs():
    set_up_and_verify, set_up_and_test = block("sh", 0), block("sh", 1)
    ci = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    for command in (set_up_and_verify, set_up_and_test):
        last = command.strip().split("&&")[-1].strip().removeprefix(".venv/bin/")
        assert last.split(" --out")[0] in ci


def test_the_program_of_the_tour_has_the_path_that_the_tour_promises(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("square.mod").write_text(block("rapid"), encoding="utf-8")
    assert run(["check", "square.mod"]) == 0
    assert run(["oracle", "square.mod", "--frame", "wobj", "--output", "square.csv"]) == 0
    told = capsys.readouterr().out
    assert "doPen: 1 at" in told
    assert "TPWrite" in told
    assert Path("square.csv").read_text(encoding="utf-8").startswith("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,speed_mm_s,j1_deg")


@pytest.mark.parametrize("place", ["docs/rapid_coverage.md", "docs/conventions.md", "docs/images/report.png", "ARCHITECTURE.md"])
def test_what_the_readme_links_to_exists(place):
    assert place in README
    assert (ROOT / place).is_file()


def test_the_case_of_the_tour_runs_and_can_fail(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "my_tests"
    folder.mkdir()
    (folder / "test_my_line.py").write_text(block("python"), encoding="utf-8")
    source = (ROOT / "mitl" / "atc" / "atc_0.mod").read_text(encoding="utf-8")
    (folder / "my_line.mod").write_text(source.replace("TEST subOption", "TEST 1"), encoding="utf-8")
    assert run(["verify", "--tests", "my_tests", "--out", "mine"]) == 0
    assert run(["verify", "--tests", "my_tests", "--out", "broken", "--fault", "target-offset=20"]) == 1
