"""A controller's streamed view of itself as topics of a recording: /robot/egm with axes, plan and states, /robot/egm/flange."""

from __future__ import annotations

import numpy as np

from mitl.feedback import FeedbackSamples
from mitl.paths import PosePath
from mitl.recording.records import PoseTrack, Series

_COLUMNS = (*(f"j{i}" for i in range(1, 7)), *(f"planned_j{i}" for i in range(1, 7)), "motors_on", "running")


def feedback_series(samples: FeedbackSamples) -> Series:
    """Gives axes and planned axes in rad, and whether motors are on and RAPID runs."""
    return Series(samples.time, np.column_stack([samples.joints, samples.planned, samples.motors_on, samples.running]), _COLUMNS)


def feedback_track(samples: FeedbackSamples) -> PoseTrack | None:
    """Gives the position that the controller told, None where it told none; a turn that is none is not valid."""
    told = np.all(np.isfinite(samples.pose), axis=1)
    if not told.any():
        return None
    turn = samples.pose[told, 3:]
    length = np.linalg.norm(turn, axis=1)
    proper = np.abs(length - 1.0) < 1e-2
    turn = np.where(proper[:, None], turn / np.where(proper, length, 1.0)[:, None], [1.0, 0.0, 0.0, 0.0])
    return PoseTrack(PosePath(samples.time[told], samples.pose[told, :3], turn, proper), "base", "flange")


def feedback_facts(samples: FeedbackSamples) -> str:
    """Gives in words how much came and what did not."""
    late = f"median delay {1e3 * samples.delay:.1f} ms"
    return f"EGM: {len(samples)} datagrams, {samples.lost} lost, {samples.malformed} malformed, {samples.foreign} from elsewhere, {late}"
