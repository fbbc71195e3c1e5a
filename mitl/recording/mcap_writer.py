"""Writes recordings as MCAP that Foxglove opens: poses as foxglove.PoseInFrame, series with a schema each, foxglove.Log.

Invariant: what has been appended is in the file at the latest half a second of wall time later, if something is appended then.
"""

from __future__ import annotations

import json
import re
import time as wall
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import IO

import numpy as np
from mcap.writer import CompressionType, Writer

from mitl.errors import UsageError
from mitl.paths import BoolArray, FloatArray, PosePath
from mitl.recording.atomic import replacing
from mitl.recording.protobuf import Bytes, Nanoseconds, pose_message, pose_schema, series_message, series_schema
from mitl.recording.records import LOG, LogMessage, PoseTrack, Recording, Series

PROFILE = "mitl"
METADATA = "mitl"  # name of the metadata record with the provenance
VALID_SUFFIX = "/valid"  # topic beside a pose topic, 1 or 0 from each time on; absent where all samples are valid
LEVELS = ("unknown", "debug", "info", "warning", "error", "fatal")  # index: foxglove.Log.Level
_FLUSH = 0.5  # s of wall time
_CHUNK = 1 << 20  # bytes
_INTERLEAVE = 1.0  # s of recorded time written of one topic before the next has its turn
_MOST_SECONDS = 1 << 32  # MCAP's nanoseconds in 64 bits would allow more, the padded varints not

_LOG_SCHEMA = {
    "title": "foxglove.Log",
    "description": "A log message",
    "type": "object",
    "properties": {
        "timestamp": {
            "type": "object",
            "title": "time",
            "properties": {"sec": {"type": "integer", "minimum": 0}, "nsec": {"type": "integer", "minimum": 0, "maximum": 999999999}},
        },
        "level": {
            "title": "foxglove.LogLevel",
            "oneOf": [{"title": name.upper(), "const": number} for number, name in enumerate(LEVELS)],
        },
        "message": {"type": "string"},
        "name": {"type": "string"},
        "file": {"type": "string"},
        "line": {"type": "integer", "minimum": 0},
    },
}


class RecordingWriter:
    """Writes one recording as it comes, in chunks. Use as a context manager.

    The file grows under its own name, so that a killed process leaves what it had; `write_recording` writes whole files instead.
    Times are s from 0 on, on the recorder's clock. Raises UsageError where the file cannot be written, ValueError for a negative
    time or columns that change.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            self._file: IO[bytes] = path.open("wb")
        except OSError as error:
            raise UsageError(f"{path}: cannot be written: {error.strerror or error}") from error
        self._writer = Writer(self._file, chunk_size=_CHUNK, compression=CompressionType.ZSTD)
        self._writer.start(profile=PROFILE)
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._columns: dict[str, tuple[str, ...]] = {}
        self._valid: dict[str, bool] = {}
        self._flushed = wall.monotonic()

    def __enter__(self) -> RecordingWriter:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Completes the file with its index. Safe to call twice."""
        if not self._file.closed:
            self._writer.finish()  # type: ignore[no-untyped-call] # mcap annotates only some methods
            self._file.close()

    def flush(self) -> None:
        """Completes the chunk in progress and hands it to the operating system."""
        self._writer.flush()  # type: ignore[no-untyped-call] # mcap annotates only some methods
        self._flushed = wall.monotonic()

    def add_poses(self, topic: str, path: PosePath, *, frame: str, body: str) -> None:
        """Appends poses of `body` in `frame` to a topic."""
        if len(path) == 0 and topic in self._channels:
            return
        message = pose_message(frame)
        if topic not in self._channels:
            schema = self._schema("foxglove.PoseInFrame", "protobuf", pose_schema())
            self._channels[topic] = self._writer.register_channel(topic, "protobuf", schema, {"frame": frame, "body": body})
        nanoseconds = _nanoseconds(path.time)
        self._add_validity(topic, path.time, path.valid)
        x_y_z_qx_qy_qz_qw = np.concatenate([path.position, path.quaternion_wxyz[:, 1:], path.quaternion_wxyz[:, :1]], axis=1)
        self._add(topic, nanoseconds, message.encode(nanoseconds, x_y_z_qx_qy_qz_qw))

    def add_series(self, topic: str, series: Series) -> None:
        """Appends rows to a topic; its columns must stay the same."""
        if topic not in self._channels:
            fields = field_names(series.columns)
            name = field_names((topic.strip("/").replace("/", "_"),))[0]
            schema = self._schema(f"mitl.{name}", "protobuf", series_schema(name, fields))
            columns = {"columns": json.dumps(series.columns)}
            self._channels[topic] = self._writer.register_channel(topic, "protobuf", schema, columns)
            self._columns[topic] = series.columns
        if self._columns.get(topic) != series.columns:
            raise ValueError(f"{topic}: expected the columns {self._columns.get(topic)}, got {series.columns}")
        nanoseconds = _nanoseconds(series.time)
        self._add(topic, nanoseconds, series_message(len(series.columns)).encode(nanoseconds, series.values))

    def add_log(self, messages: Sequence[LogMessage]) -> None:
        """Appends messages to /log."""
        if LOG not in self._channels:
            schema = self._schema("foxglove.Log", "jsonschema", json.dumps(_LOG_SCHEMA).encode())
            self._channels[LOG] = self._writer.register_channel(LOG, "json", schema)
        times = _nanoseconds(np.array([message.time for message in messages], dtype=np.float64))
        for at, message in zip(times.tolist(), messages, strict=True):
            content = {
                "timestamp": {"sec": at // 1_000_000_000, "nsec": at % 1_000_000_000},
                "level": LEVELS.index(message.level) if message.level in LEVELS else 0,
                "message": message.text,
                "name": message.source,
                "file": message.file,
                "line": message.line,
            }
            self._writer.add_message(self._channels[LOG], at, json.dumps(content, ensure_ascii=False).encode(), at)
        self._flush_if_due()

    def add_metadata(self, metadata: dict[str, str]) -> None:
        """Appends provenance; a later value of a key replaces the earlier one."""
        self._writer.add_metadata(METADATA, metadata)

    def add_attachment(self, name: str, content: bytes) -> None:
        """Appends a whole file, e.g. the program text or the calibration."""
        self._writer.add_attachment(0, 0, name, _media_type(name), content)

    def _schema(self, name: str, encoding: str, data: bytes) -> int:
        if name not in self._schemas:
            self._schemas[name] = self._writer.register_schema(name, encoding, data)
        return self._schemas[name]

    def _add_validity(self, topic: str, time: FloatArray, valid: BoolArray) -> None:
        """Writes when validity changes; before the poses themselves, so that no readable pose lacks its validity."""
        if len(valid) == 0:
            return
        before = self._valid.get(topic, True)
        changed = np.diff(np.concatenate([[before], valid]).astype(np.int8)) != 0
        self._valid[topic] = bool(valid[-1])
        if np.any(changed):
            self.add_series(topic + VALID_SUFFIX, Series(time[changed], valid[changed].astype(np.float64)[:, None], ("valid",)))

    def _add(self, topic: str, nanoseconds: Nanoseconds, messages: Bytes) -> None:
        channel, size, content = self._channels[topic], messages.shape[1], messages.tobytes()
        add = self._writer.add_message
        for i, at in enumerate(nanoseconds.tolist()):
            add(channel, at, content[i * size : (i + 1) * size], at)
        self._flush_if_due()

    def _flush_if_due(self) -> None:
        if wall.monotonic() - self._flushed >= _FLUSH:
            self.flush()


def write_recording(path: Path, recording: Recording) -> None:
    """Writes a whole recording; topics take turns by recorded time, so that a viewer reads neighbours together.

    Raises UsageError where the file cannot be written, ValueError for a negative time.
    """
    with replacing(path) as beside, RecordingWriter(beside) as writer:
        writer.add_metadata(recording.metadata)
        for name, content in recording.attachments.items():
            writer.add_attachment(name, content)
        tracks = [(topic, track, _turns(track.path.time)) for topic, track in recording.paths.items()]
        series = [(topic, rows, _turns(rows.time)) for topic, rows in recording.series.items()]
        log = sorted(recording.log, key=lambda message: message.time)
        log_turns = _turns(np.array([message.time for message in log], dtype=np.float64))
        starts = sorted({start for *_, turns in [*tracks, *series] for start in turns} | set(log_turns))
        for topic, track, turns in tracks:
            if not turns:  # an empty path is still a topic
                _add_track(writer, topic, track, slice(0, 0))
        for topic, rows, turns in series:
            if not turns:
                writer.add_series(topic, rows)
        for start in starts:
            for topic, track, turns in tracks:
                if start in turns:
                    _add_track(writer, topic, track, turns[start])
            for topic, rows, turns in series:
                if start in turns:
                    part = turns[start]
                    writer.add_series(topic, Series(rows.time[part], rows.values[part], rows.columns))
            if start in log_turns:
                writer.add_log(log[log_turns[start]])


def _add_track(writer: RecordingWriter, topic: str, track: PoseTrack, part: slice) -> None:
    path = track.path
    piece = PosePath(path.time[part], path.position[part], path.quaternion_wxyz[part], path.valid[part])
    writer.add_poses(topic, piece, frame=track.frame, body=track.body)


def _turns(time: FloatArray) -> dict[int, slice]:
    """Gives the samples of each turn: number of the turn -> slice. time: (N,) not decreasing."""
    if len(time) == 0:
        return {}
    turn = np.floor(time / _INTERLEAVE).astype(np.int64)
    first = np.concatenate([[0], np.flatnonzero(np.diff(turn)) + 1])
    last = np.concatenate([first[1:], [len(time)]])
    return {int(turn[a]): slice(int(a), int(b)) for a, b in zip(first, last, strict=True)}


def _nanoseconds(time: FloatArray) -> Nanoseconds:
    if len(time) and not (time.min() >= 0.0 and time.max() < _MOST_SECONDS):
        raise ValueError(f"recorded times are s from 0 on, got {time.min():.6f} to {time.max():.6f}; shift the path first")
    seconds = np.floor(time)
    return seconds.astype(np.int64) * 1_000_000_000 + np.rint((time - seconds) * 1e9).astype(np.int64)


def field_names(names: Sequence[str]) -> tuple[str, ...]:
    """Gives the names of a series' columns that protobuf allows, all different; the true ones stand in the channel's metadata."""
    taken: list[str] = []
    for name in names:
        plain = re.sub(r"\W", "_", name, flags=re.ASCII)
        plain = plain if plain[:1].isalpha() else f"c_{plain}"
        unique, number = plain, 2
        while unique in taken or unique == "timestamp":
            unique, number = f"{plain}_{number}", number + 1
        taken.append(unique)
    return tuple(taken)


def _media_type(name: str) -> str:
    texts = {".mod", ".sys", ".prg", ".modx", ".sysx", ".pgf", ".txt"}
    known = {
        ".toml": "application/toml",
        ".json": "application/json",
        ".csv": "text/csv",
        ".urdf": "application/xml",
        ".xml": "application/xml",
    }
    suffix = Path(name).suffix.lower()
    return known.get(suffix, "text/plain" if suffix in texts else "application/octet-stream")
