"""Conveyor belts: how a belt is built, and where it has been and will be.

Invariant: what a belt did before a command stays; what comes after it is what the belt does if no further command comes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from mitl.paths import FloatArray

_STANDS = 1e-12


@dataclass(frozen=True, eq=False)
class Conveyor:
    """A belt with an encoder, which moves its frame along the frame's own x axis.

    unit: the mechanical unit that RAPID's work objects name. X_BU: its frame in the base where the encoder counts 0, at the sensor that
    sees work pieces. counts_per_m: of the encoder. speed: m/s from the beginning on. speed_signal: the output that commands the drive in
    mm/s, or "". position_signal: the input that tells how far it is in mm, or "". acceleration: m/s^2 with which the drive changes it.
    length: m; where it has a drive of its own, a belt stops at its home, 0, and there. farthest: m behind the sensor at which a work piece
    can no longer be followed. pieces: (K,) m before the sensor at which work pieces lie while the encoder counts 0, ascending.
    """

    name: str
    unit: str
    X_BU: RigidTransform
    counts_per_m: float
    speed: float = 0.0
    speed_signal: str = ""
    position_signal: str = ""
    acceleration: float = math.inf
    length: float = math.inf
    farthest: float = math.inf
    pieces: tuple[float, ...] = (0.0,)

    @property
    def direction(self) -> FloatArray:
        """Gives the belt's direction (3,) in the base."""
        return np.asarray(self.X_BU.rotation.as_matrix()[:, 0])

    def frame_at(self, counts: float) -> RigidTransform:
        """Gives X_BU when the encoder has counted so far."""
        return RigidTransform.from_translation(self.direction * counts / self.counts_per_m) * self.X_BU


class Belt:
    """The motion of one belt, in pieces of even acceleration from some time on."""

    def __init__(self, conveyor: Conveyor, time: float = 0.0) -> None:
        self.conveyor = conveyor
        self.restart(time)

    def restart(self, time: float) -> None:
        """Puts the belt back to its home at `time` s, running at its own speed."""
        self._time, self._position = [time], [0.0]
        self._speed, self._acceleration = [self.conveyor.speed], [0.0]

    def command(self, speed: float, time: float) -> None:
        """Has the drive go over to a speed in m/s from `time` s on."""
        here, now = self.position(time), self.speed_at(time)
        while len(self._time) > 1 and self._time[-1] >= time:
            for values in (self._time, self._position, self._speed, self._acceleration):
                values.pop()
        self._go_over(time, here, now, speed)
        if self.conveyor.speed_signal:
            self._stop_at_the_ends(time, speed)

    def position(self, time: float) -> float:
        """Gives the way in m that the belt has gone at `time` s; 0 is its home."""
        return float(self.positions(np.array([time]))[0])

    def positions(self, time: FloatArray) -> FloatArray:
        """Gives the ways (N,) in m that the belt has gone at times (N,) s."""
        k, since = self._since(time)
        position, speed, acceleration = (np.array(values)[k] for values in (self._position, self._speed, self._acceleration))
        return np.asarray(position + since * (speed + 0.5 * acceleration * since))

    def speed_at(self, time: float) -> float:
        """Gives the belt's speed in m/s at `time` s."""
        return float(self.speeds(np.array([time]))[0])

    def speeds(self, time: FloatArray) -> FloatArray:
        """Gives the belt's speeds (N,) in m/s at times (N,) s."""
        k, since = self._since(time)
        return np.asarray(np.array(self._speed)[k] + np.array(self._acceleration)[k] * since)

    def when_at(self, position: float, since: float) -> float:
        """Gives the time in s, `since` or later, at which the belt has gone `position` m or more, as it runs now; inf if it will not."""
        if self.position(since) >= position:
            return since
        starts = [*self._time, math.inf]
        for k, begin in enumerate(self._time):
            time = self._crosses(k, position - self._position[k])
            if max(begin, since) <= begin + time <= starts[k + 1]:
                return begin + time
        return math.inf

    def was_back_at(self, position: float, since: float, now: float) -> bool:
        """Gives whether the belt has been back at `position` m or before it after `since` s, up to `now`."""
        nodes = [time for time in self._time if since < time <= now]
        return any(self.position(time) <= position + _STANDS for time in [*nodes, now])

    # -------------------------------------------------------------------------------------------------------------------------

    def _go_over(self, time: float, position: float, now: float, speed: float) -> None:
        """Adds the pieces in which the belt goes over from one speed to another, from a time and place on."""
        ramp = abs(speed - now) / self.conveyor.acceleration
        if ramp > _STANDS:
            self._append(time, position, now, math.copysign(self.conveyor.acceleration, speed - now))
        self._append(time + ramp, position + 0.5 * (now + speed) * ramp, speed, 0.0)

    def _append(self, time: float, position: float, speed: float, acceleration: float) -> None:
        if time <= self._time[-1]:  # a command at the very time of the last one takes its place
            for values in (self._time, self._position, self._speed, self._acceleration):
                values.pop()
        self._time.append(time)
        self._position.append(position)
        self._speed.append(speed)
        self._acceleration.append(acceleration)

    def _since(self, time: FloatArray) -> tuple[np.ndarray[tuple[int], np.dtype[np.intp]], FloatArray]:
        """Gives the piece (N,) in which times (N,) s lie and the time (N,) since its start; before the first piece the belt stands."""
        starts = np.array(self._time)
        k = np.maximum(np.searchsorted(starts, time, side="right") - 1, 0)
        return k, np.maximum(time - starts[k], 0.0)

    def _crosses(self, k: int, way: float) -> float:
        """Gives after how many s of piece k the belt has gone `way` m of it, going forwards; inf if it does not."""
        speed, acceleration = self._speed[k], self._acceleration[k]
        if abs(acceleration) < _STANDS:
            return way / speed if speed > _STANDS and way >= 0 else math.inf
        root = speed * speed + 2 * acceleration * way
        if root < 0:
            return math.inf
        times = [time for time in ((-speed + sign * math.sqrt(root)) / acceleration for sign in (-1, 1)) if time >= 0]
        return min(times, default=math.inf)

    def _stop_at_the_ends(self, since: float, wanted: float) -> None:
        """Lets the belt stand from where it reaches one of its ends, home or its length; it leaves an end where the wanted speed does."""
        first = next((k for k, time in enumerate(self._time) if time >= since), len(self._time) - 1)
        for k in range(first, len(self._time)):
            until = self._time[k + 1] if k + 1 < len(self._time) else math.inf
            for end, outward in ((0.0, -1.0), (self.conveyor.length, 1.0)):
                time = self._leaves(k, end, outward)
                if self._time[k] + time < until:
                    for values in (self._time, self._position, self._speed, self._acceleration):
                        del values[k + 1 :]
                    self._append(self._time[k] + time, end, 0.0, 0.0)
                    if outward * wanted < 0:
                        self._go_over(self._time[-1], end, 0.0, wanted)
                        self._stop_at_the_ends(self._time[-1], wanted)
                    return

    def _leaves(self, k: int, end: float, outward: float) -> float:
        """Gives after how many s of piece k the belt passes an end outwards; inf if it does not."""
        if not math.isfinite(end):
            return math.inf
        way, speed, acceleration = (outward * value for value in (end - self._position[k], self._speed[k], self._acceleration[k]))
        if abs(acceleration) < _STANDS:
            return max(way, 0.0) / speed if speed > _STANDS else math.inf
        root = speed * speed + 2 * acceleration * max(way, 0.0)
        if root < 0:
            return math.inf
        times = [time for time in ((-speed + sign * math.sqrt(root)) / acceleration for sign in (-1, 1)) if time >= -_STANDS]
        leaving = [max(time, 0.0) for time in times if speed + acceleration * (time + 1e-9) > 0]
        return min(leaving, default=math.inf)
