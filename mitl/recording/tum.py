"""TUM trajectory text: `t x y z qx qy qz qw` a line, s and m, `#` comments."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mitl.errors import UsageError
from mitl.paths import FloatArray, PosePath
from mitl.recording.atomic import replacing

_COLUMNS = "t x y z qx qy qz qw"


def write_tum(path: Path, poses: PosePath) -> None:
    """Writes the valid poses; the format knows no validity. Raises UsageError where the file cannot be written."""
    valid = poses.only_valid()
    q = valid.quaternion_wxyz
    rows = np.concatenate([valid.time[:, None], valid.position, q[:, 1:], q[:, :1]], axis=1)
    with replacing(path) as beside, beside.open("w", encoding="ascii") as file:
        file.write(f"# {_COLUMNS}\n")
        np.savetxt(file, rows, fmt="%.9f %.12g %.12g %.12g %.15g %.15g %.15g %.15g")


def read_tum(path: Path) -> PosePath:
    """Reads a path; quaternions are normalised. Raises UsageError naming file and line where something is wrong."""
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise UsageError(f"{path}: not a TUM text file: {error}") from error
    rows: list[list[float]] = []
    lines: list[int] = []
    for number, line in enumerate(text.splitlines(), start=1):
        content = line.partition("#")[0].replace(",", " ").split()
        if not content:
            continue
        if len(content) != 8:
            raise UsageError(f"{path}:{number}: expected 8 numbers `{_COLUMNS}`, got {len(content)}")
        try:
            rows.append([float(word) for word in content])
        except ValueError as error:
            raise UsageError(f"{path}:{number}: expected 8 numbers `{_COLUMNS}`: {error}") from error
        lines.append(number)
    if not rows:
        raise UsageError(f"{path}: no pose in this file: expected lines `{_COLUMNS}`")
    table = np.array(rows)
    quaternion = np.concatenate([table[:, 7:8], table[:, 4:7]], axis=1)
    return checked_path(path, np.array(lines), table[:, 0], table[:, 1:4], quaternion)


def checked_path(
    path: Path, lines: np.ndarray[tuple[int], np.dtype[np.int64]], time: FloatArray, position: FloatArray, q: FloatArray
) -> PosePath:
    """Gives a path from columns of a text file. Raises UsageError naming the line where a value cannot be used.

    lines: (N,) line numbers. time: (N,). position: (N, 3) m. q: (N, 4) wxyz, not yet normalised.
    """
    finite = np.isfinite(time) & np.all(np.isfinite(position), axis=1) & np.all(np.isfinite(q), axis=1)
    if not np.all(finite):
        raise UsageError(f"{path}:{lines[np.argmin(finite)]}: expected finite numbers")
    norm = np.linalg.norm(q, axis=1)
    unit = np.abs(norm - 1.0) < 1e-2
    if not np.all(unit):
        at = int(np.argmin(unit))
        raise UsageError(f"{path}:{lines[at]}: expected a unit quaternion, its length is {norm[at]:.4g}")
    late = np.diff(time) <= 0
    if np.any(late):
        at = int(np.argmax(late)) + 1
        raise UsageError(f"{path}:{lines[at]}: time must increase, but {time[at]:.9g} s follows {time[at - 1]:.9g} s")
    return PosePath(time, position, q / norm[:, None], np.ones(len(time), dtype=np.bool_))
