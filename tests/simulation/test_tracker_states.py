"""What a tracked device does besides noise: sleep, occlusion, one base station, held and predicted poses, velocity, shocks, buttons."""

import time
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chisquare

from mitl.samples import TrackerSamples, TrackingResult
from mitl.simulation.tracker_button import ButtonInput
from mitl.simulation.tracker_model import TrackerModel
from mitl.simulation.tracker_parameters import load_preset

from . import truth

IDEAL, THESIS, LIGHTHOUSE2 = (load_preset(name) for name in ("ideal", "thesis", "lighthouse2"))


def sampled(model, position):
    times, facing = truth.times_of(position), truth.facing(position)
    cuts = [slice(first, first + 1024) for first in range(0, len(position), 1024)]
    return TrackerSamples.joined([model.sample(times[cut], position[cut], facing[cut]) for cut in cuts])


def rest_then_move(rest_s):
    still = np.tile([1.0, 0.0, 1.0], (round(rest_s / truth.PERIOD), 1))
    return np.concatenate([still, still[-1] + truth.line(0.1, seconds=4.0)])


def test_after_ten_seconds_at_rest_it_sleeps_and_wakes_one_and_a_half_to_two_seconds_after_it_was_moved():
    sleepy = replace(IDEAL, sleep=THESIS.sleep)
    for seed in range(5):
        position = rest_then_move(12.0)
        seen = sampled(TrackerModel(sleepy, seed), position).path
        wrong = np.flatnonzero(np.any(seen.position != position, axis=1))
        assert wrong[0] == 3001  # 12 s, where the motion begins: until then the held pose is right
        assert 1.5 <= (wrong[-1] - wrong[0] + 1) * truth.PERIOD <= 2.01
        assert seen.valid.all()
    awake = rest_then_move(9.0)
    np.testing.assert_array_equal(sampled(TrackerModel(sleepy, 1), awake).path.position, awake)


def test_a_sleeper_may_find_its_frame_moved():
    jumpy = replace(IDEAL, sleep=THESIS.sleep, frame_jump=replace(THESIS.frame_jump, probability_per_reacquisition=1.0))
    position = rest_then_move(12.0)
    error = np.linalg.norm(sampled(TrackerModel(jumpy, 1), position).path.position - position, axis=1)
    assert error[:3000].max() == 0.0
    assert error[-1] > 1e-3


def test_while_occluded_poses_stay_valid_with_a_code_and_drift_then_they_are_lost():
    hidden = replace(
        IDEAL, occlusion=replace(THESIS.occlusion, rate_per_s=0.2, duration_min_s=3.0, duration_max_s=4.0), frame_jump=THESIS.frame_jump
    )
    position = np.tile([1.0, 2.0, 3.0], (15_000, 1))
    samples = sampled(TrackerModel(hidden, 1), position)
    out = samples.result == TrackingResult.RUNNING_OUT_OF_RANGE
    coasting, lost = out & samples.path.valid, ~samples.path.valid
    assert coasting.any()
    assert lost.any()
    assert np.all(out[lost])
    assert not samples.path.position[lost].any()
    error = np.linalg.norm(samples.path.position - position, axis=1)
    assert 0.005 < error[coasting].max() < 2.0
    first = np.flatnonzero(coasting)[0]
    assert error[first] == 0.0
    end = first + np.argmin(coasting[first:])
    assert 1.0 <= (end - first) * truth.PERIOD <= 2.01


def test_with_one_base_station_noise_along_the_ray_is_seven_times_as_large():
    base = replace(IDEAL, position_noise=replace(THESIS.position_noise, axis_factors=(1.0, 1.0, 1.0), slow_sd_m=0.0, moving_sd_m=0.0))
    one = replace(base, one_base=replace(THESIS.one_base, share=1.0, station_m=(0.0, 0.0, 0.0)))
    position = np.tile([3.0, 0.0, 0.0], (20_000, 1))
    sd = truth.positions_seen(TrackerModel(one, 1), position).std(axis=0)
    assert sd == pytest.approx([7 * 0.09e-3, 0.09e-3, 0.09e-3], rel=0.1)
    some = replace(base, one_base=replace(THESIS.one_base, share=0.3))
    places = np.repeat(np.random.default_rng(1).uniform(-3.0, 3.0, (400, 3)), 50, axis=0)
    error = (truth.positions_seen(TrackerModel(some, 1), places) - places).reshape(400, 50, 3)
    assert np.mean(np.linalg.norm(error.std(axis=1), axis=1) > 3e-4) == pytest.approx(0.3, abs=0.1)


def test_on_update_poses_are_those_of_the_devices_last_event():
    held = replace(IDEAL, output=replace(IDEAL.output, mode="OnUpdate", update_rate_hz=50.0))
    position = truth.line(1.0)
    seen = sampled(TrackerModel(held, 1), position).path.position[:, 0]
    assert len(np.unique(np.round(seen, 9))) == pytest.approx(100, abs=2)  # 50 a second for 2 s
    late = position[10:, 0] - seen[10:]
    assert 0.0 <= late.min() < late.max() <= 0.0201


def test_predicted_poses_carry_the_noise_of_the_velocity_times_their_age():
    aged = replace(IDEAL, velocity=replace(THESIS.velocity, per_m_s2=0.0), output=replace(IDEAL.output, age_s=0.01))
    still = np.zeros((20_000, 3))
    assert truth.positions_seen(TrackerModel(aged, 1), still).std() == pytest.approx(0.85e-3, rel=0.1)


def test_native_velocity_is_as_noisy_as_the_thesis_saw_it():
    position = truth.line(0.3, seconds=20.0)
    error = sampled(TrackerModel(THESIS, 1), position).velocity[60:] - [0.3, 0.0, 0.0]
    assert error.std(axis=0) == pytest.approx([0.085] * 3, rel=0.1)
    assert 0.2 < np.abs(error).max() < 0.5  # thesis, figure 4.1: +-200 mm/s


def test_a_hard_stop_spoils_what_comes_from_the_imu_for_a_while():
    shaken = replace(IDEAL, shock=replace(THESIS.shock, position_sd_m=2e-3), velocity=replace(THESIS.velocity, per_m_s2=0.0))
    move = truth.line(1.0, seconds=1.0)
    position = np.concatenate([move, np.tile(move[-1], (500, 1))])
    for seed in range(5):
        error = np.linalg.norm(sampled(TrackerModel(shaken, seed), position).path.position - position, axis=1)
        hit = np.flatnonzero(error[100:] > 0.0) + 100
        assert hit[0] == 250
        assert 0.095 <= (hit[-1] - hit[0] + 1) * truth.PERIOD <= 0.205
    gentle = truth.line(1.0, seconds=1.0) * (1 - np.cos(np.linspace(0, np.pi, 250)))[:, None] / 2
    assert not (truth.positions_seen(TrackerModel(shaken, 1), gentle) - gentle).any()


def test_a_button_is_reported_late_as_in_table_4_9():
    delays = []
    random = np.random.default_rng(1)
    for seed in range(600):
        line = ButtonInput(THESIS.button, seed)
        pressed_at = 1.0 + random.uniform(0.0, 0.004)
        line.change(pressed_at, pressed=True)
        times = np.arange(500) * truth.PERIOD
        states = np.concatenate([line.states(times[:251]), line.states(times[251:])])
        # The thesis counts from the sample nearest to the trigger point, in steps of 4 ms.
        delays.append(times[np.argmax(states)] - np.rint(pressed_at / 0.004) * 0.004)
    counts = np.bincount(np.rint(np.array(delays) / 0.004).astype(int), minlength=6)[:6]
    assert counts.sum() == 600
    expected = np.array([2, 13, 18, 14, 11, 2]) * 10
    assert chisquare(counts, expected).pvalue > 0.01 or np.abs(counts - expected).max() < 50  # the thesis's own counts have sd 3.5 of 14


def test_a_button_goes_up_again_and_keeps_the_order_of_its_changes():
    line = ButtonInput(replace(THESIS.button, delay_min_s=0.0, delay_max_s=0.5), 3)
    line.change(1.0, pressed=True)
    line.change(1.01, pressed=False)
    times = np.arange(0.0, 2.0, 0.004)
    assert not np.any(line.states(times)[-20:])
    samples = TrackerSamples(
        sampled(TrackerModel(IDEAL, 1), np.zeros((4, 3))).path,
        np.full(4, 200, dtype=np.int16),
        np.array([0, 2, 2, 0], dtype=np.int16),
        np.zeros((4, 3)),
    )
    assert samples.pressed(1).tolist() == [pytest.approx(0.004)]
    assert len(samples.pressed(0)) == 0


def test_devices_of_one_session_share_the_drift_and_have_noise_of_their_own():
    drifting = replace(IDEAL, drift=THESIS.drift, position_noise=replace(THESIS.position_noise, slow_sd_m=0.0))
    still = np.zeros((5000, 3))
    hand, reference = (truth.positions_seen(TrackerModel(drifting, 1, device=device), still) for device in (0, 1))
    assert not np.array_equal(hand, reference)
    assert (hand - reference).mean(axis=0) == pytest.approx(np.zeros(3), abs=2e-5)
    assert np.abs(hand.mean(axis=0)).max() > 1e-4


def test_skipping_five_minutes_is_as_letting_them_pass():
    slow = replace(IDEAL, drift=THESIS.drift)
    changes = []
    for seed in range(300):
        model = TrackerModel(slow, seed)
        here = truth.positions_seen(model, np.zeros((1, 3)))[0]
        model.skip(300.0)
        changes.append(model.measure(np.array([300.004]), np.zeros((1, 3)), truth.facing(np.zeros((1, 3)))).position[0] - here)
    expected = np.asarray(THESIS.drift.sd_m) * np.sqrt(2 * (1 - np.exp(-300 / 1200)))
    assert np.std(changes, axis=0) == pytest.approx(expected, rel=0.15)


def test_lighthouse_2_jitters_as_the_public_recordings():
    from mitl.metrics.tracker_statistics import tracker_statistics
    from mitl.paths import PosePath

    plain = replace(LIGHTHOUSE2, location=replace(LIGHTHOUSE2.location, gain_sd_log=0.0))
    still = np.zeros((1000, 3))
    found = []
    for seed in range(60):
        path = sampled(TrackerModel(plain, seed), still).path
        found.append(tracker_statistics(PosePath(path.time, path.position, path.quaternion_wxyz, path.valid)))
    jitter = {window: np.mean([j.mean for s in found for j in s.jitter if j.window == window]) * 1e3 for window in (0.2, 0.5)}
    assert jitter[0.2] == pytest.approx(1.02, rel=0.1)  # facts/tracker.md
    assert jitter[0.5] == pytest.approx(1.28, rel=0.1)
    assert np.median([s.mean_turn_sd for s in found]) == pytest.approx(np.radians(0.025), rel=0.25)


def test_the_model_alone_makes_a_million_samples_a_second_even_on_a_busy_machine():
    # Two million on a quiet one (benchmarks/simulation_speed.py); half of it still tells a loop over samples from array code.
    position = np.cumsum(np.where((np.arange(65_536) // 500 % 2)[:, None], 0.001, 0.0) * np.ones(3), axis=0)
    times, facing = truth.times_of(position), truth.facing(position)
    best = np.inf
    for _ in range(5):
        model = TrackerModel(THESIS, 1)
        begin = time.process_time()
        model.sample(times, position, facing)
        best = min(best, time.process_time() - begin)
    assert 65_536 / best > 1e6
