"""The report in a real Chromium: it loads clean and soon, one cursor moves everything, filters work, hostile text stays text."""

import os
from pathlib import Path

import numpy as np
import pytest

from mitl.engine import case_recording
from mitl.engine.case_recording import RecordedRun, recording_of
from mitl.engine.record import BudgetTerm, CaseRecord, CheckRecord, Message, RunRecord
from mitl.engine.results import text_of
from mitl.history.page import trend_page
from mitl.history.store import open_store
from mitl.outcome import Outcome
from mitl.paths import PosePath
from mitl.recording.records import LogMessage, Series
from mitl.report import write_report

HOSTILE = (
    "<script>document.title='hacked'</script><img src=x onerror=\"document.title='hacked'\"> </script> "
    "\u202egnirts \u05e9\u05dc\u05d5\u05dd {{ 7*7 }}"
)
SOLID_COLOURS = """canvas => {
  const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data, found = new Set();
  for (let i = 0; i < pixels.length; i += 4) if (pixels[i + 3] === 255) found.add([pixels[i], pixels[i + 1], pixels[i + 2]].join());
  return [...found];
}"""
WATCH_SHIFTS = """window.shifts = 0;
new PerformanceObserver(list => list.getEntries().forEach(entry => shifts += entry.value)).observe({type: 'layout-shift', buffered: true});
"""
SOURCE = "MODULE A\n" + "".join(f"  MoveL p{n}, v100, fine, tool0; ! to {n}\n" for n in range(60)) + "ENDMODULE\n"
TIME = np.linspace(0.0, 4.0, 1000)


def circle(offset=0.0, phase=0.0):
    position = np.stack([0.2 * np.cos(TIME + phase), 0.2 * np.sin(TIME + phase), 0.05 * TIME + offset], axis=1)
    return PosePath(TIME, position, np.tile([1.0, 0.0, 0.0, 0.0], (1000, 1)), np.full(1000, True))


def recorded(folder, name, *names):
    moves = Series(np.arange(4.0), np.stack([np.arange(4.0), 10.0 + 10.0 * np.arange(4.0)], axis=1), ("move", "line"))
    signals = Series(np.array([0.0, 2.0]), np.array([[0.0], [1.0]]), ("doPen",))
    runs = [RecordedRun(each, circle(), circle(0.004 * (1 + k)), circle(), 0.0, moves, signals, 0.5) for k, each in enumerate(names)]
    size = 4.0 + 3.0 * np.sin(2.0 * TIME)
    series = {f"/check/deviation-{each}": Series(TIME, size[:, None], ("mm",)) for each in names}
    log = [LogMessage(1.0, "info", "10000 started", "controller"), LogMessage(3.0, "warning", HOSTILE, "controller")]
    case_recording.write(folder / name, recording_of(runs, paths={}, series=series, log=log, metadata={}, attachments={}))
    return tuple(
        CheckRecord(f"deviation {each}", 7.0, "mm", 5.0, 0.4, Outcome.FAIL, series=topic, budget=(BudgetTerm("noise", 0.4),))
        for each, topic in zip(names, series, strict=True)
    )


def made(folder, cases, rig="sim"):
    run = RunRecord(rig, "irb140", 7, tuple(cases), {"mitl": "1"}, started="2026-01-02T03:04:05+00:00")
    (folder / "results.json").write_text(text_of(run), encoding="utf-8")
    return write_report(folder).as_uri()


@pytest.fixture
def report(tmp_path):
    """Gives a run with a failed case of two runs, and passed ones."""
    failed = CaseRecord(
        "a/failed",
        "Circles",
        Outcome.FAIL,
        4.0,
        recorded(tmp_path, "a.mcap", "one", "two"),
        recording="a.mcap",
        source=SOURCE,
        program="a.mod",
    )
    passed = [
        CaseRecord(f"b/passed-{n}", "Lines", Outcome.PASS, 1.0, (CheckRecord("x", 1.0, "mm", 5.0, 0.1, Outcome.PASS),)) for n in range(3)
    ]
    return made(tmp_path, [*passed, failed])


def test_one_time_moves_plots_space_program_and_log(page, report):
    page.goto(report)
    explorer = page.locator("article.fail .explorer")
    assert explorer.locator(".uplot").count() == 3  # its check, the speed, the outputs
    slider = explorer.locator(".slider")
    for time, line, event in ((1.2, "20", 0), (2.6, "30", 1)):
        slider.evaluate("(e, t) => { e.value = 2000 * t / 4; e.dispatchEvent(new Event('input')); }", time)
        assert explorer.locator(".rapid .now").inner_text().strip().startswith(f"MoveL p{int(line) - 2},")
        assert f"line {line}" in slider.get_attribute("aria-valuetext")
        assert f"{time:.3f} s" in explorer.locator(".readout").inner_text()
        assert "now" in (explorer.locator(".events li").nth(event).get_attribute("class") or "")
        places = explorer.locator(".playhead").evaluate_all("all => all.map(e => e.getBoundingClientRect().x)")
        assert max(places) - min(places) < 1.0
    explorer.locator(".u-over").first.scroll_into_view_if_needed()
    box = explorer.locator(".u-over").first.bounding_box()
    page.mouse.move(box["x"] + 0.55 * box["width"], box["y"] + 20)
    assert abs(float(explorer.locator(".readout").inner_text().split()[0]) - 2.2) < 0.05
    assert "doPen 1" in explorer.locator(".panel-head b").last.inner_text()


def test_runs_are_chosen_and_compared(page, report):
    page.goto(report)
    explorer = page.locator("article.fail .explorer")
    explorer.get_by_role("button", name="two").click()
    assert "deviation two" in explorer.locator(".panel-head").first.inner_text()
    explorer.get_by_role("button", name="compare runs").click()
    assert "distance from the oracle" in explorer.inner_text()
    for name in ("XY", "×10", "Larger"):
        explorer.get_by_role("button", name=name).click()
    assert "deviation ×10" in explorer.locator(".scale").inner_text()


def test_the_space_shows_oracle_and_recording(page, report):
    page.goto(report)
    colours = page.locator("article.fail .space canvas").evaluate(SOLID_COLOURS)
    assert {"180,192,208", "176,134,0"} <= set(colours)  # the oracle's grey, and the shade for four fifths of the limit


def test_filters_search_and_links_find_cases(page, report):
    page.goto(report)
    shown = page.locator("article:visible")
    page.get_by_role("button", name="1 fail").click()
    assert shown.count() == 1
    assert page.locator("#told").inner_text() == "1 of 4 cases shown"
    page.get_by_role("button", name="1 fail").click()
    page.keyboard.press("/")
    page.keyboard.type("passed-2")
    assert shown.count() == 1
    page.locator("#search").fill("")
    page.locator("table.cases a", has_text="b/passed-1").click()
    page.locator("#case-1 details.case[open]").wait_for()


def test_the_keyboard_reaches_and_works_everything(page, report):
    page.goto(report)
    slider = page.locator("article.fail .slider")
    slider.focus()
    before = slider.input_value()
    page.keyboard.press("ArrowRight")
    assert int(slider.input_value()) == int(before) + 1
    page.locator("article.fail .play").focus()
    page.keyboard.press("Enter")
    page.wait_for_function("before => Number(document.querySelector('article.fail .slider').value) > Number(before) + 20", arg=before)
    page.keyboard.press("Enter")
    page.locator("body").press("k")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_both_themes_load_without_a_shift_and_the_button_changes_them(page, report, scheme):
    page.emulate_media(color_scheme=scheme)
    page.add_init_script(WATCH_SHIFTS)
    page.goto(report)
    page.wait_for_timeout(200)
    assert page.evaluate("shifts") < 0.02
    background = "getComputedStyle(document.body).backgroundColor"
    first = page.evaluate(background)
    for _ in range(2 if scheme == "light" else 1):
        page.locator("#theme").click()
    assert page.evaluate(background) != first


def test_hostile_text_renders_as_text(page, tmp_path):
    checks = (CheckRecord(HOSTILE, 9.0, HOSTILE, 5.0, 0.1, Outcome.FAIL, budget=(BudgetTerm(HOSTILE, 0.1, HOSTILE),)),)
    messages = (Message(HOSTILE, HOSTILE), Message("error", "x" * 10_000), Message("info", "wide " * 2000))
    cases = [
        CaseRecord(f"{HOSTILE} {n}", HOSTILE, Outcome.FAIL, 1.0, checks, messages, program=HOSTILE, source=HOSTILE * 100) for n in range(2)
    ]
    seen = recorded(tmp_path, "a.mcap", "one")
    cases.append(
        CaseRecord("c", "</script><b>", Outcome.FAIL, 1.0, seen, recording="a.mcap", source=HOSTILE + "\n" + "y" * 10_000, program="a.mod")
    )
    page.goto(made(tmp_path, cases, rig=HOSTILE))
    page.get_by_role("button", name="Open all").click()
    assert "hacked" not in page.title() or "<script>" in page.title()
    assert page.locator("img").count() == 0
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert HOSTILE[:30] in page.locator("article h2").first.inner_text()


@pytest.mark.parametrize("outcome", [None, Outcome.ERROR, Outcome.SKIPPED])
def test_runs_without_a_verdict_load(page, tmp_path, outcome):
    cases = [] if outcome is None else [CaseRecord(f"c-{n}", "t", outcome, messages=(Message("error", "lost"),)) for n in range(3)]
    page.goto(made(tmp_path, cases))
    assert page.locator("h1").is_visible()


def test_two_hundred_cases_load_soon_and_stay_small(page, tmp_path):
    checks = recorded(tmp_path, "a.mcap", "one")
    cases = [
        CaseRecord(f"suite/case-{n}", "Circles", Outcome.FAIL, 4.0, checks, recording="a.mcap", source=SOURCE, program="a.mod")
        for n in range(200)
    ]
    address = made(tmp_path, cases)
    assert (tmp_path / "report.html").stat().st_size < 5e6
    page.goto(address)
    assert page.locator("article").count() == 200
    page.get_by_role("button", name="Close all").click()


def test_printing_opens_the_cases_and_draws_in_light_colours(page, report):
    page.emulate_media(color_scheme="dark")
    page.goto(report)
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.locator("details.case[open]").count() == 4
    assert page.evaluate("mitl.palette().card") == "rgb(255, 255, 255)"
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert page.locator("details.case[open]").count() == 1


def test_the_trend_page_draws_what_is_opened_and_filters(page, tmp_path):
    with open_store(tmp_path / "h.sqlite", create=True) as store:
        for number, value in enumerate([1.0, 1.2, 9.0], start=1):
            outcome = Outcome.FAIL if value > 5.0 else Outcome.PASS
            checks = tuple(CheckRecord(f"check {k}", value if k else 1.0, "mm", 5.0, 0.2, outcome if k else Outcome.PASS) for k in range(9))
            run = RunRecord("sim", "irb140", number, (CaseRecord("a", "A", outcome, 1.0, checks),), {}, started=f"2026-01-0{number}T00:00")
            folder = tmp_path / str(number)
            folder.mkdir()
            (folder / "results.json").write_text(text_of(run))
            store.add(folder)
        (tmp_path / "t.html").write_text(trend_page(store, store.run("last")))
    page.goto((tmp_path / "t.html").as_uri())
    assert page.locator(".uplot").count() == 6
    page.locator("summary").last.click()
    page.locator("article").last.locator(".uplot").wait_for()
    page.get_by_label("only what is bad").check()
    assert page.locator("article:visible").count() == 8
    assert page.locator("#told").inner_text() == "8 of 9 checks shown"


def test_an_accessibility_checker_finds_nothing_serious(page, report):
    axe = os.environ.get("MITL_AXE")
    if axe is None:
        pytest.skip("needs axe-core: npm pack axe-core, and the path of its axe.min.js in MITL_AXE")
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        page.goto(report)
        page.evaluate(Path(axe).read_text(encoding="utf-8"))
        found = page.evaluate("async () => (await axe.run()).violations.map(v => [v.impact, v.id, v.nodes.map(n => n.html.slice(0, 200))])")
        assert [each for each in found if each[0] in {"serious", "critical"}] == []
