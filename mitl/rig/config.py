"""RigConfig: a rig file, read strictly. An unknown key is refused, because a misspelt one would silently mean its default.

[rig]
kind = "simulation"     # or "physical", with sections of its own: see docs/physical_rig.md
robot = "irb140"        # a folder in models/
tracker = "thesis"      # a preset in models/trackers/, or a preset file (.toml) beside the rig file
fidelity = "kinematic"  # the executed trajectory is played back; "dynamic": servo, gravity, tracker on a compliant mount
cell = "line"           # what stands around the robot, with its conveyors: a folder in models/cells/, or one beside the rig file
poses = "poses.mod"     # RAPID program with the calibration poses, made by `mitl calibrate --plan`; the robot's own without it
calibration = "c.toml"  # a stored calibration beside the rig file, verified at the start of every case; without it every run calibrates

[buttons]               # outputs of the controller that are wired to buttons (0 to 14) of the tracker on the flange
doTrigger = 0
aoTrigger = { button = 1, above = 5.0 }   # an analog output over a comparator: pressed above that value

[devices.reference]     # further tracked devices, by name; "reference" stands still and tells whether the tracker's frame stays
tracker = "thesis"      # preset; the rig's own without it
position = [0.8, -0.6, 0.4]   # m, in the world
velocity = [0.1, 0.0, 0.0]    # m/s from the beginning of every case on; at rest without it
conveyor = "belt"             # of the cell: the device lies on this belt, `position` being its place when the encoder counts 0

[health]                # what every run asks of the rig's latest health check: see rig/health_section.py

A [devices] section replaces the built-in reference and the device on the belt of the cell `line`; an empty one leaves the rig without.
"""

from __future__ import annotations

import difflib
import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mitl.errors import UsageError
from mitl.protocols import HealthGate
from mitl.rig.health_section import health_gate

Triple = tuple[float, float, float]
REFERENCE = "reference"
"""Name of the device that stands still in view."""
BELT = "belt"
"""Name of the device that lies on a conveyor."""
_TEXTS: dict[str, tuple[str, ...] | None] = {
    "kind": ("simulation", "physical"),  # physical: read by physical_config
    "robot": None,
    "tracker": None,
    "fidelity": ("kinematic", "dynamic"),
    "calibration": None,
    "poses": None,
    "cell": None,
}
_SECTIONS = ("rig", "buttons", "devices", "health")
_MOST_BUTTONS = 15


@dataclass(frozen=True)
class DeviceConfig:
    """Another tracked device. tracker: preset, or "" for the rig's own. position: m, velocity: m/s, both in the world.

    conveyor: name of the belt on which it lies, or "".
    """

    tracker: str = ""
    position: Triple = (0.8, -0.6, 0.4)
    velocity: Triple = (0.0, 0.0, 0.0)
    conveyor: str = ""


_ON_THE_LINE = DeviceConfig(position=(0.62, -0.3, 0.36), conveyor="belt")
"""The built-in rig's device on the belt of the cell `line`: behind the place where the tool works."""


@dataclass(frozen=True)
class RigConfig:
    """What a rig file says. name: as results call the rig. calibration: a file, or "" for a calibration of every run's own.

    poses: RAPID program with the calibration poses, or "" for the robot's. cell: a cell's name or folder, or "" for none.
    buttons: output of the controller -> button of the tracker, pressed above the output's threshold, 0 without one.
    devices: by name. folder: what paths are relative to.
    """

    name: str = "sim"
    kind: str = "simulation"
    robot: str = "irb140"
    tracker: str = "thesis"
    fidelity: str = "kinematic"
    calibration: str = ""
    poses: str = ""
    cell: str = "line"
    buttons: Mapping[str, int] = field(default_factory=lambda: {"doTrigger": 0, "aoTrigger": 1})
    thresholds: Mapping[str, float] = field(default_factory=lambda: {"aoTrigger": 5.0})
    devices: Mapping[str, DeviceConfig] = field(default_factory=lambda: {REFERENCE: DeviceConfig(), BELT: _ON_THE_LINE})
    folder: Path = Path()
    health: HealthGate | None = None


def read_rig(name_or_file: str) -> RigConfig:
    """Gives the built-in rig `sim`, or what a rig file says. Raises UsageError naming file and key."""
    if name_or_file == "sim":
        return RigConfig()
    file = Path(name_or_file)
    if not file.is_file():
        raise UsageError(f"no rig {name_or_file!r}: expected sim or a rig file (.toml) that exists")
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"{file}: not valid TOML: {error}") from error
    except OSError as error:
        raise UsageError(f"{file}: cannot be read: {error.strerror or error}") from error
    for section in table:
        _known(file, section, _SECTIONS, "unknown section or key")
    if not isinstance(table.get("rig"), dict):
        raise UsageError(f"{file}: expected a section [rig]")
    values: dict[str, Any] = {"name": file.stem, "folder": file.parent, **_texts(file, table["rig"])}
    values["health"] = health_gate(file, table)
    if "buttons" in table:
        values["buttons"], values["thresholds"] = _buttons(file, _section(file, table, "buttons"))
    if "devices" in table:
        values["devices"] = {
            name: _device(file, f"devices.{name}", _section(file, table["devices"], name, "devices."))
            for name in _section(file, table, "devices")
        }
    elif values.get("cell", RigConfig.cell) != RigConfig.cell:
        values["devices"] = {REFERENCE: DeviceConfig()}
    return RigConfig(**values)


def _known(file: Path, key: str, known: tuple[str, ...], what: str) -> None:
    if key not in known:
        near = difflib.get_close_matches(key, known, n=1)
        raise UsageError(f"{file}: {what} {key!r}" + (f"; did you mean {near[0]}?" if near else f", known are {', '.join(known)}"))


def _section(file: Path, table: Mapping[str, Any], key: str, prefix: str = "") -> Mapping[str, Any]:
    if not isinstance(table[key], dict):
        raise UsageError(f"{file}: {prefix}{key} must be a section [{prefix}{key}], is {table[key]!r}")
    section: Mapping[str, Any] = table[key]
    return section


def _texts(file: Path, table: Mapping[str, Any]) -> dict[str, str]:
    for key, value in table.items():
        _known(file, key, tuple(_TEXTS), "[rig] unknown key")
        if not isinstance(value, str):
            raise UsageError(f"{file}: [rig] {key} must be a string, is {value!r}")
        allowed = _TEXTS[key]
        if allowed and value not in allowed:
            raise UsageError(f"{file}: [rig] {key} = {value!r}: expected {' or '.join(allowed)}")
    return dict(table)


def _buttons(file: Path, table: Mapping[str, Any]) -> tuple[dict[str, int], dict[str, float]]:
    """Gives the button of every output, and the threshold of those that have one."""
    buttons, thresholds = {}, {}
    for signal, wire in table.items():
        button = wire
        if isinstance(wire, dict):
            for key in wire:
                _known(file, key, ("button", "above"), f"[buttons] {signal}: unknown key")
            button, above = wire.get("button"), wire.get("above", 0.0)
            if isinstance(above, bool) or not isinstance(above, int | float) or not math.isfinite(above):
                raise UsageError(f"{file}: [buttons] {signal}: above must be a number, is {above!r}")
            thresholds[signal] = float(above)
        if isinstance(button, bool) or not isinstance(button, int) or not 0 <= button < _MOST_BUTTONS:
            raise UsageError(f"{file}: [buttons] {signal} must be a button's number, 0 to {_MOST_BUTTONS - 1}, is {button!r}")
        buttons[signal] = button
    if len(set(buttons.values())) < len(buttons):
        raise UsageError(f"{file}: [buttons] two outputs drive one button; expected a button for each")
    return buttons, thresholds


def _device(file: Path, section: str, table: Mapping[str, Any]) -> DeviceConfig:
    values: dict[str, Any] = {}
    for key, value in table.items():
        _known(file, key, ("tracker", "position", "velocity", "conveyor"), f"[{section}] unknown key")
        if key in ("tracker", "conveyor"):
            if not isinstance(value, str):
                raise UsageError(f"{file}: [{section}] {key} must be a string, is {value!r}")
            values[key] = value
            continue
        if not isinstance(value, list) or len(value) != 3 or any(isinstance(v, bool) or not isinstance(v, int | float) for v in value):
            raise UsageError(f"{file}: [{section}] {key} must be three numbers, is {value!r}")
        values[key] = tuple(float(v) for v in value)
    if section == f"devices.{REFERENCE}" and (any(values.get("velocity", ())) or values.get("conveyor")):
        raise UsageError(f"{file}: [{section}] must have neither velocity nor conveyor: the reference stands still")
    if any(values.get("velocity", ())) and values.get("conveyor"):
        raise UsageError(f"{file}: [{section}] has a velocity and a conveyor; expected one of them")
    return DeviceConfig(**values)
