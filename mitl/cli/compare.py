"""`mitl compare`: two paths from files, aligned and compared. A thin wrapper over `metrics.compare` and `calibration.time_offset`."""

from __future__ import annotations

from pathlib import Path

import click

_ALIGN = ("none", "time", "rigid", "similarity")


@click.command(
    "compare",
    short_help="Compare two recorded paths.",
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
@click.option("--format", "form", type=click.Choice(("text", "json")), default="text", show_default=True, help="Form of the output.")
def compare_command(reference: Path, measured: Path, align: str, form: str) -> None:
    """Compares the path in MEASURED with that in REFERENCE, at the same time.

    Files are MCAP, the CSV of `mitl oracle`, or TUM text (t x y z qx qy qz qw, in s and m). MEASURED is interpolated nowhere:
    REFERENCE is, at the times of MEASURED. `scale` is what measured positions were multiplied by, `time_offset_s` what was added to
    measured times; an offset within its own noise counts as none.
    """
    # heavy imports only when the command runs: `mitl --help` loads neither SciPy nor MCAP
    import json  # noqa: PLC0415 - see above
    from dataclasses import asdict  # noqa: PLC0415 - see above

    from mitl.calibration.time_offset import time_offset  # noqa: PLC0415 - see above
    from mitl.errors import UsageError  # noqa: PLC0415 - see above
    from mitl.metrics.compare import Align, compare  # noqa: PLC0415 - see above
    from mitl.recording.read import read_path_and_damage  # noqa: PLC0415 - see above

    (expected, missing), (seen, missing_too) = read_path_and_damage(reference), read_path_and_damage(measured)
    for file, what in ((reference, missing), (measured, missing_too)):
        if what:
            click.echo(f"warning: {file}: {what}; what was before is compared", err=True)
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
