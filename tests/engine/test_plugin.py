"""The plug-in as its users meet it: small case files run by pytest on a closed-form rig."""

import subprocess
import sys
from pathlib import Path

import pytest

from mitl.recording.mcap_reader import read_recording

LINE = """
from mitl.metrics.path import nearest_distance

@case("line/straight", title="Straight", purpose="A line is a line.", catches=("offset",), program="line.mod")
def test_straight(bench, check):
    run = bench.run(2)
    there = run.tool.position[np.argmax(run.tool.position[:, 1])]
    check("far end", value=1e3 * (there[1] - .3), limit=3.0, uncertainty=.3)
    distance = nearest_distance(run.oracle.tcp.position, run.tool.position) * 1e3
    check("distance", value=distance.max(), limit=3.0, uncertainty=.3, over_time=(run.tool.time, distance))
"""


def case_text(body, name="any", fixtures="check", title="Any"):
    return f"""
@case("some/{name}", title="{title}", purpose="Try.", program="line.mod")
def test_{name}({fixtures}):
    {body}
"""


def only(results):
    (found,) = results["cases"]
    return found


def test_a_nominal_robot_passes_and_the_recording_holds_the_run(cases):
    cases(LINE).assert_outcomes(passed=1)
    found = only(cases.results())
    assert found["outcome"] == cases.results()["outcome"] == "pass"
    assert found["recording"] == "line_straight.mcap"
    recording = read_recording(cases.path / "out" / "line_straight.mcap")
    assert set(recording.paths) == {"/tracker/pose", "/tool/measured", "/tool/oracle"}
    assert recording.series["/check/distance"].columns == ("distance mm",)
    assert recording.metadata["case"] == "line/straight"
    assert recording.attachments["line.mod"].startswith(b"MODULE Line")
    assert {path.name for path in (cases.path / "out").iterdir()} == {
        "results.json",
        "junit.xml",
        "report.html",
        "replay.html",
        "summary.txt",
        "line_straight.mcap",
        "calibration.toml",
        "calibration.mcap",
    }


def test_still_points_and_calibration_poses_are_recorded_too(cases):
    body = """bench.go(1, 3, settle=.2)
    point = bench.still_point()
    assert np.allclose(point.tool[:3], bench.last_oracle.tcp.position[-1], atol=2e-3)
    check("poses", value=len(bench.calibration_poses), limit=12, uncertainty=0, unit="", at_least=True)
    bench.record_path("belt", bench.last_oracle.tcp, frame="world", body="belt")"""
    cases(case_text(body, fixtures="bench, check")).assert_outcomes(passed=1)
    recording = read_recording(cases.path / "out" / "some_any.mcap")
    lengths = {topic: len(track.path) for topic, track in recording.paths.items()}
    expected = {"/tracker/still": 1, "/tool/still": 1, "/calibration/flange": 12, "/calibration/tracker": 12, "/path/belt": 250}
    assert lengths == expected
    again = read_recording(cases.path / "out" / "calibration.mcap")
    assert set(again.paths) == {"/calibration/flange", "/calibration/tracker"}


def test_a_fault_fails_the_case(cases):
    cases(LINE, "--mitl-fault=offset=8").assert_outcomes(failed=1)
    found = only(cases.results())
    assert found["outcome"] == "fail"
    assert found["checks"][0]["value"] == pytest.approx(8.0, abs=1.0)
    assert cases.results()["faults"] == ["offset=8"]


def test_the_same_seed_gives_the_same_numbers_whichever_cases_run_and_another_seed_others(cases):
    other = case_text("bench.run(2); check('y', value=bench.still_point().tool[1] * 1e3, limit=3, uncertainty=.3)", "other", "bench, check")
    cases(other + LINE)
    both = cases.results()["cases"]
    cases(other + LINE, "--mitl-case=line")
    assert only(cases.results()) == both[1]
    cases(LINE, "--mitl-seed=2")
    assert only(cases.results())["checks"][1]["value"] != both[1]["checks"][1]["value"]


@pytest.mark.parametrize(
    ("body", "outcome", "in_pytest", "text"),
    [
        ("check('x', value=-3, limit=2, uncertainty=.1)", "fail", "failed", ""),
        ("check('x', value=1.9, limit=2, uncertainty=.1)", "inconclusive", "skipped", ""),
        ("check('x', value=float('nan'), limit=2, uncertainty=.1)", "error", "failed", "the value is nan"),
        (
            "check('x', value=1, limit=2, uncertainty=.1); check('w', value=3, limit=2, uncertainty=.1, warning=True)",
            "pass",
            "passed",
            "out of 2 mm",
        ),
        ("pass", "error", "failed", "made no check"),
        ("assert 1 == 2", "error", "failed", "at test_cases.py:"),
        ("1 / 0", "error", "failed", "ZeroDivisionError"),
        ("check('x', value=3, limit=2, uncertainty=.1); 1 / 0", "fail", "failed", "ZeroDivisionError"),
        ("pytest.skip('no belt at this rig')", "skipped", "skipped", "no belt at this rig"),
        ("check.message('warning', 'felt is worn'); check('x', value=1, limit=2, uncertainty=0)", "pass", "passed", "felt is worn"),
    ],
)
def test_how_a_case_ends(cases, body, outcome, in_pytest, text):
    result = cases(case_text(body))
    result.assert_outcomes(**{in_pytest: 1})
    found = only(cases.results())
    assert found["outcome"] == outcome
    assert text in " ".join(message["text"] for message in found["messages"])
    if outcome == "inconclusive":
        result.stdout.fnmatch_lines(["SKIPPED*test_cases.py:*inconclusive: x:*"])


@pytest.mark.parametrize(
    ("option", "expected"),
    [(8, "stopped by itself during option 8*40001 axis 3 out of range"), (9, "option 9, subOption 0 was not done after 5 s")],
)
def test_a_robot_that_does_not_obey_is_an_error_and_its_track_is_kept(cases, option, expected):
    cases(case_text(f"bench.run({option}, timeout=5)", fixtures="bench, check")).assert_outcomes(failed=1)
    found = only(cases.results())
    assert found["outcome"] == "error"
    for part in expected.split("*"):
        assert part in found["messages"][0]["text"]
    assert "Traceback" not in found["messages"][0]["text"]
    assert "Traceback" in (cases.path / "out" / found["log"]).read_text()
    assert "/tracker/pose" in read_recording(cases.path / "out" / found["recording"]).paths


def test_a_lost_tracker_is_an_error(cases):
    cases(LINE, "--mitl-fault=lost")
    found = only(cases.results())
    assert found["outcome"] == "error"
    assert "no valid pose" in found["messages"][0]["text"]


def test_a_rig_that_cannot_be_reached_is_an_error_of_every_case(cases):
    cases(LINE + case_text("pass", fixtures="bench, check"), "--mitl-fault=unreachable").assert_outcomes(errors=2)
    assert [found["outcome"] for found in cases.results()["cases"]] == ["error", "error"]
    assert cases.results()["cases"][0]["messages"][0]["text"] == "no controller answers at 192.0.2.1"


def test_an_unknown_fault_is_told_before_anything_is_written(cases):
    result = cases(LINE, "--mitl-fault=nonsense")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(["ERROR: unknown fault 'nonsense'"])
    assert not (cases.path / "out").exists()


def test_fatal_stops_robot_and_run(cases):
    text = case_text("bench.run(2); check.fatal('it moves the wrong way')", "first", "bench, check") + case_text("pass", "second")
    cases(text).assert_outcomes(failed=1)
    first, second = cases.results()["cases"]
    assert (first["outcome"], second["outcome"], cases.results()["interrupted"]) == ("error", "skipped", True)
    assert first["messages"][0] == {"level": "fatal", "text": "it moves the wrong way"}


def test_fatal_is_not_swallowed_by_a_case_that_catches_exceptions(cases):
    body = "try: check.fatal('stop')\n    except Exception: check('x', value=1, limit=2, uncertainty=0)"
    cases(case_text(body.replace("try: ", "try:\n        "), "first") + case_text("pass", "second"))
    assert cases.results()["interrupted"]


def test_an_interrupt_keeps_what_was_finished_and_stops_the_robot(cases):
    good = case_text("check('x', value=1, limit=2, uncertainty=0)", "good")
    broken = case_text("check('x', value=1, limit=2, uncertainty=0); bench.run(2); raise KeyboardInterrupt", "broken", "bench, check")
    (cases.path / "out").mkdir()
    run_in_process_of_its_own(cases, good + broken + case_text("pass", "later"))
    results = cases.results()
    assert [found["outcome"] for found in results["cases"]] == ["pass", "error", "skipped"]
    assert results["outcome"] == "error"
    assert results["interrupted"]
    assert results["cases"][1]["recording"] == "some_broken.mcap"
    assert (cases.path / "out" / "report.html").is_file()
    stops, running = (cases.path / "end.txt").read_text().split()
    assert int(stops) > 0
    assert running == "False"


def run_in_process_of_its_own(cases, text):
    head = "import numpy as np\nimport pytest\nfrom mitl.engine import case\n"
    (cases.path / "test_cases.py").write_text(head + text)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--mitl-rig=line", "--mitl-out=out"]
    return subprocess.run(command, cwd=cases.path, capture_output=True, text=True, timeout=60, check=False)


def test_the_robot_stands_after_a_crash(cases):
    cases(case_text("bench.start(); 1 / 0", fixtures="bench, check"))
    assert (cases.path / "end.txt").read_text().split()[1] == "False"


def test_an_id_used_twice_is_refused(cases):
    result = cases(case_text("pass") + case_text("pass").replace("test_any", "test_again"))
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(["ERROR: case id 'some/any' is used twice: by *test_any and by *test_again"])


def test_parameters_make_ids_of_their_own(cases):
    text = case_text("check('x', value=speed, limit=2, uncertainty=0)", fixtures="check, speed").replace(
        "@case", "@pytest.mark.parametrize('speed', [1, 3])\n@case"
    )
    cases(text).assert_outcomes(passed=1, failed=1)
    assert [found["id"] for found in cases.results()["cases"]] == ["some/any[1]", "some/any[3]"]


def test_a_selection_takes_whole_parts_of_ids(cases):
    text = case_text("check('x', value=1, limit=2, uncertainty=0)", "one") + case_text("pass", "onetwo")
    cases(text, "--mitl-case=some/one").assert_outcomes(passed=1, deselected=1)
    result = cases(text, "--mitl-case=some/ome")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(["ERROR: unknown case 'some/ome': did you mean some/one*"])


def test_a_test_without_case_may_use_the_fixtures_and_others_are_left_alone(cases):
    text = """
def test_mine(rig, check):
    '''Looks at the robot.'''
    check("z", value=rig.controller.flange()[2], limit=1, uncertainty=.01, unit="m")

def test_not_ours():
    pass
"""
    cases(text).assert_outcomes(passed=2)
    found = only(cases.results())
    assert (found["id"], found["purpose"]) == ("test_cases.py::test_mine", "Looks at the robot.")


def test_a_folder_is_used_again_without_leftovers_of_the_former_run(cases):
    cases(LINE)
    (cases.path / "out" / "notes.txt").write_text("mine")
    cases(case_text("check('x', value=1, limit=2, uncertainty=0)"))
    names = {path.name for path in (cases.path / "out").iterdir()}
    assert "line_straight.mcap" not in names
    assert "notes.txt" in names


def test_workers_of_xdist_report_to_one_record(cases):
    pytest.importorskip("xdist")
    cases(LINE)
    alone = only(cases.results())
    text = LINE + case_text("check('x', value=1, limit=2, uncertainty=0)")
    (cases.path / "test_cases.py").write_text("import numpy as np\nimport pytest\nfrom mitl.engine import case\n" + text)
    command = [sys.executable, "-m", "pytest", "-q", "-n1", "-p", "no:cacheprovider", "--mitl-rig=line", "--mitl-out=out"]
    subprocess.run(command, cwd=cases.path, capture_output=True, text=True, timeout=60, check=True)
    together = {found["id"]: found for found in cases.results()["cases"]}
    assert together["line/straight"] == alone
    assert set(together) == {"line/straight", "some/any"}
    assert cases.results()["rig"] == "line"


def test_other_peoples_runs_load_nothing_heavy(pytester):
    pytester.makepyfile(
        """
        import sys

        def test_light():
            assert not {name for name in sys.modules if name.split(".")[0] in {"numpy", "scipy", "pydrake"}}
        """
    )
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:hypothesispytest"]
    found = subprocess.run(command, cwd=pytester.path, capture_output=True, text=True, timeout=60, check=False)
    assert "1 passed" in found.stdout


def test_a_missing_program_is_told_where_the_case_is_declared(cases):
    result = cases(case_text("pass").replace("line.mod", "gone.mod"))
    result.stdout.fnmatch_lines([f"*UsageError: case some/any: its program {Path(cases.path)}/gone.mod does not exist"])
