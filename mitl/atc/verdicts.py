"""The verdicts that many cases ask for: a deviation along a path, an orientation along it, a speed.

Invariant: values are SI until they are handed to `check`; a limit comes from the case.
"""

from __future__ import annotations

import numpy as np

from mitl.atc.measuring import budget_of_path, budget_of_speed, budget_of_turn
from mitl.engine import Bench, Check
from mitl.errors import RigError
from mitl.metrics.deviation import largest_deviation
from mitl.outcome import Outcome
from mitl.paths import FloatArray, PosePath

TURN_LIMIT = float(np.radians(5.0))
"""Limit of an orientation in rad (thesis 3.4.3.2: 5 deg)."""


def check_position(bench: Bench, check: Check, name: str, path: PosePath, deviation: FloatArray, limit: float) -> Outcome:
    """Judges the largest window mean of a deviation (N,) or (N, 3) in m, by a limit in m. Raises RigError for none."""
    if not len(path):
        raise RigError(f"{name}: the tracker was out of sight")
    largest = largest_deviation(path.time, deviation)
    size = np.abs(deviation) if deviation.ndim == 1 else np.linalg.norm(deviation, axis=1)
    return check(
        name,
        value=1e3 * largest.value,
        limit=1e3 * limit,
        unit="mm",
        budget=budget_of_path(bench, largest),
        over_time=(path.time, 1e3 * size),
    )


def check_turn(bench: Bench, check: Check, name: str, path: PosePath, turn: FloatArray) -> Outcome:
    """Judges the largest window mean of rotation vectors (N, 3) in rad by TURN_LIMIT."""
    largest = largest_deviation(path.time, turn)
    half = largest.window / 2
    known = bench.last_oracle.accuracy_between(largest.time - half, largest.time + half)
    return check(
        name,
        value=float(np.degrees(largest.value)),
        limit=float(np.degrees(TURN_LIMIT)),
        unit="deg",
        budget=budget_of_turn(bench, largest.random, known.turn),
        over_time=(path.time, np.degrees(np.linalg.norm(turn, axis=1))),
    )


def check_speed(bench: Bench, check: Check, name: str, *, faster: float, at: float, random: float, limit: float) -> Outcome:
    """Judges by how many m/s a mean speed of `at` m/s is off; random is its own standard uncertainty, limit in m/s."""
    return check(name, value=1e3 * faster, limit=1e3 * limit, unit="mm/s", budget=budget_of_speed(bench, random=random, speed=at))
