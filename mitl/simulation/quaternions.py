"""Quaternions (N, 4), scalar first, for the sensor model.

Not scipy's Rotation: that takes most of a microsecond a sample, these a tenth, and its last bit depends on how many are computed at once.
Invariant: only sums and products of columns, so that a sample's bits do not depend on its neighbours.
"""

from __future__ import annotations

import numpy as np

from mitl.paths import FloatArray


def product(p_wxyz: FloatArray, q_wxyz: FloatArray) -> FloatArray:
    """Gives the products p q (N, 4) of quaternions (N, 4) or (1, 4) each."""
    w1, x1, y1, z1 = p_wxyz.T
    w2, x2, y2, z2 = q_wxyz.T
    result = np.empty((*np.broadcast_shapes(w1.shape, w2.shape), 4))
    result[:, 0] = w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2
    result[:, 1] = w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2
    result[:, 2] = w1 * y2 + y1 * w2 + z1 * x2 - x1 * z2
    result[:, 3] = w1 * z2 + z1 * w2 + x1 * y2 - y1 * x2
    return result


def rotated(q_wxyz: FloatArray, vectors: FloatArray) -> FloatArray:
    """Gives vectors (N, 3) or (1, 3) rotated by unit quaternions (N, 4) or (1, 4)."""
    w, a, b, c = q_wxyz.T
    x, y, z = vectors.T
    tx, ty, tz = 2.0 * (b * z - c * y), 2.0 * (c * x - a * z), 2.0 * (a * y - b * x)
    return np.stack([x + w * tx + b * tz - c * ty, y + w * ty + c * tx - a * tz, z + w * tz + a * ty - b * tx], axis=1)


def turned(q_wxyz: FloatArray, rotation_vector: FloatArray) -> FloatArray:
    """Gives unit quaternions (N, 4) turned by small rotation vectors (N, 3) in rad about the body's own axes, normalised.

    First order: the angle a comes out as 2 atan(a / 2), short by a^3 / 12.
    """
    turn = np.ones((len(rotation_vector), 4))
    turn[:, 1:] = 0.5 * rotation_vector
    a, b, c = turn[:, 1:].T
    turn /= np.sqrt(1.0 + a * a + b * b + c * c)[:, np.newaxis]
    return product(q_wxyz, turn)


def small_turn(from_wxyz: FloatArray, to_wxyz: FloatArray) -> FloatArray:
    """Gives the rotation vectors (N, 3) in rad, in the body's axes, that lead from one unit quaternion to the other.

    First order: the angle a comes out as 2 sin(a / 2), short by a^3 / 24.
    """
    turn = product(from_wxyz * [1.0, -1.0, -1.0, -1.0], to_wxyz)
    vector: FloatArray = turn[:, 1:] * np.copysign(2.0, turn[:, :1])
    return vector
