"""How far a robot model's oracles may be from the real arm, read from `models/<robot>/provenance.toml`, section [oracle].

Invariant: a model that does not say so gets the largest figures known, never zero.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

from mitl.errors import UsageError
from mitl.protocols import OracleAccuracy

UNKNOWN = OracleAccuracy(path=1.0e-3, time=15e-3, speed=2e-3)
"""For a model without figures. ASSUMPTION A-200: p95 of a fitted model on programs it was not tuned to (facts/motion.md)."""


def load_accuracy(folder: Path) -> OracleAccuracy:
    """Gives the standard uncertainties of the oracles of the model in `folder`. Raises UsageError where the file does not fit."""
    file = folder / "provenance.toml"
    if not file.is_file():
        return UNKNOWN
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8")).get("oracle")
    except tomllib.TOMLDecodeError as error:
        raise UsageError(f"{file}: not valid TOML: {error}") from error
    if table is None:
        return UNKNOWN
    values = []
    for key, per_si in (("path_mm", 1e-3), ("time_ms", 1e-3), ("speed_per_cent", 1e-2)):
        value = table.get(key) if isinstance(table, dict) else None
        if isinstance(value, bool) or not isinstance(value, int | float) or value < 0:
            raise UsageError(f"{file}: [oracle] {key} must be a number of 0 or more, is {value!r}")
        values.append(per_si * value)
    return OracleAccuracy(*values)
