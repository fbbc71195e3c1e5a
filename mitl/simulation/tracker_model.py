"""The sensor model of a tracker as a function of arrays: true poses of the body in, samples as the tracker reports them out.

Invariant: same parameters, same seed, same truth give the same samples, bit for bit, however the truth is cut into calls.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum, auto
from typing import Protocol

import numpy as np
from scipy.special import ndtri

from mitl.paths import BoolArray, FloatArray, PosePath
from mitl.samples import TrackerSamples, TrackingResult
from mitl.simulation.noise import HeldField, LocationField, OrnsteinUhlenbeck, lengths, slow_or_not, times_matrix
from mitl.simulation.quaternions import small_turn, turned
from mitl.simulation.tracker_effects import Creep, FrameJumps, Glitches, Losses
from mitl.simulation.tracker_parameters import Distortion, TrackerParameters
from mitl.simulation.tracker_states import Held, Occlusions, Shocks, Sleeping, updates

_MOST_AT_ONCE = 8192
"""Samples that are computed together: more no longer fit the processor's cache."""


class SensorModel(Protocol):
    """Makes samples of true poses; may carry state from call to call."""

    @property
    def period(self) -> float:
        """Gives the time between samples in s."""
        ...

    def sample(self, times: FloatArray, positions: FloatArray, quaternions_wxyz: FloatArray) -> TrackerSamples:
        """Gives the samples at the next instants `times` (N,) in s, of true positions (N, 3) in m and quaternions (N, 4) of M in L."""
        ...

    def skip(self, seconds: float) -> None:
        """Lets `seconds` pass without samples, the body at rest."""
        ...


class _Draw(IntEnum):
    """What a generator is for. Each purpose has its own, so that adding one leaves the others' numbers as they were: append only."""

    FAST_POSITION = auto()
    SLOW_POSITION = auto()
    MOVING_POSITION = auto()
    FAST_ORIENTATION = auto()
    SLOW_ORIENTATION = auto()
    TIME = auto()
    GAIN_FIELD = auto()
    DRIFT_FIELD = auto()
    DRIFT = auto()
    CREEP_WANDER = auto()  # no longer drawn
    CREEP_TARGET = auto()
    GLITCH_MOMENT = auto()
    GLITCH_DIRECTION = auto()
    LOSS = auto()
    JUMP_CHANCE = auto()
    JUMP = auto()
    FORMER_DRIFT = auto()
    SLEEP = auto()
    OCCLUSION = auto()
    ONE_BASE = auto()
    VELOCITY = auto()
    SHOCK = auto()
    SHOCK_LENGTH = auto()
    CREEP_HABIT = auto()
    GLITCH_IN_MOTION = auto()


@dataclass(frozen=True)
class Session:
    """A session of a device that has been on for `elapsed` s: its room and the drift that it began with come from the session's seed."""

    seed: int
    elapsed: float


class TrackerModel:
    """A tracker with the given parameters, and the luck that comes with `seed` (an integer >= 0).

    One object is one stretch of one device's session: it remembers the last true pose, its noise, its frame. Without a `session` of its
    own it begins one. device: number of the device; devices of one seed and session share room and drift and have noise of their own.
    leader: the device whose re-acquisitions move the frame of all; the others are sampled after it.
    Source: facts/tracker.md, fitted model.
    """

    def __init__(
        self,
        parameters: TrackerParameters,
        seed: int,
        session: Session | None = None,
        *,
        device: int = 0,
        leader: TrackerModel | None = None,
    ) -> None:
        session = session or Session(seed, 0.0)

        def draw(purpose: _Draw) -> np.random.Generator:
            return _generator(seed, purpose, device) if device else _generator(seed, purpose)

        def draw_for_all(purpose: _Draw) -> np.random.Generator:
            return _generator(seed, purpose)

        def draw_for_session(purpose: _Draw) -> np.random.Generator:
            return _generator(session.seed, purpose)

        self.parameters = parameters
        period = parameters.period
        noise, turn, place = parameters.position_noise, parameters.orientation_noise, parameters.location
        fast_turn, slow_turn = np.radians([turn.fast_sd_deg, turn.slow_sd_deg])
        self._fast = OrnsteinUhlenbeck(draw(_Draw.FAST_POSITION), noise.fast_sd_m, noise.fast_tau_s, period)
        self._slow = slow_or_not(draw(_Draw.SLOW_POSITION), noise.slow_sd_m, noise.slow_tau_s, period)
        self._moving = OrnsteinUhlenbeck(draw(_Draw.MOVING_POSITION), noise.moving_sd_m, noise.moving_tau_s, period)
        self._fast_turn = OrnsteinUhlenbeck(draw(_Draw.FAST_ORIENTATION), fast_turn, turn.fast_tau_s, period)
        self._slow_turn = slow_or_not(draw(_Draw.SLOW_ORIENTATION), slow_turn, turn.slow_tau_s, period)
        drift = parameters.drift
        former = draw_for_session(_Draw.FORMER_DRIFT).standard_normal(3) * np.asarray(drift.sd_m)
        self._drift = slow_or_not(draw_for_all(_Draw.DRIFT), drift.sd_m, drift.tau_s, period, former=former, elapsed=session.elapsed)
        self._gain_field = HeldField(LocationField(draw_for_session(_Draw.GAIN_FIELD), place.correlation_length_m))
        self._drift_field = HeldField(LocationField(draw_for_session(_Draw.DRIFT_FIELD), place.correlation_length_m))
        self._base_field = HeldField(LocationField(draw_for_session(_Draw.ONE_BASE), parameters.one_base.patch_length_m))
        self._one_base_below = float(ndtri(parameters.one_base.share))
        self._time_errors = draw(_Draw.TIME)
        habits = draw_for_session(_Draw.CREEP_HABIT)
        self._creep = Creep(draw(_Draw.CREEP_TARGET), habits, parameters.creep, period)
        glitches = draw(_Draw.GLITCH_MOMENT), draw(_Draw.GLITCH_DIRECTION), draw(_Draw.GLITCH_IN_MOTION)
        self._glitches = Glitches(*glitches, parameters.glitch, period)
        self._losses = Losses(draw(_Draw.LOSS), parameters.loss, period)
        self._occlusions = Occlusions(draw(_Draw.OCCLUSION), parameters.occlusion, period)
        self._sleeping = Sleeping(draw(_Draw.SLEEP), parameters.sleep, period)
        self._velocity = OrnsteinUhlenbeck(draw(_Draw.VELOCITY), parameters.velocity.sd_m_s, parameters.velocity.tau_s, period)
        self._shocks = Shocks(draw(_Draw.SHOCK_LENGTH), parameters.shock, period)
        # ASSUMPTION A-75: what a shock does to positions is correlated over 20 ms.
        self._shock_error = OrnsteinUhlenbeck(draw(_Draw.SHOCK), parameters.shock.position_sd_m, 0.02, period)
        self._frame = FrameJumps(draw(_Draw.JUMP_CHANCE), draw(_Draw.JUMP), parameters.frame_jump)
        self._leader = leader
        self._held = Held()
        self._distortion = _distortion_matrix(parameters.distortion)
        self._axis_factors = np.asarray(noise.axis_factors)
        self._last: tuple[FloatArray, FloatArray, FloatArray] | None = None
        self._last_step: FloatArray = np.zeros((1, 3))
        self._was_moving = False

    @property
    def period(self) -> float:
        """Gives the time between samples in s."""
        return self.parameters.period

    def measure(self, times: FloatArray, positions: FloatArray, quaternions_wxyz: FloatArray) -> PosePath:
        """Gives the poses of `sample`."""
        return self.sample(times, positions, quaternions_wxyz).path

    def sample(self, times: FloatArray, positions: FloatArray, quaternions_wxyz: FloatArray) -> TrackerSamples:
        """Gives the samples at the next instants `times` (N,) in s, of true positions (N, 3) in m and quaternions (N, 4) of M in L.

        Times are `period` apart; after a gap the body counts as having stood still. A lost sample is not valid and its pose zero
        (origin, identity), as the real one's. No button is pressed: buttons have wires of their own (tracker_button.py).
        """
        count = len(times)
        if count == 0:
            return TrackerSamples.joined([])
        if count > _MOST_AT_ONCE:
            cuts = range(0, count, _MOST_AT_ONCE)
            parts = [slice(begin, begin + _MOST_AT_ONCE) for begin in cuts]
            return TrackerSamples.joined([self.sample(times[part], positions[part], quaternions_wxyz[part]) for part in parts])
        last_time = self._last[0][0] if self._last else times[0] - self.period
        before, turned_from = self._poses_before(times, positions, quaternions_wxyz)
        step = positions - before
        speed = lengths(step) / self.period
        moving, stops = self._phases_of_motion(speed)
        acceleration = self._accelerations(step)
        shock = self._shocks.sample(acceleration)
        velocity_error = self._velocity_errors(acceleration, shock)

        time_error = (self._time_errors.standard_normal(count) * self.parameters.sampling.time_jitter_s / self.period)[:, np.newaxis]
        output, new = self.parameters.output, None
        if output.mode == "OnUpdate":
            new, age = updates(times, float(last_time), output.update_rate_hz)
            time_error -= np.minimum(age / self.period, 1.0)[:, np.newaxis]
        position = self._distort(positions + step * time_error, positions, speed, moving, stops)
        if output.mode == "Predicted" and output.age_s != 0.0:
            position += velocity_error * output.age_s
        if shock is not None:
            position += self._shock_error.sample(count) * shock[:, np.newaxis]
        elif self.parameters.shock.position_sd_m != 0.0:
            self._shock_error.sample(count)
        # All turns are small: adding the rotation vectors is exact to their product, and every one acts in the body's axes.
        turn = small_turn(turned_from, quaternions_wxyz) * time_error
        turn += self._fast_turn.sample(count) + self._slow_turn.sample(count)
        quaternion = turned(quaternions_wxyz, turn)
        return self._states(times, position, quaternion, step / self.period + velocity_error, moving, new)

    def skip(self, seconds: float) -> None:
        """Lets `seconds` pass without samples, the body at rest: slow noise, drift, creep and sleep go on; nothing else happens."""
        for process in (self._slow, self._slow_turn, self._drift):
            process.skip(seconds)
        count = round(seconds / self.period)
        self._creep.skip(count)
        self._glitches.skip(count)
        self._sleeping.skip(count)

    def _states(
        self,
        times: FloatArray,
        position: FloatArray,
        quaternion: FloatArray,
        velocity: FloatArray,
        moving: BoolArray,
        new: BoolArray | None,
    ) -> TrackerSamples:
        """Gives the samples as the device's states leave them: asleep, occluded, lost, its frame jumped, its pose held."""
        result = np.full(len(times), TrackingResult.RUNNING_OK, dtype=np.int16)
        lost, found = self._losses.sample(len(times))
        held = None if new is None else ~new
        occluded = self._occlusions.sample(len(times))
        if occluded is not None:
            hidden, gone, seen, error = occluded
            position += error
            lost, found = lost | gone, found | seen
            result[hidden] = TrackingResult.RUNNING_OUT_OF_RANGE
        sleeping = self._sleeping.sample(moving)
        if sleeping is not None:
            asleep, woken = sleeping
            found = found | woken
            held = asleep if held is None else held | asleep
            velocity[asleep] = 0.0
        if self._leader is None:
            position, quaternion = self._frame.apply(times, position, quaternion, found)
        else:
            position, quaternion = self._leader._frame.followed(times, position, quaternion)  # another device of our own kind
        position, quaternion = self._held.apply(position, quaternion, held)
        if np.any(lost):
            position[lost], quaternion[lost], velocity[lost] = 0.0, [1.0, 0.0, 0.0, 0.0], 0.0
            result[lost] = TrackingResult.RUNNING_OUT_OF_RANGE
        return TrackerSamples(PosePath(times, position, quaternion, ~lost), result, np.zeros(len(times), dtype=np.int16), velocity)

    def _accelerations(self, step: FloatArray) -> FloatArray:
        """Gives the size (N,) in m/s^2 of the acceleration that led to each step (N, 3)."""
        change = np.empty_like(step)
        np.subtract(step[1:], step[:-1], out=change[1:])
        change[:1] = step[:1] - self._last_step
        self._last_step = step[-1:].copy()
        return lengths(change) / self.period**2

    def _velocity_errors(self, acceleration: FloatArray, shock: FloatArray | None) -> FloatArray:
        """Gives the errors (N, 3) in m/s of the device's own velocity."""
        growth = 1.0 + acceleration * self.parameters.velocity.per_m_s2
        if shock is not None:
            growth *= 1.0 + shock * (self.parameters.shock.velocity_factor - 1.0)
        return np.asarray(self._velocity.sample(len(acceleration)) * growth[:, np.newaxis])

    def _distort(self, sampled: FloatArray, location: FloatArray, speed: FloatArray, moving: BoolArray, stops: BoolArray) -> FloatArray:
        """Gives the positions seen (N, 3), for those `sampled` at the jittered times; the rest at their nominal ones."""
        count, noise, place = len(sampled), self.parameters.position_noise, self.parameters.location
        fade = np.clip((speed - noise.moving_from_m_s) / (noise.moving_full_m_s - noise.moving_from_m_s), 0.0, 1.0)[:, np.newaxis]
        error = self._moving.sample(count)
        error *= fade
        error += self._fast.sample(count)
        error += self._slow.sample(count)
        error *= self._axis_factors
        error += self._creep.sample(location, moving, stops)
        if place.gain_sd_log == 0.0:
            error *= place.gain_median
        else:
            error *= (place.gain_median * np.exp(place.gain_sd_log * self._gain_field.at(location)))[:, np.newaxis]
        if self.parameters.one_base.share > 0.0:
            error += self._along_the_ray(location, error)
        drift = self._drift.sample(count)
        if place.drift_sd_log != 0.0:
            drift *= np.exp(place.drift_sd_log * self._drift_field.at(location))[:, np.newaxis]
        error += drift
        error += times_matrix(self._distortion, sampled)
        self._glitches.add(error, moving, stops)
        return error

    def _along_the_ray(self, location: FloatArray, error: FloatArray) -> FloatArray:
        """Gives what is added to errors (N, 3) where only one base station sees the body."""
        one_base = self.parameters.one_base
        ray = location - np.asarray(one_base.station_m)
        ray /= np.maximum(lengths(ray), 1e-6)[:, np.newaxis]
        x, y, z = (ray * error).T
        only_one = self._base_field.at(location) < self._one_base_below
        return np.asarray(ray * ((one_base.factor - 1.0) * only_one * (x + y + z))[:, np.newaxis])

    def _poses_before(self, times: FloatArray, positions: FloatArray, quaternions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gives each sample's predecessor, position (N, 3) and quaternion (N, 4); the sample itself after a gap."""
        last_time, last_position, last_quaternion = self._last or (times[:1] - np.inf, positions[:1], quaternions[:1])
        gap = (times - np.concatenate([last_time, times[:-1]]) > 1.5 * self.period)[:, np.newaxis]
        before = np.concatenate([last_position, positions[:-1]])
        turned_from = np.concatenate([last_quaternion, quaternions[:-1]])
        self._last = times[-1:].copy(), positions[-1:].copy(), quaternions[-1:].copy()
        if np.any(gap):
            before, turned_from = np.where(gap, positions, before), np.where(gap, quaternions, turned_from)
        return before, turned_from

    def _phases_of_motion(self, speed: FloatArray) -> tuple[BoolArray, BoolArray]:
        """Gives moving (N,) and stops (N,), the first sample at rest after motion."""
        moving = speed > self.parameters.creep.still_below_m_s
        stops = np.concatenate([[self._was_moving], moving[:-1]]) & ~moving
        self._was_moving = bool(moving[-1])
        return moving, stops


def _generator(*seeds: int) -> np.random.Generator:
    """Gives a generator of its own for so many numbers; the fastest of numpy's, as half the model's time is spent on drawing."""
    return np.random.Generator(np.random.SFC64(seeds))


def _distortion_matrix(distortion: Distortion) -> FloatArray:
    """Gives the upper triangular matrix (3, 3) that positions in L are multiplied by."""
    matrix = np.diag(distortion.scale)
    matrix[0, 1], matrix[0, 2], matrix[1, 2] = np.tan(np.radians(distortion.skew_deg))
    return matrix
