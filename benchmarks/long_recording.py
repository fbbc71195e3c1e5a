"""Prints what a recording of a million samples (67 minutes at 250 Hz) costs: report and replay, their size, the browser's longest stall.

Run: python benchmarks/long_recording.py [SAMPLES]. The stalls need `pip install mitl[browser]` and Chromium. The bar (issue 8): 20 MB, 1 s.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from mitl.engine import case_recording
from mitl.engine.case_recording import RecordedRun, recording_of
from mitl.engine.record import CaseRecord, CheckRecord, RunRecord
from mitl.engine.results import text_of
from mitl.outcome import Outcome
from mitl.paths import PosePath
from mitl.recording.records import Series
from mitl.report import write_report

COUNT = 1_000_000
SOURCE = "MODULE A\n" + "".join(f"  MoveL p{n}, v100, fine, tool0;\n" for n in range(60)) + "ENDMODULE\n"
WATCH = """window.longest = 0; let last = performance.now();
const tick = () => { const now = performance.now(); longest = Math.max(longest, now - last); last = now; requestAnimationFrame(tick); };
requestAnimationFrame(tick);"""
SWITCHES = ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update"]
SWITCHES += ["--disable-sync", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def circles(samples: int, offset: float) -> PosePath:
    """Gives a round of 200 mm after the other, at 250 Hz."""
    t = np.arange(samples) / 250.0
    position = np.stack([0.2 * np.cos(t), 0.2 * np.sin(t), 0.05 * np.sin(0.1 * t) + offset], axis=1)
    return PosePath(t, position, np.tile([0.0, 0.0, 1.0, 0.0], (samples, 1)), np.full(samples, True))


def folder_of_run(folder: Path, samples: int) -> None:
    """Writes a run of one case whose recording has so many samples and one spike."""
    measured = circles(samples, 0.001)
    deviation = np.full((samples, 1), 1.0)
    deviation[samples * 2 // 3] = 77.25
    frames = (np.array([0.0, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0]), np.array([0.5, 0.0, 0.4, 1.0, 0.0, 0.0, 0.0]))
    moves = Series(np.arange(4.0), np.stack([np.arange(4.0), 10.0 + 10.0 * np.arange(4.0)], axis=1), ("move", "line"))
    run = RecordedRun("", None, measured, circles(samples, 0.0), 0.0, moves, None, 0.5, *frames)
    series = {"/check/deviation": Series(measured.time, deviation, ("mm",))}
    metadata, program = {"robot": "irb140"}, {"a.mod": SOURCE.encode()}
    case_recording.write(folder / "a.mcap", recording_of([run], paths={}, series=series, log=[], metadata=metadata, attachments=program))
    check = CheckRecord("deviation", 77.25, "mm", 5.0, 0.4, Outcome.FAIL, series="/check/deviation")
    case = CaseRecord("long", "Long", Outcome.FAIL, 4.0, (check,), recording="a.mcap", source=SOURCE, program="a.mod")
    (folder / "results.json").write_text(text_of(RunRecord("sim", "irb140", 7, (case,), {})), encoding="utf-8")


def stalls(file: Path) -> str:
    """Gives the time until the page has loaded and the longest time between two frames, while the slider goes through all of it."""
    binary = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome")
    if binary is None:
        return "no Chromium"
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - sizes are told without it

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=binary, args=SWITCHES)
        page = browser.new_page(viewport={"width": 1400, "height": 1000})
        page.add_init_script(WATCH)
        begin = time.perf_counter()
        page.goto(file.as_uri())
        loaded = time.perf_counter() - begin
        slider = page.locator("input[type=range]").first
        for step in range(20):
            slider.evaluate("(e, s) => { e.value = e.max * s; e.dispatchEvent(new Event('input')); }", step / 20)
            page.wait_for_timeout(30)
        longest = page.evaluate("longest")
        browser.close()
    return f"loaded in {loaded:.2f} s, longest stall {longest / 1e3:.2f} s"


def main() -> None:
    """Prints the table."""
    samples = int(sys.argv[1]) if len(sys.argv) > 1 else COUNT
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder_of_run(folder, samples)
        begin = time.process_time()
        write_report(folder)
        print(f"{samples} samples: report and replay made in {time.process_time() - begin:.1f} s of processor time")  # noqa: T201 - a benchmark prints
        for file in (folder / "report.html", folder / "replay.html"):
            print(f"{file.name}: {file.stat().st_size / 1e6:.2f} MB (20), {stalls(file)} (1 s)")  # noqa: T201 - a benchmark prints


if __name__ == "__main__":
    main()
