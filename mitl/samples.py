"""TrackerSamples: what a tracker tells beside the pose. PosePath stays the currency; this record goes along with it.

Invariant: all arrays have the length of the path.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from mitl.paths import BoolArray, FloatArray, PosePath

CodeArray = NDArray[np.int16]


class TrackingResult(IntEnum):
    """OpenVR's ETrackingResult. While occluded a device reports RUNNING_OUT_OF_RANGE with a valid pose (facts/rig.md)."""

    UNINITIALIZED = 1
    CALIBRATING = 100
    CALIBRATING_OUT_OF_RANGE = 101
    RUNNING_OK = 200
    RUNNING_OUT_OF_RANGE = 201
    ROTATION_ONLY = 300


@dataclass(frozen=True, eq=False)
class TrackerSamples:
    """Samples of one device: poses, and for each its TrackingResult (N,), pressed buttons as bits (N,), native velocity (N, 3) m/s in L.

    Raises ValueError where lengths disagree.
    """

    path: PosePath
    result: CodeArray
    buttons: CodeArray
    velocity: FloatArray

    def __post_init__(self) -> None:
        n = len(self.path)
        shapes = (self.result.shape, self.buttons.shape, self.velocity.shape)
        if shapes != ((n,), (n,), (n, 3)):
            raise ValueError(f"expected shapes ({n},), ({n},), ({n}, 3), got {shapes}")

    def __len__(self) -> int:
        return len(self.path)

    @classmethod
    def plain(cls, path: PosePath) -> TrackerSamples:
        """Gives samples of a path without more: OK where valid, no button, velocity not a number."""
        n = len(path)
        result = np.where(path.valid, TrackingResult.RUNNING_OK, TrackingResult.RUNNING_OUT_OF_RANGE).astype(np.int16)
        return cls(path, result, np.zeros(n, dtype=np.int16), np.full((n, 3), np.nan))

    @classmethod
    def joined(cls, parts: list[TrackerSamples]) -> TrackerSamples:
        """Gives parts in a row as one; no parts give no samples."""
        if not parts:
            empty = PosePath(np.empty(0), np.empty((0, 3)), np.empty((0, 4)), np.empty(0, dtype=np.bool_))
            return cls.plain(empty)
        if len(parts) == 1:
            return parts[0]
        path = PosePath(
            np.concatenate([part.path.time for part in parts]),
            np.concatenate([part.path.position for part in parts]),
            np.concatenate([part.path.quaternion_wxyz for part in parts]),
            np.concatenate([part.path.valid for part in parts]),
        )
        return cls(
            path,
            np.concatenate([part.result for part in parts]),
            np.concatenate([part.buttons for part in parts]),
            np.concatenate([part.velocity for part in parts]),
        )

    def select(self, chosen: BoolArray) -> TrackerSamples:
        """Gives the samples where `chosen` (N,) is true."""
        return TrackerSamples(self.path.select(chosen), self.result[chosen], self.buttons[chosen], self.velocity[chosen])

    def trusted(self) -> PosePath:
        """Gives the path, not valid where the device did not see where it is, whatever it says of its pose.

        While occluded it goes on valid for 1 to 2 s by its inertial sensors, centimetres off in the end: nothing may be judged by that.
        """
        path = self.path
        return replace(path, valid=path.valid & (self.result == TrackingResult.RUNNING_OK))

    def pressed(self, button: int) -> FloatArray:
        """Gives the times (K,) in s of the samples at which a button (a bit number) is newly seen pressed."""
        down = (self.buttons >> button) & 1
        first = np.concatenate([[0], down[:-1]]) if len(down) else down
        return np.asarray(self.path.time[(down == 1) & (first == 0)])
