"""The CSV of `mitl oracle` (docs: the command's --help): one row a sample, public units (mm, deg), one column a signal at the end."""

from __future__ import annotations

import csv
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from mitl.errors import UsageError
from mitl.paths import FloatArray, PosePath
from mitl.recording.atomic import replacing
from mitl.recording.tum import checked_path

_POSE = ("t_s", "x_mm", "y_mm", "z_mm", "qw", "qx", "qy", "qz")
_TAIL = ("move", "module", "line")


@dataclass(frozen=True, eq=False)
class OracleTable:
    """An oracle as it stands in its CSV file, in SI.

    path: N poses of the tool. speed: (N,) m/s. joints: (N, k) rad. move: (N,) index of the executed motion instruction. module: N
    names. line: (N,) source lines. signals: name -> (N,) value of the output at each sample.
    """

    path: PosePath
    speed: FloatArray
    joints: FloatArray
    move: np.ndarray[tuple[int], np.dtype[np.int64]]
    module: tuple[str, ...]
    line: np.ndarray[tuple[int], np.dtype[np.int64]]
    signals: dict[str, FloatArray] = field(default_factory=dict)


def columns_of(joints: int, signals: list[str]) -> list[str]:
    """Gives the header for so many joints and these signals."""
    return [*_POSE, "speed_mm_s", *(f"j{i}_deg" for i in range(1, joints + 1)), *_TAIL, *signals]


def write_csv(path: Path, table: OracleTable) -> None:
    """Writes an oracle. Raises UsageError where the file cannot be written."""
    header = columns_of(table.joints.shape[1], list(table.signals))
    numbers = np.concatenate(
        [table.path.position * 1e3, table.path.quaternion_wxyz, table.speed[:, None] * 1e3, np.rad2deg(table.joints)], axis=1
    )
    signals = np.stack(list(table.signals.values()), axis=1) if table.signals else np.zeros((len(table.path), 0))
    with replacing(path) as beside, beside.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        for time, row, move, module, line, outputs in zip(
            table.path.time.tolist(),
            numbers.tolist(),
            table.move.tolist(),
            table.module,
            table.line.tolist(),
            signals.tolist(),
            strict=True,
        ):
            writer.writerow([f"{time:.9f}", *(f"{v:.9f}" for v in row), move, module, line, *(f"{v:.9g}" for v in outputs)])


def read_csv(path: Path) -> OracleTable:
    """Reads an oracle. Raises UsageError naming file, line and column where something is missing or wrong."""
    header, rows, lines = _rows(path)
    index = {name: i for i, name in enumerate(header)}
    joints = [name for name in header if name.startswith("j") and name.endswith("_deg")]
    known = {*_POSE, "speed_mm_s", *joints, *_TAIL}
    signals = [name for name in header if name not in known]

    def column(name: str, default: float | None = None) -> FloatArray:
        if name not in index:
            if default is None:
                raise UsageError(f"{path}:1: the column {name} is missing: expected {', '.join(columns_of(6, []))}")
            return np.full(len(rows), default)
        at = index[name]
        try:
            return np.array([float(row[at]) for row in rows])
        except ValueError:
            for number, row in zip(lines, rows, strict=True):
                _number(path, number, name, row[at])
            raise

    def whole(name: str) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
        values = column(name, 0.0)
        wrong = np.flatnonzero(values != np.rint(np.where(np.isfinite(values), values, 0.0)))
        if len(wrong):
            raise UsageError(f"{path}:{lines[wrong[0]]}: column {name}: expected a whole number, got {rows[wrong[0]][index[name]]!r}")
        return values.astype(np.int64)

    pose = {name: column(name) for name in _POSE}
    position = np.stack([pose[name] for name in _POSE[1:4]], axis=1) / 1e3
    quaternion = np.stack([pose[name] for name in _POSE[4:]], axis=1)
    module_at = index.get("module")
    return OracleTable(
        path=checked_path(path, np.array(lines, dtype=np.int64), pose["t_s"], position, quaternion),
        speed=column("speed_mm_s", 0.0) / 1e3,
        joints=np.deg2rad(np.stack([column(name) for name in joints], axis=1)) if joints else np.zeros((len(rows), 0)),
        move=whole("move"),
        module=tuple(row[module_at] for row in rows) if module_at is not None else ("",) * len(rows),
        line=whole("line"),
        signals={name: column(name) for name in signals},
    )


def _rows(path: Path) -> tuple[list[str], list[list[str]], list[int]]:
    """Gives the header, the rows, and the line number of each row."""
    rows: list[list[str]] = []
    lines: list[int] = []
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(file, strict=True)
            header = [name.strip() for name in next(reader, [])]
            if header[:1] != ["t_s"]:
                raise UsageError(f"{path}:1: expected a header that begins with t_s, got {','.join(header)[:60]!r}")
            for row in reader:
                if not row:
                    continue
                if len(row) != len(header):
                    raise UsageError(f"{path}:{reader.line_num}: expected {len(header)} columns, got {len(row)}")
                rows.append(row)
                lines.append(reader.line_num)
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise UsageError(f"{path}: not a CSV file: {error}") from error
    if not rows:
        raise UsageError(f"{path}: no sample in this file")
    return header, rows, lines


def _number(path: Path, line: int, name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError as error:
        raise UsageError(f"{path}:{line}: column {name}: expected a number, got {text!r}") from error
