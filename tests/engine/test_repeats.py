"""Inconclusive cases are repeated as a sequential test; sub-tests end by themselves."""

import pytest

from mitl.engine.case import CaseInfo
from mitl.engine.check import Check, FatalError
from mitl.engine.judging import Look, Question, judged, promising
from mitl.engine.record import BudgetTerm
from mitl.engine.recorder import CaseRecorder
from mitl.errors import RigError
from mitl.outcome import Outcome

NOISY = (BudgetTerm("random", 3.0), BudgetTerm("registration", 4.0))


@pytest.fixture
def recorder():
    return CaseRecorder(CaseInfo("some/case", "Some case"), most_looks=3)


def test_only_the_random_term_falls_with_the_number_of_looks():
    question = Question("x", "mm", 20.0, looks=4)
    record = judged(question, [Look(value, 5.0, NOISY) for value in (1.0, 2.0, 3.0, 6.0)])
    assert record.value == 3.0
    assert record.looks == 4
    assert [term.value for term in record.budget] == [1.5, 4.0]
    assert record.uncertainty == pytest.approx((1.5**2 + 4.0**2) ** 0.5)
    assert record.guard == 2.067


def test_an_uncertainty_without_terms_does_not_fall():
    record = judged(Question("x", "mm", 5.0, looks=3), [Look(4.0, 1.0), Look(4.0, 2.0)])
    assert record.uncertainty == 2.0
    assert not promising(Question("x", "mm", 5.0, looks=3), [Look(4.0, 1.0)])


def test_a_look_that_is_no_number_makes_the_check_an_error():
    assert judged(Question("x", "mm", 5.0, looks=3), [Look(4.0, 1.0), Look(float("nan"), 1.0)]).outcome is Outcome.ERROR


@pytest.mark.parametrize(("limit", "rounds"), [(12.0, 1), (6.0, 2), (3.0, 1)])
def test_a_case_is_repeated_only_while_a_verdict_is_in_sight(recorder, limit, rounds):
    check = Check(recorder)
    while True:
        budget = {"random": 2.5, "registration": 0.5}
        check("x", value=2.0, limit=limit, uncertainty=(2.5**2 + 0.5**2) ** 0.5, budget=budget)
        if not recorder.next_round():
            break
    assert recorder.round == rounds


def test_cases_are_repeated_by_the_plugin_and_the_record_says_how_often(cases):
    text = """
@case("sim/a", title="A", purpose="-")
def test_a(check):
    check("open", value=3.0, limit=6.0, uncertainty=1.9, budget={"random": 1.9})
    check("clear", value=0.0, limit=6.0, uncertainty=1.9, budget={"random": 1.9})
"""
    cases(text).assert_outcomes(passed=1)
    (found,) = cases.results()["cases"]
    assert [(made["outcome"], made["looks"], made["guard"]) for made in found["checks"]] == [("pass", 2, 1.992), ("pass", 2, 1.992)]
    cases(text, "--mitl-repeats=1").assert_outcomes(skipped=1)
    assert cases.results()["cases"][0]["checks"][0]["guard"] == 1.65


def test_a_number_of_repeats_that_has_no_constant_is_refused(cases):
    result = cases('@case("sim/a", title="A", purpose="-")\ndef test_a(check):\n    pass\n', "--mitl-repeats=11")
    assert result.ret == 4
    result.stderr.fnmatch_lines(["*--mitl-repeats=11: expected 1 to 10*"])


def test_an_error_in_a_subtest_ends_the_subtest_and_the_case_goes_on(recorder):
    check = Check(recorder)
    with check.subtest("first"):
        check("x", value=1.0, limit=5.0, uncertainty=0.1)
        raise RigError("the tracker is lost")
    with check.subtest("second"):
        check("x", value=9.0, limit=5.0, uncertainty=0.1)
    record = recorder.finish()
    assert [(part.name, part.outcome.value) for part in record.subtests] == [("first", "error"), ("second", "fail")]
    assert [made.name for made in record.checks] == ["first: x", "second: x"]
    assert record.messages[0].text == "first: the tracker is lost"
    assert record.outcome is Outcome.FAIL


def test_a_subtest_that_judges_nothing_is_an_error(recorder):
    with Check(recorder).subtest("idle"):
        pass
    assert recorder.finish().outcome is Outcome.ERROR


def test_what_ends_the_run_passes_through_a_subtest(recorder):
    check = Check(recorder)
    with pytest.raises(FatalError), check.subtest("first"):
        check.fatal("the fence is open")


def test_subtests_do_not_nest(recorder):
    check = Check(recorder)
    with check.subtest("outer"), check.subtest("inner"):
        pass
    assert "do not nest" in recorder.messages[0].text


def test_an_attachment_is_kept_in_the_recording(recorder):
    check = Check(recorder)
    check.attach("photo.txt", b"as it stood")
    with pytest.raises(ValueError, match=r"photo\.txt"):
        check.attach("photo.txt", b"again")
    assert recorder.recorded({}).attachments == {"photo.txt": b"as it stood"}
    check.operator("Put the second device on the belt.")
    assert recorder.finish().messages[0].level == "operator"


def test_an_order_that_is_not_done_in_time_stops_the_robot_and_ends_only_its_subtest(cases):
    cases("""
@case("sim/a", title="A", purpose="-", program="line.mod")
def test_a(bench, check):
    with check.subtest("endless"):
        bench.run(9, timeout=0.5)
    with check.subtest("line"):
        run = bench.run(2)
        check("samples", value=len(run.tool), limit=100, uncertainty=0.0, unit="", at_least=True)
""")
    (found,) = cases.results()["cases"]
    assert [part["outcome"] for part in found["subtests"]] == ["error", "pass"]
    assert "was not done after 0.5 s" in found["messages"][0]["text"]
