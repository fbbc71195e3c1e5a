"""The random processes a sensor model is made of, as functions of arrays with carried state.

Invariant: N samples asked for in one call and in N calls are the same numbers, bit for bit. So every process has its own generator,
draws in row order, and adds in a fixed order (no matrix products, whose order of addition depends on the shape).
"""

from __future__ import annotations

import math
from functools import reduce

import numpy as np
from scipy.signal import lfilter

from mitl.paths import FloatArray

_AT_ONCE = 4096


class OrnsteinUhlenbeck:
    """Stationary exponentially correlated noise of three axes, sampled every `period` s; sd (3,), correlation time tau in s.

    former: (3,), what it was `elapsed` s ago; without it, it begins anywhere.
    """

    def __init__(
        self,
        generator: np.random.Generator,
        sd: float | tuple[float, float, float],
        tau: float,
        period: float,
        *,
        former: FloatArray | None = None,
        elapsed: float = math.inf,
    ) -> None:
        self._generator = generator
        self._sd = np.broadcast_to(np.asarray(sd, dtype=float), (3,))
        self._tau = tau
        self._decay = math.exp(-period / tau)
        self._silent = not np.any(self._sd)
        start = np.zeros(3) if self._silent else generator.standard_normal(3) * self._sd
        if former is not None:
            kept = math.exp(-elapsed / tau)
            start = kept * former + math.sqrt(1.0 - kept**2) * start
        self._state: FloatArray = (start * self._decay)[np.newaxis, :]
        self._ready: FloatArray = np.empty((0, 3))  # drawn and not yet handed out: many small draws cost more than a large one

    def sample(self, count: int) -> FloatArray:
        """Gives the next `count` samples (count, 3)."""
        if self._silent:
            return np.zeros((count, 3))
        if len(self._ready) < count:
            lacking = -(-(count - len(self._ready)) // _AT_ONCE) * _AT_ONCE  # whole blocks: what is drawn does not depend on the calls
            white = self._generator.standard_normal((lacking, 3))
            scale = self._sd * math.sqrt(1.0 - self._decay**2)
            white *= scale if np.ptp(scale) else float(scale[0])  # one factor is four times as fast as three
            values, self._state = low_pass(white, self._decay, self._state)
            self._ready = np.concatenate([self._ready, values]) if len(self._ready) else values
        given, self._ready = self._ready[:count], self._ready[count:]
        return given.copy()

    def skip(self, seconds: float) -> None:
        """Lets time pass without samples."""
        if self._silent:
            return
        now = self.sample(1)[0]
        kept = math.exp(-seconds / self._tau)
        later = kept * now + math.sqrt(1.0 - kept**2) * self._generator.standard_normal(3) * self._sd
        self._state, self._ready = (later * self._decay)[np.newaxis, :], np.empty((0, 3))


class SlowOrnsteinUhlenbeck:
    """Ornstein-Uhlenbeck noise that changes little from sample to sample: drawn every 16 samples, straight in between. As above else.

    Sixteen samples are 64 ms: of a process of 5 s the straight pieces lack .3 % of its sd. Drawing every sample took half the model's time.
    """

    _EVERY = 16

    def __init__(
        self,
        generator: np.random.Generator,
        sd: float | tuple[float, float, float],
        tau: float,
        period: float,
        *,
        former: FloatArray | None = None,
        elapsed: float = math.inf,
    ) -> None:
        if tau < 20 * self._EVERY * period:
            raise ValueError(f"expected a correlation time of {20 * self._EVERY * period:g} s or more, got {tau:g} s")
        self._knots = OrnsteinUhlenbeck(generator, sd, tau, self._EVERY * period, former=former, elapsed=elapsed)
        self._silent = not np.any(np.asarray(sd))
        self._next = 0
        self._known: FloatArray = np.empty((0, 3))
        self._first = 0  # the knot that _known begins with

    def sample(self, count: int) -> FloatArray:
        """Gives the next `count` samples (count, 3)."""
        if self._silent or count == 0:
            return np.zeros((count, 3))
        begin, self._next = self._next, self._next + count
        first, last = begin // self._EVERY, (self._next - 1) // self._EVERY + 1
        lacking = last + 1 - (self._first + len(self._known))
        if lacking > 0:
            self._known = np.concatenate([self._known, self._knots.sample(lacking)])
        self._known, self._first = self._known[first - self._first :], first
        begins, rise = self._known[:-1], self._known[1:] - self._known[:-1]
        values = np.empty((len(rise), self._EVERY, 3))
        for step in range(self._EVERY):  # a third of the time that one product of three axes takes
            values[:, step] = begins + rise * (step / self._EVERY)
        offset = begin - first * self._EVERY
        return values.reshape(-1, 3)[offset : offset + count]

    def skip(self, seconds: float) -> None:
        """Lets time pass without samples."""
        self._knots.skip(seconds)
        self._next, self._known, self._first = 0, np.empty((0, 3)), 0


def slow_or_not(
    generator: np.random.Generator,
    sd: float | tuple[float, float, float],
    tau: float,
    period: float,
    *,
    former: FloatArray | None = None,
    elapsed: float = math.inf,
) -> OrnsteinUhlenbeck | SlowOrnsteinUhlenbeck:
    """Gives the process drawn as seldom as its correlation time allows."""
    kind = SlowOrnsteinUhlenbeck if tau >= 400 * period else OrnsteinUhlenbeck
    return kind(generator, sd, tau, period, former=former, elapsed=elapsed)


def low_pass(values: FloatArray, decay: float, state: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gives y[n] = decay y[n-1] + values[n] for values (N, 3), and the state (1, 3) to go on with; state is decay y[-1]."""
    filtered, state = lfilter([1.0], [1.0, -decay], values, axis=0, zi=state)
    return filtered, state


class LocationField:
    """A smooth random function of position: normal over space with mean 0 and variance 1, fixed by the generator.

    Sum of plane waves with normal wave vectors: its correlation falls as a Gaussian of `correlation_length` m.
    """

    _WAVES = 8

    def __init__(self, generator: np.random.Generator, correlation_length: float) -> None:
        self._wave_vectors = generator.standard_normal((3, self._WAVES)) / correlation_length
        self._phases = generator.uniform(0.0, 2.0 * math.pi, self._WAVES)

    def at(self, position: FloatArray) -> FloatArray:
        """Gives the field (N,) at positions (N, 3)."""
        x, y, z = np.ascontiguousarray(position.T)
        k = self._wave_vectors[:, :, np.newaxis]
        waves = np.cos(k[0] * x + k[1] * y + k[2] * z + self._phases[:, np.newaxis])
        total: FloatArray = reduce(np.add, waves) * math.sqrt(2.0 / self._WAVES)
        return total


class HeldField:
    """A location field looked up at every eighth sample and held in between: the body moves 3 cm in that time at most."""

    _EVERY = 8

    def __init__(self, field: LocationField) -> None:
        self._field = field
        self._next = 0
        self._last: FloatArray = np.zeros(1)

    def at(self, position: FloatArray) -> FloatArray:
        """Gives the field (N,) at the next positions (N, 3)."""
        offset = self._next % self._EVERY
        first = (-offset) % self._EVERY
        found = self._field.at(position[first :: self._EVERY]) if first < len(position) else np.empty(0)
        known = np.concatenate([self._last, found]) if offset else found
        self._next += len(position)
        self._last = known[-1:] if len(known) else self._last
        return np.repeat(known, self._EVERY)[offset : offset + len(position)]


def times_matrix(matrix: FloatArray, vectors: FloatArray) -> FloatArray:
    """Gives matrix (3, 3) times each of vectors (N, 3), the same bits for any N."""
    x, y, z = np.ascontiguousarray(vectors.T)
    product = np.empty((len(vectors), 3))
    for axis, (a, b, c) in enumerate(matrix.tolist()):
        product[:, axis] = x * a + y * b + z * c
    return product


def lengths(vectors: FloatArray) -> FloatArray:
    """Gives the lengths (N,) of vectors (N, 3), the same bits for any N."""
    x, y, z = vectors.T
    length: FloatArray = np.sqrt(x * x + y * y + z * z)
    return length
