"""benchmarks/run.py knows every benchmark, tells what is missing, and writes a page that names no host; the page that is kept is its."""

import argparse
import importlib.util
import platform
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SPEC = importlib.util.spec_from_file_location("benchmarks_run", ROOT / "benchmarks" / "run.py")
runner = importlib.util.module_from_spec(SPEC)
sys.modules[SPEC.name] = runner  # dataclasses look their module up
SPEC.loader.exec_module(runner)


def options(**changes):
    return argparse.Namespace(**{"quick": True, "recordings": [], "beside": {}, **changes})


def planning(text, state=runner.State.DONE):
    return runner.Result("planning_speed", "Plans.", ("250",), state, text, 1.0)


def test_every_file_that_can_be_run_is_a_benchmark_and_every_entry_a_file():
    assert {"planning_speed", "corner30", "sampling"} <= set(runner.names())
    assert set(runner.ENTRIES) <= set(runner.names())


def test_what_lacks_its_peer_says_so_and_is_not_run(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda *_: None)
    found = runner.measured("rapid_reading", options(), 60.0)
    assert (found.state, found.reason) == (runner.State.LEFT_OUT, "needs the package lark")
    assert runner.ratios([found]) == [("lark", "reading RAPID with a syntax tree, our speed / theirs", "none: needs the package lark")]


def test_a_peer_is_given_with_its_python_or_told_to_be_missing():
    assert runner.peer_and_python("evo=/usr/bin/python3") == ("evo", "/usr/bin/python3")
    with pytest.raises(argparse.ArgumentTypeError, match="expected PEER=PYTHON"):
        runner.peer_and_python("lark=/usr/bin/python3")
    assert runner.arguments_of("inverse_kinematics", options(beside={"roboticstoolbox": "/x/python"})) == ("/x/python",)
    alone = runner.Result("inverse_kinematics", "", (), runner.State.DONE, "mitl: 0.14 us a pose")
    assert [number for _, _, number in runner.ratios([alone])] == ["none: no Python with roboticstoolbox (--beside)"]


def test_what_lacks_recordings_or_time_is_left_out():
    assert "--recordings" in runner.measured("lighthouse2", options(), 60.0).reason
    assert runner.measured("corner30", options(), 0.0).reason == "no time was left"


def test_a_failure_is_told_with_its_last_words_and_a_late_one_is_stopped(tmp_path, monkeypatch):
    (tmp_path / "broken.py").write_text('"""Breaks."""\nprint("so far")\nraise SystemExit("no such luck")\n')
    (tmp_path / "endless.py").write_text('"""Never ends."""\nprint("begun")\nimport time\ntime.sleep(60)\n')
    monkeypatch.setattr(runner, "HERE", tmp_path)
    broken = runner.measured("broken", options(), 60.0)
    assert (broken.state, broken.reason, broken.text) == (runner.State.FAILED, "no such luck", "so far\n")
    late = runner.measured("endless", options(), 1.0)
    assert (late.state, late.text, late.job) == (runner.State.LATE, "begun\n", "Never ends.")


def test_a_ratio_is_read_from_what_the_benchmark_prints():
    row = "  Drake's Toppra, pace alone     25.5 ms at best,   26.7 median; ours takes 0.37 times as long"
    found = {name: number for name, _, number in runner.ratios([planning(row)])}
    assert found == {"drake": "0.37", "toppra": "none: toppra is not installed"}


def test_a_ratio_of_what_was_stopped_is_none():
    assert {number for _, _, number in runner.ratios([planning("", runner.State.LATE)])} == {"none: the benchmark did not get so far"}


def test_the_patterns_fit_what_the_benchmarks_write():
    kept = (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8")
    blocks = dict(re.findall(r"^## (\w+)\n\n```text\n(.*?)\n```$", kept, flags=re.MULTILINE | re.DOTALL))
    results = [runner.Result(name, "", (), runner.State.DONE, text) for name, text in blocks.items()]
    for peer, what, number in runner.ratios(results):
        assert f"| {peer} | {what} | {number} |" in kept


def test_the_page_names_every_benchmark():
    kept = (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8")
    assert [name for name in runner.names() if f"| `{name}` |" not in kept] == []


def test_the_page_names_neither_host_nor_folder():
    text = f"wrote {ROOT}/out on {platform.node()}\n```\n"
    page = runner.page([planning(text)], {"cores": "2"}, "2026-01-02", quick=True)
    assert str(ROOT) not in page
    assert platform.node() not in page
    assert page.count("```") == 2
