"""Tape: all that a case was told by its rig, in order, bit for bit, so that the case can be judged again without the rig.

Invariant: what is decoded equals what was encoded. Recorded paths keep times in nanoseconds, which is why they do not serve instead.
"""

from __future__ import annotations

import dataclasses
import hashlib
import io
import json
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mitl.errors import UsageError
from mitl.feedback import FeedbackSamples
from mitl.paths import PosePath
from mitl.protocols import AveragedPoint, ExecutionState, LoggedEvent
from mitl.samples import TrackerSamples

ATTACHMENT = "rig.tape"
"""Name of a tape among the attachments of a recording."""
SCHEMA = 1
BEGINS, ENDS = "begins", "ends"
"""Marks between which the case had the rig."""
ROUND = "another round"
"""Call that marks the beginning of a repetition of the case."""
MEASURED = "measured"
"""Call that marks the end of the case's own code; what follows closes it."""

_RECORDS = {kind.__name__: kind for kind in (PosePath, AveragedPoint, TrackerSamples, FeedbackSamples, LoggedEvent)}


@dataclass(frozen=True, eq=False)
class Call:
    """One call to a part of the rig ("controller", "tracker", "clock", "device belt"): what was asked, and what came back or was refused.

    time: s on the rig's clock when it was answered.
    """

    part: str
    method: str
    arguments: tuple[str | float, ...] = ()
    result: object = None
    refused: str | None = None
    time: float = 0.0

    @property
    def asked(self) -> str:
        """Gives the call as text."""
        return f"{self.part}.{self.method}({', '.join(map(repr, self.arguments))})"


@dataclass
class Tape:
    """The calls of one case. facts: what else judging again depends on, by name. now: the rig's clock, which every call is stamped with."""

    calls: list[Call] = field(default_factory=list)
    facts: dict[str, str] = field(default_factory=dict)
    now: Callable[[], float] = lambda: 0.0

    def keep(
        self, part: str, method: str, arguments: tuple[str | float, ...] = (), result: object = None, refused: str | None = None
    ) -> None:
        """Keeps a call that has been answered or refused."""
        self.calls.append(Call(part, method, arguments, result, refused, self.now()))

    def mark(self, method: str) -> None:
        """Puts a mark between the calls."""
        self.keep("case", method)


def encoded(tape: Tape) -> bytes:
    """Gives a tape as a compressed archive of one JSON text and its arrays; equal arrays are stored once."""
    store = _Arrays()
    calls = [
        [
            *(call.part, call.method, call.time, list(call.arguments), _packed(call.result, store)),
            *([call.refused] if call.refused is not None else []),
        ]
        for call in tape.calls
    ]
    text = json.dumps({"schema": SCHEMA, "facts": tape.facts, "calls": calls}, separators=(",", ":"))
    file = io.BytesIO()
    members: dict[str, Any] = {f"a{number}": array for number, array in enumerate(store.arrays)}
    np.savez_compressed(file, tape=np.frombuffer(text.encode(), dtype=np.uint8), **members)
    return file.getvalue()


def decoded(content: bytes, where: str) -> Tape:
    """Gives the tape in the archive. Raises UsageError, which names `where`, for anything else."""
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as archive:
            members = {name: archive[name] for name in archive.files}
        told = json.loads(members.pop("tape").tobytes())
        if told["schema"] != SCHEMA:
            raise UsageError(f"{where}: its tape has schema {told['schema']}; expected {SCHEMA}: record it again with this version of mitl")
        calls = [
            Call(part, method, tuple(arguments), _unpacked(result, members), refused[0] if refused else None, time)
            for part, method, time, arguments, result, *refused in told["calls"]
        ]
        return Tape(calls, {str(key): str(value) for key, value in told["facts"].items()})
    except (ValueError, KeyError, TypeError, IndexError, EOFError, zipfile.BadZipFile) as error:
        raise UsageError(f"{where}: its tape cannot be read: {error}") from error


class _Arrays:
    """Arrays by their content."""

    def __init__(self) -> None:
        self.arrays: list[NDArray[Any]] = []
        self._known: dict[str, int] = {}

    def place(self, array: NDArray[Any]) -> int:
        whole = np.ascontiguousarray(array)
        key = hashlib.sha256(f"{whole.dtype.str}{whole.shape}".encode() + whole.tobytes()).hexdigest()
        if key not in self._known:
            self._known[key] = len(self.arrays)
            self.arrays.append(whole)
        return self._known[key]


def _packed(value: object, store: _Arrays) -> object:
    """Gives a value as JSON: {"array": number}, {"state": name}, {"record": name, "of": fields}, or itself."""
    match value:
        case None | bool() | str():
            return value
        case np.ndarray():
            return {"array": store.place(value)}
        case np.generic():
            return value.item()
        case int() | float():
            return value
        case ExecutionState():
            return {"state": value.value}
        case list() | tuple():
            return [_packed(item, store) for item in value]
        case _ if type(value).__name__ in _RECORDS and dataclasses.is_dataclass(value):
            parts = {part.name: _packed(getattr(value, part.name), store) for part in dataclasses.fields(value)}
            return {"record": type(value).__name__, "of": parts}
        case _:
            raise TypeError(f"a rig gave a {type(value).__name__}, which a tape does not hold")


def _unpacked(value: Any, arrays: Mapping[str, NDArray[Any]]) -> object:  # noqa: ANN401 - a value of JSON
    match value:
        case {"array": int(number)}:
            return arrays[f"a{number}"]
        case {"state": str(name)}:
            return ExecutionState(name)
        case {"record": str(name), "of": dict(parts)}:
            fields: dict[str, Any] = {key: _unpacked(part, arrays) for key, part in parts.items()}
            return _RECORDS[name](**fields)
        case list():
            return [_unpacked(item, arrays) for item in value]
        case _:
            return value
