"""The sensor model in the Drake diagram: takes the true pose every sampling period and hands samples to whoever subscribed.

Invariant: the samples are those that the sensor model gives for the collected truth, whatever the size of the chunks.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from pydrake.systems.framework import Context, LeafSystem

from mitl.paths import FloatArray
from mitl.poses import pose_of, transform_of
from mitl.samples import TrackerSamples
from mitl.simulation.quaternions import product, rotated
from mitl.simulation.tracker_model import SensorModel

Receiver = Callable[[TrackerSamples], None]


class TrackerSystem(LeafSystem):
    """Input `X_WF` (7,). Every period of the model it notes X_LM = X_WL^-1 X_WF X_FM; a full buffer or `flush` makes samples of it.

    The samples leave the diagram by a periodic publish event, Drake's kind of event for what acts on the world outside the simulation:
    nothing in the diagram depends on them. One array call for many samples is what makes the model fast.
    """

    _CAPACITY = 1024

    def __init__(self, model: SensorModel, *, X_WL: FloatArray, X_FM: FloatArray, name: str = "tracker") -> None:
        super().__init__()
        self.set_name(name)
        self._model = model
        self._X_LW = pose_of(transform_of(X_WL).inv())[np.newaxis]
        self._X_FM = pose_of(transform_of(X_FM))[np.newaxis]
        self._receivers: list[Receiver] = []
        self._times = np.empty(self._CAPACITY)
        self._X_WF = np.empty((self._CAPACITY, 7))
        self._count = 0
        self._flange = self.DeclareVectorInputPort("X_WF", 7)
        self.DeclarePeriodicPublishEvent(model.period, 0.0, self._collect)

    @property
    def period(self) -> float:
        """The time between samples in s."""
        return self._model.period

    def skip(self, seconds: float) -> None:
        """Lets time pass without samples."""
        self.flush()
        self._model.skip(seconds)

    def subscribe(self, receiver: Receiver) -> None:
        """Has every chunk of samples handed to `receiver` from now on, times on the world's clock."""
        self.flush()
        self._receivers.append(receiver)

    def flush(self) -> None:
        """Hands over all samples up to now."""
        if self._count:
            times = self._times[: self._count].copy()
            p_WF, q_WF = self._X_WF[: self._count, :3], self._X_WF[: self._count, 3:]
            position = rotated(self._X_LW[:, 3:], p_WF + rotated(q_WF, self._X_FM[:, :3])) + self._X_LW[:, :3]
            quaternion = product(product(self._X_LW[:, 3:], q_WF), self._X_FM[:, 3:])
            quaternion *= np.where(quaternion[:, :1] < 0.0, -1.0, 1.0)
            self._count = 0
            samples = self._model.sample(times, position, quaternion)
            for receiver in self._receivers:
                receiver(samples)

    def drop(self) -> None:
        """Forgets what was collected and not yet handed over."""
        self._count = 0

    def use(self, model: SensorModel) -> None:
        """Goes on with another model of the same period."""
        if model.period != self._model.period:
            raise ValueError(f"the diagram samples every {self._model.period} s, the new model every {model.period} s")
        self.flush()
        self._model = model

    def _collect(self, context: Context) -> None:
        self._times[self._count] = context.get_time()
        self._X_WF[self._count] = np.asarray(self._flange.Eval(context))
        self._count += 1
        if self._count == self._CAPACITY:
            self.flush()
