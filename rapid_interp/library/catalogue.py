"""The library as a whole: finds a routine by its name.

Invariant: names are unique over all families. A new family is added to `_FAMILIES` and nowhere else.
"""

from __future__ import annotations

from functools import cache

from rapid_interp.library import (
    bits,
    clocks,
    dialogs,
    files,
    interrupts,
    maths,
    motion,
    operator,
    pending,
    poses,
    positions,
    refused,
    settings,
    signals,
    system,
    text,
    triggers,
    variables,
)
from rapid_interp.library.table import LibraryRoutine

_FAMILIES = (
    motion, settings, triggers, positions, signals, interrupts, operator, dialogs, clocks, system, variables, maths, bits, poses, text,
    files, refused, pending,
)  # fmt: skip


@cache
def catalogue() -> dict[str, LibraryRoutine]:
    """Gives all routines of the library by their names in lower case."""
    return {routine.name.lower(): routine for family in _FAMILIES for routine in family.ROUTINES}
