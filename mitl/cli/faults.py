"""`mitl faults`: what can be broken on purpose."""

from __future__ import annotations

import json

import click


@click.command("faults", epilog="Example:  mitl faults; mitl verify atc-1 --fault target-offset=6")
@click.option("--format", "output_format", type=click.Choice(["text", "json"]), default="text", show_default=True, help="Form of the list.")
def faults_command(output_format: str) -> None:
    """List the faults that `mitl verify --fault NAME[=SIZE]` injects into the simulated controller, with unit and default size."""
    from mitl.controllers.faults import KINDS  # noqa: PLC0415 - loads the planner

    if output_format == "json":
        rows = [{"name": k.name, "title": k.title, "layer": k.layer, "unit": k.unit, "size": k.size} for k in KINDS.values()]
        click.echo(json.dumps(rows, indent=2))
        return
    width = max(len(name) for name in KINDS)
    for kind in KINDS.values():
        click.echo(f"{kind.name:<{width}}  {f'{kind.size:g} {kind.unit}':<14}  {kind.title} [{kind.layer}]")
