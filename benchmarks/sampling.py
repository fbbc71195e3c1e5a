"""Prints how evenly the OpenVR tracker samples at 250 Hz on a stand-in for SteamVR: lost samples, intervals, share of a core.

Run: python benchmarks/sampling.py [--seconds 600]. Needs g++ and the package openvr. Three conditions, one after the other: nothing else
to do; as many busy processes as there are cores; and besides these a busy thread of Python in the tracker's own process, as a planner is.
The bar (issue 7): no sample lost; the 99th percentile of the interval's deviation from 4 ms at most .2 ms idle and .5 ms under load; at
most a tenth of a core. Once a second the path so far is asked for, as a case does that looks at it while it is tracked.

Beside it runs a control: a loop in C, real-time as the sampling is, that does nothing but wait for the same 250 deadlines a second.
Where it comes a period late, the machine itself stood still (a virtual one's host, above all), and no program of this kind can do better.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import shutil
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
CONDITIONS = (("idle", False, False), ("loaded", True, False), ("loaded, busy thread", True, True))
"""Name, whether as many processes as cores are busy beside it, and whether a thread of its own process is."""
CONTROL = """
#include <cstdio>
#include <csignal>
#include <sched.h>
#include <ctime>
static volatile sig_atomic_t ended = 0;
int main() {
  sched_param priority{11};
  bool realtime = sched_setscheduler(0, SCHED_RR, &priority) == 0;
  signal(SIGTERM, [](int) { ended = 1; });
  timespec next; clock_gettime(CLOCK_MONOTONIC, &next);
  long lost = 0, count = 0; double worst = 0;
  while (!ended) {
    next.tv_nsec += 4000000; if (next.tv_nsec >= 1000000000) { next.tv_nsec -= 1000000000; ++next.tv_sec; }
    if (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, nullptr)) continue;
    timespec now; clock_gettime(CLOCK_MONOTONIC, &now);
    double late = 1e3 * (now.tv_sec - next.tv_sec) + 1e-6 * (now.tv_nsec - next.tv_nsec);
    ++count; if (late > worst) worst = late; if (late >= 4.0) ++lost;
  }
  printf("control in C: realtime %s, %ld deadlines, %ld missed by a period, worst %.3f ms\\n", realtime ? "yes" : "no", count, lost, worst);
}
"""


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
    while time.monotonic() - began < seconds:
        time.sleep(1.0)
        tracker.path()
    ended.set()
    cpu, wall = time.process_time() - busy, time.monotonic() - began
    own, lost = tracker.cpu_time(), tracker.statistics().lost - before.lost
    taken = tracker.stop()
    gaps = np.diff(taken.time) * RATE
    tracker.close()
    fed.close()
    off = np.abs(np.diff(taken.time) - 1.0 / RATE)
    return {
        "realtime": tracker.realtime,
        "seconds": round(wall, 1),
        "samples": len(taken),
        "expected": round(wall * RATE),
        "lost": lost,
        "gaps_of_two_periods": int(np.count_nonzero(gaps > 1.5)),
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


def _control() -> Path | None:
    """Builds the control, where there is a compiler."""
    compiler = shutil.which("g++")
    if compiler is None:
        return None
    program = Path(tempfile.mkdtemp(prefix="mitl-control-")) / "control"
    command = [compiler, "-O2", "-x", "c++", "-", "-o", str(program)]
    subprocess.run(command, input=CONTROL, text=True, check=True)  # noqa: S603 - our own text
    return program


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def main() -> None:
    """Measures all three conditions."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=600.0, help="of each condition; idle takes a quarter")
    parser.add_argument("--only", choices=[name for name, *_ in CONDITIONS], help="one condition, for all of --seconds")
    parser.add_argument("--child", help=argparse.SUPPRESS)
    parser.add_argument("--thread", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.child:
        _say(json.dumps(sample(Path(arguments.child), arguments.seconds, thread=arguments.thread)))
        return
    from tests.trackers import steamvr  # noqa: PLC0415 - found by the path above, and not needed by the child

    cores, control = os.cpu_count() or 1, _control()
    _say(f"{cores} cores, load before: {os.getloadavg()[0]:.2f}")
    for name, loaded, thread in CONDITIONS:
        if arguments.only not in (None, name):
            continue
        beside = [multiprocessing.Process(target=_burn, daemon=True) for _ in range(cores if loaded else 0)]
        for process in beside:
            process.start()
        machine = None if control is None else subprocess.Popen([str(control)], stdout=subprocess.PIPE, text=True)  # noqa: S603 - as below
        try:
            with tempfile.TemporaryDirectory() as folder:
                feed = Path(folder) / "feed"
                seconds = arguments.seconds if loaded or arguments.only else arguments.seconds / 4
                command = [sys.executable, __file__, "--child", str(feed), "--seconds", str(seconds), *(["--thread"] if thread else [])]
                done = subprocess.run(  # noqa: S603 - this very file
                    command, env={**os.environ, **steamvr.environment(feed)}, stdout=subprocess.PIPE, text=True, check=True
                )
            _say(f"{name}: {done.stdout.strip()}")
        finally:
            if machine is not None:
                machine.terminate()
                _say(f"  {machine.communicate()[0].strip()}")
            for process in beside:
                process.kill()


if __name__ == "__main__":
    main()
