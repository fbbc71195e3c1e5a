"""`mitl report`: makes the report of a run again."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("report", short_help="Make the report of a run again.", epilog="Example: mitl report mitl-run")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
def report_command(folder: Path) -> None:
    """Makes DIR/report.html again from results.json and the recordings beside it, and prints its path.

    DIR is the folder of a run of `mitl verify`.
    """
    from mitl.report import write_report  # noqa: PLC0415 - loads matplotlib, which `mitl --help` must not

    click.echo(write_report(folder))
