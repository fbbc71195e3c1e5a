"""`mitl health`: whether robot and tracker are what they were, by a few cases of their own and a stored baseline."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mitl.errors import UsageError

if TYPE_CHECKING:
    from mitl.engine.health import HealthRecord


@click.command(
    "health",
    short_help="Check in ten minutes whether robot and tracker are what they were.",
    epilog="Example: mitl health --rig cell.toml --arm",
)
@click.option("--rig", default="sim", show_default=True, metavar="sim|FILE.toml", help="The simulated rig, or a rig file.")
@click.option(
    "--baseline",
    type=click.Path(dir_okay=False, path_type=Path),
    metavar="FILE",
    help="Health record of when the rig was well; [health] baseline of the rig file by default.",
)
@click.option("--set-baseline", is_flag=True, help="Write what is found now to the baseline, if all of it is within its own limits.")
@click.option("--reason", default="", metavar="TEXT", help="Why the rig is known to be well now, or why the old baseline no longer holds.")
@click.option(
    "--record",
    type=click.Path(dir_okay=False, path_type=Path),
    metavar="FILE",
    help="Where the result is kept; [health] record of the rig file by default, or else health.json in --out.",
)
@click.option("--seed", default=1, show_default=True, type=click.IntRange(min=0), metavar="N", help="Seed of the simulated rig.")
@click.option("--fault", "faults", multiple=True, metavar="NAME[=SIZE]", help="Break the simulated controller on purpose (mitl faults).")
@click.option(
    "--out",
    default="mitl-health",
    show_default=True,
    type=click.Path(file_okay=False, path_type=Path),
    metavar="DIR",
    help="Folder of the run: report.html, results.json and a recording a case. An earlier run in it is replaced.",
)
@click.option("--arm", is_flag=True, help="Let a physical rig move. Needs a terminal, unless the rig file allows unattended runs.")
@click.option("--format", "form", type=click.Choice(("text", "json")), default="text", show_default=True, help="Form of the output.")
@click.pass_context
def health_command(
    context: click.Context,
    rig: str,
    baseline: Path | None,
    set_baseline: bool,
    reason: str,
    record: Path | None,
    seed: int,
    faults: tuple[str, ...],
    out: Path,
    arm: bool,
    form: str,
) -> None:
    """Measures jitter, glitches and valid samples of the tracker, repeatability, the calibration, drift, a line's speed and reaction time.

    Every figure is judged by a limit of its own, and by how much worse it is than in the baseline. The result is kept; a rig file with a
    section [health] lets mitl verify refuse, or mark, runs on a rig whose latest result is bad, missing or too old.

    Exit code: that of mitl verify. 0 the rig is well, 1 it is not, 2 usage, 3 it cannot be told, 4 it could not be measured.
    """
    from mitl import health as cases  # noqa: PLC0415 - heavy imports only when the command runs
    from mitl.cli import verify_output  # noqa: PLC0415 - see above
    from mitl.cli.verify import Observer, exit_code, run_pytest  # noqa: PLC0415 - see above
    from mitl.engine.health import health_of, other_rig, read_health, write_health  # noqa: PLC0415 - see above
    from mitl.engine.results import read_run  # noqa: PLC0415 - see above
    from mitl.outcome import Outcome  # noqa: PLC0415 - see above
    from mitl.rig.health_section import gate_of  # noqa: PLC0415 - see above

    gate = gate_of(rig)
    baseline = baseline or (gate.baseline if gate else None)
    record = record or (gate.record if gate else out / "health.json")
    if set_baseline and (baseline is None or not reason.strip()):
        raise UsageError("--set-baseline needs a --reason, and a --baseline FILE where the rig file names none in [health]")
    if reason and not set_baseline:
        raise UsageError("--reason says why a baseline is set: give --set-baseline too")
    if set_baseline and faults:
        raise UsageError("a rig that is broken on purpose (--fault) gives no baseline")
    then: HealthRecord | None = None
    if baseline is not None and (baseline.is_file() or not set_baseline):
        then = read_health(baseline)
    called = Path(rig).stem if Path(rig).is_file() else rig
    if then is not None and then.rig != called and not set_baseline:
        raise UsageError(f"the baseline {baseline} is of another rig: {then.rig!r}, now {called!r}; set one of this rig: --set-baseline")
    options = [
        f"--mitl-rig={rig}",
        f"--mitl-seed={seed}",
        "--mitl-health=ignore",
        f"--mitl-out={out}",
        *(f"--mitl-fault={fault}" for fault in faults),
        *([f"--mitl-baseline={baseline}"] if then is not None and not set_baseline else []),
    ]
    observer = Observer(progress=sys.stderr.isatty(), arm=arm)
    run_pytest(Path(cases.__file__).resolve().parent, options, observer)
    run = observer.run or read_run(out)
    found = health_of(run, baseline=None if set_baseline else then, reason=reason)
    if form == "json":
        from mitl.engine.health import text_of  # noqa: PLC0415 - see above

        click.echo(text_of(found), nl=False)
    else:
        verify_output.print_table(run)
        _print_figures(found, then)
    if then is not None and (different := other_rig(found, then)):
        if not set_baseline:
            raise UsageError(f"the baseline {baseline} is of another rig: {different}; set one of this rig: --set-baseline")
        click.echo(f"the old baseline is of another rig: {different}", err=True)
    write_health(record, found)
    click.echo(f"kept: {record}; report: {out / 'report.html'}", err=True)
    if then is None and not set_baseline:
        click.echo("there is no baseline: every figure was judged by its own limit alone; see --set-baseline", err=True)
    if set_baseline and baseline is not None:
        if run.outcome is Outcome.PASS:
            write_health(baseline, found)
            click.echo(f"new baseline: {baseline}", err=True)
        else:
            click.echo(f"no new baseline: the rig is not known to be well ({run.outcome.value})", err=True)
    context.exit(exit_code(run))


def _print_figures(found: HealthRecord, then: HealthRecord | None) -> None:
    """Prints the figures, with those of the baseline beside them."""
    from mitl.engine.health import CHANGE  # noqa: PLC0415 - see above

    width = max((len(figure.name) for figure in found.figures), default=0)
    for figure in found.figures:
        old = then.figure(figure.name) if then is not None and not figure.name.endswith(CHANGE) else None
        before = f", was {old.value:.4g}" if old is not None and old.value is not None else ""
        value = "no number" if figure.value is None else f"{figure.value:.4g}"
        spread = "?" if figure.uncertainty is None else f"{figure.uncertainty:.2g}"
        click.echo(f"{figure.name:<{width}}  {value} +- {spread} {figure.unit}, limit {figure.limit:.4g}{before}: {figure.outcome.value}")
