"""What the cases share: still points, paths on the oracle's clock, and the uncertainty budgets of both.

Invariant: nothing here knows a limit; the cases judge.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mitl.calibration.distortion import distortion_matrix
from mitl.calibration.known_offset import refine_offset
from mitl.calibration.time_offset import TimeOffset
from mitl.engine import Bench, StillPoint, TrackedRun
from mitl.engine.bench import STILL
from mitl.errors import RigError
from mitl.metrics.deviation import LargestDeviation
from mitl.metrics.uncertainty import Budget, Term, drift_sigma, point_budget, position_budget
from mitl.paths import FloatArray, PosePath
from mitl.protocols import ProgrammedMove

DRIFT_SD, DRIFT_TAU = 0.84e-3, 1200.0
"""The tracker's drift on its worst axis, m, and its correlation time, s (facts/tracker.md, preset thesis, after the thesis's table 4.3)."""
SETTLING = 0.1
"""Seconds between the end of an order and the averaging of a still point: the arm has settled (.08 s, facts/motion.md), while the tracker's
creep after a stop, which grows over .7 s (facts/tracker.md), has not."""
_EDGE = 0.1
_REST = 0.3
"""Seconds of standstill after the first move that help to tell the clocks' offset; the programs wait for half a second there."""
MOST_UNSEEN = 0.5
"""Seconds of a judged motion that may go unseen: as long as the robot goes on moving with its tracker lost (docs/physical_rig.md)."""


@dataclass(frozen=True, eq=False)
class TimedRun:
    """A tracked run brought onto its oracle's clock: `tool` is X_OT with times of the oracle."""

    run: TrackedRun
    tool: PosePath
    offset: TimeOffset

    def moves(self, kind: str) -> list[ProgrammedMove]:
        """Gives the programmed moves of a kind, e.g. MoveL, in order."""
        return [move for move in self.run.oracle.moves if move.kind == kind]

    def during(self, first: ProgrammedMove, last: ProgrammedMove | None = None) -> PosePath:
        """Gives the samples from the beginning of one move to the end of it or of a later one, less a tenth of a second at both ends.

        Raises RigError where the tracker did not see half a second of it: what was not seen cannot be judged.
        """
        begin, end = first.begins + _EDGE, (last or first).ends - _EDGE
        chosen = self.tool.between(begin, end)
        if len(chosen) == 0:
            raise RigError(f"no valid sample between {first.begins:.2f} s and {(last or first).ends:.2f} s of the run")
        unseen = float(np.diff(chosen.time).max(initial=0.0))  # between samples: at the ends a robot may simply be early or late
        if unseen > MOST_UNSEEN:
            during = f"between {begin:.2f} s and {end:.2f} s of the run"
            raise RigError(f"the tracker was out of sight for {unseen:.2f} s of the motion {during}")
        return chosen


def timed(run: TrackedRun) -> TimedRun:
    """Gives a run on its oracle's clock, by the way to its start, its first move.

    What follows is what is judged: fitted over the whole run, the offset would hide a part of a wrong timing, and on a circle it cannot
    be told from a turn about the centre. Raises RigError where the first move does not tell the clocks' offset.
    """
    ends = run.oracle.moves[0].ends + _REST
    began = run.given
    reference = run.oracle.tcp.between(0.0, ends)
    offset = refine_offset(reference, run.tool.between(began - STILL, began + ends), -began)
    if not np.isfinite(offset.sigma):
        raise RigError("the recording cannot be brought onto the oracle's clock: the tool does not make the first move of the program")
    return TimedRun(run, run.tool.shifted(offset.seconds), offset)


def still_point(bench: Bench, option: int, sub_option: int) -> tuple[StillPoint, FloatArray]:
    """Gives the still point at which an order ends, as measured, and the pose X_OT (7,) at which it was programmed to end."""
    oracle = bench.go(option, sub_option, settle=SETTLING)
    return bench.still_point(), oracle.moves[-1].end


def undistorted(bench: Bench, point: StillPoint) -> FloatArray:
    """Gives the pose X_LM (7,) of a still point with the tracker's scale and skew taken off."""
    calibration = bench.calibration
    position = np.linalg.solve(distortion_matrix(calibration.scale, calibration.skew), point.raw.position)
    return np.concatenate([position, point.raw.quaternion_wxyz])


def budget_of_point(bench: Bench, point: StillPoint) -> Budget:
    """Gives the budget in m of a still point's position."""
    registration = bench.calibration.position_uncertainty(_lever(bench))
    return point_budget(jitter=point.raw.jitter, registration=registration, drift=drift_since(bench))


def budget_of_path(bench: Bench, largest: LargestDeviation, *, speed: float = 0.0, offset: TimeOffset | None = None) -> Budget:
    """Gives the budget in m of a path's largest deviation, its time on the oracle's clock.

    speed m/s and clock offset only where deviations at the same time are judged. The oracle's term is its bound where the deviation is.
    """
    half = largest.window / 2
    known = bench.last_oracle.accuracy_between(largest.time - half, largest.time + half)
    budget = position_budget(
        random=largest.random,
        registration=bench.calibration.position_uncertainty(_lever(bench)),
        drift=drift_since(bench),
        speed=speed,
        time_sigma=0.0 if offset is None else offset.sigma,
    )
    late = 0.0 if offset is None else speed * known.time
    return budget.with_term("oracle", float(np.hypot(known.path, late)), "robot model, against the real arm")


def budget_of_turn(bench: Bench, random: float, oracle: float = 0.0) -> Budget:
    """Gives the budget in rad of an orientation, `random` rad being its own noise, `oracle` rad the oracle's bound."""
    budget = Budget(
        (Term("random", random, "noise of the recording"), Term("registration", bench.calibration.rotation_uncertainty(), "calibration"))
    )
    return budget.with_term("oracle", oracle, "robot model, against the real arm") if oracle > 0.0 else budget


def budget_of_speed(bench: Bench, *, random: float, speed: float) -> Budget:
    """Gives the budget in m/s of a mean speed of `speed` m/s, `random` m/s being its own noise."""
    first = 12
    scale = np.sqrt(np.diag(bench.calibration.covariance)[first:])
    relative = float(scale.max()) if len(scale) else 0.0
    return Budget(
        (
            Term("random", random, "noise of the recording"),
            Term("scale", relative * speed, f"tracker's scale, known to {relative:.2g}"),
            Term("oracle", bench.last_oracle.accuracy.speed * speed, "robot model, steady speed"),
        )
    )


def drift_since(bench: Bench) -> float:
    """Gives what the tracker may have drifted in m since the calibration."""
    return drift_sigma(DRIFT_SD, DRIFT_TAU, bench.since_calibration)


def _lever(bench: Bench) -> float:
    """Gives the distance in m of the tool's tip from the flange, over which an error of orientation acts."""
    return float(np.linalg.norm(bench.last_oracle.tool[:3]))
