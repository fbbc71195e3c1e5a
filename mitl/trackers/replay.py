"""ReplayTracker: a recording played again on a clock, for recordings of any tracker.

Invariant: it gives the recorded samples as they are, with their own times; the sample at the beginning of the recording is taken at the
clock's time when the tracker was made.
"""

from __future__ import annotations

import numpy as np

from mitl.errors import RigError
from mitl.metrics.path_queries import average
from mitl.paths import PosePath
from mitl.protocols import AveragedPoint, Clock
from mitl.samples import TrackerSamples


class ReplayClock:
    """A virtual clock that begins at 0 s. Implements Clock."""

    def __init__(self) -> None:
        self._now = 0.0

    def now(self) -> float:
        """Gives the time in s."""
        return self._now

    def wait(self, seconds: float) -> None:
        """Lets time pass at once."""
        if not (np.isfinite(seconds) and seconds >= 0.0):
            raise ValueError(f"expected a time of 0 s or more to wait, got {seconds}")
        self._now += seconds


class ReplayTracker:
    """A recording as a tracker. Implements Tracker."""

    def __init__(self, samples: TrackerSamples, clock: Clock) -> None:
        if len(samples) == 0:
            raise RigError("the recording to be replayed has no sample")
        self._samples = samples
        self._clock = clock
        self._shift = float(samples.path.time[0]) - clock.now()
        self._begin: float | None = None
        self._end: float | None = None

    def start(self) -> None:
        """Starts a new path."""
        self._begin, self._end = self._time(), None

    def stop(self) -> PosePath:
        """Ends the path and gives it."""
        path = self.path()
        if self._end is None:
            self._end = self._time()
        return path

    def path(self) -> PosePath:
        """Gives the path so far, while it is played or after; not valid where the device was out of sight."""
        return self.samples().trusted()

    def samples(self) -> TrackerSamples:
        """Gives the path so far with result codes, buttons and velocities."""
        if self._begin is None:
            raise RigError("the tracker was not started: call start() before asking for a path")
        return self._between(self._begin, self._time() if self._end is None else self._end)

    def latest(self) -> PosePath:
        """Gives the most recent sample as a path of length one."""
        time = self._time()
        at = int(np.searchsorted(self._samples.path.time, time, side="right")) - 1
        self._ended(time)
        chosen = np.arange(len(self._samples)) == max(at, 0)
        latest = self._samples.path.select(chosen)
        if not latest.valid[0]:
            raise RigError(f"the tracker is lost: its sample at {latest.time[0]:.3f} s is not valid")
        return latest

    def average(self, seconds: float) -> AveragedPoint:
        """Averages the next `seconds` of the recording."""
        begin = self._time()
        self._clock.wait(seconds)
        end = self._time()
        window = self._between(begin, end).trusted()
        if not np.any(window.valid):
            self._ended(begin)
            raise RigError(f"the tracker is lost: none of {len(window)} samples in {seconds} s is valid")
        return average(window)

    def _time(self) -> float:
        """Gives the time on the recording's clock; a rounding error must not lose a sample."""
        return self._clock.now() + self._shift + 1e-9

    def _between(self, begin: float, end: float) -> TrackerSamples:
        """Gives the samples from `begin`, up to `end`."""
        time = self._samples.path.time
        return self._samples.select((time >= begin - 2e-9) & (time <= end))

    def _ended(self, time: float) -> None:
        last = float(self._samples.path.time[-1])
        usual = float(np.median(np.diff(self._samples.path.time))) if len(self._samples) > 1 else 0.0
        if time > last + 2.0 * usual + 1e-6:
            raise RigError(f"the recording has ended: its last sample is at {last:.3f} s, now is {time:.3f} s")
