"""Prints how well a preset fitted to one half of still recordings predicts the jitter of the other half.

Run: python benchmarks/fit_tracker.py RECORDING... (the public ones are not in this repository). Places differ, so halves of the places
are split in all ways; halves of the time of every recording show what is left when places do not matter.
"""

from __future__ import annotations

import sys
from itertools import combinations
from pathlib import Path

import numpy as np

from mitl.metrics.tracker_fit import fit_tracker, place_jitter
from mitl.paths import PosePath
from mitl.recording.read import read_tracker_recordings
from mitl.trackers.fit import fitted_preset, predicted_jitter

_MOST_SPLITS = 60


def half(path: PosePath, second: bool) -> PosePath:
    """Gives one half of a recording in time."""
    chosen = (np.arange(len(path)) >= len(path) // 2) == second
    return path.select(chosen)


def error(fitted: list[PosePath], others: list[PosePath], window: float) -> float:
    """Gives how far the predicted typical jitter (geometric mean over places) is from that of the others, as a share."""
    predicted = predicted_jitter(fitted_preset(fit_tracker(fitted), "fitted"), window)
    seen = np.array([place_jitter(path, window) for path in others])
    # the simulated places have the fitted gains' spread: their geometric mean is that of the fit, within 1 / sqrt(places) of the spread
    return float(np.exp(np.mean(np.log(predicted)) - np.mean(np.log(seen)))) - 1.0


def table(files: list[Path]) -> list[str]:
    """Gives the benchmark's lines."""
    paths = [recording.path for file in files for recording in read_tracker_recordings(file)]
    lines = [f"{len(paths)} recordings; error of the predicted typical jitter"]
    for window in (0.2, 0.5):
        first = error([half(path, False) for path in paths], [half(path, True) for path in paths], window)
        lines.append(f"{window * 1e3:.0f} ms, first half of every recording predicts the second: {first:+.1%}")
        splits = list(combinations(range(len(paths)), len(paths) // 2))
        chosen = np.random.default_rng(1).permutation(len(splits))[:_MOST_SPLITS]
        errors = []
        for number in chosen:
            ours = splits[number]
            errors.append(error([paths[i] for i in ours], [paths[i] for i in range(len(paths)) if i not in ours], window))
        size = np.abs(errors)
        lines.append(
            f"{window * 1e3:.0f} ms, half of the places predicts the others ({len(chosen)} splits): median size {np.median(size):.1%},"
            f" within 20 % in {np.mean(size <= 0.2):.0%}"
        )
        odd = error(paths[::2], paths[1::2], window)
        lines.append(f"{window * 1e3:.0f} ms, every other place predicts the rest: {odd:+.1%}")
    return lines


if __name__ == "__main__":
    print("\n".join(table([Path(name) for name in sys.argv[1:]])))  # noqa: T201 - a benchmark prints
