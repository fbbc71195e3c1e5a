"""What a rig cannot see is told, with what could."""

import pytest

from mitl.engine.reach import blind, seen_beyond, unseen
from mitl.engine.record import BudgetTerm, CaseRecord, CheckRecord
from mitl.engine.wording import reason
from mitl.outcome import Outcome


def check(**changes):
    given = {
        "name": "speed",
        "value": 1.0,
        "unit": "mm/s",
        "limit": 5.0,
        "uncertainty": 10.0,
        "outcome": Outcome.INCONCLUSIVE,
        "guard": 2.0,
    }
    return CheckRecord(**{**given, "budget": (BudgetTerm("random", 10.0),), **changes})


def case(*checks):
    return CaseRecord("a/b", "title", Outcome.INCONCLUSIVE, checks=checks, catches=("speed-dip",))


def test_a_check_whose_limit_is_below_its_guard_band_says_what_passes_unseen():
    told = unseen(case(check(), check(name="clear", uncertainty=1.0, outcome=Outcome.PASS)))
    assert "what stays small of speed-dip: in 1 of 2 checks" in told
    assert "speed: told for certain only beyond 45 mm/s" in told
    assert "4.0 times as quiet could, as a marker camera system is beside a Vive" in told


@pytest.mark.parametrize(
    ("budget", "said"),
    [
        ((BudgetTerm("random", 25.0),), "10.0 times as quiet could, as a laser tracker is"),
        ((BudgetTerm("random", 250.0),), "100 times as quiet could, which not even a laser tracker is"),
        ((BudgetTerm("random", 8.0), BudgetTerm("oracle", 3.0)), "no tracker could, because the oracle itself is not known well enough"),
        ((BudgetTerm("random", 6.0), BudgetTerm("oracle", 2.0)), "4.0 times as quiet"),
        ((), "does not say what of u is the tracker's"),
    ],
)
def test_the_class_of_tracker_follows_from_the_budget(budget, said):
    assert said in unseen(case(check(budget=budget)))


@pytest.mark.parametrize(
    "changes",
    [{"uncertainty": 2.4, "value": 4.9}, {"outcome": Outcome.FAIL, "value": 90.0}, {"uncertainty": None}, {"outcome": Outcome.PASS}],
)
def test_a_check_that_could_have_told_says_nothing_of_it(changes):
    one = check(**changes)
    assert not blind(one)
    assert unseen(case(one)) == ""


def test_a_deviation_that_large_fails_whatever_the_noise():
    one = check()
    assert seen_beyond(one) == 45.0
    assert seen_beyond(check(uncertainty=None)) == float("inf")


def test_it_is_a_reason_of_the_case():
    lines = reason(case(check(), check(name="near", value=4.9, uncertainty=1.0))).splitlines()
    assert [line.split(":")[0] for line in lines] == ["speed", "near", "this rig cannot see what stays small of speed-dip"]
