"""Signals under other names, and what can be asked about signals and data themselves.

Invariant: a signal variable holds the name of the signal that it stands for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rapid_interp.effects import ReadSignal, SourceLine
from rapid_interp.library.signals import signal_name
from rapid_interp.library.table import Effects, LibraryRoutine
from rapid_interp.meaning.types import RapidType, Value
from rapid_interp.running.values import Fault, Reference, SlotReference, error_number

if TYPE_CHECKING:
    from rapid_interp.running.task import Stepper


def _signal_variable(target: tuple[RapidType, Reference]) -> Reference:
    kind, variable = target
    if not kind.name.startswith("signal"):
        raise Fault(f"an alias needs a signal variable, found {kind.name}", "RAPID-R320", number=error_number("ERR_ALIASIO_TYPE"))
    return variable


def _alias(source: Value, target: tuple[RapidType, Reference]) -> None:
    _signal_variable(target).put(signal_name(source))


def _forget(target: tuple[RapidType, Reference]) -> None:
    _signal_variable(target).put("")


def _valid(at: SourceLine, signal: Value) -> Effects:
    if not signal:
        return False
    try:
        yield ReadSignal(at, str(signal))
    except Fault:
        return False
    return True


def _stored(task: Stepper, typed: tuple[RapidType, Reference], storage: str) -> bool:
    origin = typed[1].origin()
    if isinstance(origin, SlotReference) and origin.slots is task.globals:
        symbol = task.modules.by_slot(origin.slot)
        return symbol is not None and symbol.storage == storage
    return storage == "VAR" and isinstance(origin, SlotReference)


ROUTINES = (
    LibraryRoutine("PROC AliasIO(signalname FromSignal, INOUT anydata ToSignal)", _alias),
    LibraryRoutine("PROC AliasIOReset(INOUT anydata Signal)", _forget),
    LibraryRoutine("FUNC bool ValidIO(signalname Signal)", _valid, True),
    LibraryRoutine("FUNC bool IsPers(INOUT anydata DatObj)", lambda task, data: _stored(task, data, "PERS"), task=True),
    LibraryRoutine("FUNC bool IsVar(INOUT anydata DatObj)", lambda task, data: _stored(task, data, "VAR"), task=True),
)
