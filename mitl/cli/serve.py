"""`mitl serve`: the virtual controller, the simulated controller behind ABB's Robot Web Services."""

from __future__ import annotations

import asyncio
import os
import signal
import tempfile
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mitl.errors import UsageError

if TYPE_CHECKING:
    from mitl.controllers.virtual.server import VirtualServer

_LOOPBACK = ("127.0.0.1", "localhost", "::1")
_KINDS = ("DI", "DO", "AI", "AO", "GI", "GO")
PASSWORD_VARIABLE = "MITL_SERVE_PASSWORD"  # noqa: S105 - the name of a variable


@click.command(
    "serve",
    short_help="Serve a virtual controller by Robot Web Services.",
    epilog="Example: mitl serve --rws 2 --port 8443 --program cell/ --signal diStart=DI",
)
@click.option(
    "--rws", "generation", type=click.Choice(("1", "2", "8")), default="1", show_default=True, help="1: IRC5, 2: OmniCore, 8: RobotWare 8."
)
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to listen on.")
@click.option("--port", default=0, type=click.IntRange(0, 65535), help="Port to listen on; any free one if not given.")
@click.option("--robot", default="irb140", show_default=True, help="Robot model, a folder in models/.")
@click.option("--program", type=click.Path(exists=True, path_type=Path), help="Folder or file of a program to load, pointer at main.")
@click.option(
    "--home",
    type=click.Path(file_okay=False, path_type=Path),
    help="Folder that is the controller's disk; else one that is removed at the end.",
)
@click.option(
    "--realtime/--fast", default=True, show_default=True, help="Time passes as on the wall, or as fast as possible while RAPID runs."
)
@click.option(
    "--egm", metavar="HOST:PORT", help="Stream the controller's own view of its motion there, as EGMStreamStart does: 250 Hz, UDP."
)
@click.option(
    "--signal", "signals", multiple=True, metavar="NAME=KIND", help=f"A signal beside those that the program uses ({', '.join(_KINDS)})."
)
@click.option("--fault", "faults", multiple=True, metavar="NAME[=SIZE]", help="Break the controller on purpose (mitl faults).")
@click.option("--tls/--no-tls", default=None, help="Encrypt with a certificate of its own; as real ones: off with 1, on with 2 and 8.")
@click.option(
    "--poses", type=click.Path(dir_okay=False, path_type=Path), help="File for a simulated tracker's poses (for a stand-in for SteamVR)."
)
@click.option("--tracker", default="thesis", show_default=True, help="With --poses: the tracker's preset, in models/trackers/.")
@click.option(
    "--seed", default=1, show_default=True, type=click.IntRange(min=0), help="With --poses: where the tracker is put, and its noise."
)
@click.option(
    "--rate-limit",
    default=0.0,
    type=click.FloatRange(min=0),
    metavar="N",
    help="Answer 503 beyond N requests a second and session; 0: never.",
)
def serve_command(
    generation: str,
    host: str,
    port: int,
    robot: str,
    program: Path | None,
    home: Path | None,
    realtime: bool,
    egm: str | None,
    signals: tuple[str, ...],
    faults: tuple[str, ...],
    tls: bool | None,
    poses: Path | None,
    tracker: str,
    seed: int,
    rate_limit: float,
) -> None:
    """Serves a virtual controller: the simulated controller, real RAPID, behind Robot Web Services 1.0, 2.0 or those of RobotWare 8.

    Its address is the first line of standard output, printed when it is ready. Users are "Default User" and "Admin"; their password is
    ABB's default or that of the environment variable MITL_SERVE_PASSWORD. Ctrl-C ends it.
    """
    from mitl.controllers.faults import parse_fault  # noqa: PLC0415 - heavy imports only when the command runs
    from mitl.controllers.virtual import start  # noqa: PLC0415 - see above
    from mitl.controllers.virtual.answers import Dialect  # noqa: PLC0415 - see above
    from mitl.controllers.virtual.egm_sender import EgmSender  # noqa: PLC0415 - see above
    from mitl.controllers.virtual.server import Pace, VirtualServer  # noqa: PLC0415 - see above
    from mitl.controllers.virtual.tls import self_signed  # noqa: PLC0415 - see above

    if host not in _LOOPBACK:
        click.echo(f"mitl: warning: {host} is not loopback: everybody who reaches this computer can ask this controller", err=True)
        if PASSWORD_VARIABLE not in os.environ:
            click.echo(f"mitl: warning: the password is ABB's published default; set {PASSWORD_VARIABLE}", err=True)
    dialect = Dialect(generation)
    broken, known = [parse_fault(text) for text in faults], dict(map(_signal, signals))
    context, fingerprint = self_signed(host) if tls or (tls is None and dialect is not Dialect.RWS1) else (None, "")
    if poses is not None and not realtime:
        raise UsageError("--poses needs --realtime: who reads the poses goes by the wall's clock")
    if poses is None:
        cell = start.virtual_cell(robot, faults=broken, signals=known)
    else:
        from mitl.rig.virtual_cell import tracked_cell  # noqa: PLC0415 - loads the simulator

        cell, _ = tracked_cell(robot, tracker, seed, poses, faults=broken, signals=known)
    with closing(cell), tempfile.TemporaryDirectory(prefix="mitl-disk-") as own:
        if program is not None:
            start.load_at_start(cell, program)
        service = start.service(
            cell, dialect, home or Path(own), password=os.environ.get(PASSWORD_VARIABLE, start.PASSWORD), rate=rate_limit
        )
        stream = EgmSender(cell, egm) if egm is not None else None
        server = VirtualServer(service, host=host, port=port, pace=Pace.REALTIME if realtime else Pace.FAST, tls=context, egm=stream)
        asyncio.run(_serve(server, fingerprint))


async def _serve(server: VirtualServer, fingerprint: str) -> None:
    ended = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, ended.set)
    address = await server.start()
    click.echo(address)
    if fingerprint:
        click.echo(f"certificate SHA-256 {fingerprint}", err=True)
    try:
        await ended.wait()
    finally:
        await server.stop()
    click.echo("stopped", err=True)


def _signal(text: str) -> tuple[str, str]:
    name, _, kind = text.partition("=")
    if not name.isidentifier() or kind.upper() not in _KINDS:
        raise UsageError(f"--signal {text}: expected NAME=KIND with KIND one of {', '.join(_KINDS)}, e.g. diStart=DI")
    return name, kind.upper()
