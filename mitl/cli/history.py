"""`mitl history`: runs kept in SQLite, and what they tell together."""

from __future__ import annotations

from pathlib import Path

import click

from mitl.cli.store_option import store_option


@click.group(
    "history",
    short_help="Keep runs, and see their trends.",
    epilog="Example: mitl history add mitl-run && mitl history page --html trend.html",
)
@store_option("The SQLite file that keeps the runs.")
@click.pass_context
def history_command(context: click.Context, store: Path) -> None:
    """Keeps runs in one SQLite file and tells what they tell together.

    Runs are compared with runs of the same rig, robot and injected faults.
    """
    context.obj = store


@history_command.command("add", epilog="Example: mitl history add mitl-run")
@click.argument("folders", metavar="RUN...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.pass_obj
def add_command(store: Path, folders: tuple[Path, ...]) -> None:
    """Keeps runs and makes their reports again, which then say since when a case fails. A run that is known already is left."""
    from mitl.history.since import since_of  # noqa: PLC0415 - heavy imports only when the command runs
    from mitl.history.store import open_store  # noqa: PLC0415 - see above
    from mitl.report import write_report  # noqa: PLC0415 - see above
    from mitl.report.since import write_since  # noqa: PLC0415 - see above

    with open_store(store, create=True) as opened:
        for folder in folders:
            run, new = opened.add(folder)
            write_since(folder, since_of(opened, run))
            write_report(folder)
            click.echo(f"{run.id}  {run.outcome.value:<12}  {folder}{'' if new else '  (was known)'}")


@history_command.command("runs", epilog="Example: mitl history runs --format json")
@click.option("--format", "form", type=click.Choice(("text", "json")), default="text", show_default=True, help="Form of the output.")
@click.pass_obj
def runs_command(store: Path, form: str) -> None:
    """Lists the runs that are kept, oldest first."""
    import json  # noqa: PLC0415 - see above

    from mitl.history.store import open_store  # noqa: PLC0415 - see above

    with open_store(store) as opened:
        runs = opened.runs()
    if form == "json":
        keys = ("id", "started", "rig", "robot", "seed", "wall_s", "folder")
        click.echo(
            json.dumps(
                [{**{key: getattr(run, key) for key in keys}, "outcome": run.outcome.value, "faults": list(run.faults)} for run in runs],
                indent=2,
            )
        )
        return
    for run in runs:
        faults = f"  {' '.join(run.faults)}" if run.faults else ""
        click.echo(
            f"{run.id}  {run.started[:19]:<19}  {run.outcome.value:<12}  {run.rig} {run.robot} seed {run.seed}{faults}  {run.folder}"
        )


@history_command.command("trend", epilog="Example: mitl history trend atc-1/path")
@click.argument("case", required=False)
@click.option("--run", "name", default="last", show_default=True, metavar="ID", help="The run whose like are compared.")
@click.pass_obj
def trend_command(store: Path, case: str | None, name: str) -> None:
    """Tells of every check its newest value, the row of values, since when it does not pass, and whether it flickers and why."""
    from mitl.history.page import why  # noqa: PLC0415 - see above
    from mitl.history.store import open_store  # noqa: PLC0415 - see above
    from mitl.history.trend import flicker_of, trends  # noqa: PLC0415 - see above

    with open_store(store) as opened:
        found = trends(opened.checks(), opened.run(name))
    for trend in found:
        if case is not None and not (trend.case_id == case or trend.case_id.startswith(f"{case}/")):
            continue
        row = " ".join(f"{value:.3g}" for value in trend.values[-8:])
        click.echo(f"{trend.last.outcome.value:<12}  {trend.case_id}: {trend.name}: {row} (limit {trend.last.limit:g} {trend.last.unit})")
        if trend.bad_since is not None:
            click.echo(
                f"              not passing since {trend.bad_since.started[:19]} (run {trend.bad_since.id}), {trend.bad_runs} in a row"
            )
        flicker = flicker_of(trend)
        if flicker is not None:
            click.echo(f"              flickers: {why(flicker)}")


@history_command.command("page", epilog="Example: mitl history page --html trend.html")
@click.option("--html", required=True, type=click.Path(dir_okay=False, path_type=Path), metavar="OUT", help="The page to write.")
@click.option("--run", "name", default="last", show_default=True, metavar="ID", help="The run whose like are shown.")
@click.pass_obj
def page_command(store: Path, html: Path, name: str) -> None:
    """Writes the trend page: every check over the runs with its limit, what flickers and why, and the drift of the rig's calibration."""
    from mitl.history.page import trend_page  # noqa: PLC0415 - see above
    from mitl.history.store import open_store  # noqa: PLC0415 - see above
    from mitl.report.replay import write_page  # noqa: PLC0415 - see above

    with open_store(store) as opened:
        write_page(html, trend_page(opened, opened.run(name)))
    click.echo(html)


@history_command.command("forget", epilog="Example: mitl history forget 3f2a91c0de")
@click.argument("name", metavar="ID")
@click.pass_obj
def forget_command(store: Path, name: str) -> None:
    """Takes a run out of the history."""
    from mitl.history.store import open_store  # noqa: PLC0415 - see above

    with open_store(store) as opened:
        run = opened.run(name)
        opened.remove(run.id)
    click.echo(f"{run.id} is forgotten")
