"""A controller's log of its axes: MCAP with /robot/egm or /robot/joints, or CSV with a time and j1_deg to j6_deg (or j1 to j6 in rad).

Invariant: times strictly increase and every value is finite; a row that is not so is told with its number.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from mitl.errors import UsageError
from mitl.paths import FloatArray
from mitl.recording.mcap_reader import read_recording
from mitl.recording.records import EGM, JOINTS

_TIMES = ("t_s", "time_s", "time")
_FEWEST = 50


def read_joint_log(file: Path) -> tuple[FloatArray, FloatArray]:
    """Gives times (N,) s and joints (N, 6) rad. Raises UsageError naming what is missing or wrong."""
    time, joints = _from_mcap(file) if file.suffix.lower() == ".mcap" else _from_csv(file)
    if len(time) < _FEWEST:
        raise UsageError(f"{file}: {len(time)} samples of the axes are too few, expected {_FEWEST} or more")
    wrong = np.flatnonzero(~(np.isfinite(time) & np.isfinite(joints).all(axis=1)))
    if len(wrong):
        raise UsageError(f"{file}: sample {wrong[0] + 1}: expected finite numbers")
    late = np.flatnonzero(np.diff(time) <= 0)
    if len(late):
        raise UsageError(f"{file}: sample {late[0] + 2}: time must increase, got {time[late[0] + 1]:g} s after {time[late[0]]:g} s")
    return time, joints


def _from_mcap(file: Path) -> tuple[FloatArray, FloatArray]:
    series = read_recording(file).series
    found = next((series[topic] for topic in (EGM, JOINTS) if topic in series), None)
    if found is None:
        raise UsageError(f"{file}: neither {EGM} nor {JOINTS}: record with the controller's feedback on")
    try:
        return found.time, np.stack([found.column(f"j{axis}") for axis in range(1, 7)], axis=1)
    except KeyError as error:
        raise UsageError(f"{file}: six axes are wanted: {error.args[0]}") from error


def _from_csv(file: Path) -> tuple[FloatArray, FloatArray]:
    try:
        with file.open(encoding="utf-8-sig", newline="") as text:
            rows = [row for row in csv.reader(text) if row]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise UsageError(f"{file}: cannot be read: {error}") from error
    header = [name.strip() for name in rows[0]] if rows else []
    time = next((name for name in _TIMES if name in header), None)
    degrees = "j1_deg" in header
    names = [f"j{axis}_deg" if degrees else f"j{axis}" for axis in range(1, 7)]
    missing = [name for name in names if name not in header]
    if time is None or missing:
        raise UsageError(
            f"{file}:1: expected a header with {' or '.join(_TIMES)}, and j1_deg to j6_deg or j1 to j6, got {', '.join(header)[:80]!r}"
        )
    places = [header.index(name) for name in (time, *names)]
    values = np.empty((len(rows) - 1, 7))
    for number, row in enumerate(rows[1:], start=2):
        try:
            values[number - 2] = [float(row[place]) for place in places]
        except (ValueError, IndexError) as error:
            raise UsageError(f"{file}: row {number}: expected numbers in {time} and {', '.join(names)}") from error
    return values[:, 0], np.radians(values[:, 1:]) if degrees else values[:, 1:]
