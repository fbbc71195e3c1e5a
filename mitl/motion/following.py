"""How an arm follows work pieces on conveyor belts: which one, where the controller takes it to be, how far the arm is carried.

Moves on a belt are planned where their work piece is when it is connected; from then on the arm is carried with it. Invariant: at any time
the controller knows of a belt only what its encoder has told up to then.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import RigidTransform

from mitl.errors import MitlError
from mitl.motion.conveyor import Belt
from mitl.paths import FloatArray

_LET_GO = 0.2
"""Seconds in which an arm that is let go stops being carried. ASSUMPTION A-278."""


class FollowingError(MitlError):
    """A work piece cannot be connected or followed as told."""


@dataclass(frozen=True)
class Encoder:
    """How a controller reads a belt's encoder. gain: 1 if it counts right. delay: s that it does not know of."""

    gain: float = 1.0
    delay: float = 0.0


@dataclass(eq=False)
class Connection:
    """A work piece that a program has connected: the controller's belief of how far the sensor is behind it, and where that began, in m.

    piece: m before the sensor at which it lay at the encoder's 0. begin: how far it was, as believed, when it was connected.
    let_go: time in s from which on the arm is no longer carried further.
    """

    belt: Belt
    origin: float
    horizon: float
    encoder: Encoder
    piece: float
    begin: float = 0.0
    let_go: float = np.inf

    def believed(self, time: FloatArray) -> FloatArray:
        """Gives how far (N,) in m the piece is past the sensor at times (N,) s of the run, as the controller takes it.

        ASSUMPTION A-277: it makes its own delay, half its filters, good by the belt's speed then; so at an even speed it is right.
        """
        seen = self.origin + time - self.horizon - self.encoder.delay
        ahead = self.belt.positions(seen) + self.horizon * self.belt.speeds(seen)
        return np.asarray(self.encoder.gain * ahead - self.piece)

    def carried(self, time: FloatArray) -> FloatArray:
        """Gives how far (N,) in m the arm is carried with the piece at times (N,) s, from where it was connected."""
        way = self.believed(np.minimum(time, self.let_go)) - self.begin
        since = np.clip(time - self.let_go, 0.0, _LET_GO)
        if np.any(since > 0):
            speed = self.belt.speed_at(self.origin + self.let_go - self.horizon - self.encoder.delay)
            way = way + self.encoder.gain * speed * since * (1 - since / (2 * _LET_GO))
        return np.asarray(way)

    def passed(self, time: FloatArray) -> FloatArray:
        """Gives how far (N,) in m the piece really is past the sensor at times (N,) s of the run."""
        return np.asarray(self.belt.positions(self.origin + time) - self.piece)


@dataclass(frozen=True, eq=False)
class Following:
    """By what share of its belt's way a move is carried, at its beginning and at its end: 0 in the room, 1 with the work piece."""

    connection: Connection
    begin: float
    end: float

    def shares(self, done: FloatArray) -> FloatArray:
        """Gives the shares (N,) after shares (N,) of the move; where it changes, its rate and the rate's begin and end at 0."""
        smooth = done**3 * (10 + done * (6 * done - 15))
        return np.asarray(self.begin + (self.end - self.begin) * smooth)


@dataclass(eq=False)
class _Unit:
    """A belt as a mechanical unit: active, which piece is connected, when which was last connected."""

    belt: Belt
    active: bool = False
    connected: Connection | None = None
    taken: dict[float, float] = field(default_factory=dict)


class ConveyorUnits:
    """The belts of a controller as mechanical units, for one run of a program.

    origin: the belts' time in s at which the run's is 0. horizon: s by which the controller looks ahead. encoder: how it reads them.
    """

    def __init__(self, belts: Sequence[Belt], *, origin: float = 0.0, horizon: float = 0.0, encoder: Encoder | None = None) -> None:
        self._origin = origin
        self._horizon = horizon
        self._encoder = encoder or Encoder()
        self._units = {belt.conveyor.unit.lower(): _Unit(belt) for belt in belts}

    def __contains__(self, unit: str) -> bool:
        """Gives whether there is such a unit."""
        return unit.lower() in self._units

    def activate(self, unit: str, active: bool) -> None:
        """Activates a unit or puts it out of use."""
        self._units[unit.lower()].active = active

    def object_frame(self, unit: str, X_UO: RigidTransform) -> RigidTransform:
        """Gives X_BO of a work object in the unit's frame while its piece is at the sensor."""
        return self._of(unit).belt.conveyor.X_BU * X_UO

    def connected(self, unit: str) -> Connection:
        """Gives the unit's connected piece. Raises FollowingError where there is none."""
        connection = self._of(unit).connected
        if connection is None:
            raise FollowingError(f"no work object of {unit} is connected: WaitWObj comes first")
        return connection

    def arrives(self, unit: str, distance: float, since: float) -> float:
        """Gives the time in s, `since` or later, at which the unit's next piece is `distance` m past its sensor, as its belt runs now."""
        found = self._of(unit)
        piece = self._next(found, since)
        way = (piece + distance) / self._encoder.gain
        return found.belt.when_at(way, self._origin + since) - self._origin

    def expect(self, unit: str) -> None:
        """Raises FollowingError where no piece of the unit can be connected: one is, or the unit is not active."""
        found = self._of(unit)
        if not found.active:
            raise FollowingError(f"{unit} is not active: ActUnit {unit} comes first")
        if found.connected is not None:
            raise FollowingError(f"a work object of {unit} is connected already: DropWObj comes first")

    def connect(self, unit: str, time: float) -> None:
        """Connects the unit's next piece at `time` s. Raises FollowingError where that cannot be, see `expect`."""
        self.expect(unit)
        found = self._of(unit)
        piece = self._next(found, time)
        found.taken[piece] = self._origin + time
        found.connected = Connection(found.belt, self._origin, self._horizon, self._encoder, piece)
        found.connected.begin = float(found.connected.believed(np.array([time]))[0])

    def drop(self, unit: str) -> None:
        """Lets go of the unit's connected piece."""
        self._of(unit).connected = None

    def commanded(self, signal: str, _before: float, value: float, time: float) -> None:
        """Hands an output (name in lower case) that commands a drive on to its belt: mm/s at `time` s of the run."""
        for unit in self._units.values():
            if unit.belt.conveyor.speed_signal.lower() == signal:
                unit.belt.command(1e-3 * value, self._origin + time)

    def inputs(self, others: Callable[[str, float], float] | None) -> Callable[[str, float], float] | None:
        """Gives the inputs by name and time in s: positions in mm of belts that tell it, and all others as `others` has them."""
        telling = {unit.belt.conveyor.position_signal.lower(): unit.belt for unit in self._units.values()}
        telling.pop("", None)
        if not telling:
            return others

        def value(name: str, time: float) -> float:
            belt = telling.get(name.lower())
            if belt is not None:
                return round(1e3 * belt.position(self._origin + time), 6)
            return 0.0 if others is None else others(name, time)

        return value

    def _of(self, unit: str) -> _Unit:
        found = self._units.get(unit.lower())
        if found is None:
            known = ", ".join(unit.belt.conveyor.unit for unit in self._units.values())
            raise FollowingError(
                f"there is no conveyor {unit!r}" + (f"; known are {known}" if known else ": name a cell that has it (--cell)")
            )
        return found

    def _next(self, unit: _Unit, time: float) -> float:
        """Gives the first piece that is still to come, or lies behind the sensor and was not connected since it came there."""
        belt, now = unit.belt, self._origin + time
        for piece in unit.belt.conveyor.pieces:
            since = unit.taken.get(piece)
            if since is None or belt.was_back_at(piece, since, now):
                return piece
        return np.inf
