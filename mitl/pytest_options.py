"""The options of the pytest plug-in, --mitl-..., and the hooks that it offers.

It is loaded in every pytest run of whoever has mitl installed: it imports nothing but pytest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from mitl.engine.calibration_session import SessionCalibration
    from mitl.engine.record import RunRecord
    from mitl.protocols import Rig


class HookSpecifications:
    """The hook that this plug-in offers to a conftest.py."""

    @pytest.hookspec(firstresult=True)
    def pytest_mitl_load_rig(self, config: pytest.Config, name: str, seed: int, faults: tuple[str, ...]) -> Rig | None:
        """Gives the rig called `name`, or None if it is not known here: for a rig of one's own that no rig.toml describes."""

    @pytest.hookspec(firstresult=True)
    def pytest_mitl_calibration(self, rig: Rig, case_id: str) -> SessionCalibration | None:
        """Gives the calibration for a case, or None where the session's own is to be used: for runs that are judged again."""

    @pytest.hookspec
    def pytest_mitl_run_finished(self, run: RunRecord, unwritten: str) -> None:
        """Tells the run's record when all has ended; unwritten: why the folder does not hold it as it is, or ""."""


def add_options(parser: pytest.Parser) -> None:
    """Adds the options of mitl to pytest's."""
    group = parser.getgroup("mitl", "mitl: verify robot controllers")
    group.addoption("--mitl-rig", default="sim", metavar="RIG", help="sim (default) or a rig.toml file")
    group.addoption("--mitl-seed", default=1, type=int, metavar="N", help="seed of the simulated rig (default 1)")
    group.addoption("--mitl-fault", action="append", default=[], metavar="NAME[=SIZE]", help="break the simulated controller on purpose")
    group.addoption("--mitl-case", action="append", default=[], metavar="CASE", help="run only this case id, or those below it")
    group.addoption("--mitl-in-order", action="store_true", help="run cases in the order of the --mitl-case that asked for them")
    group.addoption(
        "--mitl-calibration", default=None, metavar="FILE", help="RAPID program with the calibration poses (default: the rig's)"
    )
    group.addoption(
        "--mitl-repeats",
        default=3,
        type=int,
        metavar="N",
        help="run an inconclusive case at most N times, as a sequential test (default 3)",
    )
    group.addoption("--mitl-baseline", default=None, metavar="FILE", help="health record that the health check's cases are compared with")
    group.addoption(
        "--mitl-health",
        default=None,
        choices=("refuse", "mark", "ignore"),
        help="what becomes of a run whose rig has no good health check (default: what the rig file says)",
    )
    group.addoption("--mitl-judged-from", default=None, metavar="NAME", help="name of the run whose recordings are judged again")
    group.addoption("--mitl-long", action="store_true", help="also run cases that take hours")
    group.addoption("--mitl-out", default=None, metavar="DIR", help="keep results.json, junit.xml, report.html and recordings here")
    group.addoption(
        "--mitl-resume", action="store_true", help="go on with the run in --mitl-out: run what was not judged there, keep the rest"
    )
