"""Instructions that change data, and functions that ask about it.

Invariant: changes go through the reference that the caller gave.
"""

from __future__ import annotations

from rapid_interp.library.table import LibraryRoutine
from rapid_interp.meaning.types import NUM, RapidType, Value
from rapid_interp.running.numbers import add
from rapid_interp.running.values import Fault, Reference


def _changed(data: tuple[RapidType, Reference], by: float) -> None:
    kind, reference = data
    before = reference.get()
    reference.put(add(before, by) if kind is NUM else before + by)


def _incr(data: tuple[RapidType, Reference]) -> None:
    _changed(data, 1.0)


def _decr(data: tuple[RapidType, Reference]) -> None:
    _changed(data, -1.0)


def _clear(name: Reference) -> None:
    name.put(0.0)


def _dim(typed: tuple[object, Value], number: float) -> float:
    value = typed[1]
    for _ in range(int(number) - 1):
        if not isinstance(value, tuple) or not value:
            break
        value = value[0]
    if number < 1 or not isinstance(value, tuple):
        raise Fault(f"the array has no dimension {number:g}", "RAPID-R330")
    return float(len(value))


def _try_int(value: float) -> None:
    if value != int(value):
        raise Fault(f"{value:g} is no integer", "RAPID-R331")


ROUTINES = (
    LibraryRoutine("PROC Incr(INOUT numericdata Name)", _incr),
    LibraryRoutine("PROC Decr(INOUT numericdata Name)", _decr),
    LibraryRoutine("PROC Add(INOUT numericdata Name, numeric AddValue)", _changed),
    LibraryRoutine("PROC Clear(INOUT numeric Name)", _clear),
    LibraryRoutine("PROC TryInt(numeric DataObj)", _try_int),
    LibraryRoutine("FUNC num Dim(anytype ArrPar, num DimNo)", _dim),
)
