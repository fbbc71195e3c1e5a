"""Clocks for measuring time.

Invariant: a clock is (seconds counted, runs, started at); the time itself always comes as the reply to `ReadClock`.
"""

from __future__ import annotations

from collections.abc import Generator

from rapid_interp.effects import Effect, ReadClock, Reply, SourceLine
from rapid_interp.library.table import Effects, LibraryRoutine, number_told
from rapid_interp.running.values import Reference

RESOLUTION_S = 0.001


def _now(at: SourceLine) -> Generator[Effect, Reply, float]:
    return number_told((yield ReadClock(at)), "time")


def _start(at: SourceLine, clock: Reference) -> Effects:
    now = yield from _now(at)
    counted, runs, _ = clock.get()
    if not runs:
        clock.put((counted, True, now))


def _stop(at: SourceLine, clock: Reference) -> Effects:
    now = yield from _now(at)
    counted, runs, since = clock.get()
    if runs:
        clock.put((counted + now - since, False, 0.0))


def _reset(clock: Reference) -> None:
    clock.put((0.0, False, 0.0))


def _read(at: SourceLine, clock: Reference, _high_res: bool) -> Effects:
    now = yield from _now(at)
    counted, runs, since = clock.get()
    total = counted + (now - since if runs else 0.0)
    return round(total / RESOLUTION_S) * RESOLUTION_S


ROUTINES = (
    LibraryRoutine("PROC ClkReset(INOUT clock Clock)", _reset),
    LibraryRoutine("PROC ClkStart(INOUT clock Clock)", _start, True),
    LibraryRoutine("PROC ClkStop(INOUT clock Clock)", _stop, True),
    LibraryRoutine(r"FUNC num ClkRead(INOUT clock Clock \switch HighRes)", _read, True),
)
