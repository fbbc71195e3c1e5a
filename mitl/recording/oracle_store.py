"""The store of oracles: one MCAP a program with the path of every order, and an index with hashes and provenance.

Invariant: the index tells of every file what it was made from and why; a file that is not as the index says is not read.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from enum import Enum
from pathlib import Path

import numpy as np

from mitl.errors import UsageError
from mitl.paths import FloatArray, PosePath
from mitl.recording.atomic import replacing
from mitl.recording.mcap_reader import read_recording
from mitl.recording.mcap_writer import write_recording
from mitl.recording.records import PoseTrack, Recording

INDEX = "index.json"
SCHEMA = 1
RATE = 25.0
"""Samples per second that are kept: 40 mm at 1 m/s, enough to see a change, and a few megabytes for all programs."""
_TOPIC = "/order/"


class Kind(Enum):
    """Where an oracle comes from: elsewhere (closed form, published or measured figures), or the planner itself."""

    INDEPENDENT = "independent"
    REGRESSION = "regression"


@dataclass(frozen=True)
class Entry:
    """One stored file. file, program: names. program_sha256, sha256: of the program's text and of the file. robot: a model's name.

    source: what made it. reason: why it was blessed. blessed: date, ISO 8601. orders: "option.subOption" of each path in it.
    """

    file: str
    program: str
    program_sha256: str
    robot: str
    kind: Kind
    source: str
    reason: str
    blessed: str
    sha256: str
    orders: tuple[str, ...]


@dataclass(frozen=True)
class Difference:
    """How far a path is from the stored one: the largest distance at the same time in m, and by how much it is longer in s."""

    distance: float
    longer: float


def read_index(folder: Path) -> tuple[Entry, ...]:
    """Gives the entries of a store; none where there is no index yet. Raises UsageError where it is no index of ours."""
    file = folder / INDEX
    if not file.is_file():
        return ()
    try:
        table = json.loads(file.read_text(encoding="utf-8"))
        if table["schema"] != SCHEMA:
            raise UsageError(f"{file}: schema {table['schema']}, this mitl reads {SCHEMA}")
        return tuple(Entry(**{**row, "kind": Kind(row["kind"]), "orders": tuple(row["orders"])}) for row in table["oracles"])
    except (ValueError, KeyError, TypeError) as error:
        raise UsageError(f"{file}: not an index of oracles: {error}") from error


def read_oracles(folder: Path, entry: Entry) -> dict[str, PosePath]:
    """Gives the paths of an entry by order. Raises UsageError where the file is missing or not as the index says."""
    file = folder / entry.file
    if not file.is_file():
        raise UsageError(f"{file}: the index names it, but it is missing")
    if sha256_of(file) != entry.sha256:
        raise UsageError(f"{file}: not as the index says (another hash): only mitl oracle bless writes here")
    return {topic.removeprefix(_TOPIC): track.path for topic, track in read_recording(file).paths.items()}


def write_oracles(folder: Path, entry: Entry, paths: Mapping[str, PosePath]) -> Entry:
    """Writes a file of paths by order and enters it into the index; gives the entry with its hash."""
    tracks = {_TOPIC + order: PoseTrack(path, "wobj", "tool") for order, path in paths.items()}
    facts = {"program": entry.program, "program sha256": entry.program_sha256, "robot": entry.robot, "kind": entry.kind.value}
    write_recording(folder / entry.file, Recording(tracks, metadata={**facts, "source": entry.source, "reason": entry.reason}))
    made = replace(entry, sha256=sha256_of(folder / entry.file), orders=tuple(paths))
    _write_index(folder, [*(other for other in read_index(folder) if other.file != entry.file), made])
    return made


def remove_oracles(folder: Path, entry: Entry) -> None:
    """Takes a file out of the store."""
    (folder / entry.file).unlink(missing_ok=True)
    _write_index(folder, [other for other in read_index(folder) if other.file != entry.file])


def thinned(path: PosePath) -> PosePath:
    """Gives a path at RATE, with its last sample."""
    if len(path) < 2:
        return path
    step = max(1, round(float(1.0 / RATE / np.median(np.diff(path.time)))))
    return path.select(np.union1d(np.arange(0, len(path), step), [len(path) - 1]))


def difference(stored: PosePath, made: PosePath) -> Difference:
    """Gives how far a path that was made now, sampled more densely, is from the stored one; both are held at their ends."""
    there = np.stack([_at(stored.time, made, axis) for axis in range(3)], axis=1)
    return Difference(float(np.linalg.norm(there - stored.position, axis=1).max()), float(made.time[-1] - stored.time[-1]))


def sha256_of(file: Path) -> str:
    """Gives the SHA-256 of a file."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def _at(time: FloatArray, path: PosePath, axis: int) -> FloatArray:
    return np.interp(time, path.time, path.position[:, axis])


def _write_index(folder: Path, entries: list[Entry]) -> None:
    rows = [{**asdict(entry), "kind": entry.kind.value} for entry in sorted(entries, key=lambda entry: entry.file)]
    with replacing(folder / INDEX) as beside:
        beside.write_text(json.dumps({"schema": SCHEMA, "oracles": rows}, indent=1) + "\n", encoding="utf-8")
