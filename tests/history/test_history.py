"""History: runs are kept once and whole, trends and flicker come from measured values, gates and differences decide, and pages escape."""

import json
import sqlite3
from dataclasses import replace
from datetime import date

import numpy as np
import pytest

from mitl.cli import run as mitl
from mitl.engine.record import BudgetTerm, CaseRecord, CheckRecord, Message, RunRecord
from mitl.engine.results import text_of
from mitl.errors import UsageError
from mitl.history import markdown
from mitl.history.difference import difference_of
from mitl.history.gates import Gates, Known, judge, read_gates
from mitl.history.since import since_of
from mitl.history.store import open_store
from mitl.history.trend import cause_of, flicker_of, trends
from mitl.outcome import Outcome
from mitl.report import render

HOSTILE = "<script>alert(1)</script> | `x` @nobody https://example.invalid *bold*\n# title \u202egnirts"


def check(value=1.0, outcome=None, name="deviation", budget=(), **more):
    outcome = outcome or (Outcome.PASS if abs(value) < 4.0 else Outcome.FAIL if abs(value) > 6.0 else Outcome.INCONCLUSIVE)
    return CheckRecord(name, value, "mm", 5.0, 0.5, outcome, budget=tuple(budget), **more)


def made(folder, number, value=1.0, *, case="a/line", checks=None, outcome=None, **more):
    checks = (check(value),) if checks is None else checks
    worst = outcome or (checks[0].outcome if checks else Outcome.ERROR)
    cases = (CaseRecord(case, "Line", worst, 2.0, checks, () if checks else (Message("error", "lost"),)),)
    run = RunRecord("sim", "irb140", number, cases, {"mitl": "1"}, started=f"2026-01-{number:02d}T03:00:00+00:00", **more)
    target = folder / f"run-{number}"
    target.mkdir()
    (target / "results.json").write_text(text_of(run), encoding="utf-8")
    return target


def kept(tmp_path, values, **more):
    store = open_store(tmp_path / "h.sqlite", create=True)
    with store as opened:
        for number, value in enumerate(values, start=1):
            opened.add(made(tmp_path, number, value, **more))
        return opened.runs(), opened.checks(), since_of(opened, opened.run("last"))


def test_a_run_is_kept_once_with_all_that_its_checks_say(tmp_path):
    budget = (BudgetTerm("random", 0.3, "noise"), BudgetTerm("registration", 0.4))
    folder = made(tmp_path, 1, checks=(check(1.5, budget=budget, at_least=True, warning=True, guard=2.1),))
    with open_store(tmp_path / "h.sqlite", create=True) as store:
        assert [store.add(folder)[1] for _ in range(2)] == [True, False]
        (found,) = store.checks()
        assert found.check == check(1.5, budget=budget, at_least=True, warning=True, guard=2.1)
        assert (store.run("last"), store.run(found.run.id[:4])) == (found.run, found.run)
        store.remove(found.run.id)
        assert (store.runs(), store.checks(), store.cases()) == ([], [], [])


def test_a_run_that_cannot_be_kept_whole_is_not_kept_at_all(tmp_path):
    folder = made(tmp_path, 1, checks=(check(1.0), check(2.0)))  # one name twice
    with open_store(tmp_path / "h.sqlite", create=True) as store:
        with pytest.raises(UsageError, match="UNIQUE"):
            store.add(folder)
        assert store.runs() == []


@pytest.mark.parametrize("content", [b"rubbish" * 100, None])
def test_what_is_no_store_is_told(tmp_path, content):
    file = tmp_path / "h.sqlite"
    if content is None:
        with sqlite3.connect(file) as other:
            other.execute("CREATE TABLE mine (x)")
    else:
        file.write_bytes(content)
    with pytest.raises(UsageError, match=r"not a store|a store of version 0"), open_store(file) as store:
        store.runs()


def test_bad_since_is_the_first_run_of_the_last_unbroken_row(tmp_path):
    runs, checks, since = kept(tmp_path, [1.0, 9.0, 1.0, 9.0, 5.0, 8.0])
    (trend,) = trends(checks)
    assert (trend.bad_since, trend.bad_runs) == (runs[3], 3)
    assert (since["a/line"].started, since["a/line"].runs, since["a/line"].known) == (runs[3].started, 3, 5)
    assert since["a/line"].words == "since 2026-01-04 03:00, 3 runs in a row"


def test_runs_with_other_faults_are_another_trend(tmp_path):
    with open_store(tmp_path / "h.sqlite", create=True) as store:
        store.add(made(tmp_path, 1, 1.0))
        store.add(made(tmp_path, 2, 9.0, faults=("speed",)))
        store.add(made(tmp_path, 3, 1.1))
        assert sorted(len(trend.points) for trend in trends(store.checks())) == [1, 2]
        (mine,) = trends(store.checks(), store.run("last"))
        assert mine.values == [1.0, 1.1]


@pytest.mark.parametrize(
    ("values", "flickers"),
    [
        ([1.0, 1.1, 0.9, 1.0, 1.05], False),
        ([1.0, 1.1, 0.9, 1.0, 9.0], False),  # a step
        ([1.0, 1.1, 9.1, 9.0, 9.05, 8.95], False),  # a step and steady after it
        ([3.0, 4.5, 3.2, 4.4, 3.1], True),  # back and forth
        ([3.0, 3.9, 3.2, 3.8, 3.1], True),  # passes still, but within two spreads of the guard band's edge at 4.175
        ([3.0, 9.0, 3.0], False),  # too few to tell
    ],
)
def test_flicker_is_judged_from_measured_values(tmp_path, values, flickers):
    _, checks, _ = kept(tmp_path, values)
    assert (flicker_of(trends(checks)[0]) is not None) == flickers


def test_the_spread_is_split_by_cause_and_the_rest_is_the_controllers(tmp_path):
    generator = np.random.default_rng(1)
    budget = (BudgetTerm("random", 0.3), BudgetTerm("drift", 0.4), BudgetTerm("registration", 0.5), BudgetTerm("time", 0.1))
    with open_store(tmp_path / "h.sqlite", create=True) as store:
        for number in range(1, 29):
            value = 4.0 + float(generator.normal(0.0, 2.0))
            store.add(made(tmp_path, number, checks=(check(value, budget=budget),)))
        flicker = flicker_of(trends(store.checks())[0])
    assert sum(flicker.causes.values()) == pytest.approx(1.0)
    variance = flicker.spread**2
    assert flicker.causes["tracker"] == pytest.approx(0.25 / variance)
    assert flicker.causes["calibration"] == pytest.approx(0.25 / variance)
    assert flicker.causes["clock"] == pytest.approx(0.01 / variance)
    assert flicker.causes["controller"] == pytest.approx(1.0 - 0.51 / variance)
    assert cause_of(BudgetTerm("settling of the arm", 1.0)) == "controller"


def run_of(*cases, **more):
    return RunRecord("sim", "irb140", 1, tuple(CaseRecord(name, name, outcome) for name, outcome in cases), {}, **more)


DAY = date(2026, 6, 1)


@pytest.mark.parametrize(
    ("outcome", "known", "opens"),
    [
        (Outcome.PASS, None, True),
        (Outcome.FAIL, None, False),
        (Outcome.ERROR, None, False),
        (Outcome.INCONCLUSIVE, None, True),
        (Outcome.FAIL, Known("a/*", "x"), True),
        (Outcome.FAIL, Known("b/*", "x"), False),
        (Outcome.FAIL, Known("a/b", "x", Outcome.ERROR), False),
        (Outcome.FAIL, Known("a/b", "x", until=DAY), True),
        (Outcome.FAIL, Known("a/b", "x", until=date(2026, 5, 31)), False),
    ],
)
def test_a_gate_is_closed_by_what_nobody_expects_on_that_day(outcome, known, opens):
    result = judge(run_of(("a/b", outcome)), Gates(known=(known,) if known else ()), DAY)
    assert result.open == opens


def test_gates_count_and_tell_what_is_fixed_and_never_pass_an_interrupted_run():
    run = run_of(("a", Outcome.INCONCLUSIVE), ("b", Outcome.INCONCLUSIVE), ("c", Outcome.PASS))
    known = Known("c", "was bad")
    assert judge(run, Gates(inconclusive_at_most=1), DAY).broken == ("2 cases inconclusive, at most 1 are let through",)
    assert judge(run, Gates(inconclusive_at_most=2, known=(known,)), DAY).fixed == (known,)
    assert not judge(replace(run, interrupted=True), Gates(), DAY).open


def test_a_gates_file_is_read_as_its_documentation_shows_it(tmp_path):
    import mitl.history.gates as module

    file = tmp_path / "gates.toml"
    file.write_text(module.__doc__.partition("\n\n")[2], encoding="utf-8")
    found = Known("atc-2/zone-speed", "the tracker cannot judge it", Outcome.INCONCLUSIVE, date(2027, 1, 31))
    assert read_gates(file) == Gates((Outcome.FAIL, Outcome.ERROR), 3, 0, (found,))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[gates]", "unknown key 'gates', known are gate, known"),
        ("[gate]\nfail_on = ['bad']", "fail_on: expected one of pass, fail, inconclusive, error, skipped, found 'bad'"),
        ("[gate]\ninconclusive_at_most = -1", "expected a whole number from 0 on, found -1"),
        ("[[known]]\ncase = 'a'", "[[known]] 1 needs a case and a reason"),
        ("[[known]]\ncase = 'a'\nreason = 'b'\nuntil = 'soon'", "until: expected a day such as 2027-01-31, found 'soon'"),
        ("[[known]]\ncase = 'a'\nreason = 'b'\nhow = 1", "unknown key 'how'"),
        ("gate = 1", "expected a section [gate]"),
        ("x =", "not valid TOML"),
    ],
)
def test_a_wrong_gates_file_is_told_with_its_key(tmp_path, text, told):
    (tmp_path / "g.toml").write_text(text)
    with pytest.raises(UsageError) as error:
        read_gates(tmp_path / "g.toml")
    assert told in str(error.value)


def test_a_difference_is_what_uncertainty_does_not_explain(tmp_path):
    def run(value, outcome, **more):
        return RunRecord("sim", "irb140", 1, (CaseRecord("a", "A", outcome, 1.0, (check(value),)),), {"mitl": "1"}, **more)

    same = difference_of(run(1.0, Outcome.PASS), run(2.0, Outcome.PASS))
    assert (same.cases, same.checks, same.settings) == ((), (), ())  # 1 mm of 0.7 mm
    moved = difference_of(run(1.0, Outcome.PASS), run(9.0, Outcome.FAIL, faults=("speed",)))
    assert [case.id for case in moved.worse] == ["a"]
    assert moved.checks[0].sigmas == pytest.approx(8.0 / np.hypot(0.5, 0.5))
    assert moved.settings == (("faults", "none", "speed"),)
    assert [case.id for case in difference_of(run(9.0, Outcome.FAIL), run(1.0, Outcome.PASS)).better] == ["a"]


def test_markdown_is_inert(tmp_path):
    case = CaseRecord(HOSTILE, HOSTILE, Outcome.FAIL, 1.0, (check(9.0, name=HOSTILE),))
    run = RunRecord(HOSTILE, HOSTILE, 1, (case,), {HOSTILE: HOSTILE}, (HOSTILE,))
    gate = judge(run, Gates(known=(Known("*", HOSTILE),)), DAY)
    for text in (markdown.summary(run, {}, gate), markdown.difference(difference_of(run, replace(run, rig="x", cases=())), (HOSTILE, "b"))):
        assert "<script" not in text
        assert "@nobody" not in text
        assert "://example" not in text
        assert "\n# title" not in text
        tables = [line for line in text.splitlines() if line.startswith("|")]
        assert tables
        assert len({line.replace("\\|", "").count("|") for line in tables[:2]}) == 1


def test_the_commands_work_together(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for number, value in enumerate([1.0, 1.2, 9.0, 9.1], start=1):
        made(tmp_path, number, value)
    assert mitl(["history", "runs"]) == 2
    assert "there is no history yet" in capsys.readouterr().err
    assert mitl(["history", "add", "run-1", "run-2", "run-3", "run-4"]) == 0
    assert "since 2026-01-03 03:00, 2 runs in a row" in render(tmp_path / "run-4")
    capsys.readouterr()
    assert mitl(["history", "runs", "--format", "json"]) == 0
    assert [run["outcome"] for run in json.loads(capsys.readouterr().out)] == ["pass", "pass", "fail", "fail"]
    assert mitl(["history", "trend", "a"]) == 0
    assert "not passing since 2026-01-03T03:00:00" in capsys.readouterr().out
    assert mitl(["diff", "run-1", "run-2"]) == 0
    assert mitl(["diff", "run-1", "run-3", "--format", "json"]) == 1
    assert mitl(["gate", "run-1"]) == 0
    (tmp_path / "g.toml").write_text("[[known]]\ncase='a/*'\nreason='known'\nuntil=2026-12-31\n")
    assert mitl(["gate", "run-3", "g.toml", "--today", "2026-12-31"]) == 0
    assert mitl(["gate", "run-3", "g.toml", "--today", "2027-01-01"]) == 1
    assert mitl(["history", "forget", "last"]) == 0
    assert mitl(["history", "trend", "--run", "zzz"]) == 2


def test_allure_files_have_status_history_and_attachments(tmp_path):
    folder = made(tmp_path, 1, 9.0)
    assert mitl(["gate", str(folder), "--allure", str(tmp_path / "allure")]) == 1
    (file,) = (tmp_path / "allure").glob("*-result.json")
    found = json.loads(file.read_text())
    assert (found["status"], found["fullName"], found["steps"][0]["status"]) == ("failed", "a/line", "failed")
    assert found["stop"] - found["start"] == 2000
    assert "rig=sim" in (tmp_path / "allure" / "environment.properties").read_text()
    again = made(tmp_path, 2, 1.0)
    assert mitl(["gate", str(again), "--allure", str(tmp_path / "allure")]) == 0
    assert len({json.loads(each.read_text())["historyId"] for each in (tmp_path / "allure").glob("*-result.json")}) == 1


def test_the_trend_page_is_one_document_without_markup_from_outside(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made(tmp_path, 1, 1.0, case=HOSTILE)
    made(tmp_path, 2, 9.0, case=HOSTILE)
    assert mitl(["history", "add", "run-1", "run-2"]) == 0
    assert mitl(["history", "page", "--html", "t.html"]) == 0
    text = (tmp_path / "t.html").read_text(encoding="utf-8")
    assert "<script>alert" not in text
    assert text.count("<article") == 1
