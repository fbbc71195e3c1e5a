"""The report: it shows what the folder holds, needs nothing else, and no text from outside becomes markup."""

import base64
import hashlib
import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mitl.engine import case_recording
from mitl.engine.case_recording import RecordedRun, recording_of
from mitl.engine.record import BudgetTerm, CaseRecord, CheckRecord, Message, RunRecord
from mitl.engine.results import text_of
from mitl.outcome import Outcome
from mitl.paths import PosePath
from mitl.recording.records import LogMessage, Series
from mitl.report import render, write_report
from mitl.report.columns import packed, unpacked
from mitl.report.decimation import keep_extremes, with_gaps

HOSTILE = "<script>alert(1)</script> & \"quoted' $x^2$ \u202egnirts {{ 7*7 }} ]]> --> \x01"
VOID = {"meta", "rect", "path", "use", "br", "input"}


class Page(HTMLParser):
    """Checks that tags nest, and collects ids, references and texts."""

    def __init__(self, text):
        super().__init__()
        self.open, self.tags, self.ids, self.links, self.text, self.scripts = [], [], [], [], [], []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        values = dict(attrs)
        if "id" in values:
            self.ids.append(values["id"])
        self.links += [value for key, value in attrs if key in {"href", "src", "xlink:href"}]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open[-1:] == ["script"]:
            self.scripts.append(data)
        elif "style" not in self.open:
            self.text.append(data)

    def timeline(self, number=0):
        (found,) = [
            json.loads(data)
            for data, attributes in zip(self.scripts, self.script_attributes(), strict=True)
            if attributes.get("id") == f"case-{number}-data"
        ]
        return found

    def script_attributes(self):
        return [attributes for tag, attributes in self.tags if tag == "script"]


def path(n=800, offset=0.0):
    time = np.linspace(0.0, 4.0, n)
    position = np.stack([0.2 * np.cos(time), 0.2 * np.sin(time), 0.0 * time + offset], axis=1)
    return PosePath(time, position, np.tile([1.0, 0.0, 0.0, 0.0], (n, 1)), np.full(n, True))


def check(name="deviation", value=1.0, outcome=Outcome.PASS, **more):
    return CheckRecord(name, value, "mm", 5.0, 0.4, outcome, **more)


def case(number, outcome=Outcome.PASS, checks=(), **more):
    return CaseRecord(f"some/case-{number}", f"Case {number}", outcome, 1.0, tuple(checks), **more)


def folder_of(tmp_path, *cases, **more):
    tmp_path.mkdir(exist_ok=True)
    run = RunRecord("sim", "irb140", 7, cases, {"mitl": "1"}, started="2026-01-02T03:04:05+00:00", **more)
    (tmp_path / "results.json").write_text(text_of(run))
    return tmp_path


def record(folder, name, runs, series=None):
    recording = recording_of(runs, paths={}, series=series or {}, log=[], metadata={}, attachments={})
    case_recording.write(folder / name, recording)


def test_a_run_with_recordings_is_drawn_with_oracle_deviation_and_limit(tmp_path):
    time = path().time
    record(
        tmp_path,
        "a.mcap",
        [RecordedRun("1", path(), path(offset=0.001), path())],
        {"/check/deviation": Series(time, (1.0 + 0.0 * time)[:, None], ("deviation mm",))},
    )
    shown = check(series="/check/deviation", budget=(BudgetTerm("drift", 0.3, "since calibration"), BudgetTerm("random", 0.1)))
    page = Page(render(folder_of(tmp_path, case(0, checks=[shown], recording="a.mcap", source="MODULE A\nENDMODULE\n", program="a.mod"))))
    (run,) = page.timeline()["runs"]
    (drawn,) = run["checks"]
    assert (drawn["name"], drawn["limit"], drawn["guard"]) == ("deviation", 5.0, pytest.approx(1.65 * 0.4))
    assert np.allclose(unpacked(drawn["v"]), 1.0)
    assert unpacked(run["path"]["ox"]).max() == pytest.approx(200.0, abs=0.01)
    assert np.allclose(unpacked(run["path"]["d"]), 1.0, atol=1e-3)
    alternatives = [
        attributes["aria-label"] for _, attributes in page.tags if attributes.get("role") == "img" and "oracle" in attributes["aria-label"]
    ]
    assert all("oracle x -200 to 200, y -151 to 200, z 0 to 0 mm" in alternative for alternative in alternatives)
    assert len(alternatives) == 2
    text = "".join(page.text)
    for expected in ("MODULE A", "since calibration", "90 %", "millimetre-class faults", "a.mod"):
        assert expected in text
    assert "a.mcap" in page.links


def test_of_many_runs_the_first_are_drawn_and_the_page_says_so(tmp_path):
    record(tmp_path, "a.mcap", [RecordedRun(str(n), path(), path(offset=0.001), path()) for n in range(10)])
    text = render(folder_of(tmp_path, case(0, checks=[check()], recording="a.mcap")))
    assert [run["name"] for run in Page(text).timeline()["runs"]] == [str(n) for n in range(8)]
    assert "The recording holds 10 runs; the first 8 are drawn." in text


def test_a_series_belongs_to_the_run_that_its_name_ends_with(tmp_path):
    time = path().time
    series = {f"/check/{name}": Series(time, np.ones((800, 1)), ("x",)) for name in ("end-not-turning", "end-turning", "end")}
    record(tmp_path, "a.mcap", [RecordedRun(name, path(), path(), path()) for name in ("turning", "not turning")], series)
    checks = [check(topic, series=topic) for topic in series]
    runs = Page(render(folder_of(tmp_path, case(0, checks=checks, recording="a.mcap")))).timeline()["runs"]
    assert {run["name"]: [each["name"] for each in run["checks"]] for run in runs} == {
        "turning": ["/check/end-turning", "/check/end"],
        "not-turning": ["/check/end-not-turning"],
    }


def test_lines_outputs_and_events_stand_on_the_runs_own_time(tmp_path):
    moves = Series(np.array([0.0, 1.0, 2.0]), np.array([[0.0, 7.0], [1.0, 9.0], [2.0, 9.0]]), ("move", "line"))
    signals = Series(np.array([0.0, 1.5]), np.array([[0.0], [1.0]]), ("doPen",))
    run = RecordedRun("1", path(), path().shifted(20.0), path(), 20.0, moves, signals, began=3.0)
    log = [LogMessage(at, "info", f"at {at}", "controller") for at in (0.5, 4.25, 99.0)]
    case_recording.write(tmp_path / "a.mcap", recording_of([run], paths={}, series={}, log=log, metadata={}, attachments={}))
    (drawn,) = Page(render(folder_of(tmp_path, case(0, checks=[check()], recording="a.mcap")))).timeline()["runs"]
    assert drawn["moves"] == [[0.0, 7.0], [1.0, 9.0]]
    assert drawn["signals"] == [{"name": "doPen", "at": [[0.0, 0.0], [1.5, 1.0]]}]
    assert drawn["events"] == [[1.25, "info", "at 4.25", "controller"]]
    assert unpacked(drawn["path"]["t"])[[0, -1]] == pytest.approx([0.0, 4.0], abs=1e-3)


@given(arrays(np.float64, st.integers(0, 200), elements=st.floats(-1e6, 1e6) | st.just(np.nan)))
def test_packed_numbers_come_back_within_a_65000th_of_their_span(values):
    back = unpacked(json.loads(json.dumps(packed(values))))
    assert np.array_equal(np.isnan(back), np.isnan(values))
    if np.isfinite(values).any():
        assert np.nanmax(np.abs(back - values)) <= 0.51 * (np.nanmax(values) - np.nanmin(values)) / 65_000 + 1e-9


def test_the_page_needs_nothing_from_elsewhere_and_its_ids_are_unique(tmp_path):
    record(tmp_path, "a.mcap", [RecordedRun("1", path(), path(), path())])
    cases = [case(number, checks=[check()], recording="a.mcap") for number in range(3)]
    text = render(folder_of(tmp_path, *cases))
    page = Page(text)
    assert all(link.startswith("#") or link == "a.mcap" for link in page.links)
    assert len(page.ids) == len(set(page.ids))
    assert {link[1:] for link in page.links if link.startswith("#")} <= set(page.ids)
    assert not re.search(r"@import|url\((?!#)", text)
    assert not {tag for tag, _ in page.tags} & {"link", "img", "iframe"}


def test_only_our_own_scripts_can_run(tmp_path):
    page = Page(render(folder_of(tmp_path, case(0))))
    (policy,) = [attributes["content"] for tag, attributes in page.tags if tag == "meta" and "http-equiv" in attributes]
    allowed = re.findall(r"'sha256-([^']*)'", policy)
    ours = [text for text, attributes in zip(page.scripts, page.script_attributes(), strict=True) if "type" not in attributes]
    assert allowed == [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in ours]
    assert policy.startswith("default-src 'none'; script-src 'sha256-")


def test_the_same_folder_gives_the_same_page(tmp_path):
    record(tmp_path, "a.mcap", [RecordedRun("1", path(), path(), path())])
    folder = folder_of(tmp_path, case(0, checks=[check()], recording="a.mcap"))
    assert write_report(folder).read_text() == render(folder)


def test_text_from_outside_stays_text(tmp_path):
    hostile = CaseRecord(
        HOSTILE,
        HOSTILE,
        Outcome.FAIL,
        1.0,
        (CheckRecord(HOSTILE, 9.0, HOSTILE, 5.0, 0.1, Outcome.FAIL, budget=(BudgetTerm(HOSTILE, 0.1, HOSTILE),)),),
        (Message(HOSTILE, HOSTILE * 300), Message("error", "line\n" * 300)),
        HOSTILE.replace("/", "") + ".mcap",
        HOSTILE,
        HOSTILE,
        HOSTILE,
        (HOSTILE,),
        HOSTILE,
        HOSTILE,
    )
    run = RunRecord(HOSTILE, HOSTILE, 1, (hostile,), {HOSTILE: HOSTILE}, (HOSTILE,), HOSTILE)
    (tmp_path / "results.json").write_text(text_of(run), encoding="utf-8")
    text = render(tmp_path)
    page = Page(text)
    assert sum(tag == "script" for tag, _ in page.tags) == sum(
        tag == "script" for tag, _ in Page(render(folder_of(tmp_path / "plain"))).tags
    )
    assert "{{ 7*7 }}" in text
    assert HOSTILE in "".join(page.text)
    assert not any(key.startswith("on") for _, attributes in page.tags for key in attributes)
    assert all(not link.lower().startswith("javascript") for link in page.links)


@pytest.mark.parametrize(
    ("cases", "expected"),
    [
        ([], "No case was run."),
        ([case(0, checks=[check()])], "Nothing: no case failed"),
        ([case(0, Outcome.ERROR, messages=[Message("error", "tracker lost")])], "tracker lost"),
        ([case(0, Outcome.SKIPPED)], "skipped"),
        ([case(0, Outcome.FAIL, [check(value=7.0, outcome=Outcome.FAIL)])], "× 1.4"),
        ([case(0, Outcome.INCONCLUSIVE, [CheckRecord("x", 1.0, "", 5.0, None, Outcome.INCONCLUSIVE)])], "u = unknown"),
        ([case(0, Outcome.ERROR, [CheckRecord("x", None, "", 0.0, 0.0, Outcome.ERROR)])], "—"),
        ([case(0, checks=[CheckRecord("x", 0.0, "", 0.0, 0.0, Outcome.PASS)])], "Case 0"),
    ],
)
def test_few_or_odd_cases_are_shown(tmp_path, cases, expected):
    assert expected in "".join(Page(render(folder_of(tmp_path, *cases))).text)


def test_what_needs_a_look_stands_first_and_the_worst_before(tmp_path):
    cases = [case(0), case(1, Outcome.INCONCLUSIVE), case(2, Outcome.ERROR), case(3, Outcome.FAIL)]
    text = render(folder_of(tmp_path, *cases))
    attention = text[text.index('id="attention"') : text.index('id="overview"')]
    assert re.findall(r"some/case-(\d)", attention) == ["3", "2", "1"]


def test_an_interrupted_run_says_so(tmp_path):
    assert "judges only a part" in render(folder_of(tmp_path, case(0), interrupted=True))


@pytest.mark.parametrize(("content", "note"), [(None, "cannot be read: No such file"), (b"rubbish", "not an MCAP file")])
def test_a_recording_that_is_gone_or_broken_costs_only_the_plots(tmp_path, content, note):
    if content is not None:
        (tmp_path / "a.mcap").write_bytes(content)
    text = render(folder_of(tmp_path, case(0, checks=[check()], recording="a.mcap")))
    assert f"No plots: {tmp_path}/a.mcap: {note}" in text


def test_two_hundred_cases_stay_under_five_megabytes(tmp_path):
    cases = [
        case(number, checks=[check(f"check {index}") for index in range(4)], source="! line\n" * 40, program="a.mod")
        for number in range(200)
    ]
    assert len(render(folder_of(tmp_path, *cases)).encode()) < 5e6


def test_tables_have_headers_and_outcomes_have_words(tmp_path):
    page = Page(render(folder_of(tmp_path, case(0, checks=[check()]))))
    assert all("scope" in attributes for tag, attributes in page.tags if tag == "th")
    assert [tag for tag, _ in page.tags].count("h1") == 1
    assert dict(page.tags)["html"]["lang"] == "en"
    assert "color-scheme: light dark" in render(tmp_path)


@given(arrays(np.float64, st.tuples(st.integers(0, 500), st.integers(1, 3)), elements=st.floats(-1e3, 1e3)), st.integers(14, 60))
def test_decimation_keeps_ends_and_extremes_and_its_bound(values, most):
    chosen = keep_extremes(values, most)
    assert len(chosen) <= most
    assert np.all(np.diff(chosen) > 0)
    if len(values):
        assert {chosen[0], chosen[-1]} == {0, len(values) - 1}
        assert np.array_equal(values[chosen].max(axis=0), values.max(axis=0))
        assert np.array_equal(values[chosen].min(axis=0), values.min(axis=0))


def test_a_gap_in_time_becomes_a_gap_in_the_line():
    time, values = with_gaps(np.array([0.0, 0.1, 0.2, 9.0, 9.1]), np.ones((5, 1)))
    assert np.isnan(values[:, 0]).tolist() == [False, False, False, True, False, False]
    assert time[3] == pytest.approx(4.6)


def test_many_samples_make_a_small_page(tmp_path):
    n = 60_000
    record(tmp_path, "a.mcap", [RecordedRun("1", None, path(n), path(n))])
    assert len(render(folder_of(tmp_path, case(0, checks=[check()], recording="a.mcap")))) < 200_000


@pytest.mark.parametrize(("spread", "told"), [(20.0, True), (2.9, False)])
def test_it_says_what_the_rig_cannot_see(spread, told, tmp_path):
    check = CheckRecord("speed", 1.0, "mm/s", 5.0, spread, Outcome.INCONCLUSIVE, budget=(BudgetTerm("random", spread),))
    one = CaseRecord("a/b", "Title", Outcome.INCONCLUSIVE, checks=(check,), catches=("speed-dip",))
    (tmp_path / "results.json").write_text(text_of(RunRecord("sim", "irb140", 1, (one,), {})), encoding="utf-8")
    page = Page(render(tmp_path))
    assert ("this rig cannot see what stays small of speed-dip" in " ".join(page.text)) is told
