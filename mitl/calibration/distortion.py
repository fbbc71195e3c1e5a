"""The tracker's affine distortion of positions. Invariant: orientations are never distorted."""

from __future__ import annotations

from enum import Enum

import numpy as np

from mitl.paths import FloatArray


class Distortion(Enum):
    """What the tracker does to positions in its own frame L; orientations are never distorted.

    RIGID: nothing. SCALE: one scale. AFFINE: a scale an axis and three skews.
    """

    RIGID = "rigid"
    SCALE = "scale"
    AFFINE = "affine"

    @property
    def unknowns(self) -> int:
        """Gives how many numbers describe it."""
        return {Distortion.RIGID: 0, Distortion.SCALE: 1, Distortion.AFFINE: 6}[self]


def distortion_matrix(scale: FloatArray, skew: FloatArray) -> FloatArray:
    """Gives A (3, 3): the tracker reports A p for the true position p in L. scale: (3,) x y z. skew: (3,) xy xz yz in rad.

    ASSUMPTION A-60: A is upper triangular, so that the tracker's x axis keeps its direction and the skews tilt y in the xy
    plane and z anywhere. Any other affine distortion differs from this by a rotation between positions and orientations.
    """
    return np.array([[scale[0], skew[0], skew[1]], [0.0, scale[1], skew[2]], [0.0, 0.0, scale[2]]])
