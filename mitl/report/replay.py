"""A replay in space as one HTML file: robot, oracle, recording and the RAPID line on one time slider, drawn by three.js.

Positions are in the robot's base frame where the work object is known, else in the frame of the file, and then without a robot.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from mitl.engine.case_recording import RecordedRun
from mitl.errors import UsageError
from mitl.metrics.path import nearest_distance
from mitl.motion.kinematics import Arm
from mitl.motion.program_run import joints_home
from mitl.motion.robot_model import RobotModel, load_robot_model
from mitl.paths import FloatArray, PosePath
from mitl.poses import transform_of, transforms_of_path
from mitl.recording.atomic import replacing
from mitl.recording.records import LogMessage
from mitl.report import assets
from mitl.report.columns import packed
from mitl.report.data import events_of, finite, json_in_page, moves_of, positions_at, signals_of
from mitl.report.decimation import keep_extremes
from mitl.report.robot_shape import robot_shape

if TYPE_CHECKING:
    from mitl.simulation.meshcat_replay import Animation

_SCRIPTS = ("vendor/three.min.js", "templates/plots.js", "templates/replay.js")


@dataclass(frozen=True, eq=False)
class Take:
    """One thing to replay. title: for people. joints: (N, 6) rad, RAPID's, on the times of run.oracle, where they are known.

    limit: distance in mm at which the colour turns red. program: RAPID text.
    """

    title: str
    run: RecordedRun
    robot: str | None = None
    joints: FloatArray | None = None
    limit: float | None = None
    program: str | None = None
    log: tuple[LogMessage, ...] = ()
    key: str = ""


def replay_page(takes: list[Take], *, points: int = 2000, back: str | None = None) -> str:
    """Gives the page's text; `points` samples of each take are drawn. back: address of the report, if there is one.

    Raises UsageError where there is no pose in any take.
    """
    programs = list(dict.fromkeys(take.program for take in takes if take.program is not None))
    robots: dict[str, Any] = {}
    drawn = [shown for take in takes if (shown := _take(take, programs, robots, points)) is not None]
    if not drawn:
        raise UsageError("there is no pose to replay")
    environment = Environment(loader=PackageLoader("mitl.report"), autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    return environment.get_template("replay.html").render(
        title=drawn[0]["title"] if len(drawn) == 1 else f"{len(drawn)} recordings",
        data=json_in_page({"takes": drawn, "robots": robots, "programs": programs}),
        back=back,
        style=assets.style("templates/theme.css", "templates/replay.css"),
        scripts=assets.script(*_SCRIPTS),
        policy=assets.policy(*_SCRIPTS),
    )


@dataclass(frozen=True, eq=False)
class _Drawn:
    """A take at the samples that are drawn: times (N,) s, positions (N, 3) m in the base frame (nan: none), distance (N,) mm, joints."""

    time: FloatArray
    measured: FloatArray
    expected: FloatArray
    distance: FloatArray
    joints: FloatArray | None


def _drawn(take: Take, points: int) -> _Drawn | None:
    run = take.run
    tool = None if run.tool is None else finite(run.tool.shifted(-run.shift))
    oracle = None if run.oracle is None else finite(run.oracle.shifted(-run.shift))
    lead = tool if tool is not None else oracle
    if lead is None:
        return None
    distance = np.full(len(lead), np.nan)
    if tool is not None and oracle is not None:
        distance = 1e3 * nearest_distance(oracle.position, tool.position)
    chosen = keep_extremes(np.column_stack([lead.position, distance]), max(points, 20))
    at = lead.select(np.isin(np.arange(len(lead)), chosen))
    none = np.full((len(at), 3), np.nan)
    return _Drawn(
        at.time,
        none if tool is None else _in_base(run, at),
        none if oracle is None else _in_base(run, replace(at, position=positions_at(oracle, at.time))),
        distance[chosen],
        _joints(take, at),
    )


def _take(take: Take, programs: list[str], robots: dict[str, Any], points: int) -> dict[str, Any] | None:
    run, drawn = take.run, _drawn(take, points)
    if drawn is None:
        return None
    joints = drawn.joints
    if joints is not None and take.robot is not None and take.robot not in robots:
        robots[take.robot] = robot_shape(load_robot_model(take.robot).urdf)
    columns = {"t": drawn.time, "d": drawn.distance}
    for name, position in (("m", drawn.measured), ("o", drawn.expected)):
        columns |= {f"{name}{axis}": column for axis, column in zip("xyz", position.T, strict=True)}
    if joints is not None:
        columns |= {f"j{axis}": column for axis, column in enumerate(joints.T, start=1)}
    return {
        "title": take.title,
        "key": take.key,
        "robot": take.robot if joints is not None else None,
        "tool": None if run.X_FT is None else run.X_FT[:3].tolist(),
        "object": None if run.X_BO is None else [*run.X_BO[:3].tolist(), *run.X_BO[4:].tolist(), float(run.X_BO[3])],
        "limit": take.limit,
        "program": None if take.program is None else programs.index(take.program),
        "moves": moves_of(run),
        "signals": signals_of(run),
        "events": events_of(run, take.log),
        "columns": {name: packed(column) for name, column in columns.items()},
    }


def _in_base(run: RecordedRun, path: PosePath) -> FloatArray:
    """Gives positions (N, 3) in m in the base frame, or as they are where the work object is unknown."""
    if run.X_BO is None:
        return path.position
    return np.asarray((transform_of(run.X_BO) * transforms_of_path(path)).translation)


def _joints(take: Take, path: PosePath) -> FloatArray | None:
    """Gives the angles between the links (N, 6) in rad at the samples of `path`: as known, or else such that the tool is where it was."""
    if take.robot is None:
        return None
    try:
        model: RobotModel = load_robot_model(take.robot)
    except UsageError:
        return None  # a robot that this installation has no model of
    run = take.run
    if take.joints is not None and run.oracle is not None:
        rows = [np.interp(path.time, run.oracle.time - run.shift, column) for column in take.joints.T]
        return model.between_links(np.column_stack(rows))
    if run.X_BO is None or run.X_FT is None:
        return None
    X_BF = transform_of(run.X_BO) * transforms_of_path(path) * transform_of(run.X_FT).inv()
    joints = Arm(model).joints(X_BF, joints_home())
    known = np.flatnonzero(np.isfinite(joints).all(axis=1))
    if not len(known):
        return None
    held = np.maximum.accumulate(np.where(np.isin(np.arange(len(joints)), known), np.arange(len(joints)), known[0]))
    return model.between_links(joints[held])


_SHADES = ((0.04, 0.36, 0.68), (0.0, 0.51, 0.54), (0.29, 0.55, 0.12), (0.69, 0.53, 0.0), (0.82, 0.42, 0.0), (0.78, 0.12, 0.08))
_ORACLE = (0.62, 0.68, 0.76)
_FRAMES = 25.0
"""Pictures per second of an animation in Meshcat, which sends every one to the browser."""


def animation_of(take: Take, *, points: int = 2000) -> Animation:
    """Gives a take for Meshcat, the recording in pieces of one colour. Raises UsageError where it has no pose."""
    from mitl.simulation.meshcat_replay import Animation, Curve, Marker  # noqa: PLC0415 - loads Drake

    drawn = _drawn(take, points)
    if drawn is None:
        raise UsageError(f"{take.title}: there is no pose to replay")
    seen = np.asarray(np.isfinite(drawn.measured).all(axis=1))
    curves = [Curve("oracle", drawn.expected, 6.0, _ORACLE)] if np.isfinite(drawn.expected).all() else []
    full = take.limit or float(np.nanmax(drawn.distance, initial=1e-6))
    share = np.nan_to_num(drawn.distance / full)
    shade = np.where(share > 1.0, 5, np.minimum(4, (5.0 * share).astype(int))) if take.limit else np.minimum(4, (5.0 * share).astype(int))
    first = np.flatnonzero(np.concatenate([[True], (np.diff(shade) != 0) | (np.diff(seen.astype(int)) != 0)]))
    for number, (start, stop) in enumerate(zip(first, [*first[1:], len(shade)], strict=True)):
        piece = slice(start, min(stop + 1, len(shade)))
        if bool(np.all(seen[piece])) and piece.stop - start > 1:
            curves.append(Curve(f"recorded/{number}", drawn.measured[piece], 3.0, _SHADES[shade[start]]))
    time = np.arange(drawn.time[0], drawn.time[-1], 1.0 / _FRAMES)

    def at(values: FloatArray) -> FloatArray:
        return np.column_stack([np.interp(time, drawn.time, column) for column in values.T])

    span = drawn.measured if seen.any() else drawn.expected
    size = 0.012 * float(np.linalg.norm(np.nanmax(span, axis=0) - np.nanmin(span, axis=0))) + 1e-3
    markers = [Marker("oracle", at(drawn.expected), size, _ORACLE), Marker("recorded", at(drawn.measured), size, (0.1, 0.1, 0.1))]
    urdf = load_robot_model(take.robot).urdf if take.robot is not None and drawn.joints is not None else None
    tool = None if take.run.X_FT is None else take.run.X_FT[:3]
    return Animation(time - time[0], curves, markers, urdf, None if drawn.joints is None else at(drawn.joints), tool)


def write_page(target: Path, text: str) -> None:
    """Writes a page whole or not at all. Raises UsageError where it cannot be written."""
    with replacing(target) as beside:
        beside.write_text(text, encoding="utf-8")
