"""The benchmark of the thesis's tables runs, and does not hide a miss."""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
import thesis_tables


def test_a_number_beyond_what_is_allowed_is_a_miss():
    ours = np.array([1.0, 1.02])
    assert "MISS" in thesis_tables.Row("4.x", "far off", 2.0, ours, 0.1, 20).text()
    assert "MISS" not in thesis_tables.Row("4.x", "near", 1.05, ours, 0.1, 20).text()
    assert "MISS" not in thesis_tables.Row("4.x", "a spread", 1.3, ours, is_spread=True).text()


def test_the_thesiss_four_point_calibration_leaves_its_scale_and_skew_on_the_axis_points():
    seen = np.array([thesis_tables.noiseless(thesis_tables.Laboratory(thesis_tables.QUIET, 1).model, p) for p in thesis_tables.AXES])
    R, p = thesis_tables.thesis_frame(seen)
    residual = 1e3 * np.linalg.norm((seen - p) @ R - thesis_tables.AXES, axis=1)
    np.testing.assert_allclose(residual, [0.0, 1.89, 1.65, 2.61], atol=0.02)  # table 4.4: .25 1.74 1.51 2.62


def test_the_quick_tables_are_as_the_thesis_has_them():
    counts = np.sum([thesis_tables.triggers(seed) for seed in range(5)], axis=0)
    assert counts.sum() == 300
    assert counts[0] < counts[1]
    assert counts[5] < counts[4]
    four = thesis_tables.four_points(1)
    assert 1.0 < four["residual Z"] < 4.0
    assert 300.5 < four["length X"] < 303.0
