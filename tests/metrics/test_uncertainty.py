import pytest

from mitl.metrics.uncertainty import Budget, Term, drift_sigma, point_budget, position_budget


def test_terms_add_as_squares_and_stay_visible():
    budget = position_budget(random=3e-4, registration=4e-4, scale=5e-4, length=0.0)
    assert budget.combined == pytest.approx(5e-4)
    assert {term.name: term.value for term in budget.terms}["registration"] == 4e-4
    assert budget.explained("mm", 1e3) == "0.5 mm = random 0.3, registration 0.4"


def test_scale_acts_over_length_and_timing_over_speed():
    budget = position_budget(random=0, registration=0, scale=1e-3, length=0.3, speed=0.5, time_sigma=0.8e-3)
    assert budget.combined == pytest.approx(0.5e-3)


def test_repeats_reduce_the_random_term_only():
    budget = position_budget(random=4e-4, registration=3e-4).repeated(16)
    assert {term.name: term.value for term in budget.terms}["random"] == pytest.approx(1e-4)
    assert budget.combined == pytest.approx((1e-8 + 9e-8) ** 0.5)
    with pytest.raises(ValueError, match="at least one measurement"):
        budget.repeated(0)


def test_terms_that_make_no_sense_are_refused():
    with pytest.raises(ValueError, match="'drift' must not be negative"):
        Budget((Term("drift", -1.0),))
    with pytest.raises(ValueError, match="every term once"):
        Budget().with_term("drift", 1.0).with_term("drift", 2.0)


def test_a_still_points_budget_comes_from_its_jitter():
    budget = point_budget(jitter=1e-3, registration=0.0)
    assert budget.combined == pytest.approx(0.2e-3)
    assert Budget().combined == 0.0
    assert Budget().explained() == "0 m"


def test_drift_grows_with_time_and_then_no_more():
    assert drift_sigma(0.84e-3, 1200.0, 0.0) == 0.0
    assert drift_sigma(0.84e-3, 1200.0, 12.0) == pytest.approx(0.84e-3 * (2 * 0.01) ** 0.5, rel=0.01)
    assert drift_sigma(0.84e-3, 1200.0, 1e6) == pytest.approx(0.84e-3 * 2**0.5)
