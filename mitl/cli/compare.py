"""`mitl compare`: two paths from files, aligned and compared, or judged. A thin wrapper over `metrics.compare` and `cli.compare_judged`."""

from __future__ import annotations

from math import isfinite, radians
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from mitl.paths import PosePath

_ALIGN = ("none", "time", "rigid", "similarity")


@click.command(
    "compare",
    short_help="Compare two recorded paths, or judge one against an oracle.",
    epilog="Example: mitl compare oracle.csv recording.mcap --align rigid --format json",
)
@click.argument("reference", type=click.Path(path_type=Path))
@click.argument("measured", type=click.Path(path_type=Path))
@click.option(
    "--align",
    type=click.Choice(_ALIGN),
    default="none",
    show_default=True,
    help="What is fitted first, each with those before it: the clocks' offset; rotation and translation; one scale.",
)
@click.option("--columns", metavar="MAP", help="Columns of MEASURED, a table: t=COLUMN,x=COLUMN,... or vicon, optitrack, laser, egm.")
@click.option(
    "--calibration",
    type=click.Path(path_type=Path),
    metavar="FILE.toml",
    help="Judge: REFERENCE is an oracle's MCAP, MEASURED what the tracker saw, this what mitl calibrate found.",
)
@click.option("--limit", metavar="MM", type=float, help="To judge: at the same time; 10 without.")
@click.option("--path-limit", metavar="MM", type=float, help="To judge: from the path as a curve; 5 without.")
@click.option("--turn-limit", metavar="DEG", type=float, help="To judge: of the orientation; 5 without.")
@click.option("--drift", metavar="MM", type=float, help="To judge: 1 sd of the tracker's drift since its calibration; a Vive's without.")
@click.option("--moves", metavar="FIRST:LAST", help="To judge: which moves, counted from 0; all but the first without.")
@click.option("--robot", metavar="NAME", help="To judge: the robot model of the oracle, where its file does not say.")
@click.option("--format", "form", type=click.Choice(("text", "json")), default="text", show_default=True, help="Form of the output.")
@click.pass_context
def compare_command(
    context: click.Context,
    reference: Path,
    measured: Path,
    align: str,
    columns: str | None,
    calibration: Path | None,
    limit: float | None,
    path_limit: float | None,
    turn_limit: float | None,
    drift: float | None,
    moves: str | None,
    robot: str | None,
    form: str,
) -> None:
    """Compares the path in MEASURED with that in REFERENCE, at the same time.

    Files are MCAP, the CSV of `mitl oracle`, or TUM text (t x y z qx qy qz qw, in s and m). MEASURED is interpolated nowhere:
    REFERENCE is, at the times of MEASURED. `scale` is what measured positions were multiplied by, `time_offset_s` what was added to
    measured times; an offset within its own noise counts as none.

    With --calibration the verdict is printed too, with its uncertainty: pass, fail or inconclusive; the exit code is that of
    mitl verify. The recording may be of any tracker.
    """
    # heavy imports only when the command runs: `mitl --help` loads neither SciPy nor MCAP
    import json  # noqa: PLC0415 - see above
    from dataclasses import asdict  # noqa: PLC0415 - see above

    from mitl.calibration.time_offset import time_offset  # noqa: PLC0415 - see above
    from mitl.errors import UsageError  # noqa: PLC0415 - see above
    from mitl.metrics.compare import Align, compare  # noqa: PLC0415 - see above

    judging = {"--limit": limit, "--path-limit": path_limit, "--turn-limit": turn_limit, "--drift": drift}
    for name, value in judging.items():
        if value is not None and not (isfinite(value) and value >= 0.0):
            raise UsageError(f"{name} {value:g}: expected a number of 0 or more")
    if calibration is not None:
        from mitl.cli.compare_judged import judge  # noqa: PLC0415 - see above
        from mitl.engine.path_verdict import PathLimits  # noqa: PLC0415 - see above

        if align != "none":
            raise UsageError("--align and --calibration exclude each other: the calibration says how the frames lie")
        chosen = {"in_time": limit and 1e-3 * limit, "shape": path_limit and 1e-3 * path_limit, "turn": turn_limit and radians(turn_limit)}
        limits = PathLimits(**{name: value for name, value in chosen.items() if value is not None})
        metres = None if drift is None else 1e-3 * drift
        outcome = judge(reference, _tracked(measured, columns), calibration, limits, drift=metres, moves=moves, robot=robot, form=form)
        context.exit({"pass": 0, "fail": 1, "inconclusive": 3}[outcome])
    given = [name for name, value in {**judging, "--moves": moves, "--robot": robot}.items() if value is not None]
    if given:
        raise UsageError(f"{', '.join(given)}: only to judge: give --calibration FILE.toml")
    expected, seen = _path(reference, None), _path(measured, columns)
    seconds = 0.0
    if align != "none":
        offset = time_offset(expected, seen)
        if offset.significant:
            seconds = offset.seconds
    try:
        result = compare(expected, seen, Align(align), seconds)
    except ValueError as error:
        raise UsageError(f"{reference} and {measured} cannot be compared: {error}") from error
    if form == "json":
        click.echo(json.dumps(asdict(result)))
        return
    names = {
        "position_rmse_m": ("position rms", 1e3, "mm"),
        "position_mean_m": ("position mean", 1e3, "mm"),
        "position_max_m": ("position max", 1e3, "mm"),
        "position_p95_m": ("position 95 %", 1e3, "mm"),
        "rotation_rmse_deg": ("rotation rms", 1.0, "deg"),
        "time_offset_s": ("time offset", 1e3, "ms"),
        "scale": ("scale", 1.0, ""),
        "speed_rmse_m_s": ("speed rms", 1e3, "mm/s"),
        "samples": ("samples", 1, ""),
    }
    for key, value in asdict(result).items():
        name, factor, unit = names[key]
        number = f"{value}" if key == "samples" else f"{value * factor:.6g}"
        click.echo(f"{name:<14} {number:>12} {unit}".rstrip())


def _path(file: Path, columns: str | None) -> PosePath:
    """Gives the path that a file is about, with a warning on standard error where a part of it is missing."""
    if columns is not None:
        return _tracked(file, columns)
    from mitl.recording.read import read_path_and_damage  # noqa: PLC0415 - heavy imports only when the command runs

    path, damage = read_path_and_damage(file)
    if damage:
        click.echo(f"warning: {file}: {damage}; what was before is compared", err=True)
    return path


def _tracked(file: Path, columns: str | None) -> PosePath:
    """Gives the path of the only tracker in a file; a file that is damaged is judged by what it holds."""
    from mitl.errors import UsageError  # noqa: PLC0415 - heavy imports only when the command runs
    from mitl.recording import ColumnMap  # noqa: PLC0415 - see above
    from mitl.recording.read import read_tracker_recordings  # noqa: PLC0415 - see above

    found = read_tracker_recordings(file, columns=None if columns is None else ColumnMap.parse(columns))
    if len(found) > 1:
        raise UsageError(f"{file}: expected one path, got {len(found)}: {', '.join(each.name for each in found)}")
    if found[0].damage:
        click.echo(f"warning: {file}: {found[0].damage}; what was before is compared", err=True)
    return found[0].path
