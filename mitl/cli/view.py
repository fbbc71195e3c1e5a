"""`mitl view`: a replay in space, live in Meshcat or as one HTML file."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from mitl.report.replay import Take


@click.command(
    "view",
    short_help="Replay a recording or an oracle in 3-D.",
    epilog="Example: mitl view mitl-run/atc-1_path.mcap --html path.html",
)
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--oracle", type=click.Path(path_type=Path), metavar="O", help="A second file: where the tool should have been.")
@click.option("--html", type=click.Path(dir_okay=False, path_type=Path), metavar="OUT", help="Write one HTML file that needs no network.")
@click.option("--robot", metavar="NAME", help="The robot, for files that do not name theirs (see mitl oracle --help).")
@click.option("--limit", type=click.FloatRange(min=0.0, min_open=True), metavar="MM", help="Distance from the oracle at which red begins.")
@click.option("--cell", metavar="NAME|FOLDER|FILE", help="What stands around the robot, in Meshcat (see mitl preflight --help).")
@click.option("--run", "wanted", metavar="NAME", help="Of a recording with several runs, the one to show in Meshcat.")
@click.option("--port", type=click.IntRange(1024, 65535), metavar="N", help="Port of Meshcat; the first free one from 7000 on otherwise.")
def view_command(
    file: Path,
    oracle: Path | None,
    html: Path | None,
    robot: str | None,
    limit: float | None,
    cell: str | None,
    wanted: str | None,
    port: int | None,
) -> None:
    """Replays FILE with robot, oracle and recording on one time slider, coloured by the distance from the oracle.

    FILE is a case's recording or an oracle (MCAP), the CSV of `mitl oracle`, or a path of any format that `mitl compare` reads. Without
    --html the replay is served by Meshcat on this machine until Ctrl-C. The robot is shown where the file tells where its frame is.
    """
    from mitl.errors import UsageError  # noqa: PLC0415 - heavy imports only when the command runs
    from mitl.report.replay import replay_page, write_page  # noqa: PLC0415 - see above
    from mitl.report.takes import takes_of_file, with_oracle  # noqa: PLC0415 - see above

    if robot is not None:
        from mitl.motion.robot_model import load_robot_model  # noqa: PLC0415 - see above

        load_robot_model(robot)
    takes = takes_of_file(file, robot=robot, limit=limit)
    if oracle is not None:
        (expected, *more) = takes_of_file(oracle, robot=robot, limit=limit)
        if more:
            raise UsageError(f"{oracle}: expected one path, found {1 + len(more)} runs")
        takes = [with_oracle(take, expected) for take in takes]
    if wanted is not None:
        names = [take.title for take in takes]
        takes = [take for take in takes if wanted in {take.title, take.run.name}]
        if not takes:
            raise UsageError(f"{file}: no run {wanted!r}; there are {', '.join(names)}")
    if html is not None:
        if cell is not None:
            raise UsageError("--cell is shown in Meshcat only: leave --html out")
        write_page(html, replay_page(takes))
        click.echo(html)
        return
    _serve(takes[0], [take.title for take in takes[1:]], port, cell)


def _serve(take: Take, others: list[str], port: int | None, cell: str | None) -> None:
    from mitl.report.replay import animation_of  # noqa: PLC0415 - see above
    from mitl.simulation.cell import load_cell  # noqa: PLC0415 - loads Drake
    from mitl.simulation.meshcat_replay import open_meshcat, publish  # noqa: PLC0415 - loads Drake

    around = None if cell is None else load_cell(cell)
    meshcat = open_meshcat(port)
    publish(meshcat, replace(animation_of(take), cell=around))
    click.echo(meshcat.web_url())
    click.echo(f"{take.title}: play it under Open Controls > Animations; Ctrl-C ends", err=True)
    if others:
        click.echo(f"choose another run with --run: {', '.join(others)}", err=True)
    while True:
        time.sleep(1.0)
