"""Timing: when a path is where, as cubic pieces of s(t). How they are chosen is `mitl.motion.pace`.

Invariant: the path is passed once and forwards; position, speed and acceleration are continuous.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from ruckig import ControlInterface, InputParameter, Result, Ruckig, Trajectory

from mitl.paths import FloatArray

_SOLVED = (Result.Working, Result.Finished)
"""Ruckig's answers that are trajectories."""
_MOST_NEWTON_STEPS = 60
_FADES = 1 + 1e-9
_ON_THE_SPOT = 1e-15
"""Distance in m from a position that counts as none: the rounding of positions in a path of a metre."""
_STILL = 1e-12
"""Speed in m/s that counts as none."""
_PIECES = ("start", "position", "speed", "acceleration", "jerk")


@dataclass(frozen=True, eq=False)
class Timing:
    """s(t) as cubic pieces. start (K,) s, and at each start position, speed, acceleration, and the piece's jerk (K,); duration s."""

    start: FloatArray
    position: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    jerk: FloatArray
    duration: float

    @property
    def lengths(self) -> FloatArray:
        """Gives how long each piece lasts, (K,) s."""
        return np.asarray(np.diff(self.start, append=self.duration))

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Gives path position m, speed m/s and acceleration m/s^2 at times (N,) in s; it stands before 0 and after the duration."""
        clipped = np.clip(time, 0.0, self.duration)
        piece = np.clip(np.searchsorted(self.start, clipped, side="right") - 1, 0, len(self.start) - 1)
        t = clipped - self.start[piece]
        v0, a0, j = self.speed[piece], self.acceleration[piece], self.jerk[piece]
        position = self.position[piece] + t * (v0 + t * (a0 / 2 + t * j / 6))
        return position, v0 + t * (a0 + t * j / 2), a0 + t * j

    def times_at(self, position: FloatArray) -> FloatArray:
        """Gives the times (N,) in s at which path positions (N,) in m are reached, by Newton steps that a bracket keeps in their piece."""
        begins = np.maximum.accumulate(self.position)
        piece = np.clip(np.searchsorted(begins, position, side="right") - 1, 0, len(begins) - 1)
        v0, a0, j = self.speed[piece], self.acceleration[piece], self.jerk[piece]
        way = position - self.position[piece]
        low, high = np.zeros(len(piece)), self.lengths[piece]
        whole = np.maximum(high * (v0 + high * (a0 / 2 + high * j / 6)), 1e-300)
        share = np.clip(way / whole, 0.0, 1.0)
        from_rest, to_rest = v0 < _STILL, v0 + high * (a0 + high * j / 2) < _STILL
        time = high * np.where(from_rest, np.cbrt(share), np.where(to_rest, 1 - np.cbrt(1 - share), share))  # s grows with t^3 from rest
        for _ in range(_MOST_NEWTON_STEPS):
            ahead = time * (v0 + time * (a0 / 2 + time * j / 6)) - way
            low, high = np.where(ahead < 0, time, low), np.where(ahead < 0, high, time)
            newton = time - ahead / np.maximum(v0 + time * (a0 + time * j / 2), 1e-12)
            following = np.where((newton > low) & (newton < high), newton, 0.5 * (low + high))
            far = np.abs(ahead) > _ON_THE_SPOT
            moved = np.any(far & (following != time))
            time = np.where(far, following, time)
            if not moved:
                break
        return np.asarray(self.start[piece] + time)

    def until(self, time: float) -> Timing:
        """Gives the part of the timing before `time` in s."""
        kept = self.start < time
        kept[0] = True
        return replace(self, **{name: getattr(self, name)[kept] for name in _PIECES}, duration=min(time, self.duration))

    def beyond(self, time: float) -> Timing:
        """Gives the part of the timing after `time` in s, with time counted from there."""
        piece = int(np.clip(np.searchsorted(self.start, time, side="right") - 1, 0, len(self.start) - 1))
        position, speed, acceleration = (value[:1] for value in self.at(np.array([time])))
        cut = {
            "start": np.zeros(1),
            "position": position,
            "speed": speed,
            "acceleration": acceleration,
            "jerk": self.jerk[piece : piece + 1],
        }
        later = {name: getattr(self, name)[piece + 1 :] - (time if name == "start" else 0.0) for name in _PIECES}
        return replace(self, **{name: np.concatenate([cut[name], later[name]]) for name in _PIECES}, duration=self.duration - time)


def standing(position: float) -> Timing:
    """Gives a timing that stands at a path position in m for no time."""
    still = np.zeros(1)
    return Timing(still, np.array([position]), still, still, still, 0.0)


def braked(timing: Timing, time: float, deceleration: float, window: float) -> Timing:
    """Gives the timing followed until `time` s and then brought to rest at `deceleration` m/s^2, smoothed over `window` s."""
    time = min(time, timing.duration)
    kept = timing.until(time)
    position, speed, acceleration = (float(value[0]) for value in timing.at(np.array([time])))
    if speed <= _STILL:
        return kept
    request, answer = InputParameter(1), Trajectory(1)
    request.control_interface = ControlInterface.Velocity
    request.current_position, request.current_velocity, request.current_acceleration = [position], [speed], [acceleration]
    request.target_velocity, request.target_acceleration = [0.0], [0.0]
    request.max_acceleration = [max(deceleration, abs(acceleration))]
    # where it brakes so hard already that it would stand before that has faded, it fades just in time
    request.max_jerk = [max(request.max_acceleration[0] / window, _FADES * min(acceleration, 0.0) ** 2 / (2 * speed))]
    result = Ruckig(1).calculate(request, answer)
    if result not in _SOLVED:
        raise ValueError(f"ruckig could not brake from {speed:.3g} m/s: {result}")
    return _joined([replace(kept, duration=time), _phases(answer)])


def _phases(answer: Trajectory) -> Timing:
    """Gives a one-dimensional ruckig trajectory's seven phases."""
    found = answer.profiles[0][0]
    return Timing(
        start=np.concatenate([[0.0], np.cumsum(found.t)[:-1]]),
        position=np.array(found.p[:7]),
        speed=np.array(found.v[:7]),
        acceleration=np.array(found.a[:7]),
        jerk=np.array(found.j),
        duration=float(sum(found.t)),
    )


def _joined(profiles: Sequence[Timing]) -> Timing:
    """Gives profiles that follow one another as one."""
    begins = np.concatenate([[0.0], np.cumsum([profile.duration for profile in profiles])])
    return Timing(
        start=np.concatenate([profile.start + begin for profile, begin in zip(profiles, begins[:-1], strict=True)]),
        position=np.concatenate([profile.position for profile in profiles]),
        speed=np.concatenate([profile.speed for profile in profiles]),
        acceleration=np.concatenate([profile.acceleration for profile in profiles]),
        jerk=np.concatenate([profile.jerk for profile in profiles]),
        duration=float(begins[-1]),
    )
