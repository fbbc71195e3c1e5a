"""What there is to replay in a file or in a run's folder: recordings, oracles and plain paths as takes.

Invariant: a take's tool and oracle are in one frame; the robot is shown only where that frame's place on the robot is known.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from mitl.engine.case_recording import RecordedRun, runs_of
from mitl.engine.record import CaseRecord, RunRecord
from mitl.errors import UsageError
from mitl.motion.kinematics import Arm
from mitl.motion.robot_model import load_robot_model
from mitl.paths import FloatArray, PosePath
from mitl.poses import IDENTITY, pose_of, transforms_of_path
from mitl.recording.csv_file import read_csv
from mitl.recording.mcap_reader import read_recording
from mitl.recording.read import read_path
from mitl.recording.records import JOINTS, Recording, Series
from mitl.report.replay import Take

_MCAP = b"\x89MCAP0\r\n"
_SOURCES = (".mod", ".prg", ".sys", ".modx", ".sysx")
_RIGID = 1e-3
"""Spread in m of the tool's tip in the flange up to which joints and path are in one frame with one tool."""


def takes_of_file(file: Path, *, robot: str | None = None, limit: float | None = None) -> list[Take]:
    """Gives what a file holds: every run of a case's recording, an oracle, or a path of any format that is read.

    robot: for files that do not name theirs. limit: mm. Raises UsageError where the file cannot be read or holds no pose.
    """
    if _head(file) == _MCAP:
        recording = read_recording(file)
        takes = _takes(recording, file.stem, robot=robot, limit=limit)
        if takes:
            return takes
    if file.suffix.lower() == ".csv" and _head(file).removeprefix(b"\xef\xbb\xbf").startswith(b"t_s"):
        return [_of_table(file, robot, limit)]
    path = read_path(file)
    return [Take(file.name, _plain(path), None, None, limit)]


def with_oracle(take: Take, oracle: Take) -> Take:
    """Gives a take beside the oracle of another, with its joints, moves and outputs; clocks that share no time both begin at 0."""
    expected = oracle.run.oracle if oracle.run.oracle is not None else oracle.run.tool
    measured = take.run.tool if take.run.tool is not None else take.run.oracle
    if expected is None or measured is None:
        raise UsageError("there is no path to put beside the other")
    shift, begin = oracle.run.shift, 0.0
    if measured.time[-1] < expected.time[0] or expected.time[-1] < measured.time[0]:
        shift, begin = float(expected.time[0]), float(measured.time[0])
    run = replace(
        oracle.run,
        name=take.run.name,
        tool=measured.shifted(shift - begin),
        oracle=expected,
        shift=shift,
        began=take.run.began,
        X_FT=oracle.run.X_FT if oracle.run.X_FT is not None else take.run.X_FT,
        X_BO=oracle.run.X_BO if oracle.run.X_BO is not None else take.run.X_BO,
    )
    return replace(take, run=run, joints=oracle.joints, robot=oracle.robot or take.robot, program=oracle.program or take.program)


def takes_of_run(run: RunRecord, folder: Path) -> list[Take]:
    """Gives what can be replayed of a run; recordings that are gone or broken are left out, the report says which."""
    found = []
    for number, case in enumerate(run.cases):
        try:
            recording = None if case.recording is None else read_recording(folder / case.recording)
        except UsageError:
            continue
        if recording is not None:
            takes = _takes(recording, case.id, robot=run.robot, limit=_limit(case))
            found += [
                replace(take, key=f"case-{number}", program=case.source or take.program) for take in takes if take.run.X_BO is not None
            ]
    return found


def _limit(case: CaseRecord) -> float | None:
    return min((check.limit for check in case.checks if check.unit == "mm" and not (check.at_least or check.warning)), default=None)


def _takes(recording: Recording, name: str, *, robot: str | None, limit: float | None) -> list[Take]:
    runs = [run for run in runs_of(recording) if run.tool is not None or run.oracle is not None]
    robot = recording.metadata.get("robot") or robot
    texts = [
        content.decode("utf-8", errors="replace") for file, content in recording.attachments.items() if file.lower().endswith(_SOURCES)
    ]
    takes = []
    for run in runs:
        series = recording.series.get(JOINTS)
        joints = series.values if series is not None and run.oracle is not None and len(series.time) == len(run.oracle) else None
        known = run
        if known.X_BO is None and recording.metadata.get("frame") in {"world", "base"}:
            known = replace(known, X_BO=IDENTITY)
        takes.append(
            Take(
                f"{name}: {run.name}" if run.name and len(runs) > 1 else name,
                known,
                robot if known.X_BO is not None else None,
                joints,
                limit,
                texts[0] if texts else None,
                recording.log,
            )
        )
    return takes


def _of_table(file: Path, robot: str | None, limit: float | None) -> Take:
    """Gives the take of an oracle's CSV; whether it is in the base frame shows in whether the tool is rigid in the flange."""
    table = read_csv(file)
    time = table.path.time
    moves = Series(time, np.stack([table.move, table.line], axis=1).astype(np.float64), ("move", "line"))
    signals = Series(time, np.stack(list(table.signals.values()), axis=1), tuple(table.signals)) if table.signals else None
    run = RecordedRun("", None, None, table.path, 0.0, moves, signals)
    if table.joints.shape[1] == 6:
        name = robot or "irb140"
        tool = _rigid_tool(name, table.joints, table.path)
        if tool is not None:
            return Take(file.name, replace(run, X_BO=IDENTITY, X_FT=tool), name, table.joints, limit)
    return Take(file.name, run, None, None, limit)


def _rigid_tool(robot: str, joints: FloatArray, path: PosePath) -> FloatArray | None:
    """Gives X_FT (7,) where the path is that of one tool in the base frame, None where it is not."""
    X_FT = Arm(load_robot_model(robot)).flange(joints).inv() * transforms_of_path(path)
    position = X_FT.translation
    if np.ptp(position, axis=0).max() > _RIGID:
        return None
    return np.asarray(pose_of(X_FT[0]))


def _plain(path: PosePath) -> RecordedRun:
    return RecordedRun("", None, path, None, float(path.time[0]) if len(path) else 0.0)


def _head(file: Path) -> bytes:
    try:
        with file.open("rb") as opened:
            return opened.read(8)
    except OSError as error:
        raise UsageError(f"{file}: cannot be read: {error.strerror or error}") from error
