"""The section [health] of a rig file: what a run asks of the rig's latest health check (`mitl health`). The same for all kinds of rigs.

[health]
record = "health.json"      # where the latest result is kept, beside the rig file
baseline = "healthy.json"   # what the rig showed when it was known to be well; without it figures have their own limits alone
max_age_h = 24              # older ones do not count
on_sick = "refuse"          # a run on a sick rig is refused; "mark": it is run, and every case says so
"""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from mitl.errors import UsageError
from mitl.protocols import HealthGate

_KEYS = ("record", "baseline", "max_age_h", "on_sick")
_ON_SICK = ("refuse", "mark")
_MOST_HOURS = 8760.0


def health_gate(file: Path, table: Mapping[str, Any]) -> HealthGate | None:
    """Gives what a rig file's table says in [health], or None where it has no such section. Raises UsageError naming file and key."""
    if "health" not in table:
        return None
    section = table["health"]
    if not isinstance(section, dict):
        raise UsageError(f"{file}: health must be a section [health], is {section!r}")
    for key in section:
        if key not in _KEYS:
            near = difflib.get_close_matches(key, _KEYS, n=1)
            raise UsageError(
                f"{file}: [health] unknown key {key!r}" + (f"; did you mean {near[0]}?" if near else f", known are {', '.join(_KEYS)}")
            )
    for key in ("record", "baseline"):
        if key in section and (not isinstance(section[key], str) or not section[key]):
            raise UsageError(f"{file}: [health] {key} must be the name of a file, is {section[key]!r}")
    if "record" not in section:
        raise UsageError(f"{file}: [health] record is missing: the file that mitl health writes")
    gate = HealthGate(file.parent / section["record"])
    if "baseline" in section:
        gate = replace(gate, baseline=file.parent / section["baseline"])
        if gate.baseline == gate.record:
            raise UsageError(f"{file}: [health] record and baseline are the same file; expected two")
    hours = section.get("max_age_h", gate.max_age_h)
    if isinstance(hours, bool) or not isinstance(hours, int | float) or not 0.0 < hours <= _MOST_HOURS:
        raise UsageError(f"{file}: [health] max_age_h = {hours!r}: expected more than 0 and at most {_MOST_HOURS:g} hours")
    on_sick = section.get("on_sick", gate.on_sick)
    if on_sick not in _ON_SICK:
        raise UsageError(f"{file}: [health] on_sick = {on_sick!r}: expected {' or '.join(_ON_SICK)}")
    return replace(gate, max_age_h=float(hours), on_sick=on_sick)


def gate_of(name_or_file: str) -> HealthGate | None:
    """Gives the gate of a rig by its name or file; None where there is none, or no such file, of which the rig's reader tells."""
    file = Path(name_or_file)
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        return None
    return health_gate(file, table)
