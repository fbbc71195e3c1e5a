"""A recording's paths and series to other formats: our CSV, TUM text, the thesis's XML. Told by the file's ending."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from mitl.errors import UsageError
from mitl.paths import FloatArray, PosePath
from mitl.recording.atomic import replacing
from mitl.recording.csv_file import OracleTable, write_csv
from mitl.recording.read import samples_of
from mitl.recording.records import MOVES, SIGNALS, Recording, Series
from mitl.recording.thesis_xml import write_thesis_xml
from mitl.recording.tum import write_tum

ENDINGS = (".csv", ".tum", ".txt", ".xml")


def export_path(recording: Recording, topic: str, output: Path) -> int:
    """Writes the valid samples on a topic with what belongs to them and gives how many: moves, outputs, speed to CSV; buttons to XML.

    None of the formats knows validity. Raises UsageError for another ending or a file that cannot be written.
    """
    path = recording.paths[topic].path
    match output.suffix.lower():
        case ".csv":
            write_csv(output, _table(recording, topic, path.only_valid()))
        case ".tum" | ".txt":
            write_tum(output, path)
        case ".xml":
            write_thesis_xml(output, samples_of(recording, topic))
        case ending:
            raise UsageError(f"{output}: expected an ending of {', '.join(ENDINGS)}, not {ending or 'none'}")
    return int(path.valid.sum())


def export_series(series: Series, output: Path) -> int:
    """Writes a series as CSV: t_s, then its columns. Gives its rows. Raises UsageError where the ending is not .csv."""
    if output.suffix.lower() != ".csv":
        raise UsageError(f"{output}: numbers over time are written as .csv only")
    with replacing(output) as beside, beside.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["t_s", *series.columns])
        for time, row in zip(series.time.tolist(), series.values.tolist(), strict=True):
            writer.writerow([f"{time:.9f}", *(f"{value:.9g}" for value in row)])
    return len(series.time)


def _table(recording: Recording, topic: str, path: PosePath) -> OracleTable:
    prefix = topic.rpartition("/tool/")[0] if "/tool/" in topic else topic.rpartition("/tracker/")[0]
    moves, signals = recording.series.get(prefix + MOVES), recording.series.get(prefix + SIGNALS)
    move, line = (_held(moves, name, path.time).astype(np.int64) for name in ("move", "line"))
    outputs = {} if signals is None else {name: _held(signals, name, path.time) for name in signals.columns}
    return OracleTable(path, _speed(path), np.zeros((len(path), 0)), move, ("",) * len(path), line, outputs)


def _held(series: Series | None, name: str, time: FloatArray) -> FloatArray:
    """Gives the value (N,) of a column at times (N,): the last one told, before the first that one; 0 where there is none."""
    if series is None or name not in series.columns or not len(series.time):
        return np.zeros(len(time))
    return series.column(name)[np.maximum(np.searchsorted(series.time, time, side="right") - 1, 0)]


def _speed(path: PosePath) -> FloatArray:
    """Gives the speed (N,) in m/s by central differences, as noisy as the positions are."""
    if len(path) < 2:
        return np.zeros(len(path))
    return np.asarray(np.linalg.norm(np.gradient(path.position, path.time, axis=0), axis=1))
