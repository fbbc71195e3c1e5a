"""Prints how evenly the OpenVR tracker samples at 250 Hz on a stand-in for SteamVR: lost samples, intervals, share of a core.

Run: python benchmarks/sampling.py [--seconds 600]. Needs g++ and the package openvr. Three conditions, one after the other: nothing else
to do; as many busy processes as there are cores; and besides these a busy thread of Python in the tracker's own process, as a planner is.
The bar (issue 7): no sample lost; the 99th percentile of the interval's deviation from 4 ms at most .2 ms idle and .5 ms under load; at
most a tenth of a core. A computer that others use meanwhile spoils all of it: `load before` tells.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np

from mitl.paths import PosePath
from mitl.rig.monotonic_clock import MonotonicClock
from mitl.samples import TrackerSamples
from mitl.trackers.openvr_runtime import OpenVrRuntime
from mitl.trackers.openvr_tracker import OpenVrTracker
from mitl.trackers.pose_feed import FedDevice, PoseFeed

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
RATE = 250.0


def sample(feed: Path, seconds: float, *, thread: bool) -> dict[str, float]:
    """Gives what the sampling was like in this process; thread: whether Python computes beside it."""
    fed = PoseFeed(feed, (FedDevice("LHR-1"),), latency=0.0)
    times = np.arange(10) * 0.004
    path = PosePath(times, np.tile([1.0, 2.0, 3.0], (10, 1)), np.tile([1.0, 0.0, 0.0, 0.0], (10, 1)), np.full(10, True))
    fed.write(0, times + time.monotonic(), TrackerSamples.plain(path))
    tracker = OpenVrTracker(OpenVrRuntime, MonotonicClock(), rate=RATE)
    time.sleep(1.0)
    tracker.start()
    before, began, busy = tracker.statistics(), time.monotonic(), time.process_time()
    ended = threading.Event()
    worker = threading.Thread(target=_compute, args=(ended,), daemon=True)
    if thread:
        worker.start()
    time.sleep(seconds)
    ended.set()
    cpu, wall = time.process_time() - busy, time.monotonic() - began
    own = tracker.cpu_time()
    taken = tracker.stop()
    lost = tracker.statistics().lost - before.lost
    tracker.close()
    fed.close()
    off = np.abs(np.diff(taken.time) - 1.0 / RATE)
    return {
        "realtime": tracker.realtime,
        "seconds": round(wall, 1),
        "samples": len(taken),
        "expected": round(wall * RATE),
        "lost": lost,
        "p99_ms": round(1e3 * float(np.quantile(off, 0.99)), 3),
        "p999_ms": round(1e3 * float(np.quantile(off, 0.999)), 3),
        "worst_ms": round(1e3 * float(off.max()), 3),
        "process_share_of_core": round(cpu / wall, 3),
        "sampling_share_of_core": round(own / (wall + 1.0), 3),
    }


def _compute(ended: threading.Event) -> None:
    total = 0
    while not ended.is_set():
        total += sum(range(1000))


def _burn() -> None:
    while True:
        pass


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def main() -> None:
    """Measures all three conditions."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=600.0, help="of each condition; idle takes a quarter")
    parser.add_argument("--child", help=argparse.SUPPRESS)
    parser.add_argument("--thread", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.child:
        _say(json.dumps(sample(Path(arguments.child), arguments.seconds, thread=arguments.thread)))
        return
    from tests.trackers import steamvr  # noqa: PLC0415 - found by the path above, and not needed by the child

    cores = os.cpu_count() or 1
    _say(f"{cores} cores, load before: {os.getloadavg()[0]:.2f}")
    for name, burning, thread in (("idle", 0, False), ("loaded", cores, False), ("loaded, busy thread", cores, True)):
        beside = [multiprocessing.Process(target=_burn, daemon=True) for _ in range(burning)]
        for process in beside:
            process.start()
        try:
            with tempfile.TemporaryDirectory() as folder:
                feed = Path(folder) / "feed"
                seconds = arguments.seconds if burning else arguments.seconds / 4
                command = [sys.executable, __file__, "--child", str(feed), "--seconds", str(seconds), *(["--thread"] if thread else [])]
                done = subprocess.run(  # noqa: S603 - this very file
                    command, env={**os.environ, **steamvr.environment(feed)}, stdout=subprocess.PIPE, text=True, check=True
                )
            _say(f"{name}: {done.stdout.strip()}")
        finally:
            for process in beside:
                process.kill()


if __name__ == "__main__":
    main()
