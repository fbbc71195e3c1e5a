"""`mitl doctor`: looks at a physical rig end to end before a night run, and moves nothing."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mitl.errors import UsageError

if TYPE_CHECKING:
    from mitl.rig.doctor import Finding


@click.command(
    "doctor", short_help="Check a physical rig end to end; nothing moves.", epilog="Example: mitl doctor --rig cell.toml --out runs"
)
@click.option(
    "--rig", required=True, metavar="FILE.toml", type=click.Path(exists=True, dir_okay=False, path_type=Path), help="The rig file."
)
@click.option(
    "--out", default=".", show_default=True, type=click.Path(file_okay=False, path_type=Path), help="Folder that runs will be kept in."
)
@click.option("--seconds", default=2.0, show_default=True, type=click.FloatRange(0.5, 60.0), help="How long the tracker is watched.")
@click.option("--format", "form", type=click.Choice(("text", "json")), default="text", show_default=True, help="Form of the output.")
@click.pass_context
def doctor_command(context: click.Context, rig: Path, out: Path, seconds: float, form: str) -> None:
    """Checks network, login, RobotWare, options, mode, motors, clock, tracker devices, base stations, sampling rate, calibration and disk.

    Exit code: 0 fit for a run, 4 something would keep it from one. Nothing moves, and nothing on the controller is changed.
    """
    from mitl.rig.doctor import examine  # noqa: PLC0415 - heavy imports only when the command runs
    from mitl.rig.physical_config import is_physical, read_physical  # noqa: PLC0415 - see above

    if not is_physical(str(rig)):
        raise UsageError(f'{rig}: expected a rig file of kind = "physical"; a simulated rig needs no doctor')
    context.exit(tell(examine(read_physical(rig), out, seconds), form))


def tell(findings: Sequence[Finding], form: str) -> int:
    """Prints findings as "text" or "json". Gives the exit code: 0 fit for a run, 4 something would keep it from one."""
    if form == "json":
        import json  # noqa: PLC0415 - only for this form

        click.echo(json.dumps([{"what": one.what, "state": one.state.value, "told": one.told} for one in findings], indent=2))
    else:
        for finding in findings:
            click.echo(line_of(finding))
    return 4 if any(finding.state.value == "bad" for finding in findings) else 0


def line_of(finding: Finding) -> str:
    """Gives a finding as a line of text."""
    return f"{finding.state.value:5}{finding.what:22}{finding.told}"
