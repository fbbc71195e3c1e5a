"""Legs: what one motion instruction asks for between two programmed points, before zones.

A leg is run through by its coordinate x from 0 to `length`; both kinds extend beyond their ends, because corners need that.
Invariant: for a Cartesian leg the TCP's distance is x * travel / length exactly; lines and arcs are closed forms.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from mitl.errors import MitlError
from mitl.motion.orientation import EvenTurn, HeldWrist, Turn
from mitl.paths import FloatArray

TURNING_RADIUS = 0.1
"""Length in m that a radian of turning counts for where the TCP hardly moves. ASSUMPTION A-02."""

LONGEST_ARC = np.radians(240.0)
"""RAPID's own limit of one MoveC (`facts/rapid.md`, from memory). ASSUMPTION A-03."""
CLOSEST_ARC_POINTS = 0.1e-3
"""Least distance in m of a MoveC's three points (`facts/rapid.md`, from memory). ASSUMPTION A-03."""


class GeometryError(MitlError):
    """A leg cannot be made from its points; says why."""


@dataclass(frozen=True, eq=False)
class Line:
    """A straight line from p_start (3,) along direction (3,), unit; travel in m."""

    p_start: FloatArray
    direction: FloatArray
    travel: float

    def position(self, distance: FloatArray) -> FloatArray:
        """Gives points (N, 3) at distances (N,) in m from the start."""
        return self.p_start + distance[:, None] * self.direction


@dataclass(frozen=True, eq=False)
class Arc:
    """A circle's arc: centre (3,), radius m, orthonormal u towards the start and v along the first tangent; travel in m.

    via: the programmed middle point's distance in m along the arc.
    """

    centre: FloatArray
    radius: float
    u: FloatArray
    v: FloatArray
    travel: float
    via: float = 0.0

    def position(self, distance: FloatArray) -> FloatArray:
        """Gives points (N, 3) at distances (N,) in m along the arc from the start."""
        angle = distance[:, None] / self.radius
        return self.centre + self.radius * (np.cos(angle) * self.u + np.sin(angle) * self.v)


def line_through(start: FloatArray, end: FloatArray) -> Line:
    """Gives the line between two points (3,); of no length if they coincide."""
    travel = float(np.linalg.norm(end - start))
    direction = (end - start) / travel if travel > 1e-12 else np.array([1.0, 0.0, 0.0])
    return Line(start, direction, travel)


def arc_through(start: FloatArray, via: FloatArray, end: FloatArray) -> Arc:
    """Gives the arc from `start` over `via` to `end`, each (3,) in m.

    Raises GeometryError where two points coincide, all three lie on a line, or the arc is longer than RAPID allows.
    """
    to_via, to_end = via - start, end - start
    closest = min(float(np.linalg.norm(d)) for d in (to_via, to_end, end - via))
    if closest < CLOSEST_ARC_POINTS:
        raise GeometryError(
            f"the points of the circle are {1e3 * closest:.3g} mm apart, at least {1e3 * CLOSEST_ARC_POINTS:g} mm is needed"
        )
    normal = np.cross(to_via, to_end)
    twice_area = float(np.linalg.norm(normal))
    if twice_area < 1e-6 * np.linalg.norm(to_via) * np.linalg.norm(to_end):
        raise GeometryError("the three points of the circle lie on a line")
    axis = normal / twice_area
    to_centre = (np.dot(to_end, to_end) * np.cross(normal, to_via) + np.dot(to_via, to_via) * np.cross(to_end, normal)) / (
        2 * twice_area**2
    )
    centre = start + to_centre
    radius = float(np.linalg.norm(to_centre))
    u = -to_centre / radius
    v = np.cross(axis, u)
    at_via, angle = (float(np.arctan2(np.dot(point - centre, v), np.dot(point - centre, u))) % (2 * np.pi) for point in (via, end))
    if angle > LONGEST_ARC + 1e-9:
        raise GeometryError(f"the arc turns by {np.degrees(angle):.1f} deg, more than the {np.degrees(LONGEST_ARC):.0f} deg of one MoveC")
    return Arc(centre, radius, u, v, radius * angle, radius * at_via)


@dataclass(frozen=True, eq=False)
class CartesianLeg:
    """MoveL or MoveC: the TCP on a curve in the base frame, the tool turning as `turn` says.

    track (K, 6) rad: the joints at coordinates marks (K,), from start to end, where its solutions were followed: close together only near
    a singularity. X_FT: the tool.
    """

    curve: Line | Arc
    turn: Turn
    X_FT: RigidTransform
    marks: FloatArray
    track: FloatArray

    @cached_property
    def q_start(self) -> FloatArray:
        """Gives the joints (6,) rad at the leg's start."""
        return np.asarray(self.track[0])

    @cached_property
    def q_end(self) -> FloatArray:
        """Gives the joints (6,) rad at the leg's end."""
        return np.asarray(self.track[-1])

    @property
    def travel(self) -> float:
        """Gives the TCP's way in m."""
        return self.curve.travel

    @property
    def turning(self) -> float:
        """Gives the angle in rad by which the tool would turn if it did all along as at its quickest."""
        return self.turn.turning

    @cached_property
    def length(self) -> float:
        """Gives the range of the leg's coordinate in m: the TCP's way, or more where the leg is mostly turning."""
        return max(self.travel, TURNING_RADIUS * self.turning)

    def position(self, x: FloatArray) -> FloatArray:
        """Gives TCP positions (N, 3) in m at coordinates (N,)."""
        return self.curve.position(x * (self.travel / self.length if self.length > 0 else 0.0))

    def coordinate(self, way: float) -> float:
        """Gives the coordinate in m at which the TCP has come `way` m."""
        return way * self.length / self.travel

    def share(self, x: FloatArray) -> FloatArray:
        """Gives the share (N,) of the leg that is done at coordinates (N,)."""
        return x / self.length if self.length > 0 else np.zeros_like(x)

    def rotation(self, x: FloatArray) -> Rotation:
        """Gives tool rotations at coordinates (N,); not to be asked where the wrist's axes decide (`held_wrist`)."""
        assert not isinstance(self.turn, HeldWrist)  # noqa: S101 - the arm has to be asked, see above
        return self.turn.rotation(self.share(x))

    def matrices(self, x: FloatArray) -> FloatArray:
        """Gives `rotation` as matrices (N, 3, 3)."""
        if isinstance(self.turn, EvenTurn) and self.turn.turning == 0:
            return np.broadcast_to(self.turn.R_start.as_matrix(), (len(x), 3, 3))
        return self.rotation(x).as_matrix()

    @property
    def held_wrist(self) -> HeldWrist | None:
        """Gives the law of the wrist's axes where they are interpolated; None where the orientation is."""
        return self.turn if isinstance(self.turn, HeldWrist) else None

    def joints_near(self, x: float) -> FloatArray:
        """Gives joints (6,) in rad near those at a coordinate, of the same solution."""
        return np.array([np.interp(x, self.marks, values) for values in self.track.T])


@dataclass(frozen=True, eq=False)
class JointLeg:
    """MoveJ or MoveAbsJ: joints on a straight line from q_start to q_end (6,) rad.

    travel: the TCP's way in m, by quadrature. fastest, quickest: the TCP's greatest way in m, and turn in rad, per whole leg passed.
    ways (K,) m: the TCP's way at even shares of the leg, from 0 to travel; None where it runs evenly.
    """

    q_start: FloatArray
    q_end: FloatArray
    X_FT: RigidTransform
    travel: float
    fastest: float
    quickest: float
    ways: FloatArray | None = None

    @cached_property
    def turning(self) -> float:
        """Gives the largest joint's way in rad."""
        return float(np.abs(self.q_end - self.q_start).max())

    @cached_property
    def length(self) -> float:
        """Gives the range of the leg's coordinate in m."""
        return max(self.travel, TURNING_RADIUS * self.turning)

    def coordinate(self, way: float) -> float:
        """Gives the coordinate in m at which the TCP has come `way` m."""
        if self.ways is None:
            return way * self.length / self.travel
        return self.length * float(np.interp(way, self.ways, np.linspace(0.0, 1.0, len(self.ways))))

    def joints_near(self, x: float) -> FloatArray:
        """Gives the joints (6,) in rad at a coordinate."""
        return np.asarray(self.joints(np.array([x]))[0])

    def joints(self, x: FloatArray) -> FloatArray:
        """Gives joints (N, 6) in rad at coordinates (N,)."""
        share = x / self.length if self.length > 0 else np.zeros_like(x)
        return self.q_start + share[:, None] * (self.q_end - self.q_start)


Leg = CartesianLeg | JointLeg
