"""Prints preset `lighthouse2` beside the public recordings it was fitted to, in the same statistics.

Run: python benchmarks/lighthouse2.py RECORDING... (the public ones are not in this repository). Medians over places; jitter is also told by
its mean, because a few places are four times as bad as the others.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from mitl.metrics.tracker_statistics import TrackerStatistics, tracker_statistics
from mitl.paths import PosePath
from mitl.recording.read import read_tracker_recordings
from mitl.simulation.tracker_model import TrackerModel
from mitl.simulation.tracker_parameters import load_preset

PLACES = 120
FACTS = {"200 ms": 1.02, "500 ms": 1.28, "means": 0.18, "turn": 0.025, "fast": 0.152, "tau": 10.2, "walk": 0.26}


def simulated(places: int = PLACES) -> list[TrackerStatistics]:
    """Gives the statistics of so many simulated places, four seconds each."""
    preset = load_preset("lighthouse2")
    random = np.random.default_rng(1)
    times, found = np.arange(1000) * np.float64(preset.period), []
    for seed in range(places):
        place = np.tile(random.uniform(-2.0, 2.0, 3), (1000, 1))
        path = TrackerModel(preset, seed).measure(times, place, np.tile([1.0, 0.0, 0.0, 0.0], (1000, 1)))
        found.append(tracker_statistics(PosePath(path.time, path.position, path.quaternion_wxyz, path.valid)))
    return found


def numbers(found: list[TrackerStatistics]) -> dict[str, tuple[float, float]]:
    """Gives median and mean over places of each figure; mm, deg, ms."""
    rows: dict[str, list[float]] = {key: [] for key in FACTS}
    for s in found:
        for window, key in ((0.2, "200 ms"), (0.5, "500 ms")):
            rows[key] += [1e3 * jitter.mean for jitter in s.jitter if jitter.window == window]
        if s.mean_sd is not None and s.mean_turn_sd is not None:
            rows["means"].append(1e3 * float(np.sqrt(np.mean(s.mean_sd**2))))
            rows["turn"].append(float(np.degrees(np.sqrt(np.mean(s.mean_turn_sd**2)))))
        if s.noise is not None:
            for key, value in (("fast", 1e3 * s.noise.fast_sd), ("tau", 1e3 * s.noise.fast_tau), ("walk", 1e3 * s.noise.walk)):
                rows[key].append(value)
    return {key: (float(np.median(values)), float(np.mean(values))) for key, values in rows.items()}


NAMES = {
    "200 ms": "jitter 200 ms, mm",
    "500 ms": "jitter 500 ms, mm",
    "means": "sd of 500 ms means, rms of axes, mm",
    "turn": "the same, deg",
    "fast": "fast noise, mm",
    "tau": "its correlation time, ms",
    "walk": "random walk, mm/sqrt(s)",
}

if __name__ == "__main__":
    recordings = [recording.path for name in sys.argv[1:] for recording in read_tracker_recordings(Path(name))]
    real, model = numbers([tracker_statistics(path) for path in recordings]), numbers(simulated())
    print(f"{'':<38}{'facts':>8}{'recordings':>22}{'preset':>22}")  # noqa: T201 - a benchmark prints
    print(f"{'':<38}{'':>8}{'median':>12}{'mean':>10}{'median':>12}{'mean':>10}")  # noqa: T201
    for key, name in NAMES.items():
        print(f"{name:<38}{FACTS[key]:>8.3g}{real[key][0]:>12.3f}{real[key][1]:>10.3f}{model[key][0]:>12.3f}{model[key][1]:>10.3f}")  # noqa: T201
