"""The text formats of the public data set Vive-Accuracy-Experiment: a comment line with the layout, then poses without time stamps.

Layouts: `x y z w j i k` (m, quaternion with w first; its other letters are wrong, the order is x y z) and `3x4` (the pose matrix, row by
row, m). Invariant: times are n / rate with the nominal rate of the header, because the files have none.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.errors import UsageError
from mitl.paths import FloatArray, PosePath
from mitl.recording.tum import checked_path

_HEADER = re.compile(rb"#\s*(x y z w j i k|3x4)\b.*\bFreq:\s*([0-9.]+)")
_COLUMNS = {b"x y z w j i k": 7, b"3x4": 12}


def is_vive_text(head: bytes) -> bool:
    """Gives whether a file that begins with `head` is in one of these formats."""
    return _HEADER.match(head.removeprefix(b"\xef\xbb\xbf")) is not None


def read_vive_text(path: Path) -> PosePath:
    """Reads a recording. Raises UsageError naming file and line where something is wrong."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror or error}") from error
    lines = content.removeprefix(b"\xef\xbb\xbf").splitlines()
    header = _HEADER.match(lines[0]) if lines else None
    if header is None:
        raise UsageError(f"{path}:1: expected a header `# x y z w j i k Freq: HZ` or `# 3x4 ... Freq: HZ`")
    width, rate = _COLUMNS[header[1]], _rate(path, header[2])
    rows: list[list[float]] = []
    numbers: list[int] = []
    for number, line in enumerate(lines[1:], start=2):
        words = line.partition(b"#")[0].split()
        if not words:
            continue
        try:
            row = [float(word) for word in words]
        except ValueError as error:
            raise UsageError(f"{path}:{number}: expected {width} numbers: {error}") from error
        if len(row) != width:
            raise UsageError(f"{path}:{number}: expected {width} numbers, got {len(row)}")
        rows.append(row)
        numbers.append(number)
    if not rows:
        raise UsageError(f"{path}: no pose in this file")
    table = np.array(rows)
    at = np.array(numbers)
    position, quaternion = _matrices(path, at, table) if width == 12 else (table[:, :3], table[:, 3:])
    return checked_path(path, at, np.arange(len(table)) / rate, position.copy(), quaternion.copy())


def _rate(path: Path, text: bytes) -> float:
    try:
        rate = float(text)
    except ValueError:
        rate = 0.0
    if not rate > 0.0:
        raise UsageError(f"{path}:1: expected a rate in Hz after `Freq:`, got {text.decode(errors='replace')!r}")
    return rate


def _matrices(path: Path, lines: np.ndarray[tuple[int], np.dtype[np.int64]], table: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gives position (N, 3) and quaternion (N, 4) of pose matrices (N, 12)."""
    X = table.reshape(-1, 3, 4)
    R = X[:, :, :3]
    finite = np.all(np.isfinite(table), axis=1)
    error = np.abs(np.where(finite[:, None, None], R @ np.swapaxes(R, 1, 2), 0.0) - np.eye(3)).max(axis=(1, 2))
    turns = (error < 1e-2) & (np.linalg.det(np.where(finite[:, None, None], R, np.eye(3))) > 0.0)
    if not np.all(turns):
        raise UsageError(f"{path}:{lines[np.argmin(turns)]}: expected a pose matrix, its 3x3 part is no rotation")
    return X[:, :, 3], Rotation.from_matrix(R).as_quat(scalar_first=True)
