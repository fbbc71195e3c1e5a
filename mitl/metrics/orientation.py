"""Deviation of orientations: from each other, and from the even turn between two. Quaternions are wxyz, unit."""

from __future__ import annotations

import numpy as np

from mitl.paths import FloatArray


def angle_between(first_wxyz: FloatArray, second_wxyz: FloatArray) -> FloatArray:
    """Gives the angle (N,) in rad, 0 to pi, between orientations (N, 4) or (4,) and (N, 4).

    By the norms of difference and sum, which keeps small angles exact where the arc cosine does not.
    """
    dot = np.sum(first_wxyz * second_wxyz, axis=-1, keepdims=True)
    nearer = np.where(dot < 0.0, -second_wxyz, second_wxyz)
    difference = np.linalg.norm(first_wxyz - nearer, axis=-1)
    total = np.linalg.norm(first_wxyz + nearer, axis=-1)
    return np.asarray(4.0 * np.arctan2(difference, total))


def turn_between(first_wxyz: FloatArray, second_wxyz: FloatArray) -> FloatArray:
    """Gives the rotation vectors (N, 3) in rad, in the first's axes, that turn the first (N, 4) or (4,) into the second (N, 4)."""
    w1, v1 = first_wxyz[..., :1], first_wxyz[..., 1:]
    w2, v2 = second_wxyz[..., :1], second_wxyz[..., 1:]
    real = w1 * w2 + np.sum(v1 * v2, axis=-1, keepdims=True)
    vector = w1 * v2 - w2 * v1 - np.cross(v1, v2)
    vector = np.where(real < 0.0, -vector, vector)
    length = np.linalg.norm(vector, axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(length, np.abs(real))
    return np.asarray(np.where(length > 1e-12, angle / np.where(length > 1e-12, length, 1.0), 2.0) * vector)


def slerp(start_wxyz: FloatArray, end_wxyz: FloatArray, fraction: FloatArray) -> FloatArray:
    """Gives the orientations (N, 4) at fractions (N,) of the even turn between two, the shorter way round.

    start, end: (4,) or (N, 4).
    """
    dot = np.sum(start_wxyz * end_wxyz, axis=-1, keepdims=True)
    nearer = np.where(dot < 0.0, -end_wxyz, end_wxyz)
    half = 0.5 * angle_between(start_wxyz, nearer)[..., None]
    sine = np.sin(half)
    small = sine < 1e-9
    safe = np.where(small, 1.0, sine)
    t = fraction[:, None]
    from_start = np.where(small, 1.0 - t, np.sin((1.0 - t) * half) / safe)
    from_end = np.where(small, t, np.sin(t * half) / safe)
    mixed = from_start * start_wxyz + from_end * nearer
    return np.asarray(mixed / np.linalg.norm(mixed, axis=-1, keepdims=True))


def orientation_deviation(quaternion_wxyz: FloatArray, start_wxyz: FloatArray, end_wxyz: FloatArray, progress: FloatArray) -> FloatArray:
    """Gives the rotation vectors (N, 3) in rad from the even turn start..end (4,) at `progress` (N,) to the orientations (N, 4).

    progress: 0 at start, 1 at end, as the position along the path says; values outside are taken as the nearer end.
    """
    return turn_between(slerp(start_wxyz, end_wxyz, np.clip(progress, 0.0, 1.0)), quaternion_wxyz)
