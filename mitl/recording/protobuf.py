"""Messages of fixed size in protobuf's wire format, encoded and decoded as arrays, with their schemas.

A numeric message here always has the same length: every field is written even where zero, numbers are doubles, and the two varints
of the timestamp are padded to a fixed width, which the format allows. So N messages are one structured array, and encoding costs
no loop in Python. Messages of other writers (shorter varints, missing zeros) are read one by one.
Source: protobuf.dev, "Encoding"; schemas: github.com/foxglove/foxglove-sdk, schemas/proto/foxglove.
Invariant: what is written is what a protobuf library reads by the schema beside it.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mitl.paths import FloatArray

Bytes = NDArray[np.uint8]
Nanoseconds = NDArray[np.int64]

_VARINT, _DOUBLE, _LENGTH, _FIXED32 = 0, 1, 2, 5
_WIDTH = 5  # bytes of a padded varint: 35 bits, enough for seconds until the year 3058
_TYPE_DOUBLE, _TYPE_INT64, _TYPE_INT32, _TYPE_STRING, _TYPE_MESSAGE = 1, 3, 5, 9, 11


def varint(value: int) -> bytes:
    """Gives a non-negative integer as a varint."""
    out = bytearray()
    while value > 0x7F:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    out.append(value)
    return bytes(out)


def _tag(number: int, wire: int) -> bytes:
    return varint(number << 3 | wire)


def _block(number: int, content: bytes) -> bytes:
    return _tag(number, _LENGTH) + varint(len(content)) + content


@dataclass(frozen=True, eq=False)
class FixedMessage:
    """A message of fixed size. template: its bytes with zeros for what varies. fixed: (size,) bool, bytes that never vary.

    seconds, nanos: offsets of the two padded varints. doubles: offsets of the k numbers.
    """

    template: Bytes
    fixed: NDArray[np.bool_]
    seconds: int
    nanos: int
    doubles: tuple[int, ...]

    @property
    def size(self) -> int:
        """Gives the length of a message in bytes."""
        return len(self.template)

    def encode(self, nanoseconds: Nanoseconds, values: FloatArray) -> Bytes:
        """Gives N messages (N, size) from times (N,) and numbers (N, k)."""
        out = np.tile(self.template, (len(nanoseconds), 1))
        out[:, self.seconds : self.seconds + _WIDTH] = _padded(nanoseconds // 1_000_000_000)
        out[:, self.nanos : self.nanos + _WIDTH] = _padded(nanoseconds % 1_000_000_000)
        raw = np.ascontiguousarray(values, dtype="<f8").view(np.uint8).reshape(len(values), len(self.doubles), 8)
        for i, offset in enumerate(self.doubles):
            out[:, offset : offset + 8] = raw[:, i]
        return out

    def fits(self, messages: Bytes) -> bool:
        """Gives whether all messages (N, size) have this layout."""
        return bool(np.all(messages[:, self.fixed] == self.template[self.fixed]))

    def decode(self, messages: Bytes) -> FloatArray:
        """Gives the numbers (N, k) of messages (N, size) that fit."""
        out = np.empty((len(messages), len(self.doubles)))
        for i, offset in enumerate(self.doubles):
            out[:, i] = np.ascontiguousarray(messages[:, offset : offset + 8]).view("<f8")[:, 0]
        return out


def _padded(values: Nanoseconds) -> Bytes:
    """Gives integers (N,) of up to 35 bits as varints of fixed width (N, 5)."""
    shifts = np.arange(_WIDTH) * 7
    groups = (values[:, None] >> shifts) & 0x7F
    groups[:, :-1] |= 0x80
    return groups.astype(np.uint8)


class _Layout:
    """Builds a FixedMessage piece by piece."""

    def __init__(self) -> None:
        self.bytes = bytearray()
        self.varying: list[tuple[int, int]] = []
        self.doubles: list[int] = []

    def put(self, content: bytes) -> None:
        self.bytes += content

    def vary(self, width: int) -> int:
        offset = len(self.bytes)
        self.varying.append((offset, width))
        self.bytes += bytes(width)
        return offset

    def double(self, number: int) -> None:
        self.put(_tag(number, _DOUBLE))
        self.doubles.append(self.vary(8))

    def timestamp(self) -> tuple[int, int]:
        self.put(_tag(1, _LENGTH) + varint(2 * (1 + _WIDTH)) + _tag(1, _VARINT))
        seconds = self.vary(_WIDTH)
        self.put(_tag(2, _VARINT))
        return seconds, self.vary(_WIDTH)

    def message(self, seconds: int, nanos: int) -> FixedMessage:
        fixed = np.ones(len(self.bytes), dtype=np.bool_)
        for offset, width in self.varying:
            fixed[offset : offset + width] = False
        return FixedMessage(np.frombuffer(bytes(self.bytes), dtype=np.uint8), fixed, seconds, nanos, tuple(self.doubles))


def pose_message(frame: str) -> FixedMessage:
    """Gives foxglove.PoseInFrame for one frame_id; its numbers are x y z qx qy qz qw, in the order of the fields."""
    layout = _Layout()
    seconds, nanos = layout.timestamp()
    layout.put(_block(2, frame.encode()))
    vector, quaternion = 3 * 9, 4 * 9
    layout.put(_tag(3, _LENGTH) + varint(2 + vector + 2 + quaternion))
    layout.put(_tag(1, _LENGTH) + varint(vector))
    for number in (1, 2, 3):
        layout.double(number)
    layout.put(_tag(2, _LENGTH) + varint(quaternion))
    for number in (1, 2, 3, 4):
        layout.double(number)
    return layout.message(seconds, nanos)


def series_message(count: int) -> FixedMessage:
    """Gives the message of a series with `count` columns: timestamp = 1, then one double a column from 2 on."""
    layout = _Layout()
    seconds, nanos = layout.timestamp()
    for number in range(2, 2 + count):
        layout.double(number)
    return layout.message(seconds, nanos)


# ---------------------------------------------------------------- schemas: descriptor.proto's FileDescriptorSet by hand


def _field(name: str, number: int, kind: int, type_name: str = "") -> bytes:
    content = _block(1, name.encode()) + _tag(3, _VARINT) + varint(number) + _tag(4, _VARINT) + varint(1)  # label: optional
    content += _tag(5, _VARINT) + varint(kind)
    if type_name:
        content += _block(6, type_name.encode())
    return _block(2, content)


def _file(name: str, package: str, message: str, fields: list[bytes], imports: tuple[str, ...] = ()) -> bytes:
    content = _block(1, name.encode()) + _block(2, package.encode())
    content += b"".join(_block(3, other.encode()) for other in imports)
    content += _block(4, _block(1, message.encode()) + b"".join(fields)) + _block(12, b"proto3")
    return _block(1, content)


_TIMESTAMP_FILE = "google/protobuf/timestamp.proto"
_TIMESTAMP = _file(_TIMESTAMP_FILE, "google.protobuf", "Timestamp", [_field("seconds", 1, _TYPE_INT64), _field("nanos", 2, _TYPE_INT32)])
_STAMP_FIELD = _field("timestamp", 1, _TYPE_MESSAGE, ".google.protobuf.Timestamp")


def pose_schema() -> bytes:
    """Gives the FileDescriptorSet of foxglove.PoseInFrame."""
    doubles = {name: number for number, name in enumerate("xyzw", start=1)}
    vector = [_field(name, doubles[name], _TYPE_DOUBLE) for name in "xyz"]
    quaternion = [_field(name, doubles[name], _TYPE_DOUBLE) for name in "xyzw"]
    pose = [
        _field("position", 1, _TYPE_MESSAGE, ".foxglove.Vector3"),
        _field("orientation", 2, _TYPE_MESSAGE, ".foxglove.Quaternion"),
    ]
    in_frame = [_STAMP_FIELD, _field("frame_id", 2, _TYPE_STRING), _field("pose", 3, _TYPE_MESSAGE, ".foxglove.Pose")]
    return (
        _TIMESTAMP
        + _file("foxglove/Vector3.proto", "foxglove", "Vector3", vector)
        + _file("foxglove/Quaternion.proto", "foxglove", "Quaternion", quaternion)
        + _file("foxglove/Pose.proto", "foxglove", "Pose", pose, ("foxglove/Vector3.proto", "foxglove/Quaternion.proto"))
        + _file("foxglove/PoseInFrame.proto", "foxglove", "PoseInFrame", in_frame, (_TIMESTAMP_FILE, "foxglove/Pose.proto"))
    )


def series_schema(message: str, fields: tuple[str, ...]) -> bytes:
    """Gives the FileDescriptorSet of mitl.<message> with a timestamp and one double a field; names must be identifiers."""
    numbers = [_field(name, number, _TYPE_DOUBLE) for number, name in enumerate(fields, start=2)]
    return _TIMESTAMP + _file(f"mitl/{message}.proto", "mitl", message, [_STAMP_FIELD, *numbers], (_TIMESTAMP_FILE,))


# ---------------------------------------------------------------- messages of other writers, one by one


def fields_of(data: bytes) -> dict[int, int | bytes]:
    """Gives the fields of any message by number: varints as int, the rest as bytes; of a repeated field the last.

    Raises ValueError where the bytes are no message.
    """
    fields: dict[int, int | bytes] = {}
    at = 0
    while at < len(data):
        key, at = _read_varint(data, at)
        number, wire = key >> 3, key & 7
        if wire == _VARINT:
            fields[number], at = _read_varint(data, at)
            continue
        if wire == _LENGTH:
            size, at = _read_varint(data, at)
        elif wire == _DOUBLE:
            size = 8
        elif wire == _FIXED32:
            size = 4
        else:
            raise ValueError(f"unknown wire type {wire}")
        if at + size > len(data):
            raise ValueError("the message ends within a field")
        fields[number] = data[at : at + size]
        at += size
    return fields


def _read_varint(data: bytes, at: int) -> tuple[int, int]:
    value = shift = 0
    while True:
        if at >= len(data) or shift > 63:
            raise ValueError("the message ends within a number")
        byte = data[at]
        value |= (byte & 0x7F) << shift
        at += 1
        shift += 7
        if byte < 0x80:
            return value, at


def block_of(fields: dict[int, int | bytes], number: int) -> bytes:
    """Gives a field that holds bytes, empty where it is absent, as zeros are in proto3."""
    content = fields.get(number, b"")
    if not isinstance(content, bytes):
        raise ValueError(f"field {number} holds no bytes")  # noqa: TRY004 - the data is wrong, not the caller
    return content


def double_of(fields: dict[int, int | bytes], number: int) -> float:
    """Gives a field that holds a double, zero where it is absent."""
    content = block_of(fields, number)
    if len(content) not in {0, 8}:
        raise ValueError(f"field {number} holds no double")
    return float(struct.unpack("<d", content)[0]) if content else 0.0
