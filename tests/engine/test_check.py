"""`check`: what it records and what it refuses."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mitl.engine.case import CaseInfo, case, matches
from mitl.engine.check import Check
from mitl.engine.recorder import CaseRecorder, file_name
from mitl.engine.selection import select
from mitl.errors import UsageError
from mitl.metrics.uncertainty import Budget, Term
from mitl.outcome import Outcome


@pytest.fixture
def recorder():
    return CaseRecorder(CaseInfo("some/case", "Some case"))


@pytest.fixture
def check(recorder):
    return Check(recorder)


@given(
    value=st.floats(-1e3, 1e3),
    limit=st.floats(0.0, 1e3),
    uncertainty=st.floats(0.0, 1e2),
    at_least=st.booleans(),
)
def test_the_guard_band_decides(value, limit, uncertainty, at_least):
    found = Check(CaseRecorder(CaseInfo("a", "A")))("x", value=value, limit=limit, uncertainty=uncertainty, at_least=at_least)
    error = limit - value if at_least else abs(value) - limit
    band = 1.65 * uncertainty
    near = min(abs(error + band), abs(error - band)) < 1e-9 * (1.0 + abs(value) + limit + band)
    assert near or found is (Outcome.PASS if error + band <= 0 else Outcome.FAIL if error - band > 0 else Outcome.INCONCLUSIVE)


def test_a_budget_in_si_becomes_terms_and_uncertainty_in_the_checks_unit(check, recorder):
    check("x", value=1.0, limit=5.0, budget=Budget((Term("random", 3e-4, "noise"), Term("drift", 4e-4))), unit="mm")
    (made,) = recorder.checks
    assert made.uncertainty == pytest.approx(0.5)
    assert [(term.name, pytest.approx(term.value), term.source) for term in made.budget] == [("random", 0.3, "noise"), ("drift", 0.4, "")]
    assert made.tur == pytest.approx(5.0)
    assert made.margin == 4.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"uncertainty": -1.0}, "check 'x': expected an uncertainty >= 0, got -1.0"),
        ({"uncertainty": float("nan")}, "check 'x': expected an uncertainty >= 0, got nan"),
        ({"limit": float("inf"), "uncertainty": 1.0}, "check 'x': expected a finite limit >= 0, got inf"),
        ({"limit": -1.0, "uncertainty": 1.0}, "check 'x': expected a finite limit >= 0, got -1.0"),
        ({}, "check 'x': give its uncertainty, or a Budget that it follows from"),
        ({"budget": Budget((Term("random", 1.0),)), "unit": "furlong"}, "unit 'furlong': a Budget can be converted to m, mm"),
    ],
)
def test_what_makes_no_sense_is_refused(check, arguments, message):
    with pytest.raises(ValueError, match="^" + message.replace("(", r"\(")):
        check("x", **{"value": 1.0, "limit": 2.0, **arguments})


def test_an_unknown_uncertainty_is_inconclusive_and_has_no_number(check, recorder):
    assert check("x", value=0.0, limit=2.0, uncertainty=float("inf")) is Outcome.INCONCLUSIVE
    assert recorder.checks[0].uncertainty is None
    assert recorder.checks[0].tur is None


def test_two_checks_of_one_name_are_refused(check):
    check("x", value=0.0, limit=2.0, uncertainty=0.1)
    with pytest.raises(ValueError, match="check 'x' was already made in this case"):
        check("x", value=0.0, limit=2.0, uncertainty=0.1)


def test_series_of_like_names_keep_topics_of_their_own(check, recorder):
    time = np.array([0.0, 1.0])
    for name in ("a b", "a-b"):
        check(name, value=0.0, limit=2.0, uncertainty=0.1, over_time=(time, time))
    assert [made.series for made in recorder.checks] == ["/check/a-b", "/check/a-b-2"]


def test_numpy_numbers_become_plain_ones(check, recorder):
    check("x", value=np.float64(1.5), limit=np.float64(2.0), uncertainty=np.float32(0.1))
    assert type(recorder.checks[0].value) is float
    assert type(recorder.checks[0].uncertainty) is float


def test_an_unknown_level_of_a_message_is_refused(check):
    with pytest.raises(ValueError, match=r"message level 'fatal': expected one of info, warning, error; check\.fatal ends the run"):
        check.message("fatal", "no")


def test_a_malformed_id_is_refused():
    with pytest.raises(UsageError, match="case id 'ATC 1': expected lower-case words joined by - and /, for example atc-1/linear"):
        case("ATC 1", title="t", purpose="p")


@pytest.mark.parametrize(
    ("wanted", "meant"),
    [("atc-1", True), ("atc-1/line", True), ("atc-1/line/", False), ("atc-1/lin", False), ("atc", False), ("tc-1", False)],
)
def test_a_case_is_meant_by_whole_leading_parts(wanted, meant):
    assert matches("atc-1/line", wanted) is meant
    assert not matches("atc-10/line", "atc-1")


def test_without_a_selection_all_are_meant_and_a_slash_at_the_end_does_no_harm():
    cases = [CaseInfo(name, name) for name in ("a/b", "a/c", "d")]
    assert select(cases[:2], []) == {"a/b", "a/c"}
    assert select(cases, ["a/"]) == {"a/b", "a/c"}


def test_a_case_that_takes_hours_is_run_only_where_it_is_asked_for():
    cases = [CaseInfo("a/b", "short"), CaseInfo("a/c", "long", long=True)]
    assert select(cases, []) == select(cases, ["a"]) == {"a/b"}
    assert select(cases, ["a/c"]) == {"a/c"}
    assert select(cases, [], long=True) == {"a/b", "a/c"}


@given(st.text(max_size=200), st.text(max_size=200))
def test_file_names_are_plain_and_differ_where_ids_differ(one, other):
    names = [file_name(text, ".mcap") for text in (one, other)]
    assert all(name.isascii() and not set(name) & set("/\\: \n\0") and not name.startswith(".") and len(name) < 130 for name in names)
    if one != other and one.replace("/", "_") != other.replace("/", "_"):
        assert names[0] != names[1]
