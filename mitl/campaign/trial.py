"""One trial: pytest with our plug-in, in this process, nothing kept but the outcomes.

Invariant: the same trial gives the same outcomes wherever it is run.
"""

from __future__ import annotations

import io
import os
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path

import pytest

from mitl import atc
from mitl.campaign.plan import Trial
from mitl.errors import MitlError, UsageError


@dataclass(frozen=True)
class TrialResult:
    """A trial's key, seed and fault, and the outcome of every case that was run."""

    key: str
    seed: int
    fault: str | None
    outcomes: dict[str, str]


class _Outcomes:
    """Pytest plug-in: takes the outcomes as cases finish, and ends a trial that is run until something is found."""

    def __init__(self, *, until_found: bool) -> None:
        self.found: dict[str, str] = {}
        self._until_found = until_found

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Takes the record of a finished case."""
        finished = getattr(report, "mitl", None)
        if finished is not None:
            self.found[finished["case"]["id"]] = finished["case"]["outcome"]

    def pytest_runtest_logfinish(self) -> None:
        """Ends the session where a case has failed and no other is wanted."""
        if self._until_found and "fail" in self.found.values():
            pytest.exit("a case has failed", returncode=pytest.ExitCode.TESTS_FAILED)


def run_trial(trial: Trial) -> TrialResult:
    """Gives the outcomes of a trial. Raises UsageError for a bad rig, fault or case, MitlError where pytest breaks down."""
    folder = Path(atc.__file__).resolve().parent
    outcomes = _Outcomes(until_found=trial.until_found)
    own = ["-c", os.devnull, f"--rootdir={folder}", "--noconftest", "--import-mode=importlib", "-p", "mitl.pytest_plugin"]
    quiet = ["-p", "no:cacheprovider", "-p", "no:terminal"]
    asked = [f"--mitl-rig={trial.rig}", f"--mitl-seed={trial.seed}", "--mitl-in-order", *(f"--mitl-case={case}" for case in trial.cases)]
    broken = [f"--mitl-fault={trial.fault}"] if trial.fault is not None else []
    told = io.StringIO()
    before = os.environ.get("PYTEST_DISABLE_PLUGIN_AUTOLOAD")
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    try:
        with redirect_stderr(told), redirect_stdout(told):
            code = pytest.main([str(folder), *own, *quiet, *asked, *broken], plugins=[outcomes])
    finally:
        if before is None:
            del os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"]
        else:
            os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = before
    if code is pytest.ExitCode.USAGE_ERROR:
        raise UsageError(told.getvalue().removeprefix("ERROR: ").strip())
    if not outcomes.found:
        raise MitlError(f"{trial.key}: pytest ended with {code!r} and no case was run: {told.getvalue().strip()}")
    return TrialResult(trial.key, trial.seed, trial.fault, outcomes.found)
