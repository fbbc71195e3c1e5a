"""Campaigns: what is planned, what is kept, what is counted, and that nothing is lost."""

import contextlib
import json
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mitl.campaign.execute import execute
from mitl.campaign.plan import Trial, planned, quickest_first
from mitl.campaign.store import FILE_NAME, read_results
from mitl.campaign.summary import Rate, detections, false_alarms, smallest_found
from mitl.campaign.tables import write_tables
from mitl.campaign.trial import TrialResult, run_trial
from mitl.cli import run
from mitl.errors import UsageError

sys.path.insert(0, str(Path(__file__).parent))
from work import deadly, quick

CATCHES = {"a/one": ("speed", "hiccup"), "a/two": ("speed",)}


@pytest.fixture(autouse=True)
def _workers_find_the_trials(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parent), prepend=":")


def result(seed, fault, **outcomes):
    return TrialResult(f"{seed} {fault}", seed, fault, outcomes)


def test_every_fault_is_run_with_the_cases_that_name_it_at_every_size_for_every_seed():
    trials = planned(CATCHES, {"speed": [1, 2.5], "hiccup": [40], "unnamed": [1]}, rig="sim", seeds=[1, 2], sound=True)
    assert [(trial.seed, trial.fault, trial.cases) for trial in trials[:4]] == [
        (1, None, ("a/one", "a/two")),
        (1, "speed=1", ("a/one", "a/two")),
        (1, "speed=2.5", ("a/one", "a/two")),
        (1, "hiccup=40", ("a/one",)),
    ]
    assert len({trial.key for trial in trials}) == len(trials) == 8


def test_the_quickest_case_comes_first_where_one_that_fails_is_enough():
    trials = quickest_first(planned(CATCHES, {"speed": [1]}, rig="sim", seeds=[1], sound=True), {"a/one": 60.0, "a/two": 5.0})
    assert [(trial.fault, trial.cases, trial.until_found) for trial in trials] == [
        (None, ("a/one", "a/two"), False),
        ("speed=1", ("a/two", "a/one"), True),
    ]


def test_a_trial_ends_with_the_case_that_found_the_fault():
    cases = ("atc-1/direction", "atc-1/linear")
    whole = run_trial(Trial("sim", 1, "target-offset=10", cases))
    assert whole.outcomes == {"atc-1/linear": "fail", "atc-1/direction": "fail"}
    assert run_trial(Trial("sim", 1, "target-offset=10", cases, until_found=True)).outcomes == {"atc-1/direction": "fail"}
    assert list(run_trial(Trial("sim", 1, None, cases, until_found=True)).outcomes) == list(cases)


@pytest.mark.parametrize(
    ("hits", "count", "low", "high"),
    [(0, 500, 0.0, 0.00735), (5, 10, 0.18709, 0.81291), (95, 100, 0.88717, 0.98357), (100, 100, 0.96378, 1.0)],
)
def test_bounds_are_those_of_clopper_and_pearson(hits, count, low, high):
    rate = Rate(hits, count)
    assert (rate.low, rate.high) == pytest.approx((low, high), abs=2e-5)


@given(st.integers(0, 50), st.integers(1, 50))
def test_bounds_hold_the_rate(hits, count):
    rate = Rate(min(hits, count), count)
    assert 0.0 <= rate.low <= rate.value <= rate.high <= 1.0


def test_a_fault_is_found_from_the_size_on_from_which_all_larger_ones_are_too():
    results = [
        result(seed, f"speed={size}", **{"a": outcome})
        for seed in range(4)
        for size, outcome in ((1, "fail"), (2, "pass"), (3, "fail"), (4, "fail"))
    ]
    found = detections([*results, result(9, None, a="pass")])
    assert [(one.size, one.case, one.rate.hits) for one in found if one.case is None] == [
        (1, None, 4),
        (2, None, 0),
        (3, None, 4),
        (4, None, 4),
    ]
    assert smallest_found(found) == {"speed": 3}


def test_an_error_is_no_detection_and_a_false_alarm():
    (_, found) = detections([result(1, "speed=1", a="error")])
    assert found.rate.hits == 0
    alarms = false_alarms([result(1, None, a="error", b="inconclusive"), result(2, None, a="fail", b="pass")])
    assert [(alarm.case, alarm.rate.hits, alarm.open.hits) for alarm in alarms] == [("a", 2, 0), ("b", 0, 1)]


def test_an_interrupted_campaign_goes_on_and_a_line_cut_off_is_run_again(tmp_path):
    trials = planned(CATCHES, {"speed": [1]}, rig="sim", seeds=[1, 2], sound=True)
    lines = [json.dumps(quick(trial).__dict__) for trial in trials[:2]]
    (tmp_path / FILE_NAME).write_text(lines[0] + "\n" + lines[1][:20], encoding="utf-8")
    told = []
    results = execute(trials, tmp_path, workers=1, run=quick, progress=lambda done, total: told.append((done, total)))
    assert list(results) == [trial.key for trial in trials]
    assert told == [(done, 4) for done in (1, 2, 3, 4)]
    assert set(read_results(tmp_path)) == set(results)


def test_nothing_is_lost_when_a_worker_dies(tmp_path):
    trials = [Trial(str(tmp_path / "mark"), seed, None, ("a/one",)) for seed in range(6)]
    results = execute(trials, tmp_path / "out", workers=2, run=deadly)
    assert (tmp_path / "mark").exists()
    assert [results[trial.key].seed for trial in trials] == list(range(6))


def test_two_campaigns_share_a_computer(tmp_path):
    """The first port that Dask would take for its web page is another's."""
    with socket.socket() as taken:
        taken.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        with contextlib.suppress(OSError):  # taken by somebody else is as good
            taken.bind(("127.0.0.1", 8787))
            taken.listen()
        trials = [Trial("here", 1, None, ("a/one",))]
        assert list(execute(trials, tmp_path, workers=1, run=quick)) == [trials[0].key]


def test_a_file_that_is_no_campaign_is_refused(tmp_path):
    (tmp_path / FILE_NAME).write_text('{"key": 1}\n{}\n', encoding="utf-8")
    with pytest.raises(UsageError, match="is this the folder of a campaign"):
        read_results(tmp_path)


def test_the_tables_tell_every_rate_with_its_bounds(tmp_path):
    found = detections([result(seed, "speed=5", **{"a/one": "fail"}) for seed in range(10)])
    alarms = false_alarms([result(seed, None, **{"a/one": "pass"}) for seed in range(500)])
    paths = write_tables(tmp_path, found, alarms, {"speed": "per cent"})
    page = paths[2].read_text(encoding="utf-8")
    assert "| speed | 5 | per cent |" in page
    assert "0 of 500, 0.0 % (0.0 to 0.7)" in page
    write_tables(tmp_path, found, [], {"speed": "per cent"})
    assert "nothing is told of false alarms" in paths[2].read_text(encoding="utf-8")
    assert json.loads(paths[1].read_text(encoding="utf-8"))["smallest_found"] == {"speed": 5.0}
    assert paths[0].read_text(encoding="utf-8").splitlines()[1].startswith("detection,speed,5.0,per cent,a/one,10,10,1.0,")
    assert paths[3].read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--faults", "nonsense"], "no fault 'nonsense'"),
        (["--cases", "atc-77"], "unknown case"),
        (["--faults", "none", "--no-sound"], "nothing to run"),
    ],
)
def test_what_makes_no_campaign_is_told(words, said, tmp_path, capsys):
    assert run(["campaign", *words, "--out", str(tmp_path)]) == 2
    assert said in capsys.readouterr().err


def test_the_command_runs_sound_and_broken_controllers(tmp_path):
    """The small version of what docs/detection_power.md shows."""
    words = ["--cases", "atc-1/direction", "--faults", "target-offset=1,10", "--seeds", "1", "--workers", "1", "--out", str(tmp_path)]
    done = subprocess.run([sys.executable, "-m", "mitl", "campaign", *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == ["target-offset: found from 10 mm on", "sound controller: 0 false alarms of 1 cases in 1 runs each"]
