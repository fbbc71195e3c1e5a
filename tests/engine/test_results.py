"""results.json and junit.xml: what is written can be read, hostile text does no harm, what does not fit is refused with its place."""

import json
from dataclasses import replace

import pytest
from defusedxml import ElementTree
from hypothesis import given
from hypothesis import strategies as st

from mitl.engine import junit, results
from mitl.engine.record import BudgetTerm, CaseRecord, CheckRecord, Message, RunRecord
from mitl.errors import UsageError
from mitl.outcome import Outcome

texts = st.text(max_size=40).map(lambda text: text.encode("utf-8", "replace").decode())
numbers = st.floats(-1e9, 1e9)
checks = st.builds(
    CheckRecord,
    name=texts,
    value=st.none() | numbers,
    unit=texts,
    limit=numbers,
    uncertainty=st.none() | st.floats(0.0, 1e9),
    outcome=st.sampled_from(Outcome),
    at_least=st.booleans(),
    warning=st.booleans(),
    series=st.none() | texts,
    budget=st.lists(st.builds(BudgetTerm, name=texts, value=numbers, source=texts), max_size=2).map(tuple),
)
cases = st.builds(
    CaseRecord,
    id=texts,
    title=texts,
    outcome=st.sampled_from(Outcome),
    duration_s=st.floats(0.0, 1e6),
    checks=st.lists(checks, max_size=3).map(tuple),
    messages=st.lists(st.builds(Message, level=texts, text=texts), max_size=2).map(tuple),
    recording=st.none() | st.just("a.mcap"),
    purpose=texts,
    catches=st.lists(texts, max_size=2).map(tuple),
    program=st.none() | texts,
    source=st.none() | texts,
)
runs = st.builds(
    RunRecord,
    rig=texts,
    robot=texts,
    seed=st.integers(0, 2**64),
    cases=st.lists(cases, max_size=3).map(tuple),
    versions=st.dictionaries(texts, texts, max_size=2),
    faults=st.lists(texts, max_size=2).map(tuple),
    started=st.just("2026-01-02T03:04:05+00:00"),
    wall_s=st.floats(0.0, 1e6),
    interrupted=st.booleans(),
)

PLAIN = RunRecord(
    "sim",
    "irb140",
    1,
    (
        CaseRecord("a/pass", "A", Outcome.PASS, 2.5, (CheckRecord("x", 1.0, "mm", 2.0, 0.1, Outcome.PASS),), recording="a_pass.mcap"),
        CaseRecord("a/fail", "B", Outcome.FAIL, 1.0, (CheckRecord("y", 3.0, "mm", 2.0, 0.1, Outcome.FAIL),)),
        CaseRecord("a/error", "C", Outcome.ERROR, messages=(Message("error", "lost <b>&"),)),
        CaseRecord("a/vague", "D", Outcome.INCONCLUSIVE, 0.0, (CheckRecord("z", 2.0, "mm", 2.0, 0.1, Outcome.INCONCLUSIVE),)),
    ),
    {"mitl": "1"},
)


@given(runs)
def test_what_is_written_is_read_again(run):
    text = results.text_of(run)
    assert results.run_of(json.loads(text), "results.json") == run


def test_the_keys_of_the_contract_are_there_in_its_order():
    value = results.to_json(PLAIN)
    contract = {
        "run": (value, ["schema", "outcome", "rig", "seed", "versions", "cases"]),
        "case": (value["cases"][0], ["id", "title", "outcome", "duration_s", "checks", "messages", "recording"]),
        "check": (value["cases"][0]["checks"][0], ["name", "value", "unit", "limit", "uncertainty", "outcome"]),
    }
    for found, keys in contract.values():
        assert [key for key in found if key in keys] == keys
    assert value["schema"] == 1
    assert value["outcome"] == "fail"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda v: v.pop("seed"), "'seed' is missing"),
        (lambda v: v.update(schema=2), "schema 2; this mitl reads schema 1"),
        (lambda v: v.update(seed="1"), 'seed: expected a whole number, found "1"'),
        (lambda v: v.update(seed=True), "seed: expected a whole number, found true"),
        (lambda v: v.update(outcome="pass"), "outcome is 'pass', but its cases make it 'fail'"),
        (lambda v: v["cases"][1].update(outcome="good"), "cases[1]: outcome: expected one of pass, fail, inconclusive, error, skipped"),
        (lambda v: v["cases"][0]["checks"][0].update(limit=None), "cases[0]: checks[0]: limit: expected a number, found null"),
        (lambda v: v["cases"][0].update(recording="../a.mcap"), "cases[0]: recording: expected the name of a file in the run's folder"),
        (lambda v: v.update(cases={}), "cases: expected a list, found {}"),
    ],
)
def test_what_does_not_fit_is_refused_with_its_place(tmp_path, change, message):
    value = results.to_json(PLAIN)
    change(value)
    (tmp_path / "results.json").write_text(json.dumps(value))
    with pytest.raises(UsageError) as caught:
        results.read_run(tmp_path)
    assert f"{tmp_path}/results.json" in str(caught.value)
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"), [("{", "not JSON"), ('{"schema": NaN}', "NaN is no JSON number"), ("[" * 100_000, "not JSON")]
)
def test_what_is_no_json_is_refused(tmp_path, text, message):
    (tmp_path / "results.json").write_text(text)
    with pytest.raises(UsageError, match=message):
        results.read_run(tmp_path)


@given(runs)
def test_junit_is_well_formed_whatever_the_text(run):
    root = ElementTree.fromstring(junit.text_of(run))
    assert len(root.findall(".//testcase")) == len(run.cases)


def test_junit_tells_failures_errors_and_skips_apart():
    root = ElementTree.fromstring(junit.text_of(PLAIN))
    suite = root.find("testsuite")
    assert [suite.get(key) for key in ("tests", "failures", "errors", "skipped")] == ["4", "1", "1", "1"]
    passed, failed, broken, vague = suite.findall("testcase")
    assert (passed.get("classname"), passed.get("name"), passed.get("time")) == ("mitl.a", "pass", "2.500")
    assert [child.tag for child in passed] == ["properties"]
    assert failed.find("failure").get("message") == "fail: y: 3 mm, limit 2 mm (1 mm beyond), u = 0.1 mm: fail"
    assert broken.find("error").text == "lost <b>&"
    assert vague.find("skipped").get("message").startswith("inconclusive: z: 2 mm")


@pytest.mark.parametrize(
    ("outcomes", "interrupted", "expected"),
    [
        (["pass", "pass"], False, "pass"),
        (["pass", "inconclusive"], False, "inconclusive"),
        (["inconclusive", "error"], False, "error"),
        (["error", "fail"], False, "fail"),
        (["pass", "skipped"], True, "error"),
        ([], False, "skipped"),
    ],
)
def test_the_outcome_of_a_run_is_the_worst_of_its_cases(outcomes, interrupted, expected):
    cases = tuple(CaseRecord(str(number), "", Outcome(outcome)) for number, outcome in enumerate(outcomes))
    assert replace(PLAIN, cases=cases, interrupted=interrupted).outcome is Outcome(expected)
