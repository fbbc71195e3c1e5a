"""`mitl health`: a sound rig is well, every figure can fail, and what a run does with the result."""

import json
import re
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from mitl import health
from mitl.cli import run
from mitl.cli.verify import Observer, run_pytest
from mitl.engine.health import CHANGE, read_health, sickness
from mitl.errors import UsageError
from mitl.outcome import Outcome
from mitl.protocols import HealthGate

PRESET = Path(__file__).parents[2] / "models" / "trackers" / "thesis.toml"
CASES = Path(health.__file__).parent
RIG = '[rig]\ntracker = "{tracker}"\n[health]\nrecord = "health.json"\nbaseline = "healthy.json"\n{more}'


def rig_file(folder, tracker="thesis", more=""):
    file = folder / "cell.toml"
    file.write_text(RIG.format(tracker=tracker, more=more), encoding="utf-8")
    return str(file)


@pytest.fixture(scope="module")
def ideal(tmp_path_factory):
    """A rig whose baseline was set with a perfect tracker."""
    folder = tmp_path_factory.mktemp("ideal")
    words = ["health", "--rig", rig_file(folder, "ideal"), "--out", str(folder / "run"), "--set-baseline", "--reason", "new mount"]
    assert run(words) == 0
    return folder


def figures(rig, *options):
    """Runs the health check's cases and gives the outcome of every check."""
    observer = Observer(progress=False)
    run_pytest(CASES, [f"--mitl-rig={rig}", "--mitl-repeats=1", "--mitl-health=ignore", *options], observer)
    return {check.name: check for case in observer.run.cases for check in case.checks}


def test_a_sound_rig_is_well_and_its_record_can_be_read_again(ideal):
    found = read_health(ideal / "health.json")
    assert found.outcome is Outcome.PASS
    assert found.reason == "new mount"
    assert {figure.outcome for figure in found.figures} == {Outcome.PASS}
    assert found == read_health(ideal / "healthy.json")
    assert found.versions["mitl"]


def test_a_tracker_that_is_worse_than_in_the_baseline_is_seen_though_it_is_within_its_limits(ideal):
    checks = figures(rig_file(ideal, "thesis"), f"--mitl-baseline={ideal / 'healthy.json'}", "--mitl-case=health/tracker")
    jitter = "jitter of a standing point"
    assert checks[jitter].outcome is Outcome.PASS
    assert checks[jitter + CHANGE].outcome is Outcome.FAIL
    assert any(term.name == "baseline" for term in checks[jitter + CHANGE].budget)


@pytest.mark.parametrize(
    ("case", "faults", "names"),
    [
        ("places", ["scatter"], ["repeatability"]),
        (
            "places",
            ["target-offset", "wrong-work-object"],
            ["places away from the program", "orientations away from the program"],
        ),
        ("places", ["joint-drift=0.4"], ["drift from first to last tours"]),
        ("speed", ["speed"], ["speed of a line, off by"]),
        ("reaction", ["late-start"], ["mean reaction"]),
    ],
)
def test_a_figure_fails_where_the_robot_is_at_fault(case, faults, names):
    checks = figures("sim", f"--mitl-case=health/{case}", *(f"--mitl-fault={fault}" for fault in faults))
    assert {name: checks[name].outcome for name in names} == dict.fromkeys(names, Outcome.FAIL)


@pytest.mark.parametrize(
    ("names", "keys"),
    [
        (["jitter of a standing point", "glitches"], {"fast_sd_m": 0.0006, "probability_per_stop": 0.5}),
        (["longest gap between samples"], {"rate_hz": 15.0}),
        (["valid samples"], {"rate_per_s": 1.0}),
    ],
)
def test_a_figure_fails_where_the_tracker_is_worse(tmp_path, names, keys):
    text = PRESET.read_text(encoding="utf-8")
    for key, value in keys.items():
        changed = re.sub(rf"(?m)^{key}\s*=\s*[^#\n]*", f"{key} = {value} ", text, count=1)
        assert changed != text
        text = changed
    (tmp_path / "worse.toml").write_text(text, encoding="utf-8")
    checks = figures(rig_file(tmp_path, "worse.toml"), "--mitl-case=health/tracker")
    assert {name: checks[name].outcome for name in names} == dict.fromkeys(names, Outcome.FAIL)


# --- what a run does with the result -----------------------------------------------------------------------------------------------


def verify(folder, *words):
    out = folder / "verified"
    code = run(["verify", "atc-1/orientation", "--rig", str(folder / "cell.toml"), "--repeats", "1", "--out", str(out), *words])
    return code, json.loads((out / "results.json").read_text(encoding="utf-8"))


def test_a_run_on_a_rig_that_was_never_checked_is_refused_and_says_so(tmp_path):
    rig_file(tmp_path)
    code, found = verify(tmp_path)
    assert code == 4
    assert "there is no health check" in found["health"]
    (case,) = found["cases"]
    assert any("run mitl health" in message["text"] for message in case["messages"])
    assert case["duration_s"] == 0.0


def test_a_run_on_a_sick_rig_is_marked_where_the_rig_file_says_so(tmp_path):
    rig_file(tmp_path, more='on_sick = "mark"')
    code, found = verify(tmp_path)
    assert code == 0
    assert "there is no health check" in found["health"]
    (case,) = found["cases"]
    assert any(message["level"] == "warning" and "may be sick" in message["text"] for message in case["messages"])


def test_a_run_on_a_rig_that_is_well_goes_on_unmarked(ideal, tmp_path):
    rig_file(tmp_path, "ideal")
    (tmp_path / "health.json").write_text((ideal / "health.json").read_text(encoding="utf-8"), encoding="utf-8")
    code, found = verify(tmp_path)
    assert code == 0
    assert found["health"] == ""


def spoilt(ideal, tmp_path, **changes):
    content = json.loads((ideal / "health.json").read_text(encoding="utf-8"))
    file = tmp_path / "health.json"
    file.write_text(json.dumps({**content, **changes}), encoding="utf-8")
    record = read_health(file)
    return HealthGate(file), record


def test_a_health_check_that_is_too_old_or_of_another_rig_or_bad_vouches_for_nothing(ideal, tmp_path):
    gate, record = spoilt(ideal, tmp_path)
    made = datetime.fromisoformat(record.date)
    assert sickness(gate, "cell", "irb140", made + timedelta(hours=23)) == ""
    assert "25 h old; at most 24 h" in sickness(gate, "cell", "irb140", made + timedelta(hours=25))
    assert "in the future" in sickness(gate, "cell", "irb140", made - timedelta(hours=1))
    assert "not of cell with irb120" in sickness(gate, "cell", "irb120", made)
    for outcome in ("fail", "inconclusive", "error", "skipped"):
        gate, _ = spoilt(ideal, tmp_path, outcome=outcome)
        assert f"is {outcome}" in sickness(gate, "cell", "irb140", made)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"schema": 2}, "of schema 1"),
        ({"kind": "else"}, "made by mitl health"),
        ({"date": "2026-11-26T10:00:00"}, "offset from UTC"),
        ({"outcome": "fine"}, "outcome"),
        ({"figures": [{"name": "x"}]}, "missing"),
    ],
)
def test_a_record_that_does_not_fit_the_schema_is_refused_and_vouches_for_nothing(ideal, tmp_path, changes, told):
    with pytest.raises(UsageError, match=told):
        spoilt(ideal, tmp_path, **changes)
    assert "cannot be read" in sickness(HealthGate(tmp_path / "health.json"), "cell", "irb140", datetime.now(UTC))


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ("recrod = 1", "did you mean record"),
        ("max_age_h = 0", "more than 0"),
        ("max_age_h = true", "max_age_h"),
        ('on_sick = "ignore"', "refuse or mark"),
    ],
)
def test_a_wrong_section_is_refused_with_its_key(tmp_path, capsys, more, told):
    assert run(["verify", "atc-0", "--rig", rig_file(tmp_path, more=more), "--out", str(tmp_path / "run")]) == 2
    assert told in capsys.readouterr().err


def test_a_baseline_needs_a_reason_and_no_fault(tmp_path, capsys):
    rig = rig_file(tmp_path)
    assert run(["health", "--rig", rig, "--set-baseline"]) == 2
    assert "--reason" in capsys.readouterr().err
    assert run(["health", "--rig", rig, "--set-baseline", "--reason", "x", "--fault", "speed"]) == 2
    assert "--fault" in capsys.readouterr().err
    assert run(["health", "--rig", rig]) == 2
    assert "healthy.json" in capsys.readouterr().err


def test_a_baseline_of_another_rig_is_refused(ideal, tmp_path, capsys):
    rig = rig_file(tmp_path, "ideal").replace("cell", "cell")
    other = tmp_path / "other.toml"
    other.write_text(Path(rig).read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "healthy.json").write_text((ideal / "healthy.json").read_text(encoding="utf-8"), encoding="utf-8")
    assert run(["health", "--rig", str(other), "--out", str(tmp_path / "run")]) == 2
    assert "another rig: 'cell', now 'other'" in capsys.readouterr().err
    assert not (tmp_path / "health.json").exists()
