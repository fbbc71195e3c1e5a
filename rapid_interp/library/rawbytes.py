r"""Raw bytes: packing and unpacking values, and files of bytes and of any data.

Invariant: data of type `rawbytes` is a Python `bytes` of at most 1024; indices are 1-based.
"""

from __future__ import annotations

import math
import struct
from typing import TYPE_CHECKING

from rapid_interp.library.files import device
from rapid_interp.library.table import LibraryRoutine
from rapid_interp.meaning.types import DNUM, NUM, STRING, RapidType, Value
from rapid_interp.running.format import literal
from rapid_interp.running.literals import value_of
from rapid_interp.running.numbers import num
from rapid_interp.running.sandbox import file_fault
from rapid_interp.running.values import MAX_STRING, Fault, Reference, error_number

if TYPE_CHECKING:
    from rapid_interp.running.task import Stepper

MOST_BYTES = 1024
_CODE = "latin-1"
_WHOLE = {1.0: "B", 2.0: "H", 4.0: "I", 8.0: "Q", -1.0: "b", -2.0: "h", -4.0: "i", -8.0: "q"}
"""Format of `struct` by the value of USINT, UINT, UDINT, ULINT, SINT, INT, DINT and LINT."""


def _wrong(message: str) -> Fault:
    return Fault(message, "RAPID-R337", number=error_number("ERR_ARGVALERR"))


def _place(raw: bytes, index: float, *, last: int) -> int:
    if index != int(index) or not 1 <= index <= last:
        raise Fault(f"index {index:g} is outside of 1..{last} in {len(raw)} raw bytes", "RAPID-R304", number=error_number("ERR_OUTOFBND"))
    return int(index) - 1


def _put(target: Reference, raw: bytes, place: int, packed: bytes) -> None:
    changed = raw[:place] + packed + raw[place + len(packed) :]
    if len(changed) > MOST_BYTES:
        raise _wrong(f"raw bytes hold at most {MOST_BYTES}, there would be {len(changed)}")
    target.put(changed)


def _whole_format(kind: float, network: bool) -> str:
    if kind not in _WHOLE:
        raise _wrong(f"\\IntX is USINT, UINT, UDINT, ULINT, SINT, INT, DINT or LINT, found {kind:g}")
    return (">" if network else "<") + _WHOLE[kind]


def _pack(
    typed: tuple[RapidType, Value],
    data: Reference,
    network: bool,
    start: float,
    hex1: bool,
    whole: float | None,
    float4: bool,
    ascii_: bool,
) -> None:
    kind, value = typed
    raw: bytes = data.get()
    place = _place(raw, start, last=len(raw) + 1)
    if kind not in (NUM, DNUM, STRING):
        raise _wrong(f"PackRawBytes takes a number or a string, not {kind.name}")
    try:
        if ascii_:
            packed = value.encode(_CODE) if kind is STRING else bytes([int(value)])
        elif kind is STRING:
            raise _wrong("PackRawBytes needs \\ASCII for a string")
        elif whole is not None:
            packed = struct.pack(_whole_format(whole, network), int(value))
        elif float4:
            packed = struct.pack(">f" if network else "<f", value)
        elif hex1:
            packed = bytes([int(value)])
        else:
            raise _wrong("PackRawBytes needs one of \\Hex1, \\IntX, \\Float4 and \\ASCII")
    except (struct.error, ValueError, OverflowError) as problem:
        raise _wrong(f"PackRawBytes: {value!r} does not fit: {problem}") from problem
    _put(data, raw, place, packed)


def _unpack(
    raw: bytes, network: bool, start: float, target: tuple[RapidType, Reference], hex1: bool, whole: float | None, float4: bool,
    characters: float | None,
) -> None:  # fmt: skip
    kind, reference = target
    place = _place(raw, start, last=len(raw))
    if characters is not None:
        if kind is not STRING:
            raise _wrong("UnpackRawBytes \\ASCII gives a string")
        if not 1 <= characters <= MAX_STRING or place + int(characters) > len(raw):
            raise _wrong(f"UnpackRawBytes: {characters:g} characters from {start:g} are not inside of {len(raw)} bytes")
        reference.put(raw[place : place + int(characters)].decode(_CODE))
        return
    if kind not in (NUM, DNUM):
        raise _wrong(f"UnpackRawBytes gives a number here, not {kind.name}")
    form = "<B" if hex1 else _whole_format(whole, network) if whole is not None else ">f" if network else "<f"
    if not (hex1 or float4 or whole is not None):
        raise _wrong("UnpackRawBytes needs one of \\Hex1, \\IntX, \\Float4 and \\ASCII")
    try:
        value = float(struct.unpack_from(form, raw, place)[0])
    except struct.error as problem:
        raise _wrong(f"UnpackRawBytes: too few bytes from {start:g} in {len(raw)}") from problem
    if not math.isfinite(value):
        raise _wrong("UnpackRawBytes: the bytes are no number")
    reference.put(num(value) if kind is NUM else value)


def _copy(source: bytes, start: float, target: Reference, to: float, count: float | None) -> None:
    begin = _place(source, start, last=max(1, len(source)))
    piece = source[begin:] if count is None else source[begin : begin + int(count)]
    into: bytes = target.get()
    _put(target, into, _place(into, to, last=len(into) + 1), piece)


def _clear(data: Reference, start: float | None) -> None:
    raw: bytes = data.get()
    data.put(b"" if start is None else raw[: _place(raw, start, last=len(raw) + 1)])


def _write_raw(task: Stepper, handle: float, raw: bytes, count: float | None) -> None:
    device(task).write(handle, raw if count is None else raw[: int(count)])


def _read_raw(task: Stepper, handle: float, data: Reference, _time: Value) -> None:
    data.put(device(task).read(handle, MOST_BYTES))


def _write_any(task: Stepper, handle: float, typed: tuple[RapidType, Value]) -> None:
    """ASSUMPTION A-170: the bytes of WriteAnyBin are ours, the literal with its length before it; ReadAnyBin reads them again."""
    text = literal(typed[1]).encode(_CODE, errors="replace")
    device(task).write(handle, struct.pack("<I", len(text)) + text)


def _read_any(task: Stepper, handle: float, target: tuple[RapidType, Reference], _time: Value) -> None:
    kind, reference = target
    head = device(task).read(handle, 4)
    text = device(task).read(handle, struct.unpack("<I", head)[0]).decode(_CODE) if len(head) == 4 else ""
    value = value_of(kind, text[1:-1].replace('""', '"').replace("\\\\", "\\") if kind is STRING else text) if text else None
    if value is None:
        raise file_fault(f"the file holds no {kind.name} here", "ERR_RCVDATA")
    reference.put(value)


_FORM = r"\switch Hex1 | num IntX | switch Float4"
ROUTINES = (
    LibraryRoutine(
        rf"PROC PackRawBytes(anytype Value, INOUT rawbytes RawData \switch Network, num StartIndex {_FORM} | switch ASCII)", _pack
    ),
    LibraryRoutine(
        rf"PROC UnpackRawBytes(rawbytes RawData \switch Network, num StartIndex, INOUT anydata Value {_FORM} | num ASCII)", _unpack
    ),
    LibraryRoutine(r"PROC CopyRawBytes(rawbytes FromRawData, num FromIndex, INOUT rawbytes ToRawData, num ToIndex \num NoOfBytes)", _copy),
    LibraryRoutine(r"PROC ClearRawBytes(INOUT rawbytes RawData \num FromIndex)", _clear),
    LibraryRoutine("FUNC num RawBytesLen(rawbytes RawData)", lambda raw: float(len(raw))),
    LibraryRoutine(r"PROC WriteRawBytes(iodev IODevice, rawbytes RawData \num NoOfBytes)", _write_raw, task=True),
    LibraryRoutine(r"PROC ReadRawBytes(iodev IODevice, INOUT rawbytes RawData \num Time)", _read_raw, task=True),
    LibraryRoutine("PROC WriteAnyBin(iodev IODevice, anytype Data)", _write_any, task=True),
    LibraryRoutine(r"PROC ReadAnyBin(iodev IODevice, INOUT anydata Data \num Time)", _read_any, task=True),
)
