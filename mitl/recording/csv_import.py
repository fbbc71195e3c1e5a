"""Recordings of other trackers: any table of text with a header, read by a map of its columns. Vicon, OptiTrack, laser trackers, EGM logs.

A map is a text like `t=Time,x=TX,y=TY,z=TZ,qx=RX,qy=RY,qz=RZ,qw=RW,length=mm`, or the name of a known one. Invariant: what the map
does not say is not guessed, but for the delimiter and for lines before the header, which are skipped up to where all columns occur.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.errors import UsageError
from mitl.paths import FloatArray, PosePath
from mitl.recording.tum import checked_path

_LENGTH = {"m": 1.0, "mm": 1e-3}
_TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_ANGLE = {"deg": np.pi / 180.0, "rad": 1.0}
_QUATERNION, _EULER, _ROTVEC = ("qw", "qx", "qy", "qz"), ("ez", "ey", "ex"), ("rx", "ry", "rz")
_COLUMNS = ("t", "x", "y", "z", *_QUATERNION, *_EULER, *_ROTVEC, "valid")
_OPTIONS = ("length", "time", "angle", "rate")

# ASSUMPTION A-101: headers as the makers' exports and our own EGM log name them; whoever's differ gives the map in full.
KNOWN_MAPS = {
    "egm": "t=time_s,x=x_mm,y=y_mm,z=z_mm,qw=u0,qx=u1,qy=u2,qz=u3,length=mm",
    "vicon": "x=TX,y=TY,z=TZ,rx=RX,ry=RY,rz=RZ,t=Frame,rate=100,length=mm,angle=rad",
    "optitrack": "t=Time (Seconds),x=X,y=Y,z=Z,qx=QX,qy=QY,qz=QZ,qw=QW,length=m",
    "laser": "t=time_s,x=x_mm,y=y_mm,z=z_mm,length=mm",
}


@dataclass(frozen=True)
class ColumnMap:
    """Which column is what. columns: ours -> the file's. length, time, angle: factors to m, s and rad. rate: Hz, where t counts samples.

    qw qx qy qz: quaternion. ez ey ex: Euler angles about z, then y, then x of the turned body (ABB). rx ry rz: rotation vector. Without
    any the body does not turn. valid: 0 for samples not to be used. Without t, samples come at `rate`.
    """

    columns: dict[str, str]
    length: float = 1.0
    time: float = 1.0
    angle: float = np.pi / 180.0
    rate: float | None = None

    @classmethod
    def parse(cls, text: str) -> ColumnMap:
        """Gives the map that a text or a known name says. Raises UsageError naming what is wrong."""
        columns: dict[str, str] = {}
        options: dict[str, str] = {}
        for entry in KNOWN_MAPS.get(text, text).split(","):
            ours, equals, theirs = (part.strip() for part in entry.partition("="))
            if not equals or ours not in (*_COLUMNS, *_OPTIONS) or not theirs:
                known = f"known maps are {', '.join(KNOWN_MAPS)}"
                raise UsageError(
                    f"column map: expected NAME=COLUMN with NAME one of {' '.join((*_COLUMNS, *_OPTIONS))}, got {entry!r}; {known}"
                )
            (options if ours in _OPTIONS else columns)[ours] = theirs
        missing = [axis for axis in "xyz" if axis not in columns]
        if missing:
            raise UsageError(f"column map: {', '.join(missing)} missing: expected at least x, y and z")
        groups = [group for group in (_QUATERNION, _EULER, _ROTVEC) if any(name in columns for name in group)]
        if len(groups) > 1 or any(name not in columns for group in groups for name in group):
            raise UsageError("column map: expected all of qw qx qy qz, or all of ez ey ex, or all of rx ry rz, or no orientation")
        if "t" not in columns and "rate" not in options:
            raise UsageError("column map: expected t=COLUMN, or rate=HZ for a file without times")
        return cls(
            columns,
            length=_factor(options, "length", "m", _LENGTH),
            time=_factor(options, "time", "s", _TIME),
            angle=_factor(options, "angle", "deg", _ANGLE),
            rate=_rate(options.get("rate")),
        )


def import_csv(path: Path, columns: ColumnMap) -> PosePath:
    """Reads a table by its map; rows whose position is empty are invalid. Raises UsageError naming file, line and column."""
    header, rows, lines = _table(path, columns)
    index = {ours: header.index(theirs) for ours, theirs in columns.columns.items()}

    def column(name: str) -> FloatArray:
        return np.array([_number(path, line, columns.columns[name], row[index[name]]) for line, row in zip(lines, rows, strict=True)])

    count = len(rows)
    position = np.stack([column(axis) for axis in "xyz"], axis=1) * columns.length
    seen = np.all(np.isfinite(position), axis=1)
    valid = seen & (column("valid") > 0.0 if "valid" in index else np.ones(count, dtype=np.bool_))
    counted = column("t") if "t" in index else np.arange(count, dtype=np.float64)
    time = counted * columns.time if columns.rate is None else counted / columns.rate
    group = next((group for group in (_QUATERNION, _EULER, _ROTVEC) if group[0] in index), ())
    angles = np.stack([column(name) for name in group], axis=1) if group else np.zeros((count, 0))
    quaternion = _orientation(group, angles, columns.angle)
    whole = valid & np.all(np.isfinite(quaternion), axis=1)
    position = np.where(whole[:, None], position, 0.0)
    quaternion = np.where(whole[:, None], quaternion, [1.0, 0.0, 0.0, 0.0])
    found = checked_path(path, np.array(lines), time, position, quaternion)
    return PosePath(found.time, found.position, found.quaternion_wxyz, whole)


def _orientation(group: tuple[str, ...], values: FloatArray, angle: float) -> FloatArray:
    """Gives quaternions (N, 4) of the columns (N, k) of a group, not a number where a value is not."""
    if group == _QUATERNION:
        return values
    if not group:
        return np.tile([1.0, 0.0, 0.0, 0.0], (len(values), 1))
    known = np.where(np.isfinite(values), values, 0.0) * angle
    R = Rotation.from_euler("ZYX", known) if group == _EULER else Rotation.from_rotvec(known)
    whole = np.all(np.isfinite(values), axis=1)[:, None]
    return np.where(whole, R.as_quat(scalar_first=True), np.nan)


def _table(path: Path, columns: ColumnMap) -> tuple[list[str], list[list[str]], list[int]]:
    """Gives header, rows and their line numbers."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise UsageError(f"{path}: not a text file: {error}") from error
    wanted = list(columns.columns.values())
    content = text.splitlines()
    for number, line in enumerate(content):
        for delimiter in (",", ";", "\t"):
            header = [name.strip() for name in next(csv.reader([line], delimiter=delimiter), [])]
            if all(name in header for name in wanted):
                rows, lines = [], []
                for at, following in enumerate(content[number + 1 :], start=number + 2):
                    row = next(csv.reader([following], delimiter=delimiter), [])
                    if not any(cell.strip() for cell in row):
                        continue
                    if len(row) < len(header):
                        raise UsageError(f"{path}:{at}: expected {len(header)} columns, got {len(row)}")
                    rows.append(row)
                    lines.append(at)
                if not rows:
                    raise UsageError(f"{path}: no sample after the header in line {number + 1}")
                return header, rows, lines
    raise UsageError(f"{path}: no line has all of the columns {', '.join(wanted)}")


def _number(path: Path, line: int, name: str, text: str) -> float:
    if not text.strip():
        return float("nan")
    try:
        return float(text)
    except ValueError as error:
        raise UsageError(f"{path}:{line}: column {name}: expected a number, got {text!r}") from error


def _factor(options: dict[str, str], name: str, default: str, known: dict[str, float]) -> float:
    unit = options.get(name, default)
    if unit not in known:
        raise UsageError(f"column map: {name}: expected {' or '.join(known)}, got {unit!r}")
    return known[unit]


def _rate(text: str | None) -> float | None:
    if text is None:
        return None
    try:
        rate = float(text)
    except ValueError:
        rate = 0.0
    if not (np.isfinite(rate) and rate > 0.0):
        raise UsageError(f"column map: rate: expected a number of Hz, got {text!r}")
    return rate
