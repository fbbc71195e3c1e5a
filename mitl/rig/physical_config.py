"""PhysicalConfig: a rig file of kind "physical", read strictly. docs/physical_rig.md explains every key.

Invariant: no key holds a password; an unknown key is refused, because a misspelt one would silently mean its default.
"""

from __future__ import annotations

import difflib
import re
import tomllib
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields
from pathlib import Path
from typing import Any, TypeVar
from uuid import UUID

from mitl.errors import UsageError
from mitl.protocols import HealthGate
from mitl.rig.health_section import health_gate

GENERATIONS = ("1", "2", "8")
EGM_DEVICE = re.compile(r"[A-Za-z0-9_.:-]{1,32}")
"""Names that a UdpUc device may have: they become part of a program."""


@dataclass(frozen=True)
class ControllerConfig:
    """[controller] address: http(s)://host[:port]. generation of RWS. fingerprint: SHA-256 of the certificate to pin, or "".

    station: GUID of this computer as a control station, for RobotWare 8.
    """

    address: str
    generation: str = "1"
    fingerprint: str = ""
    station: str = ""
    kind: str = "rws"


@dataclass(frozen=True)
class TrackerConfig:
    """[tracker] serial of the device, or "" for the only one. universe: raw or standing. source: predicted or on-update."""

    serial: str = ""
    universe: str = "raw"
    source: str = "predicted"
    rate_hz: float = 250.0
    kind: str = "openvr"


@dataclass(frozen=True)
class SafetyConfig:
    """[safety] unattended: whether --arm is taken without a terminal. corridor_mm: how far the flange may be off its pre-flown way.

    tracker_lost_s: how long the tracker may be lost while the robot moves. first_speed: speed ratio in per cent of the session's first
    motion, the calibration, from which it climbs, and speed that of all after it. heartbeat_s: after so long without a word of mitl's the
    program on the controller stops the robot by itself. workspace_mm: [[x, y, z] least, [x, y, z] greatest] of the flange in the base
    frame, or empty for no bound.
    """

    unattended: bool = False
    corridor_mm: float = 100.0
    tracker_lost_s: float = 0.5
    first_speed: float = 25.0
    speed: float = 100.0
    heartbeat_s: float = 3.0
    workspace_mm: tuple[tuple[float, ...], ...] = ()


@dataclass(frozen=True)
class EgmConfig:
    """[egm] host, port: where the controller's stream of its own view comes in. device: the UdpUc device on the controller that sends it

    here, which mitl then starts with every program (option 689-1), or "" where something else starts it.
    """

    host: str = ""
    port: float = 6510.0
    device: str = ""


@dataclass(frozen=True)
class PhysicalConfig:
    """What a rig file says. folder: what paths are relative to. calibration: a stored one, or "" to calibrate every run.

    egm: None where the controller streams nothing. patience_s: how long a case waits, before it begins, for a controller or a tracker
    that is not there, or held by another; a session of a mitl that was killed holds it for up to 300 s.
    """

    name: str
    robot: str
    controller: ControllerConfig
    tracker: TrackerConfig = field(default_factory=TrackerConfig)
    safety: SafetyConfig = field(default_factory=SafetyConfig)
    egm: EgmConfig | None = None
    calibration: str = ""
    patience_s: float = 330.0
    folder: Path = Path()
    health: HealthGate | None = None


def is_physical(name_or_file: str) -> bool:
    """Gives whether a rig file says that it is physical; of what cannot be read, the reader of the other kinds tells."""
    file = Path(name_or_file)
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        return False
    rig = table.get("rig")
    return isinstance(rig, dict) and rig.get("kind") == "physical"


def read_physical(file: Path) -> PhysicalConfig:
    """Gives what a rig file says. Raises UsageError naming file, section and key."""
    table = tomllib.loads(file.read_text(encoding="utf-8"))
    for section in table:
        _known(file, section, ("rig", "controller", "tracker", "safety", "egm", "health"), "unknown section or key")
    rig = dict(_section(file, table, "rig"))
    for key in rig:
        _known(file, key, ("kind", "robot", "calibration", "patience_s"), "[rig] unknown key")
    if "controller" not in table:
        raise UsageError(f"{file}: expected a section [controller] with the address of the controller")
    found = PhysicalConfig(
        name=file.stem,
        robot=_text(file, "rig", "robot", rig.get("robot")),
        controller=_record(file, "controller", _section(file, table, "controller"), ControllerConfig),
        tracker=_record(file, "tracker", _section(file, table, "tracker"), TrackerConfig),
        safety=_record(file, "safety", _section(file, table, "safety"), SafetyConfig),
        egm=_record(file, "egm", _section(file, table, "egm"), EgmConfig) if "egm" in table else None,
        calibration=_text(file, "rig", "calibration", rig.get("calibration", "")),
        patience_s=_seconds(file, rig.get("patience_s", 330.0)),
        folder=file.parent,
        health=health_gate(file, table),
    )
    _check(file, found)
    return found


def _seconds(file: Path, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value <= 86400.0:
        raise UsageError(f"{file}: [rig] patience_s = {value!r}: expected 0 to 86400 seconds")
    return float(value)


def _check(file: Path, found: PhysicalConfig) -> None:
    controller, tracker, safety = found.controller, found.tracker, found.safety
    choices = (
        ("controller", "kind", controller.kind, ("rws",)),
        ("controller", "generation", controller.generation, GENERATIONS),
        ("tracker", "kind", tracker.kind, ("openvr",)),
        ("tracker", "universe", tracker.universe, ("raw", "standing")),
        ("tracker", "source", tracker.source, ("predicted", "on-update")),
    )
    for section, key, value, allowed in choices:
        if value not in allowed:
            raise UsageError(f"{file}: [{section}] {key} = {value!r}: expected {' or '.join(allowed)}")
    if not controller.address.startswith(("http://", "https://")):
        raise UsageError(f"{file}: [controller] address = {controller.address!r}: expected http:// or https:// and a host")
    if "@" in controller.address:
        raise UsageError(f"{file}: [controller] address holds a user or password: they belong into the environment or the keyring")
    pinned = controller.fingerprint.replace(":", "").lower()
    if pinned and (len(pinned) != 64 or set(pinned) - set("0123456789abcdef")):
        raise UsageError(f"{file}: [controller] fingerprint: expected the 64 hex digits of a SHA-256")
    if controller.generation == "8":
        try:
            UUID(controller.station)
        except ValueError as error:
            raise UsageError(f"{file}: [controller] station: RobotWare 8 wants a GUID of this computer's own, e.g. from uuidgen") from error
    ranges: list[tuple[str, str, float, float, float]] = [
        ("tracker", "rate_hz", tracker.rate_hz, 10.0, 1000.0),
        ("safety", "corridor_mm", safety.corridor_mm, 1.0, 1000.0),
        ("safety", "tracker_lost_s", safety.tracker_lost_s, 0.05, 10.0),
        ("safety", "first_speed", safety.first_speed, 1.0, 100.0),
        ("safety", "speed", safety.speed, 1.0, 100.0),
        ("safety", "heartbeat_s", safety.heartbeat_s, 1.0, 30.0),
    ]
    if found.egm is not None:
        if found.egm.device and not EGM_DEVICE.fullmatch(found.egm.device):
            raise UsageError(f"{file}: [egm] device = {found.egm.device!r}: expected the name of a UdpUc device, letters, digits, _ . : -")
        if not found.egm.port.is_integer():
            raise UsageError(f"{file}: [egm] port = {found.egm.port:g}: expected a whole number")
        ranges.append(("egm", "port", found.egm.port, 1.0, 65535.0))
    for section, key, number, least, most in ranges:
        if not least <= number <= most:
            raise UsageError(f"{file}: [{section}] {key} = {number:g}: expected {least:g} to {most:g}")
    if safety.workspace_mm and [len(corner) for corner in safety.workspace_mm] != [3, 3]:
        raise UsageError(f"{file}: [safety] workspace_mm: expected [[x, y, z], [x, y, z]], the least and the greatest")


_Record = TypeVar("_Record", ControllerConfig, TrackerConfig, SafetyConfig, EgmConfig)


def _record(file: Path, section: str, table: Mapping[str, Any], kind: type[_Record]) -> _Record:
    known = {one.name: one for one in fields(kind)}
    values: dict[str, Any] = {}
    for key, value in table.items():
        _known(file, key, tuple(known), f"[{section}] unknown key")
        default = known[key].default
        if isinstance(default, bool):
            if not isinstance(value, bool):
                raise UsageError(f"{file}: [{section}] {key} must be true or false, is {value!r}")
            values[key] = value
        elif isinstance(default, float):
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise UsageError(f"{file}: [{section}] {key} must be a number, is {value!r}")
            values[key] = float(value)
        elif isinstance(default, tuple):
            values[key] = _corners(file, section, key, value)
        else:
            values[key] = _text(file, section, key, value)
    missing = [name for name, one in known.items() if one.default is MISSING and name not in values]
    if missing:
        raise UsageError(f"{file}: [{section}] {missing[0]} is missing")
    return kind(**values)


def _corners(file: Path, section: str, key: str, value: Any) -> tuple[tuple[float, ...], ...]:  # noqa: ANN401 - as tomllib gives it
    try:
        return tuple(tuple(float(number) for number in corner) for corner in value)
    except (TypeError, ValueError) as error:
        raise UsageError(f"{file}: [{section}] {key}: expected [[x, y, z], [x, y, z]], is {value!r}") from error


def _text(file: Path, section: str, key: str, value: Any) -> str:  # noqa: ANN401 - as tomllib gives it
    if not isinstance(value, str):
        raise UsageError(f"{file}: [{section}] {key} must be a string, is {value!r}")
    return value


def _section(file: Path, table: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    found = table.get(key, {})
    if not isinstance(found, dict):
        raise UsageError(f"{file}: {key} must be a section [{key}], is {found!r}")
    return found


def _known(file: Path, key: str, known: tuple[str, ...], what: str) -> None:
    if key not in known:
        near = difflib.get_close_matches(key, known, n=1)
        raise UsageError(f"{file}: {what} {key!r}" + (f"; did you mean {near[0]}?" if near else f", known are {', '.join(known)}"))
