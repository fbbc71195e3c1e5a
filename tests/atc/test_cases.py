"""The test cases themselves: sound declarations, a pass on a sound controller, and a FAIL for the faults that they name.

Every fault is injected once, and every case has to fail at least once; `mitl campaign` does it for every pair and many seeds.
"""

import importlib
import json
import subprocess
import sys
from pathlib import Path

import pytest

import mitl.atc
import rapid_interp
from mitl.controllers.faults import KINDS

MODULES = sorted(f"mitl.atc.{path.stem}" for path in Path(mitl.atc.__file__).parent.glob("test_*.py"))
CASES = {
    mark.args[0].id: mark.args[0]
    for name in MODULES
    for function in vars(importlib.import_module(name)).values()
    for mark in getattr(function, "pytestmark", [])
    if mark.name == "mitl_case"
}
USUAL = {name: case for name, case in CASES.items() if not case.long}
QUICK = ("atc-0/verify", "atc-1/linear", "atc-1/direction", "atc-2/path-speed", "atc-4/hiccups", "atc-5/reorientation")
BATCHES = 4


def verify_all(folder, runs):
    """Gives exit codes and records of several runs by name."""
    script = Path(__file__).with_name("verify_all.py")
    command = [sys.executable, str(script), str(folder), *(f"{name}:{' '.join(words)}" for name, words in runs.items())]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    codes = json.loads(done.stdout.splitlines()[-1])
    return {name: (codes[name], json.loads((folder / name / "results.json").read_text(encoding="utf-8"))) for name in runs}


def outcomes(record):
    return {case["id"]: case["outcome"] for case in record["cases"]}


def numbers(record):
    return [(case["id"], check["name"], check["value"], check["uncertainty"]) for case in record["cases"] for check in case["checks"]]


def cover():
    """Gives for every fault the cases that are to fail for it: the quickest that names it, and every case at least once."""
    naming = {fault: [case for case in USUAL.values() if fault in case.catches] for fault in KINDS}
    chosen = {fault: {min(cases, key=lambda case: case.typical_s).id} for fault, cases in naming.items()}
    for case in USUAL.values():
        if not any(case.id in cases for cases in chosen.values()):
            chosen[case.catches[0]].add(case.id)
    return {fault: sorted(cases) for fault, cases in chosen.items()}


@pytest.mark.parametrize("case", CASES.values(), ids=lambda case: case.id)
def test_a_case_says_what_it_is_for_and_what_it_must_catch(case):
    assert case.title
    assert case.purpose
    assert case.requirement
    assert case.limit_source
    assert case.catches
    assert set(case.catches) <= set(KINDS)
    assert case.long or case.typical_s <= 600.0
    rapid_interp.load([case.program])


def test_every_fault_is_named_by_a_case():
    assert {fault for case in USUAL.values() for fault in case.catches} == set(KINDS)


@pytest.mark.parametrize("batch", range(BATCHES))
def test_cases_fail_for_the_faults_that_they_name(batch, tmp_path):
    chosen = dict(list(cover().items())[batch::BATCHES])
    runs = {fault: [*cases, "--fault", fault, "--seed", "1"] for fault, cases in chosen.items()}
    found = verify_all(tmp_path, runs)
    assert {fault: outcomes(record) for fault, (_, record) in found.items()} == {
        fault: dict.fromkeys(cases, "fail") for fault, cases in chosen.items()
    }
    assert {code for code, _ in found.values()} == {1}


def test_a_sound_controller_fails_nothing(tmp_path):
    """Seed 1 runs all cases as CI's main job; here other seeds run a few."""
    found = verify_all(tmp_path, {seed: [*QUICK, "--seed", seed] for seed in ("2", "3")})
    for code, record in found.values():
        assert set(outcomes(record)) == set(QUICK)
        assert set(outcomes(record).values()) <= {"pass", "inconclusive"}
        assert code in {0, 3}


def test_speed_through_a_zone_is_open_with_the_thesiss_tracker_and_passes_with_an_ideal_one(tmp_path):
    rig = tmp_path / "ideal.toml"
    rig.write_text('[rig]\nkind = "simulation"\ntracker = "ideal"\n')
    found = verify_all(tmp_path, {"thesis": ["atc-2/zone-speed"], "ideal": ["atc-2/zone-speed", "--rig", str(rig)]})
    assert {name: code for name, (code, _) in found.items()} == {"thesis": 3, "ideal": 0}


def test_the_same_seed_gives_the_same_numbers_and_another_seed_others(tmp_path):
    found = verify_all(
        tmp_path,
        {"a": ["atc-0/verify", "atc-1/linear", "--seed", "1"], "b": ["atc-1/linear", "--seed", "1"], "c": ["atc-1/linear", "--seed", "5"]},
    )
    first, alone, other = (numbers(found[name][1]) for name in "abc")
    assert [row for row in first if row[0] == "atc-1/linear"] == alone
    assert all(ours[2] != theirs[2] for ours, theirs in zip(alone, other, strict=True))


def test_the_page_of_test_cases_is_up_to_date():
    page = Path(__file__).parents[2] / "docs" / "test_cases.md"
    command = [sys.executable, "-m", "mitl", "verify", "--list", "--format", "markdown"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert page.read_text(encoding="utf-8") == done.stdout, "run: mitl verify --list --format markdown > docs/test_cases.md"
