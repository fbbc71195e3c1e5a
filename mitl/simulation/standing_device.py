"""A tracked device that stands still: its samples need no event of the diagram, they are made when somebody asks for them.

Invariant: it is sampled at the instants of the diagram's devices, whole periods from time 0, and after the hand.
"""

from __future__ import annotations

import math

import numpy as np

from mitl.paths import FloatArray
from mitl.poses import pose_of, transform_of
from mitl.simulation.tracker_model import SensorModel
from mitl.simulation.tracker_system import Receiver


class StandingDevice:
    """A device at X_WM (7,) in front of a tracker base at X_WL (7,)."""

    def __init__(self, model: SensorModel, *, X_WL: FloatArray, X_WM: FloatArray) -> None:
        self._model = model
        self._X_LM = pose_of(transform_of(X_WL).inv() * transform_of(X_WM))
        self._receivers: list[Receiver] = []
        self._next = 0
        """Number of the next sample; its time is a whole number of periods."""

    @property
    def period(self) -> float:
        """The time between samples in s."""
        return self._model.period

    def subscribe(self, receiver: Receiver) -> None:
        """Has every chunk of samples handed to `receiver` from now on."""
        self._receivers.append(receiver)

    def use(self, model: SensorModel) -> None:
        """Goes on with another model."""
        self._model = model

    def flush(self, now: float) -> None:
        """Makes and hands over all samples up to `now` s."""
        after = math.floor(now / self.period + 1e-6) + 1
        if after <= self._next:
            return
        times = np.arange(self._next, after) * np.float64(self.period)
        self._next = after
        pose = np.tile(self._X_LM, (len(times), 1))
        samples = self._model.sample(times, pose[:, :3], pose[:, 3:])
        for receiver in self._receivers:
            receiver(samples)

    def skip(self, now: float, seconds: float) -> None:
        """Lets `seconds` from `now` on pass without samples."""
        self.flush(now)
        self._model.skip(seconds)
        self._next += round(seconds / self.period)

    def restart(self, time: float) -> None:
        """Goes on from `time` s; what was not handed over is dropped."""
        self._next = math.ceil(time / self.period - 1e-6)
