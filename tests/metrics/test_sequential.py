"""The sequential test: its error rates hold over all looks, and it stops where repeating cannot help."""

import numpy as np
import pytest

from mitl.metrics.decision import decide
from mitl.metrics.sequential import POCOCK, guard_factor, worth_repeating
from mitl.outcome import Outcome

SEQUENCES = 40_000


def rate_of_wrong_passes(looks, factor, true_value, shared=0.0):
    """Share of sequences in which some look gives PASS; looks average white noise of 1 besides a shared error."""
    random = np.random.default_rng(20)
    noise = np.cumsum(random.normal(size=(SEQUENCES, looks)), axis=1) / np.arange(1, looks + 1)
    means = true_value + noise + shared * random.normal(size=(SEQUENCES, 1))
    sigma = np.sqrt(1.0 / np.arange(1, looks + 1) + shared**2)
    return float(np.mean(np.any(means + factor * sigma <= 0.0, axis=1)))


@pytest.mark.parametrize("looks", range(1, len(POCOCK) + 1))
def test_a_value_at_the_limit_passes_wrongly_in_one_of_twenty_sequences(looks):
    rate = rate_of_wrong_passes(looks, guard_factor(looks), 0.0)
    assert rate == pytest.approx(0.05, abs=0.004)  # three standard deviations of the count are .0033


def test_looking_thrice_with_the_factor_of_one_look_would_be_wrong_twice_as_often():
    assert rate_of_wrong_passes(3, guard_factor(1), 0.0) > 0.09


def test_a_shared_error_lowers_the_rate():
    assert rate_of_wrong_passes(3, guard_factor(3), 0.0, shared=1.0) < 0.05


def test_repeating_is_given_up_where_the_shared_part_alone_leaves_it_open():
    assert worth_repeating(3.0, 5.0, random=1.0, shared=0.1, looks=3)
    assert not worth_repeating(4.9, 5.0, random=1.0, shared=1.0, looks=3)
    assert worth_repeating(4.0, 2.0, random=1.0, shared=0.1, looks=3, at_least=True)
    assert not worth_repeating(2.1, 2.0, random=0.1, shared=1.0, looks=3, at_least=True)
    assert not worth_repeating(0.0, 5.0, random=1.0, shared=float("inf"), looks=3)


def test_the_number_of_looks_is_bounded():
    with pytest.raises(ValueError, match="1 to 10 times, not 11"):
        guard_factor(11)


def test_a_wider_guard_band_leaves_open_what_a_narrow_one_decides():
    assert decide(3.0, 5.0, 1.0).outcome is Outcome.PASS
    assert decide(3.0, 5.0, 1.0, factor=guard_factor(4)).outcome is Outcome.INCONCLUSIVE
