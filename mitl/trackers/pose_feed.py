"""PoseFeed: what simulated devices measure, in a memory-mapped file that a stand-in for SteamVR reads (tests/trackers/fake_steamvr.cpp).

Invariant: a device's counter is raised after its sample was written whole; times are those of the computer's monotonic clock, so that a
reader takes the sample that was due when it asked, however the writer was scheduled.
"""

from __future__ import annotations

import mmap
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.paths import FloatArray
from mitl.samples import CodeArray, TrackerSamples

MAGIC = b"MITLVR1\0"
LATENCY = 0.1
"""Seconds by which a reader lags behind, so that the sample it wants has been written."""
MOST_DEVICES, SLOTS = 8, 1024
_HEADER = struct.Struct("<8sQQdQ")  # magic, session, quitting, latency, devices
_HEADER_SIZE = 64
_DEVICE = struct.Struct("<32s32sII")  # serial, model, class, role; then the counter
_DEVICE_SIZE, _COUNTER_AT = 96, 80
_SLOT = np.dtype(
    [
        ("time", "<f8"),
        ("matrix", "<f4", (3, 4)),
        ("velocity", "<f4", 3),
        ("result", "<i4"),
        ("flags", "<u4"),
        ("", "V4"),
        ("buttons", "<u8"),
    ]
)
_SLOTS_AT = _HEADER_SIZE + MOST_DEVICES * _DEVICE_SIZE
SIZE = _SLOTS_AT + MOST_DEVICES * SLOTS * _SLOT.itemsize
VALID, CONNECTED = 1, 2
CONTROLLER, TRACKER = 2, 3
"""OpenVR's device classes."""


@dataclass(frozen=True)
class FedDevice:
    """A device of the feed: serial and model as a runtime tells them, OpenVR's class and role."""

    serial: str
    model: str = "mitl simulated device"
    kind: int = CONTROLLER
    role: int = 0


class PoseFeed:
    """A feed in a file, which is made anew. session: another number means that the runtime was restarted."""

    def __init__(self, file: Path, devices: tuple[FedDevice, ...], *, session: int = 1, latency: float = LATENCY) -> None:
        if not 1 <= len(devices) <= MOST_DEVICES:
            raise ValueError(f"expected 1 to {MOST_DEVICES} devices, got {len(devices)}")
        beside = file.with_name(f"{file.name}.new")
        beside.write_bytes(bytes(SIZE))
        with beside.open("r+b") as opened:
            self._map = mmap.mmap(opened.fileno(), SIZE)
        for number, device in enumerate(devices):
            at = _HEADER_SIZE + number * _DEVICE_SIZE
            _DEVICE.pack_into(self._map, at, device.serial.encode(), device.model.encode(), device.kind, device.role)
        _HEADER.pack_into(self._map, 0, MAGIC, session, 0, latency, len(devices))
        self._written = [0] * len(devices)
        beside.replace(file)  # a reader sees the whole header or no file

    def write(self, device: int, times: FloatArray, samples: TrackerSamples, buttons: CodeArray | None = None) -> None:
        """Hands over samples of a device; times (N,): s, monotonic clock. buttons (N,): bits in place of the samples' own."""
        path = samples.path
        slots = np.zeros(len(path), dtype=_SLOT)
        slots["time"] = times
        lost = ~np.all(np.isfinite(path.position), axis=1) | (np.linalg.norm(path.quaternion_wxyz, axis=1) < 0.5)
        turned = np.where(lost[:, None], [1.0, 0.0, 0.0, 0.0], path.quaternion_wxyz)
        slots["matrix"][:, :, :3] = Rotation.from_quat(turned, scalar_first=True).as_matrix()
        slots["matrix"][:, :, 3] = np.where(lost[:, None], 0.0, path.position)
        slots["velocity"] = np.nan_to_num(samples.velocity)
        slots["result"] = samples.result
        slots["flags"] = CONNECTED + VALID * (path.valid & ~lost)
        slots["buttons"] = samples.buttons if buttons is None else buttons
        for slot in slots:
            at = _SLOTS_AT + (device * SLOTS + self._written[device] % SLOTS) * _SLOT.itemsize
            self._map[at : at + _SLOT.itemsize] = slot.tobytes()
            self._written[device] += 1
            struct.pack_into("<Q", self._map, _HEADER_SIZE + device * _DEVICE_SIZE + _COUNTER_AT, self._written[device])

    def quit(self) -> None:
        """Tells readers that the runtime quits."""
        struct.pack_into("<Q", self._map, 16, 1)

    def restart(self) -> None:
        """Tells readers that the runtime runs again, in another session."""
        (session,) = struct.unpack_from("<Q", self._map, 8)
        struct.pack_into("<QQ", self._map, 8, session + 1, 0)

    def close(self) -> None:
        """Lets go of the file, and tells readers that the runtime has quit."""
        self.quit()
        self._map.close()
