import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mitl.metrics.decision import decide
from mitl.metrics.deviation import largest_deviation, summarise, window_means, window_noise
from mitl.outcome import Outcome

RATE = 250.0


def white(rng, n, sd=2e-4):
    return rng.normal(size=(n, 3)) * sd


def ornstein_uhlenbeck(rng, n, sd, tau):
    keep = np.exp(-1.0 / (RATE * tau))
    out = np.empty((n, 3))
    out[0] = rng.normal(size=3) * sd
    for i, kick in enumerate(rng.normal(size=(n - 1, 3)) * sd * np.sqrt(1 - keep**2), start=1):
        out[i] = keep * out[i - 1] + kick
    return out


def test_the_plain_maximum_grows_with_the_length_of_the_recording_and_the_estimate_hardly_does():
    rng = np.random.default_rng(1)
    short, long = 500, 100_000
    noise = white(rng, long)
    plain = [np.linalg.norm(noise[:n], axis=1).max() for n in (short, long)]
    found = [largest_deviation(np.arange(n) / RATE, noise[:n]).value for n in (short, long)]
    assert plain[1] > 0.9e-3
    assert found[1] < 0.3e-3
    assert found[1] - found[0] < 0.2e-3


@pytest.mark.parametrize("kind", ["white", "correlated"])
@pytest.mark.parametrize("shape", ["constant", "one peak"])
def test_the_bounds_hold_the_true_maximum(kind, shape):
    """value +- 1.65 random must hold the true largest deviation in at least 95 % of recordings on either side."""
    n = 2500
    t = np.arange(n) / RATE
    truth = np.zeros((n, 3))
    truth[:, 1] = 2e-3 if shape == "constant" else 2e-3 * np.clip(1 - np.abs(t - 5.0) / 2.0, 0, 1)
    below = above = 0
    runs = 100
    for seed in range(runs):
        rng = np.random.default_rng(seed)
        noise = white(rng, n) if kind == "white" else ornstein_uhlenbeck(rng, n, 1.5e-4, 0.01)
        found = largest_deviation(t, truth + noise)
        below += found.value - 1.65 * found.random > 2e-3
        above += found.value + 1.65 * found.random < 1.95e-3  # the window takes 1.25 % off the peak
    assert below <= 8
    assert above <= 8


@pytest.mark.parametrize(("kind", "expected"), [("white", 2e-4 / 5.0), ("correlated", 1.5e-4 * np.sqrt(2 * 0.01 / 0.1))])
def test_the_noise_of_window_means_is_right_also_for_correlated_noise(kind, expected):
    rng = np.random.default_rng(1)
    noise = white(rng, 20_000) if kind == "white" else ornstein_uhlenbeck(rng, 20_000, 1.5e-4, 0.01)
    found = window_noise(np.arange(20_000) / RATE, noise, 0.1)
    assert found == pytest.approx(expected, rel=0.25)


def test_a_path_too_short_to_show_its_noise_counts_as_wholly_correlated():
    rng = np.random.default_rng(1)
    noise = white(rng, 60)
    assert window_noise(np.arange(60) / RATE, noise, 0.1) == pytest.approx(2e-4, rel=0.3)
    gap = np.concatenate([np.arange(30) / RATE, 10.0 + np.arange(30) / RATE])
    assert window_noise(gap, noise, 0.1) > 3e-5
    assert window_noise(np.zeros(0), np.zeros((0, 3)), 0.1) == 0.0
    assert largest_deviation(np.zeros(1), np.array([[0.0, 3e-3, 4e-3]])).value == pytest.approx(5e-3)


def test_a_fault_as_long_as_the_window_keeps_its_size():
    t = np.arange(1000) / RATE
    deviation = np.where(np.abs(t - 2.0) <= 0.06, 5e-3, 0.0)
    found = largest_deviation(t, deviation)
    assert found.value == pytest.approx(5e-3)
    assert found.time == pytest.approx(2.0, abs=0.02)


def test_signed_deviations_average_out_and_sizes_would_not():
    rng = np.random.default_rng(1)
    signed = rng.normal(size=5000) * 1e-3
    t = np.arange(5000) / RATE
    assert largest_deviation(t, signed).value < 0.9e-3 < largest_deviation(t, np.abs(signed)).value


@settings(max_examples=30)
@given(seed=st.integers(0, 1000), shift=st.floats(-1e4, 1e4))
def test_the_estimate_does_not_change_with_time_shift_or_rotation(seed, shift):
    from scipy.spatial.transform import Rotation

    rng = np.random.default_rng(seed)
    t, d = np.arange(300) * 0.0041, rng.normal(size=(300, 3))
    before = largest_deviation(t, d)
    after = largest_deviation(t + shift, Rotation.random(rng=rng).apply(d))
    # rounding of shifted times may move a sample over a window's edge: a 24th of the window
    assert after.value == pytest.approx(before.value, rel=0.15)
    assert largest_deviation(t, Rotation.random(rng=rng).apply(d)).value == pytest.approx(before.value, rel=1e-9)


def test_window_means_of_a_constant_are_that_constant_at_the_ends_too():
    t = np.sort(np.random.default_rng(1).uniform(0, 3, 500))
    np.testing.assert_allclose(window_means(t, np.full((500, 2), 7.0), 0.1), 7.0)
    assert len(window_means(t[:1], np.ones((1, 2)), 0.1)) == 1


def test_numbers_that_sum_up():
    found = summarise(np.array([[3.0, 4.0, 0.0], [0.0, 0.0, 0.0]]))
    assert (found.max, found.mean) == (5.0, 2.5)
    assert found.rms == pytest.approx(np.sqrt(12.5))
    assert summarise(np.array([-2.0, 1.0])).max == 2.0
    for call in (lambda: summarise(np.zeros(0)), lambda: largest_deviation(np.zeros(0), np.zeros((0, 3)))):
        with pytest.raises(ValueError, match="at least one sample"):
            call()


@given(value=st.floats(-10, 10), limit=st.floats(0, 10), u=st.floats(0, 5))
def test_a_verdict_is_given_only_outside_the_guard_band(value, limit, u):
    found = decide(value, limit, u)
    distance = abs(value) - limit
    if found.outcome is Outcome.PASS:
        assert distance <= 1e-9 - 1.65 * u
    elif found.outcome is Outcome.FAIL:
        assert distance > 1.65 * u - 1e-9
    else:
        assert abs(distance) <= 1.65 * u + 1e-9
    assert decide(-value, limit, u) == found


def test_verdicts_of_an_exact_measurement_and_of_none():
    assert decide(5.0, 5.0, 0.0).outcome is Outcome.PASS
    assert decide(5.000001, 5.0, 0.0).outcome is Outcome.FAIL
    assert decide(1.0, 5.0, float("inf")).outcome is Outcome.INCONCLUSIVE
    assert decide(1.0, 5.0, 1.0).tur == 2.5
    assert decide(1.0, 5.0, 3.0).indicative_only
    assert not decide(1.0, 5.0, 0.0).indicative_only
    for arguments, message in (
        ((float("nan"), 1, 0), "finite value"),
        ((1, -1, 0), "limit"),
        ((1, 1, -1), "uncertainty"),
        ((1, 1, float("nan")), "uncertainty"),
    ):
        with pytest.raises(ValueError, match=message):
            decide(*arguments)
