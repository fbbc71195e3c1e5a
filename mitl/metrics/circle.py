"""Deviation of points from the circle through three points, in its plane and out of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mitl.paths import FloatArray


@dataclass(frozen=True, eq=False)
class Circle:
    """A circle. centre: (3,) m. normal: (3,) unit, right-handed about the order of the points. radius: m. start: (3,) m, angle zero."""

    centre: FloatArray
    normal: FloatArray
    radius: float
    start: FloatArray


@dataclass(frozen=True, eq=False)
class CircleDeviation:
    """Deviation of N points from a circle.

    in_plane: (N,) m, positive outside. out_of_plane: (N,) m, positive on the normal's side. angle: (N,) rad, travelled from the
    circle's start, unwrapped along the N points. vector: (N, 3) m from the nearest point of the circle.
    """

    in_plane: FloatArray
    out_of_plane: FloatArray
    angle: FloatArray
    vector: FloatArray

    @property
    def distance(self) -> FloatArray:
        """Gives the distance (N,) in m from the circle."""
        return np.hypot(self.in_plane, self.out_of_plane)

    @property
    def angle_range(self) -> tuple[float, float]:
        """Gives the smallest and largest angle travelled, in rad."""
        return float(self.angle.min()), float(self.angle.max())


def circle_through(start: FloatArray, via: FloatArray, end: FloatArray) -> Circle:
    """Gives the circle through three points (3,), travelled in this order. Raises ValueError where they lie on a line."""
    to_via, to_end = via - start, end - start
    normal = np.cross(to_via, to_end)
    area = float(np.linalg.norm(normal))
    if area < 1e-9 * max(1e-9, float(np.linalg.norm(to_via) * np.linalg.norm(to_end))) or area < 1e-15:
        raise ValueError(f"a circle needs three points that are not on a line, got {start}, {via}, {end}")
    to_centre = np.cross(np.dot(to_via, to_via) * to_end - np.dot(to_end, to_end) * to_via, normal) / (2.0 * area**2)
    return Circle(start + to_centre, normal / area, float(np.linalg.norm(to_centre)), start)


def circle_deviation(position: FloatArray, circle: Circle) -> CircleDeviation:
    """Gives the deviation of points (N, 3) from a circle; a point on its axis has the angle of the start."""
    across = circle.start - circle.centre
    first = across / np.linalg.norm(across)
    second = np.cross(circle.normal, first)
    from_centre = position - circle.centre
    x, y, out_of_plane = from_centre @ first, from_centre @ second, from_centre @ circle.normal
    radius = np.hypot(x, y)
    in_plane = radius - circle.radius
    safe = np.where(radius > 0.0, radius, 1.0)
    outwards = np.where(radius > 0.0, x / safe, 1.0)[:, None] * first + (y / safe)[:, None] * second
    vector = in_plane[:, None] * outwards + out_of_plane[:, None] * circle.normal
    return CircleDeviation(in_plane, out_of_plane, np.unwrap(np.arctan2(y, x)), vector)


def arc_angle(circle: Circle, end: FloatArray) -> float:
    """Gives the angle in rad, 0 to 2 pi, from the circle's start to a point (3,) in the order of its three points."""
    angle = float(circle_deviation(end[None, :], circle).angle[0])
    return angle % (2.0 * np.pi)
