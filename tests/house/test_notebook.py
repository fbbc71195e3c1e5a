"""The notebook's cells run from top to bottom and find what was put in; it is kept without outputs."""

import json
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

from mitl.metrics.compare import Align

NOTEBOOK = Path(__file__).resolve().parents[2] / "examples" / "notebook" / "oracle.ipynb"
CELLS = [cell for cell in json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]


@pytest.fixture(scope="module")
def found():
    from matplotlib import pyplot

    before = mpl.get_backend()
    pyplot.switch_backend("agg")
    names = {}
    for cell in CELLS:
        exec(compile("".join(cell["source"]), cell["id"], "exec"), names)  # noqa: S102 - our own notebook
    names["figures"] = [pyplot.figure(number) for number in pyplot.get_fignums()]
    yield names
    pyplot.close("all")
    pyplot.switch_backend(before)


def test_it_is_kept_without_outputs():
    assert [cell["id"] for cell in CELLS if cell["outputs"] or cell["execution_count"] is not None] == []


def test_the_oracle_is_a_square_of_80_mm_whose_corners_are_cut(found):
    position = 1e3 * found["planned"].path.position[found["square"]]
    assert np.allclose(np.ptp(position, axis=0), [80.0, 80.0, 0.0], atol=0.1)
    to_corner = np.linalg.norm(position - [80.0, 80.0, 0.0], axis=1).min()
    assert 1.0 < to_corner < 20.0


def test_the_clocks_and_the_scale_that_were_put_in_are_found(found):
    assert found["offset"].seconds == pytest.approx(1.25, abs=0.002)
    with_scale = found["comparisons"][Align.SIMILARITY]
    assert 1.0 / with_scale.scale == pytest.approx(1.0055, abs=0.003)  # the mean of the preset's three
    assert with_scale.position_rmse_m < found["comparisons"][Align.RIGID].position_rmse_m < 2e-3
    assert float(np.sqrt(np.mean(found["deviation"] ** 2))) == pytest.approx(with_scale.position_rmse_m)


def test_it_draws_two_figures_of_two_plots(found):
    assert [[len(axes.lines) > 0 for axes in figure.axes] for figure in found["figures"]] == [[True, True], [True, True]]
