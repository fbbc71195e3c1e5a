"""SimulatedTracker: what a test case sees of the tracker in a simulated world.

Invariant: it knows the samples and nothing else of the world; times are on its own clock, which has its own offset and rate.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.distance import cdist
from scipy.spatial.transform import Rotation

from mitl.errors import RigError
from mitl.paths import FloatArray, PosePath
from mitl.protocols import AveragedPoint
from mitl.samples import CodeArray, TrackerSamples
from mitl.simulation.tracker_button import ButtonInput, WiredButton
from mitl.simulation.tracker_model import TrackerModel
from mitl.simulation.tracker_parameters import TrackerParameters
from mitl.simulation.world import HAND, World


@dataclass(frozen=True)
class TrackerClock:
    """A clock that reads offset + (1 + rate_error) * world time, in s."""

    offset: float
    rate_error: float

    @classmethod
    def drawn(cls, parameters: TrackerParameters, seed: int) -> TrackerClock:
        """Gives the clock that a tracker with these parameters has with this seed."""
        generator = np.random.default_rng([seed, _CLOCK_DRAW])
        spread = parameters.clock
        offset = generator.uniform(spread.offset_min_s, spread.offset_max_s)
        return cls(float(offset), float(generator.standard_normal() * spread.rate_error_sd_ppm * 1e-6))


_CLOCK_DRAW = 1_000_000  # keeps these draws apart from those of the sensor model, which takes its own from the same seed


class SimulatedTracker:
    """The tracker in a World. Implements Tracker.

    `latest` and `average` work at any time, as the device samples always; `path` and `stop` need `start` first. While it does not
    record, long waits of the world at rest are skipped. device: which of the world's devices it is.
    """

    def __init__(self, world: World, clock: TrackerClock, *, device: str = HAND) -> None:
        self._world = world
        self._clock = clock
        self._device = device
        self._buttons: dict[int, ButtonInput | WiredButton] = {}
        self._recording = False
        self._recorded: list[TrackerSamples] | None = None
        self._averaging: list[PosePath] | None = None
        self._latest: PosePath | None = None
        world.subscribe(self._receive, device, prompt=False)
        world.skip_unless(lambda: self._recording)

    def start(self) -> None:
        """Starts recording a new path."""
        self._world.flush()
        self._recorded = []
        self._recording = True

    def stop(self) -> PosePath:
        """Stops recording and gives the whole path."""
        path = self.path()
        self._recording = False
        return path

    def path(self) -> PosePath:
        """Gives the path so far, while recording or after; not valid where the device is out of sight."""
        return self.samples().trusted()

    def samples(self) -> TrackerSamples:
        """Gives the path so far with result codes, buttons and the device's own velocity."""
        if self._recorded is None:
            raise RigError("the tracker was not started: call start() before asking for a path")
        self._world.flush()
        self._recorded = [TrackerSamples.joined(self._recorded)]
        return self._recorded[0]

    def wire(self, button: int, line: ButtonInput | WiredButton) -> None:
        """Wires a button (0 to 14). Whoever drives a ButtonInput calls its `change` before the world passes that time."""
        self._world.flush()
        self._buttons[button] = line

    def latest(self) -> PosePath:
        """Gives the most recent sample as a path of length one."""
        self._world.flush()
        if self._latest is None:
            raise RigError("the tracker has no sample yet: let some time pass first")
        if not self._latest.valid[0]:
            raise RigError(f"the tracker is lost: its sample at {self._latest.time[0]:.3f} s is not valid")
        return self._latest

    def average(self, seconds: float) -> AveragedPoint:
        """Measures a still point for `seconds` of the rig's time from now on; recording may go on meanwhile."""
        begin = self._world.now()
        self._world.flush()
        self._averaging = []
        try:
            self._world.wait(seconds)
            self._world.flush()
            end = self._world.now()
            window = _joined(self._averaging)
        finally:
            self._averaging = None
        valid = window.only_valid()
        if len(valid) == 0:
            raise RigError(f"the tracker is lost: none of {len(window)} samples in {seconds} s is valid")
        mean = Rotation.from_quat(valid.quaternion_wxyz, scalar_first=True).mean()
        return AveragedPoint(
            time=self._reading(0.5 * (begin + end)),
            position=valid.position.mean(axis=0),
            quaternion_wxyz=mean.as_quat(canonical=True, scalar_first=True),
            jitter=diameter(valid.position),
            count=len(valid),
        )

    def begin(self, model: TrackerModel) -> None:
        """Goes on with another sensor model, with nothing recorded; the clock stays."""
        self._world.use_tracker_model(model, self._device)
        self._recording = False
        self._recorded = None
        self._latest = None

    def _reading(self, world_time: float) -> float:
        return self._clock.offset + (1.0 + self._clock.rate_error) * world_time

    def _receive(self, samples: TrackerSamples) -> None:
        path = samples.path
        times = self._clock.offset + (1.0 + self._clock.rate_error) * path.time
        own = replace(path, time=times)
        if self._recording and self._recorded is not None:
            self._recorded.append(TrackerSamples(own, samples.result, self._pressed(path.time), samples.velocity))
        elif self._buttons:
            self._pressed(path.time)
        if self._averaging is not None:
            self._averaging.append(replace(samples.trusted(), time=times))
        self._latest = own.select(np.arange(len(own)) == len(own) - 1)

    def _pressed(self, world_times: FloatArray) -> CodeArray:
        """Gives the buttons as bits (N,); a button changes on the world's clock."""
        bits = np.zeros(len(world_times), dtype=np.int16)
        for button, line in self._buttons.items():
            bits |= line.states(world_times) << button
        return bits


def diameter(points: FloatArray) -> float:
    """Gives the greatest distance between any two of points (N, 3)."""
    block = 1000  # bounds memory: block * N distances at a time
    return max(float(cdist(points[first : first + block], points[first:]).max()) for first in range(0, len(points), block))


def _joined(parts: list[PosePath]) -> PosePath:
    if not parts:
        return PosePath(np.empty(0), np.empty((0, 3)), np.empty((0, 4)), np.empty(0, dtype=np.bool_))
    return PosePath(
        np.concatenate([part.time for part in parts]),
        np.concatenate([part.position for part in parts]),
        np.concatenate([part.quaternion_wxyz for part in parts]),
        np.concatenate([part.valid for part in parts]),
    )
