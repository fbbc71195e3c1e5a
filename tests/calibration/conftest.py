import importlib.util
import sys
from pathlib import Path

import pytest

_BENCHMARK = Path(__file__).parents[2] / "benchmarks" / "calibration.py"


@pytest.fixture(scope="session")
def experiments():
    """The experiments of benchmarks/calibration.py, so that the table and the tests cannot disagree."""
    spec = importlib.util.spec_from_file_location("calibration_benchmark", _BENCHMARK)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module
