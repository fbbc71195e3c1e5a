"""A case's recording: which topics its paths and series have, and how they are found again. The only place that knows the topics' names.

A tracked run NAME has /NAME/tracker/pose, /NAME/tool/measured and /NAME/tool/oracle; a case with a single run has them without /NAME, so
that other tools find them. The oracle's times are shifted to where the order was given; metadata `oracle shift NAME` says by how much.
Likewise /NAME/rapid/move and /NAME/signals are what the oracle expects, /NAME/tool/oracle/bound how
well it knows the real arm; metadata `order given NAME` is the time in s since the case began,
`tool NAME` is X_FT and `work object NAME` is X_BO.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mitl.paths import FloatArray, PosePath
from mitl.protocols import Oracle
from mitl.recording.mcap_writer import write_recording
from mitl.recording.records import (
    BOUND_COLUMNS,
    BOUNDS,
    MEASURED,
    MOVES,
    ORACLE,
    SIGNALS,
    TRACKER,
    LogMessage,
    PoseTrack,
    Recording,
    Series,
)


@dataclass(frozen=True, eq=False)
class RecordedRun:
    """A tracked run as recorded: X_LM, X_OT on the tracker's clock, and the oracle's X_OT; None where the run did not come so far.

    shift: what was added in s to the oracle's times. moves: columns move, line; signals: a column an output; both as the oracle expects
    them, on its clock. began: s since the case began at which the order was given. X_FT, X_BO: (7,) tool and work object.
    bounds: how well the oracle knows the real arm, `recording.records.BOUND_COLUMNS`, on its clock.
    """

    name: str
    raw: PosePath | None
    tool: PosePath | None
    oracle: PosePath | None
    shift: float = 0.0
    moves: Series | None = None
    signals: Series | None = None
    began: float | None = None
    X_FT: FloatArray | None = None
    X_BO: FloatArray | None = None
    bounds: Series | None = None


def moves_of(oracle: Oracle) -> Series | None:
    """Gives which motion instruction is on its way and its source line, from the time on at which it begins; None without motion."""
    begins: dict[float, tuple[float, float]] = {}
    for number, move in enumerate(oracle.moves):
        begins[max(0.0, move.begins)] = (float(number), float(move.line))  # of two at the same time the later
    if not begins:
        return None
    time = sorted(begins)
    return Series(np.array(time), np.array([begins[at] for at in time]), ("move", "line"))


def bounds_of(oracle: Oracle) -> Series | None:
    """Gives how well the oracle knows the real arm at each of its samples; None where it says nothing of samples."""
    known = oracle.bounds
    if known is None:
        return None
    return Series(oracle.tcp.time, np.stack([known.path, known.turn, known.time], axis=1), BOUND_COLUMNS)


def signals_of(oracle: Oracle) -> Series | None:
    """Gives the values of all outputs from the times on at which one of them changes; None where the program sets none."""
    if not oracle.signals:
        return None
    time = np.unique(np.concatenate([np.maximum(times, 0.0) for times, _ in oracle.signals.values()]))
    columns = [
        values[np.maximum(np.searchsorted(np.maximum(times, 0.0), time, side="right") - 1, 0)] for times, values in oracle.signals.values()
    ]
    return Series(time, np.stack(columns, axis=1), tuple(oracle.signals))


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
    rows = dict(series)
    facts: dict[str, str] = {}
    for run in runs:
        prefix = f"/{slug(run.name)}" if len(runs) > 1 else ""
        if run.raw is not None:
            tracks[prefix + TRACKER] = PoseTrack(run.raw, "tracker", "body")
        if run.tool is not None:
            tracks[prefix + MEASURED] = PoseTrack(run.tool, "wobj", "tool")
        if run.oracle is not None:
            tracks[prefix + ORACLE] = PoseTrack(run.oracle.shifted(run.shift), "wobj", "tool")
            facts[f"oracle shift {slug(run.name)}"] = repr(run.shift)
        for topic, expected in ((MOVES, run.moves), (SIGNALS, run.signals), (BOUNDS, run.bounds)):
            if expected is not None and run.shift >= 0.0:
                rows[prefix + topic] = replace(expected, time=expected.time + run.shift)
        known = {
            "order given": run.began,
            "tool": None if run.X_FT is None else run.X_FT.tolist(),
            "work object": None if run.X_BO is None else run.X_BO.tolist(),
        }
        facts |= {f"{fact} {slug(run.name)}": json.dumps(value) for fact, value in known.items() if value is not None}
    return Recording(tracks, rows, tuple(log), {**metadata, **facts}, dict(attachments))


def runs_of(recording: Recording) -> list[RecordedRun]:
    """Gives the tracked runs of a recording in their order, the oracle's times as recorded."""
    prefixes = dict.fromkeys(
        topic.removesuffix(end) for topic in recording.paths for end in (TRACKER, MEASURED, ORACLE) if topic.endswith(end)
    )
    return [_run(recording, prefix) for prefix in prefixes]


def _run(recording: Recording, prefix: str) -> RecordedRun:
    name = prefix.strip("/")
    shift = _number(_fact(recording, "oracle shift", name))
    return RecordedRun(
        name,
        _path(recording, prefix + TRACKER),
        _path(recording, prefix + MEASURED),
        _path(recording, prefix + ORACLE),
        shift or 0.0,
        recording.series.get(prefix + MOVES),
        recording.series.get(prefix + SIGNALS),
        _number(_fact(recording, "order given", name)),
        _pose(_fact(recording, "tool", name)),
        _pose(_fact(recording, "work object", name)),
        recording.series.get(prefix + BOUNDS),
    )


def _fact(recording: Recording, fact: str, name: str) -> object:
    """Gives a fact of a run from the metadata, None where it is missing or no JSON; a single run's topics do not tell its name."""
    known = {key: value for key, value in recording.metadata.items() if key.startswith(f"{fact} ")}
    text = known.get(f"{fact} {name}") if name else next(iter(known.values()), None)
    try:
        return None if text is None else json.loads(text)
    except ValueError:
        return None


def _number(value: object) -> float | None:
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else None


def _pose(value: object) -> FloatArray | None:
    if not (isinstance(value, list) and len(value) == 7 and all(isinstance(part, int | float) for part in value)):
        return None
    return np.array(value, dtype=np.float64)


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
