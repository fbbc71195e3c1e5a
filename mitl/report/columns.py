"""Numbers for the page: columns of 16-bit steps as base64, a third of their size as JSON text.

Invariant: a column's error is at most half a 65000th of its span; what is not finite becomes a gap.
"""

from __future__ import annotations

import base64
from typing import Any

import numpy as np

from mitl.paths import FloatArray

STEPS = 65_000
GAP = 65_535
"""The value that stands for no number; app.js knows it too."""


def packed(values: FloatArray) -> dict[str, Any]:
    """Gives values (N,) as {"low", "step", "q"}: value = low + step q, q little-endian 16-bit in base64."""
    finite = np.isfinite(values)
    low, high = (float(values[finite].min()), float(values[finite].max())) if finite.any() else (0.0, 0.0)
    step = (high - low) / STEPS
    scaled = np.where(finite, (values - low) / step if step > 0.0 else 0.0, GAP)
    return {"low": low, "step": step, "q": base64.b64encode(np.rint(scaled).astype("<u2").tobytes()).decode("ascii")}


def unpacked(column: dict[str, Any]) -> FloatArray:
    """Gives the values (N,) of `packed`, gaps as nan."""
    steps = np.frombuffer(base64.b64decode(column["q"]), dtype="<u2")
    return np.where(steps == GAP, np.nan, column["low"] + column["step"] * steps.astype(np.float64))
