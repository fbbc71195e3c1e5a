"""OpenVrTracker: a device of SteamVR. Implements Tracker; `samples` tells result codes, buttons and native velocity with every sample.

Invariant: every sample keeps what the runtime said of it; nothing that was measured in another session of SteamVR counts as valid, because
its frame may have moved by centimetres (facts/tracker.md).
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from mitl.errors import RigError
from mitl.metrics.path_queries import average
from mitl.paths import PosePath
from mitl.protocols import AveragedPoint, Clock
from mitl.samples import TrackerSamples
from mitl.trackers.openvr_runtime import POSE, DeviceInfo, OpenVrRuntime, RuntimeGoneError
from mitl.trackers.sample_store import SampleStore
from mitl.trackers.sampling import Sampler, SamplingStatistics, before_others

RATE = 250.0
SETTLE = 0.2
"""Seconds from a call of `average` to its window: motion blur of the pose filter and of the mount has died away by then."""
_RECORD = np.dtype([("time", "<f8"), ("pose", POSE), ("buttons", "<u8"), ("session", "<i4")])
_FRESH = 0.1
"""Seconds after which the last sample is no longer the present one."""
_RECONNECT_EVERY, _LOOK_FOR_QUIT = 1.0, 0.1
_BUTTONS = 0x7FFF
_Columns = tuple[NDArray[Any], ...]


class OpenVrTracker:
    """A device by its serial number, or the only controller or tracker there is.

    connect: makes the runtime, also again after SteamVR quit. clock: the rig's, for waits. now: clock of the samples.
    """

    def __init__(
        self,
        connect: Callable[[], OpenVrRuntime],
        clock: Clock,
        *,
        serial: str = "",
        rate: float = RATE,
        settle: float = SETTLE,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._connect = connect
        self._clock = clock
        self._settle = settle
        self._now = now
        self._wanted = serial
        self._runtime: OpenVrRuntime | None = connect()
        self.device = chosen(self._runtime.devices(), serial)
        self._lock = threading.Lock()
        self._recording = False
        self._recorded: _Samples | None = None
        self._averaging: _Samples | None = None
        self._last = b""
        self._session = self._accepted = 0
        self._quit_seen = self._tried = 0.0
        self._sampler = Sampler(self._take, rate, now)
        self._sampler.start()

    # --- Tracker -------------------------------------------------------------------------------------------------------------

    def start(self) -> None:
        """Starts recording a new path."""
        self._refuse_if_lost()
        with self._lock:
            self._recorded, self._recording = _Samples(), True

    def stop(self) -> PosePath:
        """Stops recording and gives the whole path."""
        with self._lock:
            self._recording = False
        return self.path()

    def path(self) -> PosePath:
        """Gives the path so far, while recording or after; not valid where the device is out of sight."""
        with before_others():
            return self.samples().trusted()

    def samples(self) -> TrackerSamples:
        """Gives the path so far with result codes, buttons and the device's own velocity."""
        with self._lock:
            if self._recorded is None:
                raise RigError("the tracker was not started: call start() before asking for a path")
            recorded = self._recorded
        with before_others():
            return recorded.decoded()

    def latest(self) -> PosePath:
        """Gives the most recent sample as a path of length one."""
        self._refuse_if_lost()
        with self._lock:
            content = self._recent()
        with before_others():
            path = joined([_decoded(content)]).path
        if not len(path) or self._now() - float(path.time[0]) > _FRESH:
            raise RigError("the tracker gives no samples: is SteamVR running?")
        if not path.valid[0]:
            raise RigError(f"the tracker is lost: its sample at {path.time[0]:.3f} s is not valid")
        return path

    def average(self, seconds: float) -> AveragedPoint:
        """Measures a still point for `seconds` of the rig's time, a little from now on; recording may go on meanwhile."""
        self._refuse_if_lost()
        self._clock.wait(self._settle)
        with self._lock:
            self._averaging = _Samples()
        self._clock.wait(seconds)
        with self._lock:
            averaged, self._averaging = self._averaging, None
        with before_others():
            window = averaged.decoded().trusted()
        if not window.valid.any():
            raise RigError(f"the tracker is lost: none of {len(window)} samples in {seconds} s is valid{self._why()}")
        return average(window)

    # --- beyond Tracker ------------------------------------------------------------------------------------------------------

    @property
    def restarted(self) -> bool:
        """Whether SteamVR was restarted since this tracker was made or its new frame accepted; its samples count as invalid since then."""
        return self._session != self._accepted

    @property
    def frame(self) -> int:
        """A number that changes with every restart of SteamVR: what was calibrated before may be off by centimetres."""
        return self._session

    def accept_frame(self) -> None:
        """Counts the samples of SteamVR as it runs now as valid again; whoever calls it calibrates again. Nothing where it does not run."""
        if self._runtime is not None:
            self._accepted = self._session

    def statistics(self) -> SamplingStatistics:
        """Gives how the sampling goes."""
        return self._sampler.statistics()

    @property
    def realtime(self) -> bool:
        """Whether the system lets the sampling run before everything else."""
        return self._sampler.realtime

    def cpu_time(self) -> float:
        """Gives the processor's time in s that the sampling took so far."""
        return self._sampler.cpu_time()

    def close(self) -> None:
        """Ends the sampling and leaves SteamVR."""
        self._sampler.stop()
        if self._runtime is not None:
            self._runtime.close()
            self._runtime = None

    # -------------------------------------------------------------------------------------------------------------------------

    def _recent(self) -> bytes:
        """Gives the last sample; while recording, the last of the path, so that both agree."""
        return (self._recorded.store.last() or self._last) if self._recording and self._recorded is not None else self._last

    def _take(self, now: float) -> None:
        """Takes one sample, in the sampling thread."""
        pose, buttons = self._read(now)
        record = np.float64(now).tobytes() + pose + np.uint64(buttons).tobytes() + np.int32(self._session - self._accepted).tobytes()
        with self._lock:
            self._last = record
            if self._recording and self._recorded is not None:
                self._recorded.store.append(record)
            if self._averaging is not None:
                self._averaging.store.append(record)

    def _read(self, now: float) -> tuple[bytes, int]:
        if self._runtime is None:
            self._reconnect(now)
        if self._runtime is not None and now - self._quit_seen > _LOOK_FOR_QUIT:
            self._quit_seen = now
            if self._runtime.has_quit():
                self._runtime.close()
                self._runtime, self._session, self._tried = None, self._session + 1, now
        return (bytes(POSE.itemsize), 0) if self._runtime is None else self._runtime.read(self.device.index)

    def _reconnect(self, now: float) -> None:
        if now - self._tried < _RECONNECT_EVERY:
            return
        self._tried = now
        try:
            runtime = self._connect()
        except RuntimeGoneError:
            return
        self._runtime = runtime
        self.device = chosen(runtime.devices(), self.device.serial)

    def _refuse_if_lost(self) -> None:
        if not self._sampler.alive:
            raise RigError(f"the tracker's sampling has ended: {self._sampler.problem or 'it was closed'}") from self._sampler.problem
        if self.restarted:
            raise RigError(f"the tracker is lost{self._why()}")

    def _why(self) -> str:
        return ": SteamVR quit or was restarted, so its frame may have moved; start it, then calibrate again" if self.restarted else ""


def chosen(devices: list[DeviceInfo], serial: str) -> DeviceInfo:
    """Gives the device of a serial number, or the only controller or tracker. Raises RigError saying what there is."""
    usable = [device for device in devices if device.kind in ("controller", "tracker")]
    matching = [device for device in usable if not serial or device.serial == serial]
    shown = ", ".join(f"{device.serial} ({device.kind}, role {device.role})" for device in usable) or "none"
    if not matching:
        raise RigError(f"no device {serial or 'to track'} at SteamVR; it has: {shown}")
    if len(matching) > 1:
        raise RigError(f"several devices at SteamVR, name one by its serial in the rig file: {shown}")
    return matching[0]


class _Samples:
    """Samples of one recording. Each block is decoded once, so that asking again for a path that grows costs what is new of it."""

    def __init__(self) -> None:
        self.store = SampleStore(_RECORD.itemsize)
        self._parts: list[_Columns] = []
        self._lock = threading.Lock()

    def decoded(self) -> TrackerSamples:
        with self._lock:
            full, newest = self.store.blocks(after=len(self._parts))
            for block in full:
                self._parts.append(_decoded(block))
            parts = [*self._parts, _decoded(newest)]
        return joined(parts)


def joined(parts: Sequence[_Columns]) -> TrackerSamples:
    """Gives samples of columns that follow each other, without those whose time is not after the one before."""
    time, position, quaternion, valid, result, buttons, velocity = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    later = np.concatenate([np.ones(min(1, len(time)), dtype=np.bool_), np.diff(time) > 0])
    if not later.all():
        time, position, quaternion, valid, result, buttons, velocity = (
            column[later] for column in (time, position, quaternion, valid, result, buttons, velocity)
        )
    return TrackerSamples(PosePath(time, position, quaternion, valid), result, buttons, velocity)


def _decoded(content: bytes) -> _Columns:
    """Gives time, position, quaternion, validity, result code, buttons and velocity of records.

    Those without a place are told as (0, 0, 0), not turned, and not valid.
    """
    records = np.frombuffer(content, dtype=_RECORD)
    matrix = records["pose"]["matrix"].astype(np.float64)
    position, turn = matrix[:, :, 3], matrix[:, :, :3]
    proper = np.abs(np.linalg.det(turn) - 1.0) < 1e-2
    quaternion = np.tile([1.0, 0.0, 0.0, 0.0], (len(records), 1))
    if proper.any():
        quaternion[proper] = Rotation.from_matrix(turn[proper]).as_quat(canonical=True, scalar_first=True)
    placed = proper & np.any(position != 0.0, axis=1)
    valid = placed & records["pose"]["valid"] & records["pose"]["connected"] & (records["session"] == 0)
    buttons = (records["buttons"] & _BUTTONS).astype(np.int16)
    result, velocity = records["pose"]["result"].astype(np.int16), records["pose"]["velocity"].astype(np.float64)
    return records["time"].astype(np.float64), position, quaternion, valid, result, buttons, velocity
