"""How far a robot model's oracles may be from the real arm, read from `models/<robot>/provenance.toml`, section [oracle].

Bands, `[[oracle.band]]`, give the residuals of a kind of motion up to a speed of the tool. Invariant: a model that does not say so gets
the largest figures known, never zero, and no sample gets less because it is faster than what was measured.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from mitl.errors import UsageError
from mitl.paths import FloatArray
from mitl.protocols import OracleAccuracy, OracleBounds


class Kind(Enum):
    """What a tool does at a sample: stands, or is on a line, an arc, a joint move, or in a corner zone."""

    STILL = "still"
    LINE = "line"
    ARC = "arc"
    JOINT = "joint"
    CORNER = "corner"


@dataclass(frozen=True)
class Band:
    """Residuals of a kind of motion at up to so many m/s, as standard uncertainties: path m, turn rad, time s."""

    kind: Kind
    up_to: float
    path: float
    turn: float
    time: float


UNKNOWN = OracleAccuracy(path=1.0e-3, time=15e-3, speed=2e-3, turn=float(np.radians(0.1)), lag=2.5e-3)
"""For a model without figures. ASSUMPTION A-200: p95 of a fitted model on programs it was not tuned to (facts/motion.md);
its lag: ASSUMPTION A-291."""


@dataclass(frozen=True)
class ModelAccuracy:
    """What is known of a model: `overall`, for every motion that no band speaks of, and bands."""

    overall: OracleAccuracy
    bands: tuple[Band, ...] = ()

    def bounds(self, kinds: tuple[Kind, ...], speed: FloatArray) -> OracleBounds:
        """Gives the bounds at samples of N kinds at speeds (N,) m/s.

        Beyond the fastest band of a kind the path's and turn's grow with the square of the speed, as the arm's lag does (ASSUMPTION A-271).
        """
        found = np.repeat([[self.overall.path, self.overall.turn, self.overall.time]], len(speed), axis=0)
        of_kind = np.array([kind.value for kind in kinds])
        for kind in Kind:
            bands = sorted((band for band in self.bands if band.kind is kind), key=lambda band: band.up_to)
            here = of_kind == kind.value
            if not bands or not here.any():
                continue
            limits = np.array([band.up_to for band in bands])
            figures = np.array([[band.path, band.turn, band.time] for band in bands])
            found[here] = figures[np.minimum(np.searchsorted(limits, speed[here]), len(bands) - 1)]
            beyond = here & (speed > limits[-1])
            if limits[-1] > 0:
                found[beyond, :2] *= ((speed[beyond] / limits[-1]) ** 2)[:, None]
        return OracleBounds(found[:, 0], found[:, 1], found[:, 2])


def load_accuracy(folder: Path) -> ModelAccuracy:
    """Gives what is known of the oracles of the model in `folder`. Raises UsageError where the file does not fit."""
    file = folder / "provenance.toml"
    if not file.is_file():
        return ModelAccuracy(UNKNOWN)
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8")).get("oracle")
    except tomllib.TOMLDecodeError as error:
        raise UsageError(f"{file}: not valid TOML: {error}") from error
    if table is None:
        return ModelAccuracy(UNKNOWN)
    if not isinstance(table, dict):
        raise UsageError(f"{file}: [oracle] must be a table")
    overall = OracleAccuracy(
        path=1e-3 * _number(file, "[oracle]", table, "path_mm"),
        time=1e-3 * _number(file, "[oracle]", table, "time_ms"),
        speed=1e-2 * _number(file, "[oracle]", table, "speed_per_cent"),
        turn=float(np.radians(_number(file, "[oracle]", table, "turn_deg"))) if "turn_deg" in table else UNKNOWN.turn,
        lag=1e-3 * _number(file, "[oracle]", table, "lag_ms") if "lag_ms" in table else UNKNOWN.lag,
    )
    rows = table.get("band", [])
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise UsageError(f"{file}: [[oracle.band]] must be tables")
    bands = tuple(_band(file, f"[[oracle.band]] {number}", row) for number, row in enumerate(rows, start=1))
    return ModelAccuracy(overall, bands)


def _band(file: Path, where: str, row: dict[str, Any]) -> Band:  # tomllib's own result type
    known = [kind.value for kind in Kind]
    if row.get("kind") not in known:
        raise UsageError(f"{file}: {where} kind must be one of {', '.join(known)}, is {row.get('kind')!r}")
    return Band(
        Kind(row["kind"]),
        up_to=1e-3 * _number(file, where, row, "up_to_mm_s"),
        path=1e-3 * _number(file, where, row, "path_mm"),
        turn=float(np.radians(_number(file, where, row, "turn_deg"))),
        time=1e-3 * _number(file, where, row, "time_ms"),
    )


def _number(file: Path, where: str, table: dict[str, Any], key: str) -> float:  # tomllib's own result type
    value = table.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float) or value < 0:
        raise UsageError(f"{file}: {where} {key} must be a number of 0 or more, is {value!r}")
    return float(value)
