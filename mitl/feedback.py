"""FeedbackSamples: a controller's own view of its motion, streamed while it moves. It is kept beside the tracker's; no verdict rests on it.

Invariant: all arrays have the length of `time`, which increases strictly.
"""

from __future__ import annotations

from dataclasses import dataclass

from mitl.paths import BoolArray, FloatArray


@dataclass(frozen=True, eq=False)
class FeedbackSamples:
    """time: (N,) s on the tracker's clock. joints, planned: (N, 6) rad. pose: (N, 7) X_BF or what the controller calls its position,
    NaN where it told none. motors_on, running: (N,). lost, malformed, foreign: datagrams that did not come, were none, came from others.
    delay: median in s between a datagram's earliest possible arrival and its own.
    """

    time: FloatArray
    joints: FloatArray
    planned: FloatArray
    pose: FloatArray
    motors_on: BoolArray
    running: BoolArray
    lost: int
    malformed: int
    foreign: int
    delay: float

    def __len__(self) -> int:
        return len(self.time)
