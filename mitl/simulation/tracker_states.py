"""States of a tracked device that outlast single samples: asleep, occluded, shocked; and poses that are held.

Invariant: as in tracker_effects.py, one call with N samples and N calls with one give the same numbers.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from mitl.paths import BoolArray, FloatArray
from mitl.simulation.tracker_parameters import Occlusion, Shock, Sleep


class Sleeping:
    """The device sleeps after a while at rest, and wakes some time after it was moved again."""

    def __init__(self, generator: np.random.Generator, sleep: Sleep, period: float) -> None:
        self._generator = generator
        self._sleep = sleep
        self._period = period
        self._after = max(1, round(sleep.after_s / period)) if sleep.after_s > 0.0 else 0
        self._rest = 0
        self._asleep = False
        self._waking: int | None = None
        self._woke = False

    def skip(self, count: int) -> None:
        """Lets `count` samples pass at rest; a device that was waking is awake afterwards, or asleep again."""
        if self._after:
            self._rest = min(self._rest + count, self._after)
            self._asleep, self._waking = self._asleep or self._rest >= self._after, None

    def sample(self, moving: BoolArray) -> tuple[BoolArray, BoolArray] | None:
        """Gives asleep (N,) and woken (N,), the first sample after a sleep; None for nobody asleep. moving (N,): the body moves."""
        count = len(moving)
        if self._after == 0:
            return None
        if not self._asleep and not self._woke and self._rest + count < self._after:
            last = np.flatnonzero(moving)
            self._rest = self._rest + count if len(last) == 0 else count - 1 - int(last[-1])
            return None
        asleep, woken = np.zeros(count, dtype=np.bool_), np.zeros(count, dtype=np.bool_)
        if self._woke:
            woken[0], self._woke = True, False
        edges = [0, *(np.flatnonzero(moving[1:] != moving[:-1]) + 1).tolist(), count]
        for begin, end in pairwise(edges):
            self._run(bool(moving[begin]), begin, end, asleep, woken)
        return asleep, woken

    def _run(self, moves: bool, begin: int, end: int, asleep: BoolArray, woken: BoolArray) -> None:
        """Goes on over samples begin to end, in which the body moves or does not."""
        while begin < end:
            if not self._asleep:
                left = end - begin if moves else min(end - begin, self._after - self._rest)
                self._rest = 0 if moves else self._rest + left
                self._asleep = self._rest >= self._after
                begin += left
                continue
            if self._waking is None and moves:
                spread = self._generator.uniform(self._sleep.wake_min_s, self._sleep.wake_max_s)
                self._waking = max(1, round(spread / self._period))
            left = end - begin if self._waking is None else min(end - begin, self._waking)
            asleep[begin : begin + left] = True
            begin += left
            if self._waking is not None:
                self._waking -= left
                if self._waking == 0:
                    self._asleep, self._waking, self._rest = False, None, 0
                    if begin < len(woken):
                        woken[begin] = True
                    else:
                        self._woke = True


class Occlusions:
    """The body is hidden from all base stations at random instants: first it coasts, then it is lost."""

    def __init__(self, generator: np.random.Generator, occlusion: Occlusion, period: float) -> None:
        self._chances, self._generator = generator.spawn(2)
        self._occlusion = occlusion
        self._period = period
        self._probability = occlusion.rate_per_s * period
        self._since = 0
        self._length = 0
        self._coast = 0
        self._errors: FloatArray = np.zeros((2, 3))
        self._was_hidden = False

    def sample(self, count: int) -> tuple[BoolArray, BoolArray, BoolArray, FloatArray] | None:
        """Gives hidden (count,), lost (count,), found (count,) and the error (count, 3) in m while coasting; None for never."""
        if self._probability == 0.0:
            return None
        hidden, lost = np.zeros(count, dtype=np.bool_), np.zeros(count, dtype=np.bool_)
        error = np.zeros((count, 3))
        at = self._go_on(0, hidden, lost, error)
        for begin in np.flatnonzero(self._chances.random(count) < self._probability):
            if begin >= at:
                self._begin()
                at = self._go_on(int(begin), hidden, lost, error)
        before = np.concatenate([[self._was_hidden], hidden[:-1]])
        self._was_hidden = bool(hidden[-1])
        return hidden, lost, before & ~hidden, error

    def _begin(self) -> None:
        o = self._occlusion
        duration, coast = self._generator.uniform([o.duration_min_s, o.coast_min_s], [o.duration_max_s, o.coast_max_s])
        self._errors = self._generator.standard_normal((2, 3)) * [[o.velocity_error_m_s], [0.5 * o.acceleration_error_m_s2]]
        self._since, self._length, self._coast = 0, max(1, round(duration / self._period)), round(coast / self._period)

    def _go_on(self, begin: int, hidden: BoolArray, lost: BoolArray, error: FloatArray) -> int:
        """Fills in the occlusion in progress from sample `begin` on; gives the first sample after it."""
        left = min(self._length - self._since, len(hidden) - begin)
        index = np.arange(self._since, self._since + left)
        chosen = slice(begin, begin + left)
        hidden[chosen], lost[chosen] = True, index >= self._coast
        time = (index * self._period)[:, np.newaxis]
        error[chosen] = self._errors[0] * time + self._errors[1] * time**2
        self._since += left
        return begin + left


class Shocks:
    """How much the IMU is spoilt: 1 at a hard acceleration, falling to 0 over a tenth or two of a second."""

    def __init__(self, generator: np.random.Generator, shock: Shock, period: float) -> None:
        self._generator = generator
        self._shock = shock
        self._period = period
        self._never = shock.position_sd_m == 0.0 and shock.velocity_factor == 1.0
        self._before = False
        self._begun = 0
        self._length = 0

    def sample(self, acceleration: FloatArray) -> FloatArray | None:
        """Gives the share (N,) for accelerations (N,) in m/s^2; None for all zero."""
        if self._never:
            return None
        hard = acceleration > self._shock.from_m_s2
        begins = np.flatnonzero(hard & ~np.concatenate([[self._before], hard[:-1]]))
        self._before = bool(hard[-1])
        if len(begins) == 0 and self._begun >= self._length:
            return None
        share = np.zeros(len(hard))
        self._fade(share, 0)
        for begin in begins:
            spread = self._generator.uniform(self._shock.duration_min_s, self._shock.duration_max_s)
            self._begun, self._length = 0, max(1, round(spread / self._period))
            self._fade(share, int(begin))
        return share

    def _fade(self, share: FloatArray, begin: int) -> None:
        """Fills in the shock in progress from sample `begin` on, over whatever was there of the one before."""
        left = min(self._length - self._begun, len(share) - begin)
        following = len(share)
        if left > 0:
            share[begin : begin + left] = 1.0 - np.arange(self._begun, self._begun + left) / self._length
        share[begin + max(left, 0) : following] = 0.0
        self._begun += following - begin


class Held:
    """Poses that are held over samples that get no new one, across calls too."""

    def __init__(self) -> None:
        self._last: tuple[FloatArray, FloatArray] | None = None

    def apply(self, position: FloatArray, quaternion_wxyz: FloatArray, held: BoolArray | None) -> tuple[FloatArray, FloatArray]:
        """Gives position (N, 3) and quaternion (N, 4), where `held` (N,) is true those of the last sample that is not.

        The very first is never held. None: no sample is held.
        """
        if held is not None and np.any(held):
            first = (position[:1], quaternion_wxyz[:1]) if self._last is None else self._last
            source = np.maximum.accumulate(np.where(held, 0, np.arange(1, len(held) + 1)))
            position = np.concatenate([first[0], position])[source]
            quaternion_wxyz = np.concatenate([first[1], quaternion_wxyz])[source]
        self._last = position[-1:].copy(), quaternion_wxyz[-1:].copy()
        return position, quaternion_wxyz


def updates(times: FloatArray, last: float, rate: float) -> tuple[BoolArray, FloatArray]:
    """Gives whether the device had an event since the sample before (N,), and how long ago the last one was (N,) in s.

    times: (N,) of samples in s. last: time of the sample before them. rate: of the events in Hz.
    """
    number = np.floor(times * rate + 1e-9)
    before = np.floor(np.concatenate([[last], times[:-1]]) * rate + 1e-9)
    return number > before, times - number / rate
