"""`mitl compare --calibration`: an oracle's file and a tracker's recording to a verdict. A thin wrapper over `engine.path_verdict`."""

from __future__ import annotations

import json
import re
from dataclasses import asdict
from pathlib import Path
from typing import Any

import click
import numpy as np

from mitl.calibration.store import load_calibration
from mitl.engine.path_verdict import UNKNOWN_DRIFT, ExpectedPath, PathCheck, PathLimits, PathVerdict, judged_path
from mitl.errors import UsageError
from mitl.metrics.compare import Comparison, compare
from mitl.motion.kinematics import Arm
from mitl.motion.robot_model import load_robot_model
from mitl.paths import PosePath
from mitl.poses import path_of_transforms
from mitl.protocols import OracleBounds
from mitl.recording import read_recording
from mitl.recording.records import BOUNDS, JOINTS, MOVES, ORACLE, Recording

_SHOWN = {"m": ("mm", 1e3), "rad": ("deg", float(np.degrees(1.0)))}
_AGAIN = "write it again with: mitl oracle PROGRAM --output oracle.mcap"


def judge(
    reference: Path,
    measured: PosePath,
    calibration: Path,
    limits: PathLimits,
    *,
    drift: float | None,
    moves: str | None,
    robot: str | None,
    form: str,
) -> str:
    """Prints the verdict and gives its outcome. Raises UsageError for files that do not do, RigError for a recording that does not."""
    expected = expected_path(reference, robot)
    first, last = _moves(moves, int(expected.move.max(initial=0)))
    solved = load_calibration(calibration)
    verdict = judged_path(expected, measured, solved, limits, drift=UNKNOWN_DRIFT if drift is None else drift, first=first, last=last)
    numbers = compare(expected.tool, verdict.tool)
    if form == "json":
        click.echo(json.dumps(_as_json(verdict, numbers)))
    else:
        click.echo(_text(verdict, numbers, first, last))
    if drift is None:
        click.echo(
            f"note: the tracker's drift since its calibration was not told (--drift MM); taken as a Vive's, {1e3 * UNKNOWN_DRIFT:.2f} mm",
            err=True,
        )
    return verdict.outcome.value


def expected_path(file: Path, robot: str | None) -> ExpectedPath:
    """Gives the oracle of a file that `mitl oracle` wrote as MCAP, in the robot's base. Raises UsageError saying what it lacks."""
    recording = _oracle(file)
    name = robot or recording.metadata.get("robot")
    if name is None:
        raise UsageError(f"{file}: it does not say which robot it is for: give --robot")
    frame = recording.metadata.get("frame")
    if frame not in {"world", "base"}:
        raise UsageError(f"{file}: a verdict needs the path in the robot's base, this is in {frame or 'an unnamed frame'}; {_AGAIN}")
    tool, joints, bounds = recording.paths[ORACLE].path, recording.series[JOINTS], recording.series[BOUNDS]
    flange = path_of_transforms(tool, Arm(load_robot_model(name)).flange(joints.values))
    known = OracleBounds(bounds.column("position"), bounds.column("orientation"), bounds.column("time"))
    return ExpectedPath(tool, flange, known, recording.series[MOVES].column("move"))


def _oracle(file: Path) -> Recording:
    try:
        recording = read_recording(file)
    except UsageError as error:
        raise UsageError(f"{error}; a verdict needs the oracle with joints and bounds: {_AGAIN}") from error
    if recording.damage:
        raise UsageError(f"{file}: {recording.damage}; {_AGAIN}")
    missing = [topic for topic in (JOINTS, BOUNDS, MOVES) if topic not in recording.series]
    missing += [] if ORACLE in recording.paths else [ORACLE]
    if missing:
        raise UsageError(f"{file}: no oracle: it lacks {', '.join(missing)}; {_AGAIN}")
    return recording


def _moves(text: str | None, last: int) -> tuple[int, int]:
    """Gives the first and last move to judge. Without a text the first of several is left out: it leads from wherever the robot stood."""
    if text is None:
        return min(1, last), last
    match = re.fullmatch(r"(\d+)(?::(\d*))?", text.strip())
    if match is None:
        raise UsageError(f"--moves {text}: expected FIRST:LAST, e.g. 1:4, or 2: for all from 2 on; moves are counted from 0")
    first = int(match[1])
    until = first if match[2] is None else int(match[2] or last)
    if not first <= until <= last:
        raise UsageError(f"--moves {text}: expected moves between 0 and {last}, the first not after the last")
    return first, until


def _as_json(verdict: PathVerdict, numbers: Comparison) -> dict[str, Any]:
    checks = []
    for check in verdict.checks:
        unit, factor = _SHOWN[check.unit]
        checks.append(
            {
                "name": check.name,
                "value": check.value * factor,
                "unit": unit,
                "limit": check.limit * factor,
                "uncertainty": check.budget.combined * factor,
                "outcome": check.decision.outcome.value,
                "tur": check.decision.tur if np.isfinite(check.decision.tur) else None,
                "at_s": check.at,
                "budget": [{"name": t.name, "value": t.value * factor, "source": t.source} for t in check.budget.terms],
            }
        )
    told = {**asdict(numbers), "time_offset_s": verdict.offset.seconds, "time_offset_sd_s": verdict.offset.sigma}
    return {"outcome": verdict.outcome.value, "checks": checks, **told}


def _text(verdict: PathVerdict, numbers: Comparison, first: int, last: int) -> str:
    offset, rms = verdict.offset, 1e3 * numbers.position_rmse_m
    return "\n".join(
        [
            *(_line(check) for check in verdict.checks),
            f"judged         moves {first} to {last}, {numbers.samples} samples; rms {rms:.3f} mm at the same time",
            f"time offset    {offset.seconds:.6f} s to add to the tracker's times, sd {1e3 * offset.sigma:.3f} ms",
            f"verdict        {verdict.outcome.value}",
        ]
    )


def _line(check: PathCheck) -> str:
    unit, factor = _SHOWN[check.unit]
    indicative = ", indicative only" if check.decision.indicative_only else ""
    return (
        f"{check.name}: {check.value * factor:.3f} {unit} at {check.at:.2f} s, limit {check.limit * factor:g} {unit}: "
        f"{check.decision.outcome.value} (u {check.budget.explained(unit, factor)}; TUR {check.decision.tur:.1f}{indicative})"
    )
