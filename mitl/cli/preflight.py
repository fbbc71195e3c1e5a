"""`mitl preflight`: what a program's motion would run into. A thin wrapper over `simulation.preflight`.

Invariant: exit code 1 if there is an error, 2 if something cannot be read; warnings alone change nothing.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mitl.cli.oracle import read_assignment, read_input_change

if TYPE_CHECKING:  # heavy imports only when the command runs
    from collections.abc import Collection, Iterable

    from mitl.motion.preflight import Finding
    from mitl.simulation.preflight import Nearest, Report
    from rapid_interp import Order, Task

_POSITIVE = click.FloatRange(min=0)


@click.command("preflight", epilog="Example:  mitl preflight cell.mod --robot irb140 --cell table --clearance 20")
@click.argument("sources", nargs=-1, required=True, metavar="FILE|FOLDER...", type=click.Path(path_type=Path))
@click.option("--routine", default="main", show_default=True, help="Procedure to run.")
@click.option("--set", "presets", multiple=True, metavar="VAR=VALUE", help="Set RAPID data before the start, e.g. --set option=3.")
@click.option("--input", "inputs", multiple=True, metavar="SIGNAL=VALUE@SECONDS", help="Give an input signal a value from a time on.")
@click.option("--robot", default="irb140", show_default=True, help="Robot model.")
@click.option("--cell", metavar="NAME|FOLDER|FILE", help="What stands around the robot: a name, a folder, a .urdf or an .sdf.")
@click.option(
    "--tool",
    type=click.Path(path_type=Path, dir_okay=False, exists=True),
    metavar="FILE",
    help="A .urdf or .sdf of the tool, its origin at the flange. Without it a tool is a rod from the flange to its tip.",
)
@click.option("--clearance", type=_POSITIVE, default=0.0, show_default=True, help="Least distance in mm to keep from the cell.")
@click.option("--box", metavar="XMIN,XMAX,YMIN,YMAX,ZMIN,ZMAX", help="Box in mm of the base frame that the tool's tip must not leave.")
@click.option("--axis-margin", type=_POSITIVE, default=1.0, show_default=True, help="Least distance in deg to keep from axis limits.")
@click.option("--wrist-margin", type=_POSITIVE, default=2.0, show_default=True, help="Least angle in deg of axis 5 in linear moves.")
@click.option(
    "--max-time",
    type=click.FloatRange(min=0, min_open=True),
    help="Cut the program off after so many seconds of the robot's time.",
)
@click.option(
    "--format", "output_format", type=click.Choice(["text", "json"]), default="text", show_default=True, help="Form of the result."
)
def preflight_command(
    sources: tuple[Path, ...],
    routine: str,
    presets: tuple[str, ...],
    inputs: tuple[str, ...],
    robot: str,
    cell: str | None,
    tool: Path | None,
    clearance: float,
    box: str | None,
    axis_margin: float,
    wrist_margin: float,
    max_time: float | None,
    output_format: str,
) -> None:
    """Look a program's motion over before a robot runs it.

    Runs the program without a rig and checks what the arm would really do, every 4 ms: reach and configuration of every target, axis
    and speed limits, distance from singularities, collisions of arm and tool with themselves and with a cell, a box for the tool.
    A target that cannot be reached is skipped, so that one does not hide the next. A program that waits for orders (a loop that tests
    a variable) is given each of them once, unless --set gives it one. Exit code 1 if there is an error.
    """
    import rapid_interp  # noqa: PLC0415 - see above
    from mitl.cli.progress import Progress  # noqa: PLC0415 - see above
    from mitl.errors import UsageError  # noqa: PLC0415 - see above
    from mitl.motion.preflight import Margins  # noqa: PLC0415 - see above
    from mitl.motion.robot_model import load_robot_model  # noqa: PLC0415 - see above
    from mitl.simulation.cell import load_cell  # noqa: PLC0415 - see above
    from mitl.simulation.preflight import Surroundings, preflight, read_box, unread  # noqa: PLC0415 - see above

    model = load_robot_model(robot)
    margins = Margins(axis=math.radians(axis_margin), wrist=math.radians(wrist_margin), box=None if box is None else read_box(box))
    around = Surroundings(None if cell is None else load_cell(cell), tool, 1e-3 * clearance)
    changes = [read_input_change(text) for text in inputs]
    try:
        program = rapid_interp.load(sources, signals=[change.name for change in changes])
    except rapid_interp.RapidErrors as errors:
        if output_format == "text":
            raise
        click.echo(json.dumps(as_json(unread(model.name, errors.diagnostics)), indent=2))
        sys.exit(1)
    try:
        task = program.start(routine)
    except rapid_interp.RapidError as error:
        raise UsageError(f"--routine {routine}: {error.message}") from error
    values = dict(read_assignment(text) for text in presets)
    for name, value in values.items():
        try:
            task.set(name, value)
        except rapid_interp.RapidError as error:
            raise UsageError(f"--set {name}={value}: {error.message}") from error
    orders = left_open(rapid_interp.orders(program, routine), task, values)
    with Progress("pre-flight") as progress:
        report = preflight(
            task, model, margins=margins, around=around, inputs=changes, orders=orders, max_time=max_time, progress=progress.at
        )
    click.echo(json.dumps(as_json(report), indent=2) if output_format == "json" else as_text(report))
    if report.errors:
        sys.exit(1)


def left_open(orders: Iterable[Order], task: Task, given: Collection[str]) -> list[Order]:
    """Gives the orders that set no data otherwise than the user did; none of data that the user gave the order with."""
    names = {name.rpartition(":")[2].lower() for name in given}
    return [
        order
        for order in orders
        if order.name.lower() not in names and all(task.get(name) == value for name, value in order.values if name.lower() in names)
    ]


def as_text(report: Report) -> str:
    """Gives the findings with their places, and below them what the motion used of the arm."""
    measures = report.measures
    lines = [_line(finding) for finding in report.findings]
    lines += [
        f"robot         {report.robot}",
        *([f"orders        {len(report.orders)}, each to its end"] if report.orders else []),
        f"motion        {report.duration_s:.3f} s, looked at every 4 ms (tool: {1e3 * measures.tool_step:.1f} mm at most)",
        f"to itself     {_gap(report.itself)}",
        f"to the cell   {_gap(report.cell)}",
    ]
    if report.samples:
        room = (f"J{axis} {math.degrees(value):.1f}" for axis, value in enumerate(measures.axis_margin, 1))
        share = (f"J{axis} {100 * value:.1f} %" for axis, value in enumerate(measures.speed_share, 1))
        lines += [
            f"axis limits   at least {', '.join(room)} deg away",
            f"joint speed   {', '.join(share)} of the limit",
            f"singularities {_distances(report)}",
        ]
    errors, warnings = report.errors, len(report.findings) - report.errors
    expected = f", {len(report.expected)} expected" if report.expected else ""
    lines.append(f"findings      {errors} error{'s' * (errors != 1)}, {warnings} warning{'s' * (warnings != 1)}{expected}")
    return "\n".join(lines)


def as_json(report: Report) -> dict[str, Any]:
    """Gives the report as JSON's own types; what was not measured is null."""
    measures = report.measures
    return {
        "schema": 1,
        "robot": report.robot,
        "duration_s": round(report.duration_s, 6),
        "samples": report.samples,
        "resolution": {"time_s": 0.004, "tool_step_mm": round(1e3 * measures.tool_step, 3)},
        "clearance": {"itself": _gap_json(report.itself), "cell": _gap_json(report.cell)},
        "axes": [
            {"axis": axis, "limit_margin_deg": _number(math.degrees(room)), "speed_share": _number(share)}
            for axis, (room, share) in enumerate(zip(measures.axis_margin, measures.speed_share, strict=True), 1)
        ],
        "singularity": {
            "axis_5_deg": _number(math.degrees(measures.wrist)),
            "elbow_deg": _number(math.degrees(measures.elbow)),
            "shoulder_mm": _number(1e3 * measures.shoulder),
        },
        "orders": [dict(reversed(order.values)) for order in report.orders],
        "findings": [_finding_json(finding) for finding in report.findings],
        "expected": [_finding_json(finding) for finding in report.expected],
    }


def _finding_json(finding: Finding) -> dict[str, Any]:
    return {
        "file": finding.file,
        "module": finding.module,
        "line": finding.line,
        "column": finding.column,
        "severity": finding.severity.value,
        "code": finding.code,
        "message": finding.message,
        "time_s": _number(finding.time_s),
        "value": _number(finding.value),
        "limit": _number(finding.limit),
        "unit": finding.unit,
    }


def _line(finding: Finding) -> str:
    place = f"{finding.file or finding.module}:{finding.line}:{finding.column}"
    return f"{place}: {finding.severity.value}: {finding.message} [{finding.code}]"


def _gap(nearest: Nearest | None) -> str:
    if nearest is None:
        return "nowhere within 300 mm"
    first, second = (name.replace("_", " ") for name in nearest.bodies)
    return f"{1e3 * nearest.distance:.1f} mm, {first} and {second}, at {nearest.time_s:.2f} s, {nearest.module}:{nearest.line}"


def _gap_json(nearest: Nearest | None) -> dict[str, Any] | None:
    if nearest is None:
        return None
    return {
        "distance_mm": _number(1e3 * nearest.distance),
        "bodies": list(nearest.bodies),
        "time_s": _number(nearest.time_s),
        "module": nearest.module,
        "line": nearest.line,
    }


def _distances(report: Report) -> str:
    measures = report.measures
    if not math.isfinite(measures.elbow):
        return "no linear or circular move"
    axis_5 = f"axis 5 at least {math.degrees(measures.wrist):.1f} deg, " if math.isfinite(measures.wrist) else ""
    return f"{axis_5}arm {math.degrees(measures.elbow):.1f} deg from straight, wrist {1e3 * measures.shoulder:.0f} mm from axis 1"


def _number(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else round(float(value), 6)
