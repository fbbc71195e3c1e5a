"""RigConfig: a rig file, read strictly. An unknown key is refused, because a misspelt one would silently mean its default.

[rig]
kind = "simulation"     # the only kind so far
robot = "irb140"        # a folder in models/
tracker = "thesis"      # a preset in models/trackers/
fidelity = "kinematic"  # the executed trajectory is played back; "dynamic": servo, gravity, tracker on a compliant mount
"""

from __future__ import annotations

import difflib
import tomllib
from dataclasses import dataclass, fields
from pathlib import Path

from mitl.errors import UsageError

_CHOICES = {"kind": ("simulation",), "fidelity": ("kinematic", "dynamic")}


@dataclass(frozen=True)
class RigConfig:
    """What a rig file says. name: as results call the rig."""

    name: str = "sim"
    kind: str = "simulation"
    robot: str = "irb140"
    tracker: str = "thesis"
    fidelity: str = "kinematic"


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
        if section != "rig":
            raise UsageError(f"{file}: unknown section or key {section!r}, expected only [rig]")
    wanted = table.get("rig")
    if not isinstance(wanted, dict):
        raise UsageError(f"{file}: expected a section [rig]")
    values: dict[str, str] = {"name": file.stem}
    known = [field.name for field in fields(RigConfig)]
    for key, value in wanted.items():
        if key not in known:
            near = difflib.get_close_matches(key, known, n=1)
            raise UsageError(
                f"{file}: [rig] unknown key {key!r}{f'; did you mean {near[0]}?' if near else f', known are {chr(44).join(known)}'}"
            )
        if not isinstance(value, str):
            raise UsageError(f"{file}: [rig] {key} must be a string, is {value!r}")
        if key in _CHOICES and value not in _CHOICES[key]:
            raise UsageError(f"{file}: [rig] {key} = {value!r}: expected {' or '.join(_CHOICES[key])}")
        values[key] = value
    return RigConfig(**values)
