"""`mitl diff`: what changed from one run to another."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("diff", short_help="What changed from one run to another.", epilog="Example: mitl diff last-week mitl-run --format markdown")
@click.argument("before", metavar="RUN", type=click.Path(path_type=Path))
@click.argument("after", metavar="RUN", type=click.Path(path_type=Path))
@click.option(
    "--format", "form", type=click.Choice(("text", "json", "markdown")), default="text", show_default=True, help="Form of the output."
)
@click.pass_context
def diff_command(context: click.Context, before: Path, after: Path, form: str) -> None:
    """Compares two runs by their folders: settings, cases, and the checks whose value moved more than both uncertainties explain.

    Exit code 1 where a case that passed before does not now, else 0.
    """
    from mitl.engine.results import read_run  # noqa: PLC0415 - heavy imports only when the command runs
    from mitl.history import markdown  # noqa: PLC0415 - see above
    from mitl.history.difference import difference_of  # noqa: PLC0415 - see above

    found = difference_of(read_run(before), read_run(after))
    if form == "markdown":
        click.echo(markdown.difference(found, (before.name or str(before), after.name or str(after))), nl=False)
    elif form == "json":
        import json  # noqa: PLC0415 - see above
        from math import isfinite  # noqa: PLC0415 - see above

        cases = [
            {"id": c.id, "before": c.before.value if c.before else None, "after": c.after.value if c.after else None} for c in found.cases
        ]
        checks = [
            {
                "case": c.case_id,
                "name": c.after.name,
                "unit": c.after.unit,
                "before": c.before.value,
                "after": c.after.value,
                "moved": c.moved,
                "sigmas": c.sigmas if isfinite(c.sigmas) else None,
                "outcome": c.after.outcome.value,
            }
            for c in found.checks
        ]
        click.echo(json.dumps({"settings": [list(setting) for setting in found.settings], "cases": cases, "checks": checks}, indent=2))
    else:
        for name, old, new in found.settings:
            click.echo(f"{name}: {old} -> {new}")
        for case in found.cases:
            click.echo(f"{case.id}: {case.before.value if case.before else 'absent'} -> {case.after.value if case.after else 'absent'}")
        for c in found.checks:
            where = f"{c.case_id}: {c.after.name}"
            click.echo(
                f"{where}: {c.before.value:.4g} -> {c.after.value:.4g} {c.after.unit} ({c.sigmas:+.1f} sigma), {c.after.outcome.value}"
            )
        if not (found.cases or found.checks):
            click.echo("no case changed its outcome and no value moved by more than its uncertainty explains")
    context.exit(1 if found.worse else 0)
