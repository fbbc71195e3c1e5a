"""A case's recording: which topics its paths and series have, and how they are found again. The only place that knows the topics' names.

A tracked run NAME has /NAME/tracker/pose, /NAME/tool/measured and /NAME/tool/oracle; a case with a single run has them without /NAME, so
that other tools find them. The oracle's times are shifted to where the order was given; metadata `oracle shift NAME` says by how much.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from mitl.paths import PosePath
from mitl.recording.mcap_writer import write_recording
from mitl.recording.records import MEASURED, ORACLE, TRACKER, LogMessage, PoseTrack, Recording, Series


@dataclass(frozen=True, eq=False)
class RecordedRun:
    """A tracked run as recorded: X_LM, X_OT on the tracker's clock, and the oracle's X_OT; None where the run did not come so far."""

    name: str
    raw: PosePath | None
    tool: PosePath | None
    oracle: PosePath | None
    shift: float = 0.0


def recording_of(
    runs: Iterable[RecordedRun],
    *,
    paths: Mapping[str, PoseTrack],
    series: Mapping[str, Series],
    log: Iterable[LogMessage],
    metadata: Mapping[str, str],
    attachments: Mapping[str, bytes],
) -> Recording:
    """Gives the recording of a case's runs and of what else it kept."""
    runs = list(runs)
    tracks = dict(paths)
    shifts: dict[str, str] = {}
    for run in runs:
        prefix = f"/{slug(run.name)}" if len(runs) > 1 else ""
        if run.raw is not None:
            tracks[prefix + TRACKER] = PoseTrack(run.raw, "tracker", "body")
        if run.tool is not None:
            tracks[prefix + MEASURED] = PoseTrack(run.tool, "wobj", "tool")
        if run.oracle is not None:
            tracks[prefix + ORACLE] = PoseTrack(run.oracle.shifted(run.shift), "wobj", "tool")
            shifts[f"oracle shift {slug(run.name)}"] = repr(run.shift)
    return Recording(tracks, dict(series), tuple(log), {**metadata, **shifts}, dict(attachments))


def runs_of(recording: Recording) -> list[RecordedRun]:
    """Gives the tracked runs of a recording in their order, the oracle's times as recorded."""
    prefixes = dict.fromkeys(
        topic.removesuffix(end) for topic in recording.paths for end in (TRACKER, MEASURED, ORACLE) if topic.endswith(end)
    )
    return [
        RecordedRun(
            prefix.strip("/"),
            _path(recording, prefix + TRACKER),
            _path(recording, prefix + MEASURED),
            _path(recording, prefix + ORACLE),
        )
        for prefix in prefixes
    ]


def write(path: Path, recording: Recording) -> None:
    """Writes a recording whole or not at all; a path whose clock began before 0 is shifted to begin there."""
    tracks = {topic: replace(track, path=_from_zero(track.path)) for topic, track in recording.paths.items()}
    write_recording(path, replace(recording, paths=tracks))


def slug(text: str) -> str:
    """Gives a text as one part of a topic."""
    return re.sub(r"[^A-Za-z0-9.]+", "-", text).strip("-.").lower() or "unnamed"


def fresh(topic: str, taken: Iterable[str]) -> str:
    """Gives the topic, with a number if it is taken."""
    taken, number, chosen = set(taken), 2, topic
    while chosen in taken:
        chosen, number = f"{topic}-{number}", number + 1
    return chosen


def _path(recording: Recording, topic: str) -> PosePath | None:
    track = recording.paths.get(topic)
    return track.path if track is not None and len(track.path) else None


def _from_zero(path: PosePath) -> PosePath:
    return path.shifted(-float(path.time[0])) if len(path) and path.time[0] < 0.0 else path
