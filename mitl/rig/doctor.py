"""The doctor: what a physical rig tells of itself, and whether it is fit for a run.

Invariant: it only reads; each part is looked at even where another is broken.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from enum import Enum
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np

from mitl.calibration.store import age, load_calibration
from mitl.controllers.rws.controller import RwsController
from mitl.controllers.rws.credentials import find_credentials
from mitl.controllers.rws.transport import certificate_fingerprint
from mitl.errors import MitlError
from mitl.rig.monotonic_clock import MonotonicClock
from mitl.rig.physical_config import ControllerConfig, PhysicalConfig
from mitl.rig.remote import transport_to
from mitl.samples import TrackingResult
from mitl.trackers.openvr_runtime import OpenVrRuntime, Universe
from mitl.trackers.openvr_tracker import OpenVrTracker

_LEAST_DISK = 2 * 1024**3
_LEAST_RATE, _MOST_CLOCK_OFFSET, _OLD_CALIBRATION = 0.98, 60.0, timedelta(hours=12)
_INTERFACE, _GUIDED = "616-1 PC Interface", "689-1 Externally Guided Motion"
_PATIENCE = 3.0


class State(Enum):
    """What a finding means for a run."""

    GOOD = "good"
    LOOK = "look"
    BAD = "bad"


@dataclass(frozen=True)
class Finding:
    """One line of the examination."""

    what: str
    state: State
    told: str


def examine(config: PhysicalConfig, out: Path, seconds: float) -> list[Finding]:
    """Gives what was found of controller, tracker, calibration and disk; the tracker is watched for `seconds`."""
    return [*_certificate(config.controller), *_controller(config), *_tracker(config, seconds), _calibration(config), _disk(out)]


def _certificate(controller: ControllerConfig) -> list[Finding]:
    """Tells the SHA-256 of the certificate that an encrypted controller shows, to pin it by; nothing where it shows none."""
    address = urlsplit(controller.address)
    if address.scheme != "https":
        return []
    try:
        seen = certificate_fingerprint(controller.address, _PATIENCE)
    except OSError:  # what the controller's own finding says
        return []
    pinned = controller.fingerprint.lower().replace(":", "")
    if pinned == seen:
        return [Finding("certificate", State.GOOD, "is the pinned one")]
    if pinned:
        return [Finding("certificate", State.BAD, f"SHA-256 {seen}, pinned is another: {pinned}")]
    advice = f'if this is what the cell itself shows, pin it: fingerprint = "{seen}"'
    return [Finding("certificate", State.LOOK, f"not pinned; {advice}")]


def _controller(config: PhysicalConfig) -> list[Finding]:
    address = config.controller.address
    clock = MonotonicClock()
    try:
        transport = transport_to(config.controller, find_credentials, patience=_PATIENCE)
        controller = RwsController(transport, clock)
        version, options = controller.system()
    except MitlError as error:
        return [Finding("controller", State.BAD, str(error))]
    looks: list[tuple[str, Callable[[], tuple[State, str]]]] = [
        ("options", lambda: _options(options, config)),
        ("mode", lambda: _wanted(controller.mode(), "AUTO", "turn the key to automatic")),
        ("motors", lambda: _wanted(controller.controller_state(), "motoron", "switch them on at the cell")),
        ("RAPID", lambda: _wanted(controller.state().value, "stopped", "another program is running")),
        ("speed ratio", lambda: (State.GOOD, f"{controller.speed_ratio():g} %")),
        ("clock", lambda: _clock(controller.clock_time())),
        ("axes", lambda: (State.GOOD, " ".join(f"{angle:.2f}" for angle in np.degrees(controller.joints())) + " deg")),
    ]
    found = [Finding("controller", State.GOOD, f"{address}, RobotWare {version}"), *(_looked(what, look) for what, look in looks)]
    controller.leave()
    return found


def _looked(what: str, look: Callable[[], tuple[State, str]]) -> Finding:
    try:
        return Finding(what, *look())
    except MitlError as error:
        return Finding(what, State.BAD, str(error))


def _options(options: tuple[str, ...], config: PhysicalConfig) -> tuple[State, str]:
    wanted = [_INTERFACE, *([_GUIDED] if config.egm is not None else [])]
    missing = [name for name in wanted if not any(name.split()[0] in option for option in options)]
    if missing:
        return State.LOOK, f"not listed: {', '.join(missing)}"
    return State.GOOD, ", ".join(wanted)


def _wanted(found: str, wanted: str, advice: str) -> tuple[State, str]:
    return (State.GOOD, found) if found == wanted else (State.BAD, f"{found}, expected {wanted}: {advice}")


def _clock(told: datetime | None) -> tuple[State, str]:
    if told is None:
        return State.LOOK, "the controller's clock cannot be read"
    offset = (told - datetime.now()).total_seconds()  # noqa: DTZ005 - the controller's local time against ours
    state = State.GOOD if abs(offset) < _MOST_CLOCK_OFFSET else State.LOOK
    return state, f"{offset:+.0f} s against this computer"


def _tracker(config: PhysicalConfig, seconds: float) -> list[Finding]:
    universe = Universe(config.tracker.universe)
    clock = MonotonicClock()
    try:
        runtime = OpenVrRuntime(universe)
        devices, version = runtime.devices(), runtime.version()
        runtime.close()
        tracker = OpenVrTracker(lambda: OpenVrRuntime(universe), clock, serial=config.tracker.serial, rate=config.tracker.rate_hz)
    except MitlError as error:
        return [Finding("tracker", State.BAD, str(error))]
    try:
        tracker.start()
        clock.wait(seconds)
        tracker.stop()
        samples, realtime = tracker.samples(), tracker.realtime
    finally:
        tracker.close()
    stations = [device for device in devices if device.kind == "base station" and device.connected]
    rate = len(samples) / seconds
    intervals = np.diff(samples.path.time)
    out_of_range = float(np.mean(samples.result == TrackingResult.RUNNING_OUT_OF_RANGE)) if len(samples) else 1.0
    share = float(np.mean(samples.path.valid)) if len(samples) else 0.0
    slow = rate < _LEAST_RATE * config.tracker.rate_hz
    return [
        Finding("tracker", State.GOOD, f"{tracker.device.serial} ({tracker.device.kind}, role {tracker.device.role}), SteamVR {version}"),
        Finding(
            "base stations", State.GOOD if len(stations) > 1 else State.LOOK, f"{len(stations)} in view; one alone is seven times noisier"
        ),
        Finding(
            "valid samples", State.GOOD if share == 1.0 else State.BAD, f"{100 * share:.1f} %, {100 * out_of_range:.1f} % out of range"
        ),
        Finding(
            "sampling",
            State.BAD if slow else State.GOOD if realtime else State.LOOK,
            (
                f"{rate:.1f} Hz of {config.tracker.rate_hz:g}, interval p99 {1e3 * float(np.quantile(intervals, 0.99)):.2f} ms"
                if len(intervals)
                else "none"
            )
            + ("" if realtime else "; not real-time, so a busy computer costs samples: allow it (ulimit -r 10)"),
        ),
    ]


def _calibration(config: PhysicalConfig) -> Finding:
    if not config.calibration:
        return Finding("calibration", State.GOOD, "every run calibrates")
    file = config.folder / config.calibration
    if not file.is_file():
        return Finding("calibration", State.BAD, f"{file} is not there: mitl calibrate --rig ... --output {file}")
    try:
        old = age(load_calibration(file), datetime.now(UTC))
    except MitlError as error:
        return Finding("calibration", State.BAD, str(error))
    if old is None:
        return Finding("calibration", State.LOOK, f"{file.name} does not tell its age: mitl calibrate --rig ... --output {file}")
    state = State.GOOD if old < _OLD_CALIBRATION else State.LOOK
    return Finding("calibration", state, f"{file.name}, {old.total_seconds() / 3600:.1f} h old")


def _disk(out: Path) -> Finding:
    place = next((folder for folder in (out.absolute(), *out.absolute().parents) if folder.exists()), out)
    try:
        free = shutil.disk_usage(place).free
    except OSError as error:
        return Finding("disk", State.BAD, f"{out}: {error.strerror}")
    return Finding("disk", State.GOOD if free > _LEAST_DISK else State.BAD, f"{free / 1024**3:.1f} GiB free at {out}")
