"""What a fitted model leaves unexplained on the moves held out of the fit: residuals by kind of motion and speed, as bands.

Invariant: a kind and speed without held-out samples has no band, and falls back to what the model knew before.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mitl.motion.accuracy import Band, Kind, ModelAccuracy
from mitl.motion.bounds import doing
from mitl.motion.fit import JointLog, MotionFit, held_out
from mitl.motion.record import TICK, View
from mitl.paths import FloatArray
from mitl.protocols import OracleAccuracy

SPEEDS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.8, 1.0, 1.5, 2.5, 5.0, 10.0)
"""Upper edges in m/s of the bands."""
UNSEEN = 1e-4
"""What a controller's log cannot show, m: the way from the motors to the tool. ASSUMPTION A-276."""
_FEWEST = 10
_P95 = 1.96
_SLOWEST = 0.02


def residual_bands(fit: MotionFit, logs: Sequence[JointLog]) -> tuple[Band, ...]:
    """Gives for each kind and speed with held-out samples: half the p95 of the tool's error across its path and of its turn, rms time."""
    rows: list[FloatArray] = []
    for log, run, offset in zip(logs, fit.runs, fit.offsets, strict=True):
        time = log.time - offset
        record, arm = run.record, run.planner.arm
        ticks: FloatArray = TICK * np.arange(int(max(record.end, time[-1]) / TICK) + 2, dtype=np.float64)
        kinds, speeds = doing(record, arm, ticks)
        used = held_out(run)[record.move_at(time)] & (time >= 0) & (time <= record.end)
        at = np.clip(np.rint(time[used] / TICK).astype(np.intp), 0, len(ticks) - 1)
        tools = [record.moves[index].move.leg.X_FT for index in record.move_at(time[used])]
        model, later, seen = (
            arm.flange(joints)
            for joints in (
                record.joints(time[used], View.CONTROLLER),
                record.joints(time[used] + TICK, View.CONTROLLER),
                log.joints[used],
            )
        )
        lever = np.array([tool.translation for tool in tools]).reshape(-1, 3)
        place, next_place, measured = (X.translation + X.rotation.apply(lever) for X in (model, later, seen))
        velocity = (next_place - place) / TICK
        speed = np.linalg.norm(velocity, axis=1)
        along = np.sum((measured - place) * velocity, axis=1) / np.maximum(speed, 1e-9)
        moving = speed > _SLOWEST
        off = measured - place - np.where(moving, along / np.maximum(speed, 1e-9), 0.0)[:, None] * velocity
        turn = (model.rotation.inv() * seen.rotation).magnitude()
        number = [list(Kind).index(kinds[index]) for index in at]
        late = np.where(moving, along / np.maximum(speed, 1e-9), np.nan)
        rows.append(np.column_stack([number, speeds[at], np.linalg.norm(off, axis=1), turn, late]))
    return _bands(np.concatenate(rows))


def _bands(rows: FloatArray) -> tuple[Band, ...]:
    found = []
    for number, kind in enumerate(Kind):
        lower = -1.0
        for upper in SPEEDS:
            here = rows[(rows[:, 0] == number) & (rows[:, 1] > lower) & (rows[:, 1] <= upper)]
            lower = upper
            if len(here) < _FEWEST:
                continue
            path, turn = (float(np.percentile(here[:, column], 95)) / _P95 for column in (2, 3))
            late = here[np.isfinite(here[:, 4]), 4]
            time = float(np.sqrt(np.mean(late**2))) if len(late) else TICK
            found.append(Band(kind, upper, float(np.hypot(path, UNSEEN)), turn, max(time, TICK / 4)))
    return tuple(found)


def fitted_accuracy(bands: Sequence[Band], before: ModelAccuracy) -> ModelAccuracy:
    """Gives what is known of the fitted model: its bands, and the base model's figures for all that they do not speak of.

    Kinds of motion with bands of their own lose the base model's; `overall` stays, as it is for motions that nobody measured.
    """
    kinds = {band.kind for band in bands}
    kept = tuple(band for band in before.bands if band.kind not in kinds)
    overall = before.overall
    return ModelAccuracy(OracleAccuracy(overall.path, overall.time, overall.speed, overall.turn), (*bands, *kept))
