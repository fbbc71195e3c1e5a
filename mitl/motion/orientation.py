"""How the tool turns along a leg: evenly, with an arc's frame, over an arc's middle point, or by joint-interpolated wrist axes.

Each law is asked with shares (N,) of the leg, also a little beyond 0 and 1, because corners need that. Invariant: at 0 and 1 the
orientation is the programmed one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.paths import FloatArray

OrientationLaw = Callable[[FloatArray], FloatArray]
"""Share of the leg's turn (N,) that is done at shares (N,) of the leg; may be asked beyond 0 and 1."""

_NO_TURN = 1e-9
"""Below this angle in rad two orientations are the same: RAPID rounds quaternions."""
_STEPS = 64


def evenly(share: FloatArray) -> FloatArray:
    """Gives RAPID's own orientation law: turning in step with the path."""
    return share


@dataclass(frozen=True, eq=False)
class EvenTurn:
    """From R_start by the rotation vector `turn` (3,), body frame, along one axis."""

    R_start: Rotation
    turn: FloatArray
    law: OrientationLaw = evenly

    def rotation(self, share: FloatArray) -> Rotation:
        """Gives R_BT at shares (N,)."""
        return self.R_start * Rotation.from_rotvec(self.law(share)[:, None] * self.turn)

    @cached_property
    def turning(self) -> float:
        """Gives the angle in rad by which the tool turns."""
        return float(np.linalg.norm(self.turn))


@dataclass(frozen=True, eq=False)
class PathFrameTurn:
    """Turning evenly relative to the frame of an arc, which itself turns about `axis` (3,), base frame, by `angle` rad (CirPathMode)."""

    axis: FloatArray
    angle: float
    relative: EvenTurn

    def rotation(self, share: FloatArray) -> Rotation:
        """Gives R_BT at shares (N,)."""
        done = self.relative.law(share)[:, None]
        return Rotation.from_rotvec(done * self.angle * self.axis) * self.relative.rotation(share)

    @cached_property
    def turning(self) -> float:
        """Gives the angle in rad that the tool would turn by at its quickest, all along."""
        return _quickest(self.rotation)


@dataclass(frozen=True, eq=False)
class TurnThrough:
    """Passing R_via at share `at`: the rotation vector from there is the parabola through start (3,), 0 and end (3,). ASSUMPTION A-153."""

    R_via: Rotation
    at: float
    start: FloatArray
    end: FloatArray
    law: OrientationLaw = evenly

    def rotation(self, share: FloatArray) -> Rotation:
        """Gives R_BT at shares (N,)."""
        done = self.law(share)[:, None]
        at_start = (done - self.at) * (done - 1) / self.at
        at_end = done * (done - self.at) / (1 - self.at)
        return self.R_via * Rotation.from_rotvec(at_start * self.start + at_end * self.end)

    @cached_property
    def turning(self) -> float:
        """Gives the angle in rad that the tool would turn by at its quickest, all along."""
        return _quickest(self.rotation)


@dataclass(frozen=True, eq=False)
class HeldWrist:
    r"""SingArea \Wrist: axes 4 to 6 run evenly from start (3,) to end (3,) rad, so that the tool's orientation is what comes of it."""

    start: FloatArray
    end: FloatArray

    def angles(self, share: FloatArray) -> FloatArray:
        """Gives axes 4 to 6 (N, 3) in rad at shares (N,)."""
        return np.asarray(self.start + share[:, None] * (self.end - self.start))

    @property
    def turning(self) -> float:
        """Gives the largest way in rad of the three axes."""
        return float(np.abs(self.end - self.start).max())


Turn = EvenTurn | PathFrameTurn | TurnThrough | HeldWrist


def even_turn(R_start: Rotation, R_end: Rotation, law: OrientationLaw) -> EvenTurn:
    """Gives the shortest even turn between two orientations."""
    if R_start is R_end:
        return EvenTurn(R_start, np.zeros(3), law)
    return EvenTurn(R_start, _vector(R_start.inv() * R_end), law)


def path_frame_turn(R_start: Rotation, R_end: Rotation, axis: FloatArray, angle: float, law: OrientationLaw) -> PathFrameTurn:
    """Gives the turn along an arc about unit `axis` (3,) by `angle` rad that is even as seen from the arc's frame.

    Of the two ways round relative to the frame, the one that turns the tool less in all. ASSUMPTION A-154.
    """
    vector = _vector(R_start.inv() * Rotation.from_rotvec(-angle * axis) * R_end)
    size = float(np.linalg.norm(vector))
    ways = [vector] if size < _NO_TURN else [vector, vector * (1 - 2 * np.pi / size)]
    return min((PathFrameTurn(axis, angle, EvenTurn(R_start, way, law)) for way in ways), key=lambda turn: turn.turning)


def turn_through(R_start: Rotation, R_via: Rotation, R_end: Rotation, at: float, law: OrientationLaw) -> TurnThrough:
    """Gives the turn that passes R_via at share `at` of the way."""
    return TurnThrough(R_via, at, _vector(R_via.inv() * R_start), _vector(R_via.inv() * R_end), law)


def _vector(turn: Rotation) -> FloatArray:
    vector = np.asarray(turn.as_rotvec())
    return np.zeros(3) if np.linalg.norm(vector) < _NO_TURN else vector


def _quickest(rotation: Callable[[FloatArray], Rotation]) -> float:
    turned = rotation(np.linspace(0.0, 1.0, _STEPS + 1))
    fastest = float((turned[:-1].inv() * turned[1:]).magnitude().max()) * _STEPS
    return fastest if fastest > _NO_TURN * _STEPS else 0.0
