"""What happens to a tracker at instants: creep and glitches after stops, losses, jumps of the frame.

Invariant: as in noise.py, one call with N samples and N calls with one give the same numbers; every effect owns its generators,
draws a fixed number of variates an event, in the order of the events, and carries its state from call to call.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.paths import BoolArray, FloatArray
from mitl.simulation.noise import lengths, low_pass, times_matrix
from mitl.simulation.quaternions import product
from mitl.simulation.tracker_parameters import CreepAfterStop, FrameJump, Glitch, Loss


class Creep:
    """The body creeps in its mount: towards a new offset after each stop, back to zero while it moves.

    ASSUMPTION A-50: one first-order lag; nothing of it wanders in motion, because what did would outlast the stop, and the thesis's centre
    came back within .25 mm (table 4.4).
    """

    def __init__(self, targets: np.random.Generator, habits: np.random.Generator, creep: CreepAfterStop, period: float) -> None:
        self._targets = targets
        self._habit = Habit(habits)
        self._share = creep.repeatable_share
        self._decay = math.exp(-period / creep.tau_s)
        self._target_sd = creep.rate_m_s * creep.tau_s
        self._target: FloatArray = np.zeros(3)
        self._state: FloatArray = np.zeros((1, 3))

    def sample(self, position: FloatArray, moving: BoolArray, stops: BoolArray) -> FloatArray:
        """Gives the next offsets (N, 3) in m for a body at position (N, 3); moving (N,): it moves; stops (N,): first sample at rest."""
        count = len(moving)
        drive = np.zeros((count, 3))
        if self._target_sd == 0.0:
            return drive
        if not np.all(moving):
            drawn = self._targets.standard_normal((np.count_nonzero(stops), 3))
            if self._share > 0.0 and len(drawn):
                drawn = math.sqrt(1.0 - self._share) * drawn + math.sqrt(self._share) * self._habit.at(position[stops])
            drawn *= self._target_sd
            targets = np.concatenate([self._target[np.newaxis, :], drawn])
            pull = (1.0 - self._decay) * targets
            still = ~moving
            drive[still] = pull[np.cumsum(stops)[still]] if len(drawn) else pull[0]
            self._target = targets[-1]
        offsets, self._state = low_pass(drive, self._decay, self._state)
        return offsets

    def skip(self, count: int) -> None:
        """Lets `count` samples pass at rest."""
        offset = self._state[0] / self._decay
        self._state = ((self._target + (offset - self._target) * self._decay**count) * self._decay)[np.newaxis, :]


class Habit:
    """A smooth random direction (3,), of length sqrt 3, by where the body stops and by the way there: its numbers have variance 1.

    Sum of plane waves over the six coordinates. ASSUMPTION A-78: it changes over 10 cm of place and of way.
    """

    _WAVES, _LENGTH = 16, 0.1

    def __init__(self, generator: np.random.Generator) -> None:
        self._wave_vectors = generator.standard_normal((self._WAVES, 3, 6)) / self._LENGTH
        self._phases = generator.uniform(0.0, 2.0 * math.pi, (self._WAVES, 3))
        self._last: FloatArray = np.zeros(3)

    def at(self, stops: FloatArray) -> FloatArray:
        """Gives the numbers (K, 3) for the next stops (K, 3) in m."""
        found = np.empty_like(stops)
        for row, stop in enumerate(stops):
            place_and_way = np.concatenate([stop, stop - self._last])
            found[row] = np.cos((self._wave_vectors * place_and_way).sum(axis=2) + self._phases).sum(axis=0)
            self._last = stop
        return found * (math.sqrt(3.0) / lengths(found)[:, np.newaxis])


class Glitches:
    """A short wrong position at a random moment after some stops, and now and then in motion."""

    def __init__(
        self,
        moments: np.random.Generator,
        directions: np.random.Generator,
        in_motion: np.random.Generator,
        glitch: Glitch,
        period: float,
    ) -> None:
        self._moments = moments
        self._directions = directions
        self._in_motion = in_motion
        self._glitch = glitch
        self._period = period
        self._length = max(1, round(glitch.duration_s / period))
        self._now = 0
        self._pulses: list[tuple[int, int, FloatArray]] = []
        self._samples_between = 1.0 / (glitch.rate_in_motion_hz * period) if glitch.rate_in_motion_hz > 0.0 else math.inf
        self._left = in_motion.exponential() * self._samples_between

    def skip(self, count: int) -> None:
        """Lets `count` samples pass at rest."""
        self._now += count

    def add(self, errors: FloatArray, moving: BoolArray, stops: BoolArray) -> None:
        """Adds the next position errors in m to `errors` (N, 3), which it changes; moving and stops (N,) as for Creep."""
        if self._glitch.probability_per_stop > 0.0:
            self._after_stops(stops)
        if self._samples_between < math.inf:
            self._while_moving(moving)
        for first, after, error in self._pulses:
            errors[max(0, first - self._now) : max(0, after - self._now)] += error
        self._now += len(stops)
        self._pulses = [pulse for pulse in self._pulses if pulse[1] > self._now]

    def _after_stops(self, stops: BoolArray) -> None:
        for stop in np.flatnonzero(stops):
            chance, moment = self._moments.random(2)
            direction = self._directions.standard_normal((1, 3))
            if chance < self._glitch.probability_per_stop:
                first = self._now + int(stop) + round(moment * self._glitch.within_s / self._period)
                self._pulse(first, direction, self._glitch.size_m)

    def _while_moving(self, moving: BoolArray) -> None:
        """Begins a pulse whenever the body has moved for as many samples as were drawn."""
        count = int(np.count_nonzero(moving))
        while self._left < count:
            index = np.flatnonzero(moving)[int(self._left)]
            size = self._glitch.mean_size_in_motion_m * self._in_motion.exponential()
            self._pulse(self._now + int(index), self._in_motion.standard_normal((1, 3)), size)
            self._left += max(1.0, self._in_motion.exponential() * self._samples_between)
        self._left -= count

    def _pulse(self, first: int, direction: FloatArray, size: float) -> None:
        self._pulses.append((first, first + self._length, (direction / lengths(direction) * size)[0]))


class Losses:
    """Tracking is lost at random instants for a fixed time."""

    def __init__(self, generator: np.random.Generator, loss: Loss, period: float) -> None:
        self._generator = generator
        self._probability = loss.rate_per_s * period
        self._length = max(1, round(loss.duration_s / period))
        self._remaining = 0
        self._was_lost = False

    def sample(self, count: int) -> tuple[BoolArray, BoolArray]:
        """Gives lost (count,) and found (count,): true at the first sample after a loss."""
        lost = np.zeros(count, dtype=np.bool_)
        if self._probability == 0.0:
            return lost, lost.copy()
        lost_until = self._remaining
        lost[:lost_until] = True
        for begin in np.flatnonzero(self._generator.random(count) < self._probability):
            if begin >= lost_until:
                lost_until = int(begin) + self._length
                lost[begin:lost_until] = True
        self._remaining = max(0, lost_until - count)
        before = np.concatenate([[self._was_lost], lost[:-1]])
        self._was_lost = bool(lost[-1]) if count else self._was_lost
        return lost, before & ~lost


class FrameJumps:
    """The tracker's frame may move when tracking is found again, and stays moved: X_L'M = X_L'L X_LM, with L' the new frame.

    `followed` gives the same frame to another device of the session, which is sampled after this one. ASSUMPTION A-184: only this device's
    re-acquisitions move the frame.
    """

    def __init__(self, chances: np.random.Generator, jumps: np.random.Generator, frame_jump: FrameJump) -> None:
        self._chances = chances
        self._jumps = jumps
        self._parameters = frame_jump
        self._rotation = Rotation.identity()
        self._translation: FloatArray = np.zeros(3)
        self._history: list[tuple[float, Rotation, FloatArray]] = []

    def apply(
        self, times: FloatArray, position: FloatArray, quaternion_wxyz: FloatArray, found: BoolArray
    ) -> tuple[FloatArray, FloatArray]:
        """Gives position (N, 3) and quaternion (N, 4) in the frame as it is at times (N,); found (N,): tracking comes back here."""
        for index in np.flatnonzero(found):
            if self._chances.random() < self._parameters.probability_per_reacquisition:
                self._jump(position[index])
                self._history.append((float(times[index]), self._rotation, self._translation))
        return self.followed(times, position, quaternion_wxyz)

    def followed(self, times: FloatArray, position: FloatArray, quaternion_wxyz: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gives poses of any device of the session in the frame as it is at times (N,)."""
        if not self._history or times[-1] < self._history[0][0]:
            return position, quaternion_wxyz
        position, quaternion_wxyz = position.copy(), quaternion_wxyz.copy()
        begins = [*np.searchsorted(times, [time for time, _, _ in self._history]).tolist(), len(times)]
        for (_, rotation, translation), (begin, end) in zip(self._history, pairwise(begins), strict=True):
            part = slice(begin, end)
            position[part] = times_matrix(rotation.as_matrix(), position[part]) + translation
            quaternion_wxyz[part] = product(rotation.as_quat(scalar_first=True)[np.newaxis], quaternion_wxyz[part])
        return position, quaternion_wxyz

    def _jump(self, position: FloatArray) -> None:
        """Moves the frame so that it turns about the body at `position` (3,): what is seen jumps by the translation drawn."""
        drawn = self._jumps.standard_normal(6)
        angle = math.radians(self._jumps.uniform(self._parameters.rotation_min_deg, self._parameters.rotation_max_deg))
        turn = Rotation.from_rotvec(drawn[3:] / lengths(drawn[np.newaxis, 3:]) * angle)
        shown = self._rotation.apply(position) + self._translation
        shift = drawn[:3] * np.asarray(self._parameters.translation_sd_m)
        self._rotation = turn * self._rotation
        self._translation = shown + shift - self._rotation.apply(position)
