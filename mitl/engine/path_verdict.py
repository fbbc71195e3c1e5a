"""PathVerdict: a recording of any tracker judged against an oracle from a file, by the guard-banded decision of the test cases.

Invariant: no rig is needed, and nothing is judged that was not recorded: a recording that misses a part of the path is an error, not a
pass of the rest.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.calibration.known_offset import refine_offset
from mitl.calibration.result import Calibration
from mitl.calibration.streams import body_path, places, turning_offset
from mitl.calibration.time_offset import TimeOffset, time_offset
from mitl.errors import RigError
from mitl.metrics.decision import Decision, decide
from mitl.metrics.deviation import LargestDeviation, largest_deviation
from mitl.metrics.glitch import without_glitches
from mitl.metrics.path import PathDeviation, interpolate, path_deviation
from mitl.metrics.speed import speed
from mitl.metrics.uncertainty import DRIFT_SD, Budget, Term, position_budget
from mitl.outcome import Outcome, worst
from mitl.paths import BoolArray, FloatArray, PosePath
from mitl.poses import path_of_transforms, transforms_of_path
from mitl.protocols import OracleBounds

UNKNOWN_DRIFT = float(np.sqrt(2.0)) * DRIFT_SD
"""What a Vive may have drifted in m since a calibration of whatever age. ASSUMPTION A-330: a tracker of which nothing is told is no
better; a laser tracker's owner says so."""
_EDGE = 0.1
_LONGEST_GAP = 0.2
"""Seconds of the path without a valid sample that are no gap yet. ASSUMPTION A-331: two windows of the largest deviation; a shorter fault
would be averaged down to nothing anyway."""
_MOVES = 1e-3
"""Speed in m/s from which a tool is in motion."""


@dataclass(frozen=True, eq=False)
class ExpectedPath:
    """An oracle: tool X_BT and flange X_BF at the same times, its bounds there, and which executed move (N,) is under way."""

    tool: PosePath
    flange: PosePath
    bounds: OracleBounds
    move: FloatArray

    def during(self, first: int, last: int) -> tuple[float, float]:
        """Gives the times in s between which moves `first` to `last` go. Raises ValueError where they do not move the tool or flange."""
        speeds = np.maximum(speed(self.tool, 0.0), speed(self.flange, 0.0))
        index = np.flatnonzero((self.move >= first) & (self.move <= last) & (speeds > _MOVES))
        if len(index) < 2:
            raise ValueError(f"no motion in the moves {first} to {last}; the oracle has 0 to {int(self.move.max(initial=0))}")
        return float(self.tool.time[index[0]]), float(self.tool.time[index[-1]])


@dataclass(frozen=True)
class PathLimits:
    """Limits: m at the same time, m from the path as a curve, rad. The defaults are those of case atc-1/path."""

    in_time: float = 10e-3
    shape: float = 5e-3
    turn: float = float(np.radians(5.0))


@dataclass(frozen=True)
class PathCheck:
    """One judged value. value, limit and budget: SI, m or rad as `unit` says. at: s on the oracle's clock, where the value is."""

    name: str
    value: float
    limit: float
    unit: str
    budget: Budget
    at: float
    decision: Decision


@dataclass(frozen=True, eq=False)
class PathVerdict:
    """The checks; the clocks' offset, to add to the tracker's times; the measured tool X_BT of what was judged, on the oracle's clock."""

    checks: tuple[PathCheck, ...]
    offset: TimeOffset
    tool: PosePath

    @property
    def outcome(self) -> Outcome:
        """Gives the worst outcome of the checks."""
        return worst(check.decision.outcome for check in self.checks)


def judged_path(
    expected: ExpectedPath,
    tracked: PosePath,
    calibration: Calibration,
    limits: PathLimits = PathLimits(),
    *,
    drift: float = UNKNOWN_DRIFT,
    first: int = 0,
    last: int | None = None,
) -> PathVerdict:
    """Judges the moves `first` to `last` (None: all that follow) of an oracle by a tracker's path X_LM on a clock of its own.

    The clocks' offset is fitted to the first of these moves, as far as it tells it, so that what comes later at a wrong time is seen;
    that all comes late by the same time is not. A tracker that tells positions alone has no check of the orientation, and the tool is
    taken to be turned as it should be. drift: m, what the tracker may have drifted since its calibration. Raises RigError
    where the recording does not show the motion, or not all of it.
    """
    last = int(expected.move.max(initial=0.0)) if last is None else last
    try:
        begin, end = expected.during(first, last)
        first_ends = expected.during(first, first)[1]
    except ValueError as error:
        raise RigError(str(error)) from error
    cleaned = without_glitches(tracked)
    if calibration.positions_only:
        seen, known = places(cleaned, calibration).only_valid(), body_path(expected.flange, calibration)
    else:
        seen, known = calibration.flange_path(cleaned).only_valid(), expected.flange
    offset = _offset(known, seen, begin, first_ends, end)
    flange = seen.shifted(offset.seconds)
    begin, end = begin + _EDGE, end - _EDGE
    _require_all(expected.tool.time[(expected.tool.time >= begin) & (expected.tool.time <= end)], flange.time)
    flange = flange.between(begin, end)
    tool = _tool(expected, _turned(expected, flange, calibration) if calibration.positions_only else flange)
    deviation = path_deviation(expected.tool, tool)
    return PathVerdict(_checks(expected, deviation, calibration, limits, drift, offset), offset, tool)


def _offset(expected: PosePath, flange: PosePath, begin: float, first_ends: float, end: float) -> TimeOffset:
    coarse = turning_offset(expected, flange) or time_offset(expected, flange)
    if np.isfinite(coarse.sigma):
        for until in (first_ends, end):
            beyond = 2 * _EDGE
            window = flange.between(begin - beyond - coarse.seconds, until + beyond - coarse.seconds)
            found = refine_offset(expected, window, coarse.seconds)
            if np.isfinite(found.sigma):
                return found
    raise RigError(
        "the clocks' offset cannot be told: the recording does not show the motion of the oracle; is it of this program, and calibrated?"
    )


def _require_all(wanted: FloatArray, given: FloatArray) -> None:
    """Raises RigError where more than a short gap of the times `wanted` (N,) has no sample near."""
    inside = given[(given >= wanted[0]) & (given <= wanted[-1])] if len(wanted) else given[:0]
    edges = np.concatenate([wanted[:1], inside, wanted[-1:]])
    gaps = np.diff(edges)
    if len(inside) == 0 or gaps.max() > _LONGEST_GAP:
        at = int(np.argmax(gaps)) if len(gaps) else 0
        where = f"from {edges[at]:.2f} s to {edges[at + 1]:.2f} s" if len(edges) > 1 else "anywhere"
        raise RigError(f"the tracker gave no valid pose {where} of the oracle's clock: what was not seen is not judged")


def _turned(expected: ExpectedPath, body: PosePath, calibration: Calibration) -> PosePath:
    """Gives the flange X_BF of a body that tells its place alone: turned as it should be, so that the place's deviation is the tool's."""
    should = interpolate(expected.flange, body.time)
    turned = Rotation.from_quat(should.quaternion_wxyz, scalar_first=True).apply(calibration.X_FM[:3])
    return replace(should, position=body.position - turned)


def _tool(expected: ExpectedPath, flange: PosePath) -> PosePath:
    """Gives the measured tool X_BT: X_BF with the tool that the oracle has at the nearest sample."""
    middle = 0.5 * (expected.tool.time[1:] + expected.tool.time[:-1])
    nearest = np.searchsorted(middle, flange.time)
    X_FT = (transforms_of_path(expected.flange).inv() * transforms_of_path(expected.tool))[nearest]
    return path_of_transforms(flange, transforms_of_path(flange) * X_FT)


def _checks(
    expected: ExpectedPath, deviation: PathDeviation, calibration: Calibration, limits: PathLimits, drift: float, offset: TimeOffset
) -> tuple[PathCheck, ...]:
    lever = float(np.linalg.norm(expected.tool.position - expected.flange.position, axis=1).max())
    registration = calibration.position_uncertainty(lever)

    def position(name: str, values: FloatArray, limit: float, *, timed: bool) -> PathCheck:
        largest = largest_deviation(deviation.time, values)
        near = _near(expected.tool.time, largest)
        fast = float(speed(expected.tool, 0.0)[near].max()) if timed else 0.0
        budget = position_budget(random=largest.random, registration=registration, drift=drift, speed=fast, time_sigma=offset.sigma)
        known = float(np.hypot(expected.bounds.path[near].max(), fast * expected.bounds.time[near].max()))
        budget = budget.with_term("oracle", known, "robot model, against the real arm")
        return PathCheck(name, largest.value, limit, "m", budget, largest.time, decide(largest.value, limit, budget.combined))

    of_place = (
        position("path deviation at the same time", deviation.vector, limits.in_time, timed=True),
        position("distance from the path", deviation.nearest, limits.shape, timed=False),
    )
    if calibration.positions_only:
        return of_place
    turn = largest_deviation(deviation.time, deviation.turn)
    of_turn = Budget(
        (
            Term("random", turn.random, "noise of the recording"),
            Term("registration", calibration.rotation_uncertainty(), "calibration"),
            Term("oracle", float(expected.bounds.turn[_near(expected.tool.time, turn)].max()), "robot model, against the real arm"),
        )
    )
    return (
        *of_place,
        PathCheck(
            "orientation along the path",
            turn.value,
            limits.turn,
            "rad",
            of_turn,
            turn.time,
            decide(turn.value, limits.turn, of_turn.combined),
        ),
    )


def _near(time: FloatArray, largest: LargestDeviation) -> BoolArray:
    """Gives which oracle samples (N,) lie in the window of a largest deviation, at least the nearest one."""
    inside: BoolArray = np.abs(time - largest.time) <= largest.window / 2
    inside[int(np.argmin(np.abs(time - largest.time)))] = True
    return inside
