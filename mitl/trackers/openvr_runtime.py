"""OpenVrRuntime: SteamVR through the package `openvr`, as a background application. The only module that imports it.

Invariant: a read allocates nothing that lives on and calls the runtime twice at most: pose and buttons. Poses carry no time stamp
(facts/rig.md); the caller notes when it asked.
"""

from __future__ import annotations

import importlib
from ctypes import byref, sizeof
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np

from mitl.errors import RigError, UsageError

POSE = np.dtype(
    [
        ("matrix", "<f4", (3, 4)),
        ("velocity", "<f4", 3),
        ("turning", "<f4", 3),
        ("result", "<i4"),
        ("valid", "?"),
        ("connected", "?"),
        ("", "V2"),
    ]
)
"""OpenVR's TrackedDevicePose_t."""
_CLASSES = {2: "controller", 3: "tracker", 4: "base station"}
_ROLES = {0: "none", 1: "left hand", 2: "right hand", 3: "opt out", 4: "treadmill", 5: "stylus"}
_QUIT = 700
_EVENTS_AT_ONCE = 100


class PoseSource(Enum):
    """Which pose is read: that of now, extrapolated, or that of the controller's last own event."""

    PREDICTED = "predicted"
    ON_UPDATE = "on-update"


class Universe(Enum):
    """In which frame poses are told. Another application may change the standing one."""

    STANDING = "standing"
    RAW = "raw"


@dataclass(frozen=True)
class DeviceInfo:
    """A tracked device. kind: controller, tracker or base station. role: SteamVR's, which shifts and turns the pose (facts/rig.md)."""

    index: int
    serial: str
    model: str
    kind: str
    role: str
    connected: bool


class RuntimeGoneError(RigError):
    """SteamVR does not run, or has quit."""


class OpenVrRuntime:
    """A connection to SteamVR. Raises UsageError without the package, RuntimeGoneError where SteamVR does not run."""

    def __init__(self, universe: Universe = Universe.RAW, source: PoseSource = PoseSource.PREDICTED) -> None:
        try:
            self._vr: Any = importlib.import_module("openvr")
        except ImportError as error:
            raise UsageError("the tracker kind openvr needs the package openvr: pip install 'mitl[vive]'") from error
        vr = self._vr
        self._origin = vr.TrackingUniverseRawAndUncalibrated if universe is Universe.RAW else vr.TrackingUniverseStanding
        self._source = source
        self._system = self._initialised()
        self._table = self._system.function_table
        self._poses = (vr.TrackedDevicePose_t * vr.k_unMaxTrackedDeviceCount)()
        self._state = vr.VRControllerState_t()
        self._event = vr.VREvent_t()
        if sizeof(vr.TrackedDevicePose_t) != POSE.itemsize:
            raise RigError(f"openvr's pose has {sizeof(vr.TrackedDevicePose_t)} bytes, expected {POSE.itemsize}: use openvr 2.12.1401")

    def devices(self) -> list[DeviceInfo]:
        """Gives controllers, trackers and base stations."""
        vr, system = self._vr, self._system
        found = []
        for index in range(vr.k_unMaxTrackedDeviceCount):
            kind = _CLASSES.get(int(system.getTrackedDeviceClass(index)))
            if kind is None:
                continue
            serial = self._text(index, vr.Prop_SerialNumber_String)
            model = self._text(index, vr.Prop_ModelNumber_String)
            role = _ROLES.get(int(system.getControllerRoleForTrackedDeviceIndex(index)), "unknown")
            found.append(DeviceInfo(index, serial, model, kind, role, bool(system.isTrackedDeviceConnected(index))))
        return found

    def read(self, index: int) -> tuple[bytes, int]:
        """Gives a device's pose as the bytes of a POSE, and its pressed buttons as bits."""
        vr = self._vr
        if self._source is PoseSource.ON_UPDATE:
            pose = self._poses[index]
            self._table.getControllerStateWithPose(self._origin, index, byref(self._state), sizeof(vr.VRControllerState_t), byref(pose))
            return bytes(pose), int(self._state.ulButtonPressed)
        self._table.getDeviceToAbsoluteTrackingPose(self._origin, 0.0, self._poses, index + 1)
        pressed = 0
        if self._table.getControllerState(index, byref(self._state), sizeof(vr.VRControllerState_t)):
            pressed = int(self._state.ulButtonPressed)
        return bytes(self._poses[index]), pressed

    def has_quit(self) -> bool:
        """Gives whether SteamVR told that it quits; takes its other events out of the way."""
        for _ in range(_EVENTS_AT_ONCE):
            if not self._system.pollNextEvent(self._event):
                return False
            if self._event.eventType == _QUIT:
                return True
        return False

    def version(self) -> str:
        """Gives the runtime's version."""
        return str(self._system.getRuntimeVersion())

    def close(self) -> None:
        """Leaves SteamVR."""
        self._vr.shutdown()

    def _initialised(self) -> Any:  # noqa: ANN401 - the package ships no types
        vr = self._vr
        problem: Exception | None = None
        for application in (vr.VRApplication_Background, vr.VRApplication_Other):
            try:
                return vr.init(application)
            except vr.OpenVRError as error:
                problem = error
        raise RuntimeGoneError(f"SteamVR does not run or cannot be reached: {type(problem).__name__} {problem}; start it and try again")

    def _text(self, index: int, what: int) -> str:
        try:
            return str(self._system.getStringTrackedDeviceProperty(index, what))
        except self._vr.OpenVRError:
            return ""
