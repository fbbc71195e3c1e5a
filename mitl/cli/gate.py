"""`mitl gate`: whether a run lets the build through, known issues left out."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

import click


@click.command(
    "gate", short_help="Whether a run lets the build through.", epilog="Example: mitl gate mitl-run gates.toml --format markdown"
)
@click.argument("folder", metavar="RUN", type=click.Path(path_type=Path))
@click.argument("gates", metavar="[GATES.toml]", required=False, type=click.Path(path_type=Path))
@click.option("--format", "form", type=click.Choice(("text", "markdown")), default="text", show_default=True, help="Form of the output.")
@click.option("--allure", type=click.Path(file_okay=False, path_type=Path), metavar="DIR", help="Write Allure result files here as well.")
@click.option("--today", metavar="DAY", hidden=True, help="The day by which known issues expire, for tests.")
@click.pass_context
def gate_command(context: click.Context, folder: Path, gates: Path | None, form: str, allure: Path | None, today: str | None) -> None:
    """Judges a run by a file of quality gates and known issues, for CI.

    Without GATES.toml a case that fails or cannot be judged closes the gate. Exit code 0 where the build may go on, else 1.
    The file has a section [gate] (fail_on, inconclusive_at_most, skipped_at_most) and sections [[known]] (case, reason, outcome, until).
    """
    from mitl.engine.results import read_run  # noqa: PLC0415 - heavy imports only when the command runs
    from mitl.history import markdown  # noqa: PLC0415 - see above
    from mitl.history.gates import Gates, judge, read_gates  # noqa: PLC0415 - see above
    from mitl.report.since import read_since  # noqa: PLC0415 - see above

    run = read_run(folder)
    day = datetime.now(UTC).date() if today is None else datetime.fromisoformat(today).date()
    result = judge(run, Gates() if gates is None else read_gates(gates), day)
    if allure is not None:
        from mitl.history.allure import write_allure  # noqa: PLC0415 - see above

        write_allure(run, folder, allure)
    if form == "markdown":
        click.echo(markdown.summary(run, read_since(folder), result), nl=False)
    else:
        for case, known in result.expected:
            until = f" until {known.until}" if known.until else ""
            click.echo(f"expected{until}: {case.id}: {case.outcome.value}: {known.reason}")
        for known in result.fixed:
            click.echo(f"fixed, take it out of {gates}: {known.case}: {known.reason}")
        for reason in result.broken:
            click.echo(f"closed: {reason}")
        click.echo("the gates are open" if result.open else "the gates are closed")
    context.exit(0 if result.open else 1)
