"""The library as a whole: finds a routine by its name.

Invariant: names are unique over all families. A new family is added to `_FAMILIES` and nowhere else.
"""

from __future__ import annotations

from functools import cache

from rapid_interp.library import (
    aliases,
    bits,
    calibration,
    clocks,
    dialogs,
    events,
    files,
    guidance,
    interrupts,
    maths,
    matrices,
    messages,
    modules,
    motion,
    operator,
    poses,
    positions,
    queries,
    rawbytes,
    recorder,
    refused,
    settings,
    signals,
    sockets,
    system,
    text,
    text_tables,
    trigger_arrays,
    triggers,
    variables,
    zones,
)
from rapid_interp.library.table import LibraryRoutine

_FAMILIES = (
    motion, settings, triggers, trigger_arrays, positions, recorder, zones, guidance, signals, aliases, interrupts, events, operator,
    dialogs, clocks, system, queries, variables, maths, bits, poses, matrices, calibration, text, text_tables, rawbytes,
    files, modules, messages, sockets, refused,
)  # fmt: skip


@cache
def catalogue() -> dict[str, LibraryRoutine]:
    """Gives all routines of the library by their names in lower case."""
    return {routine.name.lower(): routine for family in _FAMILIES for routine in family.ROUTINES}
