"""The sensor model: what it promises for any truth, effect by effect. That it reproduces the thesis is in test_thesis_figures.py."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mitl.samples import TrackerSamples
from mitl.simulation.tracker_model import TrackerModel
from mitl.simulation.tracker_parameters import load_preset

from . import truth

IDEAL = load_preset("ideal")
THESIS = load_preset("thesis")
# Everything on, and events often enough that every second of truth has some.
ROUGH = replace(
    THESIS,
    glitch=replace(THESIS.glitch, probability_per_stop=0.5, within_s=0.1, rate_in_motion_hz=8.0),
    loss=replace(THESIS.loss, rate_per_s=3.0, duration_s=0.05),
    frame_jump=replace(THESIS.frame_jump, probability_per_reacquisition=0.5),
    sleep=replace(THESIS.sleep, after_s=0.1, wake_min_s=0.02, wake_max_s=0.1),
    occlusion=replace(THESIS.occlusion, rate_per_s=1.0, duration_min_s=0.05, duration_max_s=0.3, coast_min_s=0.05, coast_max_s=0.2),
    one_base=replace(THESIS.one_base, share=0.5),
    shock=replace(THESIS.shock, from_m_s2=2.0, position_sd_m=1e-3),
    output=replace(THESIS.output, mode="OnUpdate", update_rate_hz=180.0),
)


def wandering(count):
    """A truth with stops, speeds to 2 m/s and turning."""
    generator = np.random.default_rng(5)
    share = np.repeat(generator.random(count // 50 + 1) < 0.6, 50)[:count]
    steps = generator.normal(size=3) * 0.004 * share[:, np.newaxis]
    turn = np.cumsum(share)[:, np.newaxis] * np.array([0.002, 0.001, -0.003])
    return np.cumsum(steps, axis=0), Rotation.from_rotvec(turn).as_quat(scalar_first=True)


COUNT = 600
POSITION, QUATERNION = wandering(COUNT)
TIMES = truth.times_of(POSITION)


def samples_in_chunks(cuts):
    model = TrackerModel(ROUGH, seed=3)
    edges = [0, *sorted(cuts), COUNT]
    samples = TrackerSamples.joined([model.sample(TIMES[a:b], POSITION[a:b], QUATERNION[a:b]) for a, b in pairwise(edges) if b > a])
    return samples.path.position, samples.path.quaternion_wxyz, samples.path.valid, samples.result, samples.velocity


WHOLE = samples_in_chunks([])


def test_one_call_and_a_call_a_sample_give_the_same_bits():
    assert 0 < np.count_nonzero(~WHOLE[2]) < COUNT
    for one, other in zip(WHOLE, samples_in_chunks(range(1, COUNT)), strict=True):
        np.testing.assert_array_equal(one, other)


@given(st.lists(st.integers(0, COUNT), max_size=12))
@settings(max_examples=30, deadline=None, derandomize=True)
def test_any_cut_into_chunks_gives_the_same_bits(cuts):
    for one, other in zip(WHOLE, samples_in_chunks(cuts), strict=True):
        np.testing.assert_array_equal(one, other)


def test_another_seed_gives_other_samples():
    ours, others = TrackerModel(THESIS, 1), TrackerModel(THESIS, 2)
    assert not np.array_equal(truth.positions_seen(ours, POSITION), truth.positions_seen(others, POSITION))


def test_the_truth_handed_in_is_not_changed():
    position, quaternion = POSITION.copy(), QUATERNION.copy()
    TrackerModel(ROUGH, 1).measure(TIMES, position, quaternion)
    np.testing.assert_array_equal(position, POSITION)
    np.testing.assert_array_equal(quaternion, QUATERNION)


def test_the_ideal_tracker_reports_the_truth():
    samples = TrackerModel(IDEAL, 1).measure(TIMES, POSITION, QUATERNION)
    np.testing.assert_array_equal(samples.time, TIMES)
    np.testing.assert_array_equal(samples.position, POSITION)
    np.testing.assert_allclose(samples.quaternion_wxyz, QUATERNION, rtol=0, atol=1e-15)
    assert samples.valid.all()


def test_scale_and_skew_act_on_positions_in_the_trackers_frame():
    distorted = replace(IDEAL, distortion=THESIS.distortion)
    seen = truth.positions_seen(TrackerModel(distorted, 1), np.eye(3))
    expected = np.array([[1.0063, 0, 0], [0, 1.0055, 0], [np.tan(np.radians(0.42)), 0, 1.0047]])
    np.testing.assert_allclose(seen, expected, rtol=1e-12)


@pytest.mark.parametrize("speed", [0.1, 1.0])
def test_jitter_of_the_time_stamps_shifts_a_moving_body_along_its_path_by_v_sigma_t(speed):
    jittery = replace(IDEAL, sampling=replace(IDEAL.sampling, time_jitter_s=0.00126))
    position = truth.line(speed, seconds=20.0)
    error = truth.positions_seen(TrackerModel(jittery, 1), position) - position
    assert error[:, 0].std() == pytest.approx(speed * 0.00126, rel=0.05)  # 5000 samples: 1 %
    assert not error[:, 1:].any()


def test_jitter_of_the_time_stamps_turns_a_turning_body():
    jittery = replace(IDEAL, sampling=replace(IDEAL.sampling, time_jitter_s=0.00126))
    angle = np.arange(5000) * truth.PERIOD * 2.0  # 2 rad/s
    true = Rotation.from_rotvec(angle[:, np.newaxis] * [0.0, 0.0, 1.0])
    samples = TrackerModel(jittery, 1).measure(truth.times_of(angle), np.zeros((5000, 3)), true.as_quat(scalar_first=True))
    error = (true.inv() * Rotation.from_quat(samples.quaternion_wxyz, scalar_first=True)).as_rotvec()
    assert error[:, 2].std() == pytest.approx(2.0 * 0.00126, rel=0.05)
    assert np.abs(error[:, :2]).max() < 1e-12


def test_a_gap_in_time_is_not_taken_for_motion():
    jittery = replace(IDEAL, sampling=replace(IDEAL.sampling, time_jitter_s=0.00126))
    model = TrackerModel(jittery, 1)
    here, there = np.zeros((1, 3)), np.ones((1, 3))
    model.measure(np.array([0.0]), here, truth.facing(here))
    samples = model.measure(np.array([300.0]), there, truth.facing(there))
    np.testing.assert_array_equal(samples.position, there)


def test_orientation_noise_has_its_deviation():
    still = np.zeros((20_000, 3))
    parts = truth.measured(TrackerModel(replace(IDEAL, orientation_noise=THESIS.orientation_noise), 1), still)
    quaternion = np.concatenate([part.quaternion_wxyz for part in parts])
    angles = Rotation.from_quat(quaternion, scalar_first=True).as_rotvec(degrees=True)
    assert angles.std(axis=0) == pytest.approx([0.05] * 3, rel=0.4)  # the slow part has 16 independent values in 80 s


def test_a_lost_sample_is_not_valid_and_its_pose_is_zero():
    losing = replace(THESIS, loss=replace(THESIS.loss, rate_per_s=2.0, duration_s=0.1))
    position = np.tile([1.0, 2.0, 3.0], (5000, 1))
    samples = TrackerModel(losing, 1).measure(truth.times_of(position), position, truth.facing(position))
    lost = ~samples.valid
    assert 0.05 < lost.mean() < 0.35  # 2/s of .1 s each
    assert not samples.position[lost].any()
    np.testing.assert_array_equal(samples.quaternion_wxyz[lost], np.tile(truth.STILL, (lost.sum(), 1)))
    lengths = np.diff(np.flatnonzero(np.diff(np.concatenate([[False], lost, [False]]))))[::2]
    assert lengths.min() >= 24


def test_large_glitches_come_after_stops_only_and_are_short():
    sure = replace(IDEAL, glitch=replace(THESIS.glitch, probability_per_stop=1.0, rate_in_motion_hz=0.0))
    points = np.random.default_rng(1).uniform(-0.3, 0.3, (10, 3))
    position, rests = truth.visits(points, still=0.8)
    error = np.linalg.norm(truth.positions_seen(TrackerModel(sure, 1), position) - position, axis=1)
    hit = error > 1e-9
    assert error[hit] == pytest.approx(0.025)
    for rest in rests:
        assert hit[rest : rest + 150].sum() == 5  # 20 ms at 250 Hz, begun within .5 s
    assert hit.sum() == 5 * len(points)
    still = np.zeros((5000, 3))
    assert not truth.positions_seen(TrackerModel(sure, 1), still).any()


def test_glitches_in_motion_come_at_their_rate_with_their_sizes_and_never_at_rest():
    often = replace(IDEAL, glitch=replace(THESIS.glitch, probability_per_stop=0.0, rate_in_motion_hz=2.0, mean_size_in_motion_m=0.003))
    model, seconds = TrackerModel(often, 1), 400
    way = 0.1 * np.arange(1, 250 * seconds + 1)[:, np.newaxis] * truth.PERIOD * np.array([[0.0, 1.0, 0.0]])
    error = truth.positions_seen(model, way) - way
    size = np.linalg.norm(error, axis=1)
    hit = size > 1e-9
    begins = np.flatnonzero(hit & ~np.concatenate([[False], hit[:-1]]))
    assert len(begins) == pytest.approx(2.0 * seconds, rel=0.15)
    assert np.median(size[begins]) == pytest.approx(0.003 * np.log(2.0), rel=0.15)
    assert np.count_nonzero(hit) / len(begins) == pytest.approx(5.0, rel=0.1)  # 20 ms at 250 Hz; some overlap
    rest = np.tile(way[-1], (50_000, 1))
    assert np.array_equal(truth.positions_seen(model, rest)[5:], rest[5:])  # the last pulse may end at rest


def test_the_frame_jumps_when_tracking_is_found_again_and_stays_there():
    jumping = replace(
        IDEAL,
        loss=replace(THESIS.loss, rate_per_s=0.5, duration_s=0.02),
        frame_jump=replace(THESIS.frame_jump, probability_per_reacquisition=1.0),
    )
    position = np.tile([2.0, 1.0, 1.0], (2500, 1))
    samples = TrackerModel(jumping, 1).measure(truth.times_of(position), position, truth.facing(position))
    found = np.flatnonzero(samples.valid[1:] & ~samples.valid[:-1]) + 1
    assert len(found) > 2
    for begin, end in pairwise(found):
        part = samples.select(np.arange(len(position)) < end).only_valid().position[-1]
        assert samples.position[begin] == pytest.approx(part, abs=1e-12)
    first = samples.position[found[0]] - position[0]
    assert 0.0 < np.linalg.norm(first) < 4 * np.linalg.norm(THESIS.frame_jump.translation_sd_m)
    turns = np.degrees(Rotation.from_quat(samples.quaternion_wxyz[found[:1]], scalar_first=True).magnitude())
    assert 0.1 <= turns[0] <= 1.5


def test_drift_is_stationary_with_its_deviation_and_shared_by_all_places():
    # A sample a second instead of 250: drift does not care, and five hours take no time. Twenty sessions of 5 h.
    slow = replace(IDEAL, sampling=replace(IDEAL.sampling, rate_hz=1.0), drift=THESIS.drift)
    still = np.zeros((18_000, 3))
    ranges, deviations = [], []
    for seed in range(20):
        seen = TrackerModel(slow, seed).measure(np.arange(18_000.0), still, truth.facing(still)).position
        deviations.append(seen.std(axis=0))
        ranges.append(np.ptp(seen[::300], axis=0))
    assert np.mean(deviations, axis=0) == pytest.approx(THESIS.drift.sd_m, rel=0.15)
    # Table 4.3, five minutes between measurements: mean of largest and smallest location; our places differ by a gain.
    assert np.mean(ranges, axis=0) * 1e3 == pytest.approx([1.47, 3.44, 2.90], rel=0.2)


def test_an_empty_call_gives_no_samples():
    assert len(TrackerModel(THESIS, 1).measure(np.empty(0), np.empty((0, 3)), np.empty((0, 4)))) == 0
