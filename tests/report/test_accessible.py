"""An accessibility checker finds nothing in the pages, and a long recording stays small."""

import itertools
from pathlib import Path

import numpy as np
import pytest

from mitl.engine import case_recording
from mitl.engine.case_recording import RecordedRun, recording_of
from mitl.engine.record import BudgetTerm, CaseRecord, CheckRecord, Message, RunRecord
from mitl.engine.results import read_run, text_of
from mitl.history.page import trend_page
from mitl.history.store import open_store
from mitl.outcome import Outcome
from mitl.paths import PosePath
from mitl.recording.mcap_reader import read_recording
from mitl.recording.records import LogMessage, Series
from mitl.report import write_report
from mitl.report.columns import unpacked
from mitl.report.timeline import timeline_of

SOURCE = "MODULE A\n" + "".join(f"  MoveL p{n}, v100, fine, tool0;\n" for n in range(60)) + "ENDMODULE\n"
X_BO = np.array([0.5, 0.0, 0.4, 1.0, 0.0, 0.0, 0.0])
X_FT = np.array([0.0, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0])


def circle(samples, offset=0.0):
    time = np.linspace(0.0, samples / 250.0, samples)
    position = np.stack([0.2 * np.cos(time), 0.2 * np.sin(time), 0.05 * np.sin(0.1 * time) + offset], axis=1)
    return PosePath(time, position, np.tile([0.0, 0.0, 1.0, 0.0], (samples, 1)), np.full(samples, True))


def run_of(folder, measured, oracle, deviation_mm):
    moves = Series(np.arange(4.0), np.stack([np.arange(4.0), 10.0 + 10.0 * np.arange(4.0)], axis=1), ("move", "line"))
    signals = Series(np.array([0.0, 2.0]), np.array([[0.0], [1.0]]), ("doPen",))
    run = RecordedRun("", None, measured, oracle, 0.0, moves, signals, 0.5, X_FT, X_BO)
    series = {"/check/deviation": Series(measured.time, deviation_mm[:, None], ("mm",))}
    log = [LogMessage(1.0, "info", "10000 started", "controller")]
    data = recording_of([run], paths={}, series=series, log=log, metadata={"robot": "irb140"}, attachments={"a.mod": SOURCE.encode()})
    case_recording.write(folder / "a.mcap", data)
    budget = (BudgetTerm("noise", 0.3, "still recording"), BudgetTerm("calibration", 0.2, "covariance"))
    check = CheckRecord("deviation", 7.0, "mm", 5.0, 0.4, Outcome.FAIL, series="/check/deviation", budget=budget)
    messages = tuple(Message(level, f"told as {level}") for level in ("info", "warning", "error"))
    cases = [CaseRecord("a/failed", "Circles", Outcome.FAIL, 4.0, (check,), messages, recording="a.mcap", source=SOURCE, program="a.mod")]
    passing = CheckRecord("x", 1.0, "mm", 5.0, 0.1, Outcome.PASS)
    cases += [CaseRecord(f"b/{outcome.value}", "Lines", outcome, 1.0, (passing,)) for outcome in Outcome]
    (folder / "results.json").write_text(text_of(RunRecord("sim", "irb140", 7, tuple(cases), {"mitl": "1"})), encoding="utf-8")
    return write_report(folder)


@pytest.fixture
def axe(page):
    """Gives a function that loads a page, opens what is folded, and gives what axe-core has against it."""
    checker = pytest.importorskip("axe_playwright_python", reason="needs the extra 'browser'")
    script = (Path(checker.__file__).parent / "axe.min.js").read_text(encoding="utf-8")

    def look(file, scheme):
        page.emulate_media(color_scheme=scheme, reduced_motion="reduce")
        page.goto(file.as_uri())
        page.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")
        page.wait_for_timeout(150)
        page.evaluate(script)
        found = page.evaluate("axe.run()")
        assert len(found["passes"]) > 10
        return [(rule["id"], rule["impact"], node["html"][:200]) for rule in found["violations"] for node in rule["nodes"]]

    return look


def trend(folder):
    with open_store(folder / "h.sqlite", create=True) as store:
        store.add(folder)
        (folder / "trend.html").write_text(trend_page(store, store.run("last")), encoding="utf-8")
    return folder / "trend.html"


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_an_accessibility_checker_finds_nothing(axe, tmp_path, scheme):
    samples = circle(1000, 0.004)
    report = run_of(tmp_path, samples, circle(1000), 4.0 + 3.0 * np.sin(samples.time))
    pages = [report, tmp_path / "replay.html", trend(tmp_path)]
    assert list(itertools.chain.from_iterable(axe(each, scheme) for each in pages)) == []


def test_the_accessibility_checker_would_tell(axe, tmp_path):
    bad = tmp_path / "bad.html"
    words = "".join(f"<p>{n}</p>" for n in range(20))
    bad.write_text(
        f"<!DOCTYPE html><html lang='en'><title>t</title><main><h1>t</h1><button></button><ul><li>a</ul>{words}", encoding="utf-8"
    )
    assert "button-name" in {rule for rule, _, _ in axe(bad, "light")}


def test_a_long_recording_keeps_its_extreme_and_stays_small(page, tmp_path):
    samples, spike = 50_000, 32_123  # benchmarks/long_recording.py does the same with a million
    deviation = np.full(samples, 1.0)
    deviation[spike] = 77.25
    report = run_of(tmp_path, circle(samples, 0.001), circle(samples), deviation)
    assert report.stat().st_size + (tmp_path / "replay.html").stat().st_size < 5e6
    data = timeline_of(read_run(tmp_path).cases[0], read_recording(tmp_path / "a.mcap"), 1500)
    (check,) = data.data["runs"][0]["checks"]
    assert unpacked(check["v"]).max() == pytest.approx(77.25)
    assert len(unpacked(check["v"])) <= 1500
    page.goto(report.as_uri())
    page.locator("article.fail .slider").wait_for()
