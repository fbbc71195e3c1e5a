"""Calibration to TOML and back. Invariant: what was saved loads to the same numbers, bit for bit; a broken file is refused whole."""

from __future__ import annotations

import json
import os
import tomllib
from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np

from mitl.calibration.distortion import Distortion
from mitl.calibration.result import Calibration, Rejection, Residuals
from mitl.errors import UsageError
from mitl.paths import FloatArray
from mitl.protocols import AveragedPoint

_SCHEMA = 1
STORED = "stored"
"""Key of the provenance that tells when the calibration was stored, UTC."""
_RESIDUALS = ("position_rms", "position_max", "rotation_rms", "rotation_max", "count")


def save_calibration(
    path: Path, calibration: Calibration, provenance: Mapping[str, str] | None = None, reference: AveragedPoint | None = None
) -> None:
    """Writes a calibration, all in m and rad; `provenance` is added to the calibration's own. Never leaves half a file.

    reference: what a device that stands still showed then, by which the frame is verified later. The time of writing is kept as `stored`.
    """
    c = calibration
    lines = [
        "# Tracker calibration, written by mitl. Poses are x y z qw qx qy qz in m; angles in rad.",
        "# Measured X_LM = A(X_LB X_BF X_FM): L tracker base, M tracker body, B robot base, F flange.",
        f"schema = {_SCHEMA}",
        f"X_LB = {_row(c.X_LB)}",
        f"X_FM = {_row(c.X_FM)}",
        f'distortion = "{c.distortion.value}"',
        f"scale = {_row(c.scale)}",
        f"skew = {_row(c.skew)}",
        f"position_sigma = {c.position_sigma!r}",
        f"rotation_sigma = {c.rotation_sigma!r}",
        f"position_noise = {c.position_noise!r}",
        f"rotation_noise = {c.rotation_noise!r}",
        f"flange_sigma = {c.flange_sigma!r}",
        f"flange_turn_sigma = {c.flange_turn_sigma!r}",
        f"pose_count = {c.pose_count}",
        *(["positions_only = true"] if c.positions_only else []),
        "covariance = [",
        *(f"  {_row(row)}," for row in c.covariance),
        "]",
    ]
    for name, residuals in (("training", c.training), ("held_out", c.held_out)):
        lines += ["", f"[{name}]", *(f"{key} = {getattr(residuals, key)!r}" for key in _RESIDUALS)]
    if reference is not None:
        pose = np.concatenate([reference.position, reference.quaternion_wxyz])
        lines += ["", "[reference]", f"X_LR = {_row(pose)}", f"jitter = {reference.jitter!r}", f"count = {reference.count}"]
    lines += ["", "[provenance]"]
    stored = {STORED: datetime.now(UTC).isoformat(timespec="seconds")}
    lines += [f"{_text(key)} = {_text(value)}" for key, value in {**stored, **c.provenance, **(provenance or {})}.items()]
    for rejection in c.rejected:
        lines += ["", "[[rejected]]", f"index = {rejection.index}", f"reason = {_text(rejection.reason)}"]
    beside = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        beside.write_text("\n".join(lines) + "\n", encoding="utf-8")
        beside.replace(path)
    except OSError as error:
        beside.unlink(missing_ok=True)
        raise UsageError(f"{path}: cannot be written: {error.strerror or error}") from error


def load_calibration(path: Path) -> Calibration:
    """Reads a calibration. Raises UsageError naming the file and the key where something is missing or wrong."""
    return load_calibration_and_reference(path)[0]


def age(calibration: Calibration, now: datetime) -> timedelta | None:
    """Gives how old a stored calibration is at `now`; None where it does not tell when it was stored."""
    try:
        stored = datetime.fromisoformat(calibration.provenance.get(STORED, ""))
        return now - stored
    except (ValueError, TypeError):  # not a time, or one without a time zone
        return None


def load_calibration_and_reference(path: Path) -> tuple[Calibration, AveragedPoint | None]:
    """Reads a calibration and what the reference device showed, if there was one. Raises UsageError as `load_calibration` does."""
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"{path}: not a TOML file: {error}") from error
    reader = _Reader(path, table)
    if reader.integer("schema") != _SCHEMA:
        raise UsageError(f"{path}: key `schema`: expected {_SCHEMA}, got {table['schema']}; calibrate again with this version of mitl")
    name = reader.text("distortion")
    if name not in [d.value for d in Distortion]:
        raise UsageError(f"{path}: key `distortion`: expected one of {', '.join(d.value for d in Distortion)}, got {name!r}")
    distortion = Distortion(name)
    size = 12 + distortion.unknowns
    calibration = Calibration(
        X_LB=reader.pose("X_LB"),
        X_FM=reader.pose("X_FM"),
        distortion=distortion,
        scale=reader.array("scale", (3,)),
        skew=reader.array("skew", (3,)),
        covariance=reader.array("covariance", (size, size)),
        training=reader.residuals("training"),
        held_out=reader.residuals("held_out"),
        position_sigma=reader.number("position_sigma"),
        rotation_sigma=reader.number("rotation_sigma"),
        position_noise=reader.number("position_noise"),
        rotation_noise=reader.number("rotation_noise"),
        flange_sigma=reader.number("flange_sigma"),
        flange_turn_sigma=reader.number("flange_turn_sigma"),
        pose_count=reader.integer("pose_count"),
        rejected=tuple(reader.rejections()),
        positions_only=reader.flag("positions_only"),
        provenance={key: str(value) for key, value in reader.table("provenance").items()},
    )
    return calibration, reader.reference() if "reference" in table else None


def _row(values: FloatArray) -> str:
    return "[" + ", ".join(repr(float(value)) for value in values) + "]"


def _text(value: str) -> str:
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")  # JSON strings are TOML basic strings, but for DEL


class _Reader:
    """Takes values out of a table, naming file and key where one is missing or wrong."""

    def __init__(self, file: Path, table: Mapping[str, Any], prefix: str = "") -> None:
        self._file, self._table, self._prefix = file, table, prefix

    def _get(self, key: str, expected: str) -> Any:  # noqa: ANN401 - TOML values are checked by the callers
        if key not in self._table:
            raise UsageError(f"{self._file}: key `{self._prefix}{key}` is missing: expected {expected}")
        return self._table[key]

    def _wrong(self, key: str, expected: str) -> UsageError:
        return UsageError(f"{self._file}: key `{self._prefix}{key}`: expected {expected}, got {self._table[key]!r:.80}")

    def number(self, key: str) -> float:
        value = self._get(key, "a number")
        if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
            raise self._wrong(key, "a number")
        return float(value)

    def integer(self, key: str) -> int:
        value = self._get(key, "a whole number")
        if isinstance(value, bool) or not isinstance(value, int):
            raise self._wrong(key, "a whole number")
        return value

    def flag(self, key: str) -> bool:
        """Gives a key that is false where it is missing."""
        value = self._table.get(key, False)
        if not isinstance(value, bool):
            raise self._wrong(key, "true or false")
        return value

    def text(self, key: str) -> str:
        value = self._get(key, "a text")
        if not isinstance(value, str):
            raise self._wrong(key, "a text")
        return value

    def array(self, key: str, shape: tuple[int, ...]) -> FloatArray:
        expected = " x ".join(str(n) for n in shape) + " numbers"
        value = self._get(key, expected)
        try:
            array = np.array(value, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise self._wrong(key, expected) from error
        if array.shape != shape or not np.all(np.isfinite(array)):
            raise self._wrong(key, expected)
        return array

    def pose(self, key: str) -> FloatArray:
        pose = self.array(key, (7,))
        if abs(float(np.linalg.norm(pose[3:])) - 1.0) > 1e-6:
            raise self._wrong(key, "x y z and a unit quaternion qw qx qy qz")
        return pose

    def table(self, key: str) -> Mapping[str, Any]:
        value = self._get(key, "a table")
        if not isinstance(value, dict):
            raise self._wrong(key, "a table")
        return value

    def residuals(self, key: str) -> Residuals:
        inner = _Reader(self._file, self.table(key), f"{key}.")
        position_rms, position_max, rotation_rms, rotation_max = (inner.number(name) for name in _RESIDUALS[:4])
        return Residuals(position_rms, position_max, rotation_rms, rotation_max, inner.integer("count"))

    def reference(self) -> AveragedPoint:
        inner = _Reader(self._file, self.table("reference"), "reference.")
        pose = inner.pose("X_LR")
        return AveragedPoint(0.0, pose[:3], pose[3:], inner.number("jitter"), inner.integer("count"))

    def rejections(self) -> list[Rejection]:
        entries = self._table.get("rejected", [])
        if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
            raise self._wrong("rejected", "a list of tables")
        readers = [_Reader(self._file, entry, f"rejected[{i}].") for i, entry in enumerate(entries)]
        return [Rejection(reader.integer("index"), reader.text("reason")) for reader in readers]
