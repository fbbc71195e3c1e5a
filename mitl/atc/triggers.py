"""What the cases about triggers share: which presses of the tracker's buttons belong to which triggers, and the verdicts on them.

An output is wired to a button of the tracker, which tells it some ms late: its mean is known, its spread averaged over the triggers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mitl.atc.measuring import TimedRun, drift_since
from mitl.engine import Bench, Check
from mitl.metrics.lateness import lateness
from mitl.metrics.path import interpolate
from mitl.metrics.uncertainty import Budget, Term
from mitl.outcome import Outcome
from mitl.paths import FloatArray

PLACE_LIMIT = 5e-3
TIME_LIMIT = 25e-3
DELAY = 10e-3
"""Mean delay in s of a button: 8 ms, reported with the next sample of 4 ms (facts/tracker.md: uniform on -.6 to 16.6 ms)."""
DELAY_SD = 5.1e-3
DELAY_SIGMA = 0.7e-3
"""How well its mean is known: 5.1 ms over the 60 presses of the thesis's table 4.9."""
_NEAR = 0.16
"""Seconds from where a trigger is expected within which a press is taken for it."""


@dataclass(frozen=True)
class Wire:
    """An output of the robot, the tracker's button that it is wired to, and the value above which it presses it."""

    signal: str
    button: int
    above: float = 0.0


DIGITAL = Wire("doTrigger", 0)
ANALOG = Wire("aoTrigger", 1, 5.0)
"""An analog output presses its button over a comparator at 5 V, as the rig file says ([buttons])."""


@dataclass(frozen=True, eq=False)
class Triggers:
    """The rising edges of the output: expected (K,) and seen (K,) in s on the oracle's clock; not a number where none was seen."""

    expected: FloatArray
    seen: FloatArray

    @property
    def late(self) -> FloatArray:
        """Gives by how many s those seen were late."""
        return np.asarray((self.seen - self.expected)[np.isfinite(self.seen)])

    @property
    def missing(self) -> int:
        """Gives how many were not seen."""
        return int(np.sum(~np.isfinite(self.seen)))

    def every(self, step: int, first: int) -> Triggers:
        """Gives each `step`-th trigger from `first` on."""
        return Triggers(self.expected[first::step], self.seen[first::step])


def triggers(run: TimedRun, wire: Wire = DIGITAL) -> Triggers:
    """Gives the triggers of a run, each with the press next to it."""
    times, values = run.run.oracle.signals[wire.signal]
    above = values > wire.above
    expected = times[above & ~np.concatenate([[False], above[:-1]])]
    presses = run.run.samples.pressed(wire.button) + run.offset.seconds - DELAY
    seen = np.full(len(expected), np.nan)
    for place, time in enumerate(expected):
        near = presses[np.abs(presses - time) < _NEAR]
        if len(near):
            seen[place] = near[np.argmin(np.abs(near - time))]
    return Triggers(expected, seen)


def check_missing(check: Check, found: Triggers, name: str = "triggers missing") -> Outcome:
    """Judges that every trigger was seen."""
    return check(name, value=float(found.missing), limit=0.0, uncertainty=0.0, unit="")


def check_place(bench: Bench, check: Check, run: TimedRun, found: Triggers, speed: float, name: str = "beyond the place") -> Outcome:
    """Judges the mean distance in m along the path from the place of a trigger to where the tool was, at `speed` m/s."""
    expected, seen = found.expected[np.isfinite(found.seen)], found.seen[np.isfinite(found.seen)]
    if not len(seen):
        return check(name, value=float("nan"), limit=1e3 * PLACE_LIMIT, uncertainty=0.0, unit="mm")
    there, then = interpolate(run.run.oracle.tcp, expected), interpolate(run.tool, seen)
    step = interpolate(run.run.oracle.tcp, expected + 0.01).position - there.position
    direction = step / np.linalg.norm(step, axis=1)[:, None]
    beyond = np.sum((then.position - there.position) * direction, axis=1)
    spread = float(np.std(beyond, ddof=1)) if len(beyond) > 1 else speed * DELAY_SD
    budget = Budget(
        (
            Term("random", spread / np.sqrt(len(beyond)), f"{len(beyond)} triggers"),
            Term("button", speed * DELAY_SIGMA, "mean delay of the tracker's button"),
            Term("registration", bench.calibration.position_uncertainty(0.1), "calibration"),
            Term("drift", drift_since(bench), "tracker, since the calibration"),
            Term("oracle", speed * bench.last_oracle.accuracy.lag, "robot model: the tool's lag behind the outputs"),
        )
    )
    return check(name, value=1e3 * float(beyond.mean()), limit=1e3 * PLACE_LIMIT, unit="mm", budget=budget)


def check_time(bench: Bench, check: Check, run: TimedRun, found: Triggers, name: str = "late by") -> Outcome:
    """Judges the mean lateness of triggers against the tool's own passing of the places where the oracle says that they come.

    What the whole path is late by at a trigger is no lateness of the trigger: a path's time is judged elsewhere, and the model's
    knowledge of it, which is worse by far than that of the lag between outputs and tool, does not count here.
    """
    seen = np.isfinite(found.seen)
    path = lateness(run.run.oracle.tcp, run.tool, found.expected[seen])
    told = np.isfinite(path.seconds)
    late = found.late[told] - path.seconds[told]
    if not len(late):
        return check(name, value=float("nan"), limit=1e3 * TIME_LIMIT, uncertainty=0.0, unit="ms")
    slowest = float(path.speed[told].min())
    tool = float(np.sqrt(np.mean(path.random[told] ** 2)))
    budget = Budget(
        (
            Term("random", np.hypot(DELAY_SD, tool) / np.sqrt(len(late)), f"{len(late)} presses"),
            Term("button", DELAY_SIGMA, "mean delay of the tracker's button"),
            Term("registration", bench.calibration.position_uncertainty(0.1) / slowest, f"calibration, at {1e3 * slowest:.0f} mm/s"),
            Term("drift", drift_since(bench) / slowest, f"tracker, since the calibration, at {1e3 * slowest:.0f} mm/s"),
            Term("oracle", bench.last_oracle.accuracy.lag, "robot model: the tool's lag behind the outputs"),
        )
    )
    return check(name, value=1e3 * float(late.mean()), limit=1e3 * TIME_LIMIT, unit="ms", budget=budget)
