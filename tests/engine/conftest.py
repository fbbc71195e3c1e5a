"""Runs pytest on small case files with the closed-form rig of line_rig.py."""

import json
from pathlib import Path

import pytest

# pytester forgets what an inner run imported; numpy and scipy cannot be imported twice, so they are here before the first of them
import mitl.engine
import mitl.report  # noqa: F401

CONFTEST = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
from line_rig import make_rig

def pytest_mitl_load_rig(config, name, seed, faults):
    config.stop_counter = made = make_rig(seed, faults) if name == "line" else None
    return made

def pytest_configure(config):
    config.option.mitl_calibration = str(config.rootpath / "line.mod")

def pytest_unconfigure(config):
    rig = getattr(config, "stop_counter", None)
    if rig is not None:
        (config.rootpath / "end.txt").write_text(f"{{rig.controller.stops}} {{rig.controller.running}}")
"""
PROGRAM = """MODULE Line
  VAR num option := 0;
  VAR num subOption := 0;
  PERS num poseCount := 12;
ENDMODULE
"""
HEAD = """
import numpy as np
import pytest
from mitl.engine import case
"""


@pytest.fixture
def cases(pytester):
    """Gives a function that runs case files given as text and gives pytest's result; results() reads results.json."""
    pytester.makeconftest(CONFTEST)
    pytester.makefile(".mod", line=PROGRAM)

    def run(text, *options, rig="line"):
        pytester.makepyfile(test_cases=HEAD + text)
        return pytester.runpytest_inprocess("-p", "no:cacheprovider", f"--mitl-rig={rig}", "--mitl-out=out", "-rA", *options)

    run.results = lambda folder="out": json.loads((pytester.path / folder / "results.json").read_text())
    run.path = pytester.path
    return run
