"""The fixture `figures`, which hands the stored baseline (--mitl-baseline) to the health check's cases."""

from __future__ import annotations

from pathlib import Path

import pytest

from mitl.engine.check import Check
from mitl.engine.health import read_health
from mitl.health.figures import Figures


@pytest.fixture
def figures(pytestconfig: pytest.Config, check: Check) -> Figures:
    """Judges figures by their limits and by the baseline, if there is one."""
    file = pytestconfig.getoption("mitl_baseline")
    return Figures(check, read_health(Path(file)) if file else None)
