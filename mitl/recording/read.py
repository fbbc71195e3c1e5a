"""One path from a file of any format that we read."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mitl.errors import UsageError
from mitl.paths import PosePath
from mitl.recording.csv_file import read_csv
from mitl.recording.csv_import import ColumnMap, import_csv
from mitl.recording.mcap_reader import read_recording
from mitl.recording.records import MEASURED, ORACLE, TRACKER, Recording
from mitl.recording.thesis_xml import read_thesis_xml
from mitl.recording.tum import read_tum
from mitl.recording.vive_text import is_vive_text, read_vive_text
from mitl.samples import TrackerSamples

_STATE = "/tracker/state"
_MCAP = b"\x89MCAP0\r\n"
_FORMATS = "MCAP, our CSV (t_s,x_mm,...), TUM text (t x y z qx qy qz qw), Vive text (# x y z w j i k Freq: 250) or the thesis's XML"


def read_path(path: Path, topic: str | None = None) -> PosePath:
    """Reads the path that a file is about: MCAP, our CSV, TUM text, Vive text or the thesis's XML, told by content, whatever the name.

    topic: for MCAP with several paths; without it the only one, or else measured, oracle and tracker in this order.
    Raises UsageError naming the file, and the line where there is one.
    """
    return read_path_and_damage(path, topic)[0]


def read_path_and_damage(path: Path, topic: str | None = None) -> tuple[PosePath, str]:
    """Reads as `read_path` does, and what is missing of the file ("" for nothing, see `Recording.damage`)."""
    head = _head(path)
    if head.startswith(_MCAP):
        recording = read_recording(path)
        return _chosen(path, recording, topic), recording.damage
    if not head:
        raise UsageError(f"{path}: the file is empty")
    if b"\0" in head or not _is_text(head):
        raise UsageError(f"{path}: expected {_FORMATS}, got some binary file")
    if path.suffix.lower() == ".csv" or head.removeprefix(b"\xef\xbb\xbf").startswith(b"t_s"):
        return read_csv(path).path, ""
    if is_vive_text(head):
        return read_vive_text(path), ""
    if head.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"<"):
        return read_thesis_xml(path).path, ""
    if not _numeric(head):
        raise UsageError(f"{path}: unknown format: expected {_FORMATS}; it begins {head.splitlines()[0][:40].decode(errors='replace')!r}")
    return read_tum(path), ""


def _is_text(head: bytes) -> bool:
    """Gives whether a file's head is UTF-8, or Latin-1 without control characters; the head may end within a character."""
    try:
        head.decode("utf-8")
    except UnicodeDecodeError as error:
        if error.start < len(head) - 3:
            return not any(byte < 32 and byte not in b"\t\n\f\r" for byte in head)
    return True


def _numeric(head: bytes) -> bool:
    """Gives whether the first line that is no comment begins with a number, or there is none in the head."""
    for line in head.removeprefix(b"\xef\xbb\xbf").splitlines():
        words = line.partition(b"#")[0].replace(b",", b" ").split()
        if words:
            try:
                float(words[0])
            except ValueError:
                return False
            return True
    return True


@dataclass(frozen=True, eq=False)
class TrackerRecording:
    """A tracker's path X_LM from a file. name: file, and topic where it has several. nominal: the file has no time stamps of its own.

    damage: as `Recording.damage`.
    """

    name: str
    path: PosePath
    nominal: bool = False
    damage: str = ""


def read_tracker_recordings(file: Path, topic: str | None = None, columns: ColumnMap | None = None) -> list[TrackerRecording]:
    """Reads every path of a tracker in a file: of MCAP all topics that end in /tracker/pose, or else the path that it is about.

    columns: the file is another tracker's table. Raises UsageError as `read_path` does.
    """
    if columns is not None:
        return [TrackerRecording(str(file), import_csv(file, columns), nominal=columns.rate is not None)]
    head = _head(file)
    if head.startswith(_MCAP):
        recording = read_recording(file)
        topics = [name for name, track in recording.paths.items() if name.endswith(TRACKER) and len(track.path)]
        if topic is None and topics:
            names = [str(file)] if len(topics) == 1 else [f"{file}:{name}" for name in topics]
            return [
                TrackerRecording(name, samples_of(recording, each).trusted(), damage=recording.damage)
                for name, each in zip(names, topics, strict=True)
            ]
        return [TrackerRecording(str(file), _chosen(file, recording, topic), damage=recording.damage)]
    return [TrackerRecording(str(file), read_path(file), nominal=is_vive_text(head))]


def samples_of(recording: Recording, topic: str) -> TrackerSamples:
    """Gives a topic's poses with what the tracker told beside them, where `mitl record` has kept it."""
    path = recording.paths[topic].path
    state = recording.series.get(topic.removesuffix(TRACKER) + _STATE) if topic.endswith(TRACKER) else None
    if state is None or len(state.time) != len(path) or not {"result", "buttons", "vx", "vy", "vz"} <= set(state.columns):
        return TrackerSamples.plain(path)
    velocity = np.stack([state.column(name) for name in ("vx", "vy", "vz")], axis=1)
    return TrackerSamples(path, state.column("result").astype(np.int16), state.column("buttons").astype(np.int16), velocity)


def _head(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(256)
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror or error}") from error


def _chosen(file: Path, recording: Recording, topic: str | None) -> PosePath:
    found = {name: track.path for name, track in recording.paths.items() if len(track.path)}
    if not found:
        raise UsageError(f"{file}: no pose in this file" + (f" ({recording.damage})" if recording.damage else ""))
    if topic is not None:
        if topic not in found:
            raise UsageError(f"{file}: no poses on topic {topic}; there are {', '.join(found)}")
        return found[topic]
    if len(found) == 1:
        return next(iter(found.values()))
    for name in (MEASURED, ORACLE, TRACKER):
        if name in found:
            return found[name]
    raise UsageError(f"{file}: several paths ({', '.join(found)}): none is {MEASURED}, {ORACLE} or {TRACKER}")
