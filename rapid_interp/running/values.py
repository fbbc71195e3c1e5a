"""Values while a program runs: references to data, faults, and the bridge between tuples and the records of `data`.

Invariant: values are immutable, so that assigning is copying; changing a part of a record makes a new one. An array whose elements are
changed becomes a list that its slot alone has, and a tuple again (`frozen`) when it is read as a whole.
"""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any, cast
from zlib import crc32

from rapid_interp import data
from rapid_interp.meaning.types import Value

MAX_STRING = 80


class Fault(Exception):  # noqa: N818 - becomes a RapidError once the task has added the place
    """Something that a RAPID program did wrong; `start` is an offset into the source if narrower than the statement."""

    def __init__(self, message: str, code: str = "RAPID-R300", *, start: int | None = None, number: float | None = None) -> None:
        super().__init__(message)
        self.code = code
        self.start = start
        self.number = number


def error_number(name: str) -> float:
    """Gives the number of an ERR_ constant.

    ASSUMPTION A-28: the numbers are ours, made from the names; RAPID programs only compare them.
    """
    return 1000.0 + crc32(name.lower().encode()) % 1_000_000


class Absent:
    """Value of an optional parameter that was not given."""

    def __repr__(self) -> str:
        return "ABSENT"


ABSENT = Absent()


class Reference:
    """A place that holds a value: what INOUT, VAR and PERS parameters receive."""

    __slots__ = ()

    def get(self) -> Value:
        """Gives the value."""
        raise NotImplementedError

    def put(self, value: Value) -> None:
        """Changes the value."""
        raise NotImplementedError

    def raw(self) -> Value:
        """Gives the value as it lies there; an array may be a list. For reading elements only."""
        return self.get()

    def origin(self) -> Reference:
        """Gives the reference to the whole data that this is a part of."""
        return self

    def put_element(self, places: tuple[int, ...], value: Value) -> None:
        """Changes an element of an array by its 0-based places."""
        self.put(replaced(self.get(), places, value))


class SlotReference(Reference):
    """A slot of a frame or of the globals."""

    __slots__ = ("slot", "slots")

    def __init__(self, slots: list[Value], slot: int) -> None:
        self.slots = slots
        self.slot = slot

    def get(self) -> Value:
        """Gives the value."""
        value = self.slots[self.slot]
        if value.__class__ is list:
            value = self.slots[self.slot] = frozen(value)
        return value

    def put(self, value: Value) -> None:
        """Changes the value."""
        self.slots[self.slot] = value

    def raw(self) -> Value:
        """Gives the value as it lies there."""
        return self.slots[self.slot]

    def put_element(self, places: tuple[int, ...], value: Value) -> None:
        """Changes an element in place: the array becomes a list that only this slot has."""
        array = self.slots[self.slot]
        if array.__class__ is not list:
            array = self.slots[self.slot] = list(array)
        for place in places[:-1]:
            inner = array[place]
            if inner.__class__ is not list:
                inner = array[place] = list(inner)
            array = inner
        array[places[-1]] = value


class ElementReference(Reference):
    """An element of an array, by 0-based places."""

    __slots__ = ("_places", "_whole")

    def __init__(self, whole: Reference, places: tuple[int, ...]) -> None:
        self._whole = whole
        self._places = places

    def origin(self) -> Reference:
        """Gives the reference to the whole data that this is a part of."""
        return self._whole.origin()

    def get(self) -> Value:
        """Gives the value."""
        value = self._whole.raw()
        for place in self._places:
            value = value[place]
        return value

    def put(self, value: Value) -> None:
        """Changes the value."""
        self._whole.put_element(self._places, value)


class PartReference(Reference):
    """A component inside the value of another reference."""

    __slots__ = ("_place", "_whole")

    def __init__(self, whole: Reference, place: int) -> None:
        self._whole = whole
        self._place = place

    def origin(self) -> Reference:
        """Gives the reference to the whole data that this is a part of."""
        return self._whole.origin()

    def get(self) -> Value:
        """Gives the value."""
        return self._whole.get()[self._place]

    def put(self, value: Value) -> None:
        """Changes the value."""
        self._whole.put(replaced(self._whole.get(), (self._place,), value))


class FixedReference(Reference):
    """A value without a place, such as the name of a signal; changing it does nothing."""

    __slots__ = ("_value",)

    def __init__(self, value: Value) -> None:
        self._value = value

    def get(self) -> Value:
        """Gives the value."""
        return self._value

    def put(self, value: Value) -> None:
        """Changes nothing: there is no place."""


def frozen(value: Value) -> Value:
    """Gives an array as the tuple that everything but element access works with."""
    if value.__class__ is list:
        return tuple([frozen(item) if item.__class__ is list else item for item in value])
    return value


def replaced(whole: Value, path: tuple[int, ...], value: Value) -> Value:
    """Gives `whole` with the part at `path` exchanged."""
    place = path[0]
    part = value if len(path) == 1 else replaced(whole[place], path[1:], value)
    return (*whole[:place], part, *whole[place + 1 :])


_PYTHON_RECORDS: dict[str, tuple[type, tuple[str, ...]]] = {
    "pos": (data.Pos, ("",) * 3),
    "orient": (data.Orient, ("",) * 4),
    "pose": (data.Pose, ("pos", "orient")),
    "confdata": (data.ConfData, ("",) * 4),
    "extjoint": (data.ExtJoint, ("",) * 6),
    "robjoint": (data.RobJoint, ("",) * 6),
    "robtarget": (data.RobTarget, ("pos", "orient", "confdata", "extjoint")),
    "jointtarget": (data.JointTarget, ("robjoint", "extjoint")),
    "loaddata": (data.LoadData, ("", "pos", "orient", "", "", "")),
    "tooldata": (data.ToolData, ("", "pose", "loaddata")),
    "wobjdata": (data.WObjData, ("", "", "", "pose", "pose")),
    "speeddata": (data.SpeedData, ("",) * 4),
    "zonedata": (data.ZoneData, ("",) * 7),
}


def is_python_record(name: str) -> bool:
    """Gives whether `data` has a class for this record type."""
    return name in _PYTHON_RECORDS


def to_record(name: str, value: Value) -> Any:  # noqa: ANN401 - one of the classes of `data`, by name
    """Gives the record of `data` for a value of the predefined record type `name`."""
    made, parts = _PYTHON_RECORDS[name]
    return made(*(to_record(part, item) if part else item for part, item in zip(parts, value, strict=True)))


def from_record(record: Any) -> Value:  # noqa: ANN401 - one of the classes of `data`
    """Gives the value for a record of `data`."""
    if not is_dataclass(record):
        return float(record) if isinstance(record, int) and not isinstance(record, bool) else record
    return tuple(from_record(getattr(record, part.name)) for part in fields(record))


def robtarget(value: Value) -> data.RobTarget:
    """Gives the robtarget of a value."""
    return cast(data.RobTarget, to_record("robtarget", value))
