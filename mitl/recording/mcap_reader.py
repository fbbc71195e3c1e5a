"""Reads recordings back into arrays, also those that were cut off, and pose topics of other writers.

Invariant: every chunk that is whole is read; where a file ends early, `Recording.damage` says so.
"""

from __future__ import annotations

import io
import json
import mmap
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, Metadata, Schema
from mcap.stream_reader import get_chunk_data_stream

from mitl.errors import UsageError
from mitl.paths import BoolArray, FloatArray, PosePath
from mitl.recording.mcap_writer import LEVELS, VALID_SUFFIX
from mitl.recording.protobuf import Bytes, Nanoseconds, block_of, double_of, fields_of, pose_message, series_message
from mitl.recording.records import LogMessage, PoseTrack, Recording, Series

_MAGIC = b"\x89MCAP0\r\n"
_HEAD = struct.Struct("<BQ")  # opcode and length before every record
_MESSAGE = struct.Struct("<HIQQ")  # channel, sequence, log time, publish time before a message's data
_POSE = "foxglove.PoseInFrame"


@dataclass(eq=False)
class _Pieces:
    """Raw messages of one channel: times and contents, chunk by chunk."""

    times: list[Nanoseconds] = field(default_factory=list)
    contents: list[list[bytes] | Bytes] = field(default_factory=list)


@dataclass(eq=False)
class _Contents:
    """What has been read from a file so far."""

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    pieces: dict[int, _Pieces] = field(default_factory=dict)
    metadata: dict[str, str] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    damage: str = "the file has no end: the recording was cut off"


def read_recording(path: Path) -> Recording:
    """Reads an MCAP file. Topics with other schemas than poses, doubles beside a timestamp, and foxglove.Log are left out.

    A file that was cut off or is damaged at some place is read up to there. Raises UsageError where it cannot be read at all.
    """
    contents = _Contents()
    try:
        with path.open("rb") as file:
            if file.read(len(_MAGIC)) != _MAGIC:
                raise UsageError(f"{path}: not an MCAP file")
            with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
                _read_records(data, contents)
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror or error}") from error
    try:
        return _assembled(contents)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise UsageError(f"{path}: a message is not as its schema says: {error}") from error


def _read_records(data: mmap.mmap, contents: _Contents) -> None:
    at = len(_MAGIC)
    while at + _HEAD.size <= len(data):
        opcode, length = _HEAD.unpack_from(data, at)
        start = at + _HEAD.size
        if length > len(data) - start:
            contents.damage = f"the file ends within a record (at byte {at}): the recording was cut off"
            return
        if opcode == Opcode.FOOTER:  # between the data's end and here the schemas and channels stand again, also those without messages
            contents.damage = ""
            return
        try:
            _take(opcode, data[start : start + length] if opcode != Opcode.MESSAGE else b"", contents)
            if opcode == Opcode.MESSAGE:
                _split(data[at : start + length], contents)
        except Exception as error:  # noqa: BLE001 - whatever the decompressors and parsers raise, the bytes are at fault
            contents.damage = f"the record at byte {at} is damaged ({error}); nothing was read from there on"
            return
        at = start + length


def _take(opcode: int, record: bytes, contents: _Contents) -> None:
    stream = ReadDataStream(io.BytesIO(record))
    match opcode:
        case Opcode.SCHEMA:
            schema = Schema.read(stream)
            contents.schemas[schema.id] = schema
        case Opcode.CHANNEL:
            channel = Channel.read(stream)
            contents.channels[channel.id] = channel
        case Opcode.CHUNK:
            _split(_uncompressed(Chunk.read(stream)), contents)
        case Opcode.METADATA:
            contents.metadata.update(Metadata.read(stream).metadata)
        case Opcode.ATTACHMENT:
            attachment = Attachment.read(stream)
            contents.attachments[attachment.name] = attachment.data
        case 0:
            raise ValueError("zeros where a record should be")
        case _:
            pass  # indexes and statistics, which reading everything does not need


def _uncompressed(chunk: Chunk) -> bytes:
    if chunk.compression not in {"zstd", "lz4", ""}:
        raise ValueError(f"unknown compression {chunk.compression!r}")
    stream, length = get_chunk_data_stream(chunk, validate_crc=True)
    return stream.read(length)


def _split(content: bytes, contents: _Contents) -> None:
    """Sorts the messages of a chunk's content by channel, equally long ones at once."""
    offsets: list[int] = []
    lengths: list[int] = []
    at, end = 0, len(content)
    unpack = _HEAD.unpack_from
    while at + 9 <= end:
        opcode, length = unpack(content, at)
        if length > end - at - 9:
            raise ValueError("a message reaches past its chunk")
        if opcode == Opcode.MESSAGE:
            offsets.append(at + 9)
            lengths.append(length - _MESSAGE.size)
        else:
            _take(opcode, content[at + 9 : at + 9 + length], contents)
        at += 9 + length
    if not offsets:
        return
    start, size = np.array(offsets), np.array(lengths)
    if size.min() < 0:
        raise ValueError("a message is shorter than its own head")
    raw = np.frombuffer(content, dtype=np.uint8)
    head = raw[start[:, None] + np.arange(14)]  # channel, sequence, log time
    channel = np.ascontiguousarray(head[:, 0:2]).view("<u2")[:, 0]
    time = np.ascontiguousarray(head[:, 6:14]).view("<u8")[:, 0].astype(np.int64)
    for number in np.unique(channel):
        mine = np.flatnonzero(channel == number)
        pieces = contents.pieces.setdefault(int(number), _Pieces())
        pieces.times.append(time[mine])
        first = start[mine] + _MESSAGE.size
        if np.all(size[mine] == size[mine[0]]):
            pieces.contents.append(_rows(raw, first, int(size[mine[0]])))
        else:
            pieces.contents.append([content[a : a + n] for a, n in zip(first.tolist(), size[mine].tolist(), strict=True)])


def _rows(raw: Bytes, first: np.ndarray[tuple[int], np.dtype[np.int64]], size: int) -> Bytes:
    """Gives equally long pieces (N, size) of raw bytes; those at equal distances, as is usual, without gathering byte by byte."""
    if size == 0:
        return np.zeros((len(first), 0), dtype=np.uint8)
    steps = np.diff(first)
    if len(first) > 1 and np.all(steps == steps[0]) and steps[0] > 0:
        return np.lib.stride_tricks.as_strided(raw[first[0] :], (len(first), size), (int(steps[0]), 1), writeable=False)
    return np.asarray(raw[first[:, None] + np.arange(size)])


def _assembled(contents: _Contents) -> Recording:
    paths: dict[str, PoseTrack] = {}
    series: dict[str, Series] = {}
    log: list[LogMessage] = []
    for number, channel in contents.channels.items():
        schema = contents.schemas.get(channel.schema_id)
        name = schema.name if schema else ""
        pieces = contents.pieces.get(number, _Pieces())
        if name == _POSE and channel.message_encoding in {"protobuf", "json"}:
            paths[channel.topic] = _track(channel, pieces)
        elif "columns" in channel.metadata and channel.message_encoding == "protobuf":
            series[channel.topic] = _series(channel, pieces)
        elif name == "foxglove.Log" and channel.message_encoding == "json":
            log += [_log_message(content) for content in _each(pieces)]
    for topic in [topic for topic in series if topic.endswith(VALID_SUFFIX) and topic.removesuffix(VALID_SUFFIX) in paths]:
        of = topic.removesuffix(VALID_SUFFIX)
        track, changes = paths[of], series.pop(topic)
        if not len(changes.time):  # told of, but in a damaged file none of it is left
            continue
        index = np.searchsorted(changes.time, track.path.time, side="right") - 1
        valid: BoolArray = np.where(index < 0, 1.0, changes.values[np.maximum(index, 0), 0]) > 0.5
        path = PosePath(track.path.time, track.path.position, track.path.quaternion_wxyz, valid)
        paths[of] = PoseTrack(path, track.frame, track.body)
    log.sort(key=lambda message: message.time)
    return Recording(paths, series, tuple(log), contents.metadata, contents.attachments, contents.damage)


def _each(pieces: _Pieces) -> Iterator[bytes]:
    for content in pieces.contents:
        if isinstance(content, list):
            yield from content
        else:
            yield from (row.tobytes() for row in content)


def _ordered(pieces: _Pieces, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gives times (N,) in s and values in their order, of equal times the last."""
    nanoseconds = np.concatenate(pieces.times) if pieces.times else np.zeros(0, dtype=np.int64)
    if np.all(np.diff(nanoseconds) > 0):
        return nanoseconds / 1e9, values
    order = np.argsort(nanoseconds, kind="stable")
    nanoseconds, values = nanoseconds[order], values[order]
    last = np.concatenate([np.diff(nanoseconds) > 0, [True]])
    return nanoseconds[last] / 1e9, values[last]


def _track(channel: Channel, pieces: _Pieces) -> PoseTrack:
    frame = channel.metadata.get("frame")
    blocks: list[FloatArray] = []
    for content in pieces.contents:
        if frame is not None and not isinstance(content, list):
            message = pose_message(frame)
            if content.shape[1] == message.size and message.fits(content):
                blocks.append(message.decode(content))
                continue
        rows = [_pose_by_hand(row, channel.message_encoding) for row in _each(_Pieces([], [content]))]
        frame = rows[0][0] if rows and frame is None else frame
        blocks.append(np.array([row[1] for row in rows]).reshape(-1, 7))
    values = np.concatenate(blocks) if blocks else np.zeros((0, 7))
    time, values = _ordered(pieces, values)
    quaternion = np.concatenate([values[:, 6:], values[:, 3:6]], axis=1)
    path = PosePath(time, values[:, :3].copy(), quaternion, np.ones(len(time), dtype=np.bool_))
    return PoseTrack(path, frame or "", channel.metadata.get("body", channel.topic))


def _pose_by_hand(data: bytes, encoding: str) -> tuple[str, list[float]]:
    """Gives frame_id and x y z qx qy qz qw of one foxglove.PoseInFrame of any writer."""
    if encoding == "json":
        message: dict[str, Any] = json.loads(data)
        position, orientation = message["pose"]["position"], message["pose"]["orientation"]
        return str(message["frame_id"]), [float(position[k]) for k in "xyz"] + [float(orientation[k]) for k in "xyzw"]
    fields = fields_of(data)
    pose = fields_of(block_of(fields, 3))
    p, q = fields_of(block_of(pose, 1)), fields_of(block_of(pose, 2))
    return block_of(fields, 2).decode(), [double_of(p, k) for k in (1, 2, 3)] + [double_of(q, k) for k in (1, 2, 3, 4)]


def _series(channel: Channel, pieces: _Pieces) -> Series:
    columns = tuple(str(name) for name in json.loads(channel.metadata["columns"]))
    message = series_message(len(columns))
    blocks = []
    for content in pieces.contents:
        if not isinstance(content, list) and content.shape[1] == message.size and message.fits(content):
            blocks.append(message.decode(content))
            continue
        rows = [[double_of(fields, 2 + i) for i in range(len(columns))] for fields in map(fields_of, _each(_Pieces([], [content])))]
        blocks.append(np.array(rows).reshape(-1, len(columns)))
    values = np.concatenate(blocks) if blocks else np.zeros((0, len(columns)))
    time, values = _ordered(pieces, values)
    return Series(time, values, columns)


def _log_message(data: bytes) -> LogMessage:
    message: dict[str, Any] = json.loads(data)
    level = int(message.get("level", 0))
    return LogMessage(
        time=message["timestamp"]["sec"] + message["timestamp"]["nsec"] / 1e9,
        level=LEVELS[level] if 0 <= level < len(LEVELS) else LEVELS[0],
        text=str(message.get("message", "")),
        source=str(message.get("name", "")),
        file=str(message.get("file", "")),
        line=int(message.get("line", 0)),
    )
