"""`mitl verify` and `mitl report` from the outside: exit codes, what is printed where, what is left behind."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from mitl.cli import run

ENGINE_TESTS = Path(__file__).parents[1] / "engine"
CONFTEST = f"""
import sys
sys.path.insert(0, {str(ENGINE_TESTS)!r})
from line_rig import make_rig

def pytest_mitl_load_rig(name, seed, faults):
    return make_rig(seed, faults) if name == "line" else None

def pytest_configure(config):
    config.option.mitl_calibration = str(config.rootpath / "line.mod")
"""
PROGRAM = "MODULE Line\n  VAR num option := 0;\n  VAR num subOption := 0;\n  PERS num poseCount := 12;\nENDMODULE\n"
CASES = """
import os
import pytest
import time
from mitl.engine import case

@case("line/good", title="Good", purpose="Passes.", catches=("offset",), typical_s=5, program="line.mod")
def test_good(bench, check):
    print("to be captured")
    y = bench.run(2).tool.position[:, 1].max()
    check("far end", value=1e3 * (y - .3), limit=5, uncertainty=.3)

@case("line/vague", title="Vague", purpose="Inconclusive.", program="line.mod")
def test_vague(check):
    check("x", value=1.9, limit=2, uncertainty=.1)

@case("other/crash", title="Crash", purpose="Crashes.", program="line.mod")
def test_crash(check):
    if not os.path.exists("healed"):
        raise RuntimeError("no idea")
    check("x", value=1, limit=2, uncertainty=.1)

@case("other/slow", title="Slow", purpose="Waits to be ended.", program="line.mod")
def test_slow(bench, check):
    bench.start()
    check("x", value=1, limit=2, uncertainty=.1)
    open("started", "w").close()
    time.sleep(30)
"""


@pytest.fixture
def tests(tmp_path, monkeypatch):
    """Gives a folder of cases; the current folder is another one, with a pytest.ini and a conftest.py that would spoil everything."""
    folder = tmp_path / "cases"
    folder.mkdir()
    for name, text in (("conftest.py", CONFTEST), ("line.mod", PROGRAM), ("test_cli_cases.py", CASES)):
        (folder / name).write_text(text)
    here = tmp_path / "here"
    here.mkdir()
    (here / "pytest.ini").write_text("[pytest]\naddopts = --nonsense\n")
    (here / "conftest.py").write_text("raise RuntimeError('foreign conftest')\n")
    monkeypatch.chdir(here)
    monkeypatch.setenv("PYTEST_ADDOPTS", "--more-nonsense")
    return folder


def verify(tests, *words):
    return run(["verify", "--tests", str(tests), *words])


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (["line/good"], 0),
        (["line/good", "--fault", "offset=9"], 1),
        (["line"], 3),
        (["line/vague", "other/crash"], 4),
        (["line/good", "other/crash", "--fault", "offset=9"], 1),
    ],
)
def test_the_exit_code_tells_the_outcome_and_a_failure_outweighs_an_error(tests, capsys, words, code):
    assert verify(tests, *words, "--rig", "line", "--out", "run") == code
    assert {"results.json", "junit.xml", "report.html"} <= {path.name for path in Path("run").iterdir()}
    shown = capsys.readouterr()
    assert "report: run/report.html" in shown.err
    assert "to be captured" not in shown.out
    assert "Traceback" not in shown.out + shown.err


def test_the_table_names_cases_and_what_was_found(tests, capsys):
    verify(tests, "line", "--rig", "line")
    out = capsys.readouterr().out
    assert re.search(r"pass +line/good +1 +far end: \S+ of 5 mm \(\d+ %\)", out)
    assert re.search(r"inconclusive +line/vague +1 +x: 1.9 mm, limit 2 mm, u = 0.1 mm: inconclusive", out)
    assert "inconclusive: 1 pass, 1 inconclusive; rig line, seed 1" in out
    assert Path("mitl-run/report.html").is_file()


def test_json_is_the_results_and_nothing_else(tests, capsys):
    verify(tests, "line/good", "--rig", "line", "--seed", "3", "--out", "run", "--format", "json")
    printed = capsys.readouterr().out
    assert json.loads(printed) == json.loads(Path("run/results.json").read_text())
    assert json.loads(printed)["seed"] == 3


def test_the_list_tells_ids_titles_times_and_faults_and_runs_nothing(tests, capsys):
    assert verify(tests, "line", "--list") == 0
    assert capsys.readouterr().out.splitlines() == ["line/good   Good       5 s  offset", "line/vague  Vague     60 s"]
    assert verify(tests, "--list", "--format", "json") == 0
    assert [entry["id"] for entry in json.loads(capsys.readouterr().out)] == ["line/good", "line/vague", "other/crash", "other/slow"]
    assert not Path("mitl-run").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["line/god"], "mitl: error: unknown case 'line/god': did you mean line/good"),
        (["line/good", "--fault", "nonsense"], "mitl: error: unknown fault 'nonsense'"),
        (["line/good", "--seed", "one"], "Invalid value for '--seed'"),
    ],
)
def test_wrong_usage_is_told_and_leaves_nothing(tests, capsys, words, message):
    assert verify(tests, *words, "--rig", "line") == 2
    shown = capsys.readouterr()
    assert message in shown.err
    assert shown.out == ""
    assert not Path("mitl-run").exists()


def test_an_output_folder_that_cannot_be_is_told(tests, capsys):
    Path("file").write_text("")
    assert verify(tests, "line/vague", "--rig", "line", "--out", "file/run") == 2
    assert "file/run: cannot keep a run here: Not a directory" in capsys.readouterr().err


def test_cases_that_cannot_be_read_are_told(tests, capsys):
    (tests / "test_broken_cases.py").write_text("import nothing_of_this_name\n")
    assert verify(tests, "--rig", "line") == 4
    assert (
        "cases cannot be read: test_broken_cases.py: E   ModuleNotFoundError: No module named 'nothing_of_this_name'"
        in capsys.readouterr().err
    )


def test_a_terminated_run_keeps_its_record(tests):
    words = [
        sys.executable,
        "-c",
        "from mitl.cli import main; main()",
        "verify",
        "--tests",
        str(tests),
        "other/slow",
        "line/good",
        "--rig",
        "line",
    ]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    until = time.monotonic() + 30
    while not Path("started").exists() and time.monotonic() < until:
        time.sleep(0.05)
    os.kill(process.pid, signal.SIGTERM)
    out, _ = process.communicate(timeout=30)
    assert process.returncode == 4
    assert "interrupted: the run ended before all cases were run" not in out  # line/good is collected first
    results = json.loads(Path("mitl-run/results.json").read_text())
    assert {found["id"]: found["outcome"] for found in results["cases"]} == {"line/good": "pass", "other/slow": "error"}


def test_the_report_can_be_made_again(tests, capsys):
    verify(tests, "line/vague", "--rig", "line", "--out", "run")
    page = Path("run/report.html").read_text()
    Path("run/report.html").unlink()
    assert run(["report", "run"]) == 0
    assert capsys.readouterr().out.endswith("run/report.html\n")
    assert Path("run/report.html").read_text() == page
    assert run(["report", "nowhere"]) == 2
    assert "nowhere/results.json: No such file or directory; expected the folder of a run" in capsys.readouterr().err


def test_the_list_of_mitls_own_cases_loads_no_simulator():
    code = """
import sys
from mitl.cli import run
run(["verify", "--list"])
print(sorted(name for name in sys.modules if name.split(".")[0] in {"pydrake", "ruckig"}), file=sys.stderr)
"""
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert found.stderr.endswith("[]\n")


def test_a_run_that_was_ended_is_resumed_where_it_was(tests, tmp_path, capsys):
    """What was judged stays as it was; what was not is run; the summary says how far it came."""
    out = tmp_path / "run"
    arguments = ["verify", "--rig", "line", "--tests", str(tests), "--out", str(out)]
    assert run([*arguments, "line", "other/crash"]) == 4
    first = json.loads((out / "results.json").read_text())
    before = {case["id"]: case for case in first["cases"]}
    kept = (out / before["line/good"]["recording"]).stat().st_mtime_ns
    Path("healed").touch()
    assert run([*arguments, "--resume", "line", "other/crash"]) == 3
    second = json.loads((out / "results.json").read_text())
    after = {case["id"]: case for case in second["cases"]}
    assert {name: case["outcome"] for name, case in after.items()} == {
        "line/good": "pass",
        "line/vague": "inconclusive",
        "other/crash": "pass",
    }
    assert after["line/good"] == before["line/good"]
    assert (out / before["line/good"]["recording"]).stat().st_mtime_ns == kept
    assert second["started"] == first["started"]
    assert second["wall_s"] > first["wall_s"]
    assert "INCONCLUSIVE: 2 pass, 1 inconclusive" in (out / "summary.txt").read_text()
    assert run([*arguments, "--resume", "line/good", "other/crash"]) == 3, "nothing is left to run, and the record is whole"
    capsys.readouterr()
    assert run([*arguments, "--resume", "--seed", "2", "line"]) == 2
    assert "seed 1, now 2" in capsys.readouterr().err
    assert json.loads((out / "results.json").read_text())["seed"] == 1, "a refused run leaves the former alone"


def test_a_full_disk_costs_no_verdict(tests, tmp_path):
    """The limit of a file's size is the nearest that a test comes to a full disk."""
    out = tmp_path / "run"
    limit = "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (2500, 2500)); "
    script = limit + "from mitl.cli import run; sys.exit(run(sys.argv[1:]))"
    arguments = ["verify", "--rig", "line", "--tests", str(tests), "--out", str(out), "--format", "json", "line", "other/crash"]
    done = subprocess.run([sys.executable, "-c", script, *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 4
    assert "not up to date" in done.stderr
    assert "Traceback" not in done.stderr
    shown = json.loads(done.stdout)
    assert [case["id"] for case in shown["cases"]] == ["line/good", "line/vague", "other/crash"], "every case was run and told"
    assert not list(out.glob(".*")), "no half file is left"
