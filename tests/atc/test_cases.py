"""The test cases themselves: sound declarations, a pass on a sound controller, and a FAIL for every fault that they name."""

import importlib
import json
import subprocess
import sys

import pytest

import rapid_interp
from mitl.controllers.faults import KINDS

SEED = "1"
MODULES = ("mitl.atc.test_atc_0", "mitl.atc.test_atc_1")
CASES = {
    mark.args[0].id: mark.args[0]
    for name in MODULES
    for function in vars(importlib.import_module(name)).values()
    for mark in getattr(function, "pytestmark", [])
    if mark.name == "mitl_case"
}


def verify(folder, *words, seed=SEED):
    command = [sys.executable, "-m", "mitl", "verify", *words, "--seed", seed, "--out", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode in {0, 1, 3, 4}, done.stderr
    return done.returncode, json.loads((folder / "results.json").read_text(encoding="utf-8"))


def outcomes(record):
    return {case["id"]: case["outcome"] for case in record["cases"]}


def numbers(record):
    return [(case["id"], check["name"], check["value"], check["uncertainty"]) for case in record["cases"] for check in case["checks"]]


@pytest.mark.parametrize("case", CASES.values(), ids=lambda case: case.id)
def test_a_case_says_what_it_is_for_and_what_it_must_catch(case):
    assert case.title
    assert case.purpose
    assert case.requirement
    assert case.limit_source
    assert case.catches
    assert set(case.catches) <= set(KINDS)
    rapid_interp.load([case.program])


def test_every_fault_is_named_by_a_case():
    assert {fault for case in CASES.values() for fault in case.catches} == set(KINDS)


@pytest.mark.parametrize("fault", KINDS)
def test_every_case_fails_for_each_fault_that_it_names(fault, tmp_path):
    wanted = [case.id for case in CASES.values() if fault in case.catches]
    code, record = verify(tmp_path, *wanted, "--fault", fault)
    assert outcomes(record) == dict.fromkeys(wanted, "fail")
    assert code == 1


@pytest.mark.parametrize("seed", ["2", "3"])
def test_a_sound_controller_fails_nothing(seed, tmp_path):
    code, record = verify(tmp_path, seed=seed)
    found = outcomes(record)
    assert list(found) == list(CASES)
    assert set(found.values()) <= {"pass", "inconclusive"}
    # TUR of the tool tip is near 1.5: now and then the honest answer is that the tracker cannot tell
    assert [case for case, outcome in found.items() if outcome == "inconclusive"] in ([], ["atc-0/tool-offset"])
    assert code in {0, 3}


def test_the_same_seed_gives_the_same_numbers_and_another_seed_others(tmp_path):
    first = numbers(verify(tmp_path / "a", "atc-0/verify", "atc-1/linear")[1])
    alone = numbers(verify(tmp_path / "b", "atc-1/linear")[1])
    other = numbers(verify(tmp_path / "c", "atc-1/linear", seed="5")[1])
    assert [row for row in first if row[0] == "atc-1/linear"] == alone
    assert all(ours[2] != theirs[2] for ours, theirs in zip(alone, other, strict=True))
