"""A night's cases: what fits, what finds most, what was left out, and in which order."""

import json
from datetime import UTC, datetime, timedelta
from itertools import combinations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mitl.cli import run
from mitl.engine.case import CaseInfo
from mitl.errors import UsageError
from mitl.history.store import KeptCase, KeptRun
from mitl.night.kept import FILE_NAME, in_words, write_night
from mitl.night.known import FAILED, NAMED, NEW, SHARE, offers, power_of
from mitl.night.plan import Offer, plan
from mitl.outcome import Outcome

NOW = datetime(2026, 11, 27, 22, 0, tzinfo=UTC)


def kept(case, outcome, duration, *, days=0.0):
    started = (NOW - timedelta(days=days)).isoformat()
    known = KeptRun(f"{case}{days}", started, "sim", "irb140", 1, (), outcome, 1.0, {}, "f", None)
    return KeptCase(known, case, case, outcome, duration, "")


def test_two_cheap_cases_that_find_as_much_are_taken_for_one_that_is_dear():
    night = plan([Offer("dear", 100.0, {"a": 0.9, "b": 0.9}), Offer("one", 30.0, {"a": 0.9}), Offer("two", 40.0, {"b": 0.9})], 100.0)
    assert [offer.case for offer in night.chosen] == ["one", "two"]
    assert night.seconds == 70.0
    assert [offer.case for offer in night.left_out] == ["dear"]
    assert night.found == pytest.approx({"a": 0.9, "b": 0.9})


def test_what_others_find_already_is_not_paid_for_twice():
    night = plan([Offer("a1", 10.0, {"a": 1.0}), Offer("a2", 10.0, {"a": 1.0}), Offer("b", 20.0, {"b": 1.0})], 30.0)
    assert {offer.case for offer in night.chosen} in ({"a1", "b"}, {"a2", "b"})


def test_what_was_not_passed_is_run_and_comes_first():
    night = plan(
        [Offer("finds", 10.0, {"a": 1.0}), Offer("failed", 10.0, urgency=3.0, last=Outcome.FAIL), Offer("more", 10.0, {"b": 1.0})], 20.0
    )
    assert night.chosen[0].case == "failed"
    assert len(night.chosen) == 2


def test_the_calibration_takes_its_time():
    assert not plan([Offer("one", 10.0, {"a": 1.0})], 300.0, before=295.0).chosen
    assert not plan([], 300.0).chosen
    night = plan([Offer("one", 10.0, {"a": 1.0})], 310.0, before=300.0)
    assert night.seconds == 310.0


@settings(deadline=None, max_examples=60)
@given(
    st.lists(
        st.tuples(st.integers(1, 60), st.dictionaries(st.sampled_from("abcd"), st.floats(0.1, 1.0)), st.floats(0.01, 3.0)),
        min_size=1,
        max_size=7,
    ),
    st.integers(0, 200),
)
def test_no_other_choice_that_fits_is_worth_more(cases, budget):
    made = [Offer(f"c{number}", float(seconds), finds, urgency) for number, (seconds, finds, urgency) in enumerate(cases)]

    def worth(chosen):
        faults = {fault for offer in chosen for fault in offer.finds}
        found = sum(min(1.0, sum(offer.finds.get(fault, 0.0) for offer in chosen)) for fault in faults)
        return found + sum(offer.urgency for offer in chosen)

    night = plan(made, float(budget))
    assert night.seconds <= budget + 1e-9
    assert sorted([*night.chosen, *night.left_out], key=lambda offer: offer.case) == made
    best = max(
        worth(some) for size in range(len(made) + 1) for some in combinations(made, size) if sum(offer.seconds for offer in some) <= budget
    )
    assert worth(night.chosen) == pytest.approx(best, abs=1e-6)


def test_measured_times_and_rates_go_before_what_a_case_says_of_itself():
    infos = [CaseInfo("a/one", "One", catches=("speed", "hiccup"), typical_s=60.0), CaseInfo("a/two", "Two", catches=("speed",))]
    past = [kept("a/one", Outcome.PASS, 10.0, days=7), kept("a/one", Outcome.FAIL, 20.0), kept("a/one", Outcome.SKIPPED, 0.0)]
    one, two = offers(infos, now=NOW, kept=past, power={("a/one", "speed"): 0.4, ("a/one", "backlash"): 0.7})
    assert one.seconds == 15.0
    assert one.finds == {"speed": 0.4, "hiccup": NAMED, "backlash": 0.7}
    assert (one.last, one.urgency) == (Outcome.FAIL, pytest.approx(SHARE + FAILED))
    assert (two.last, two.seconds, two.urgency) == (None, 60.0, pytest.approx(SHARE + NEW))


def test_the_rates_of_a_campaign_are_those_of_its_largest_size(tmp_path):
    rows = [("a/one", 1.0, 0.2), ("a/one", -3.0, 1.0), ("a/one", 2.0, 0.6), (None, 9.0, 1.0)]
    made = {"detections": [{"fault": "speed", "size": size, "case": case, "rate": rate} for case, size, rate in rows]}
    (tmp_path / "campaign.json").write_text(json.dumps(made))
    assert power_of(tmp_path / "campaign.json") == {("a/one", "speed"): 1.0}


@pytest.mark.parametrize(
    ("text", "said"), [("[", "not JSON"), ("{}", "'detections' is missing"), ('{"detections": [{}]}', "'case' is missing")]
)
def test_another_file_is_refused(tmp_path, text, said):
    (tmp_path / "x.json").write_text(text)
    with pytest.raises(UsageError, match=said):
        power_of(tmp_path / "x.json")


def test_the_plan_is_kept_and_told(tmp_path):
    night = plan([Offer("one", 10.0, {"a": 1.0}), Offer("long", 9000.0, {"b": 1.0}, last=Outcome.FAIL)], 60.0)
    write_night(tmp_path / "run", night)
    told = json.loads((tmp_path / "run" / FILE_NAME).read_text())
    assert [one["case"] for one in told["left_out"]] == ["long"]
    assert told["planned_s"] == 10.0
    words = in_words(night)
    assert "1 of 2 cases" in words
    assert "2.5 h  fail the last time" in words
    assert words.endswith("rather miss: b")


def test_a_run_has_the_cases_of_its_plan_in_their_order(tmp_path, capsys):
    words = ["verify", "atc-1", "--budget", "370s", "--out", str(tmp_path / "run"), "--store", str(tmp_path / "none")]
    assert run(words) == 0
    told = json.loads((tmp_path / "run" / FILE_NAME).read_text())
    done = json.loads((tmp_path / "run" / "results.json").read_text())
    assert [case["id"] for case in done["cases"]] == [one["case"] for one in told["chosen"]]
    assert 1 <= len(done["cases"]) < 6
    assert told["planned_s"] <= 370.0
    assert "left out:" in capsys.readouterr().err


def test_a_time_that_is_too_short_and_a_word_that_is_no_time_are_told(tmp_path, capsys):
    assert run(["verify", "atc-1", "--budget", "5min", "--out", str(tmp_path / "run")]) == 2
    assert "no case fits" in capsys.readouterr().err
    for word in ("soon", "0s", "-5min", ""):
        assert run(["verify", "--budget", word]) == 2
        assert "45min" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("word", "told", "code"), [("1h30min", "1.5 h", 0), ("90 s", "1.5 min", 2), ("8h", "8.0 h", 0), ("45MIN", "45.0 min", 0)]
)
def test_durations_are_read_as_people_write_them(word, told, code, tmp_path, capsys):
    assert run(["verify", "--list", "--budget", word, "--store", str(tmp_path / "none")]) == code
    assert f"of {told}," in capsys.readouterr().out


def test_a_plan_is_listed_as_json_and_a_later_run_without_one_keeps_none(tmp_path, capsys):
    assert run(["verify", "atc-1/direction", "--list", "--budget", "1h", "--format", "json", "--store", str(tmp_path / "none")]) == 0
    assert [one["case"] for one in json.loads(capsys.readouterr().out)["chosen"]] == ["atc-1/direction"]
    words = ["verify", "atc-1/direction", "--out", str(tmp_path / "run")]
    assert run([*words, "--budget", "1h", "--store", str(tmp_path / "none")]) == 0
    assert (tmp_path / "run" / FILE_NAME).is_file()
    assert run(words) == 0
    assert not (tmp_path / "run" / FILE_NAME).exists()


def test_what_is_inconclusive_on_this_rig_is_not_urgent_and_an_error_is():
    infos = [CaseInfo("a/open", "Open"), CaseInfo("a/broken", "Broken")]
    past = [kept("a/open", Outcome.INCONCLUSIVE, 5.0), kept("a/broken", Outcome.ERROR, 5.0)]
    urgencies = [offer.urgency for offer in offers(infos, now=NOW, kept=past)]
    assert urgencies == pytest.approx([SHARE, SHARE + FAILED])
