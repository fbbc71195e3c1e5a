import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mitl.metrics.compare import Align, compare, umeyama
from mitl.paths import PosePath


def knot(n=400):
    t = np.linspace(0, 4, n)
    position = np.stack([np.cos(2 * t), np.sin(3 * t), 0.3 * np.sin(5 * t)], axis=1) * 0.3
    return PosePath(t, position, Rotation.from_rotvec(np.outer(t, [0.2, 0.1, -0.3])).as_quat(scalar_first=True), np.ones(n, dtype=bool))


def moved(path, R, p, scale=1.0):
    turn = (R * Rotation.from_quat(path.quaternion_wxyz, scalar_first=True)).as_quat(scalar_first=True)
    return PosePath(path.time, scale * R.apply(path.position) + p, turn, path.valid)


def test_a_path_is_equal_to_itself():
    found = compare(knot(), knot())
    assert found.position_max_m < 1e-15
    assert found.rotation_rmse_deg < 1e-6
    assert found.speed_rmse_m_s == 0.0
    assert (found.samples, found.scale, found.time_offset_s) == (400, 1.0, 0.0)


@settings(max_examples=20)
@given(seed=st.integers(0, 1000))
def test_a_rigid_motion_is_aligned_away_and_nothing_else(seed):
    rng = np.random.default_rng(seed)
    other = moved(knot(), Rotation.random(rng=rng), rng.normal(size=3))
    assert compare(knot(), other, Align.NONE).position_rmse_m > 1e-3
    found = compare(knot(), other, Align.RIGID)
    assert found.position_max_m < 1e-9
    assert found.rotation_rmse_deg < 1e-5
    noisy = PosePath(other.time, other.position + rng.normal(size=(400, 3)) * 1e-3, other.quaternion_wxyz, other.valid)
    assert compare(knot(), noisy, Align.RIGID).position_rmse_m == pytest.approx(1e-3 * np.sqrt(3), rel=0.15)


def test_a_scale_is_found_by_similarity_only():
    other = moved(knot(), Rotation.from_euler("y", 30, degrees=True), np.ones(3), 1.0055)
    assert compare(knot(), other, Align.RIGID).position_rmse_m > 1e-3
    found = compare(knot(), other, Align.SIMILARITY)
    assert found.scale == pytest.approx(1 / 1.0055)
    assert found.position_max_m < 1e-9
    assert found.speed_rmse_m_s < 1e-9


def test_a_time_offset_is_used_unless_nothing_is_to_be_aligned():
    late = knot().shifted(0.1)
    assert compare(knot(), late, Align.TIME, -0.1).position_max_m < 1e-12
    found = compare(knot(), late, Align.NONE, -0.1)
    assert found.time_offset_s == 0.0
    assert found.position_rmse_m > 0.05


def test_constant_offsets_have_their_numbers():
    found = compare(knot(), moved(knot(), Rotation.identity(), np.array([0.003, 0.004, 0.0])))
    values = (found.position_rmse_m, found.position_mean_m, found.position_max_m, found.position_p95_m)
    assert values == pytest.approx((0.005,) * 4)
    turned = moved(knot(), Rotation.from_euler("z", 2, degrees=True), np.zeros(3))
    assert compare(knot(), turned).rotation_rmse_deg == pytest.approx(2.0)


def test_a_mirrored_path_is_not_turned_inside_out():
    mirrored = knot().position * np.array([1.0, 1.0, -1.0])
    R, _, _ = umeyama(knot().position, mirrored, with_scale=True)
    assert np.linalg.det(R) == pytest.approx(1.0)


def test_paths_without_common_time_are_refused():
    with pytest.raises(ValueError, match="0 valid samples in common time, expected at least 1"):
        compare(knot(), knot().shifted(10.0))
    with pytest.raises(ValueError, match="expected at least 3"):
        compare(knot(), knot().between(0, 0.015), Align.RIGID)


def test_a_long_recording_compares_in_a_moment():
    import time

    n = 300_000
    long = PosePath(
        np.arange(n) * 0.004, np.resize(knot().position, (n, 3)), np.resize(knot().quaternion_wxyz, (n, 4)), np.ones(n, dtype=bool)
    )
    begun = time.process_time()
    compare(long, long.shifted(0.001), Align.SIMILARITY)
    assert time.process_time() - begun < 3.0  # takes .4 s; the bound only catches a loop over samples
