"""PERS data that several tasks share.

Invariant: a task sees the common values whenever it goes on and gives its own back at each of its effects. Between two effects of a task
no other task runs, so that this is the same as one place for all.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from rapid_interp.errors import RapidError
from rapid_interp.meaning.symbols import DataSymbol
from rapid_interp.meaning.types import Value, default_value, fits
from rapid_interp.running.values import frozen


@dataclass(slots=True)
class SharedData:
    """The common values by the names of the data in lower case."""

    values: dict[str, Value] = field(default_factory=dict)

    def pull(self, slots: Mapping[str, int], own: list[Value]) -> None:
        """Puts the common values into a task's own data."""
        for name, slot in slots.items():
            own[slot] = self.values[name]

    def push(self, slots: Mapping[str, int], own: list[Value]) -> None:
        """Takes the values of a task's own data as the common ones."""
        for name, slot in slots.items():
            own[slot] = self.values[name] = frozen(own[slot])


def shared_slots(data: Mapping[str, Sequence[DataSymbol]]) -> dict[str, dict[str, int]]:
    """Gives for each task the slots of its global PERS that another task declares too. Raises `RapidError` where their types differ."""
    declared: dict[str, list[tuple[str, DataSymbol]]] = {}
    for task, symbols in data.items():
        for symbol in symbols:
            if symbol.storage == "PERS" and not symbol.scope:
                declared.setdefault(symbol.name.lower(), []).append((task, symbol))
    found: dict[str, dict[str, int]] = {task: {} for task in data}
    for name, owners in declared.items():
        if len(owners) < 2:
            continue
        first_task, first = owners[0]
        for task, symbol in owners:
            if not fits(symbol.type, first.type):
                message = f"PERS {first.name}: {first.type.name} in task {first_task}, but {symbol.type.name} in task {task}"
                raise RapidError(message, code="RAPID-R364")
            found[task][name] = symbol.slot
    return found


def common_values(slots: Mapping[str, Mapping[str, int]], initial: Mapping[str, Sequence[Value]], data: Sequence[DataSymbol]) -> SharedData:
    """Gives the common values at the start.

    ASSUMPTION A-84: that of the first task which gives one other than zeros, as only one task should.
    """
    defaults = {symbol.name.lower(): default_value(symbol.type) for symbol in data}
    shared = SharedData()
    for task, names in slots.items():
        for name, slot in names.items():
            value = initial[task][slot]
            if name not in shared.values or shared.values[name] == defaults.get(name):
                shared.values[name] = value
    return shared
