"""`mitl export`: what a recording holds, in other formats."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from mitl.recording.records import Recording


@click.command(
    "export",
    short_help="Write a recording as CSV, TUM text, XML, or a Foxglove layout.",
    epilog="Example: mitl export mitl-run/atc-1_path.mcap --topic /tool/measured --output path.tum",
)
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--topic", metavar="TOPIC", help="What to write; without it the only path, or measured, oracle or tracker in this order.")
@click.option("--output", type=click.Path(dir_okay=False, path_type=Path), metavar="OUT", help="Where to: .csv, .tum, .txt (TUM) or .xml.")
@click.option("--foxglove", type=click.Path(dir_okay=False, path_type=Path), metavar="OUT.json", help="Write a layout for Foxglove.")
def export_command(file: Path, topic: str | None, output: Path | None, foxglove: Path | None) -> None:
    """Writes one path or series of an MCAP recording to another format; without --output and --foxglove, lists what it holds.

    CSV is that of `mitl oracle`, with moves and outputs where the recording has them (a series: t_s and its columns), TUM text is
    `t x y z qx qy qz qw` in s and m, XML is the thesis's path file in ms and mm. MCAP itself opens in Foxglove.
    """
    from mitl.errors import UsageError  # noqa: PLC0415 - heavy imports only when the command runs
    from mitl.recording.export import export_path, export_series  # noqa: PLC0415 - see above
    from mitl.recording.mcap_reader import read_recording  # noqa: PLC0415 - see above

    recording = read_recording(file)
    if recording.damage:
        click.echo(f"warning: {file}: {recording.damage}; what was before is written", err=True)
    if output is not None:
        chosen = _chosen(recording, topic, file)
        if chosen in recording.paths:
            count = export_path(recording, chosen, output)
        elif chosen in recording.series:
            count = export_series(recording.series[chosen], output)
        else:
            known = ", ".join([*recording.paths, *recording.series]) or "nothing"
            raise UsageError(f"{file}: nothing on topic {chosen}; there is {known}")
        click.echo(f"{output}: {count} samples of {chosen}")
    if foxglove is not None:
        import json  # noqa: PLC0415 - see above

        from mitl.recording.atomic import replacing  # noqa: PLC0415 - see above
        from mitl.recording.foxglove_layout import foxglove_layout  # noqa: PLC0415 - see above

        with replacing(foxglove) as beside:
            beside.write_text(json.dumps(foxglove_layout(recording), indent=2) + "\n", encoding="utf-8")
        click.echo(foxglove)
    if output is None and foxglove is None:
        _list(recording)


def _chosen(recording: Recording, topic: str | None, file: Path) -> str:
    from mitl.errors import UsageError  # noqa: PLC0415 - see above
    from mitl.recording.records import MEASURED, ORACLE, TRACKER  # noqa: PLC0415 - see above

    if topic is not None:
        return topic
    paths = [name for name, track in recording.paths.items() if len(track.path)]
    chosen = paths[0] if len(paths) == 1 else next((name for name in (MEASURED, ORACLE, TRACKER) if name in paths), None)
    if chosen is None:
        raise UsageError(f"{file}: choose one with --topic: {', '.join(paths) or 'there is no path'}")
    return chosen


def _list(recording: Recording) -> None:
    for name, track in recording.paths.items():
        click.echo(f"{name}: {len(track.path)} poses of {track.body} in {track.frame}")
    for name, series in recording.series.items():
        click.echo(f"{name}: {len(series.time)} rows of {', '.join(series.columns)}")
    if recording.log:
        click.echo(f"/log: {len(recording.log)} messages")
