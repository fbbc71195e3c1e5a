"""`mitl campaign`: many seeded runs, sound and broken, and what the cases find."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mitl.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mitl.engine.case import CaseInfo


@click.command("campaign", epilog="Example:  mitl campaign --cases atc-1 --faults target-offset=2,5,10 --seeds 20 --out power")
@click.option("--cases", multiple=True, metavar="CASE", help="Cases, or the beginnings of several; all by default. May be given again.")
@click.option(
    "--faults",
    multiple=True,
    metavar="NAME[=SIZE,...]",
    help="Faults with their sizes; all at their default sizes by default, none for only the sound controller. May be given again.",
)
@click.option("--seeds", default=10, show_default=True, type=click.IntRange(1), metavar="N", help="Seeds 1 to N.")
@click.option("--sound/--no-sound", default=True, show_default=True, help="Also run every case on the sound controller: its false alarms.")
@click.option("--until-found", is_flag=True, help="With a fault, run its cases from the quickest on and no more once one has failed.")
@click.option("--rig", default="sim", show_default=True, metavar="sim|FILE.toml", help="The simulated rig, or a rig file.")
@click.option("--workers", default=2, show_default=True, type=click.IntRange(1), metavar="N", help="Processes on this computer.")
@click.option("--scheduler", metavar="ADDRESS", help="A Dask scheduler, e.g. tcp://host:8786, instead of processes here.")
@click.option(
    "--out",
    default="mitl-campaign",
    show_default=True,
    type=click.Path(file_okay=False, path_type=Path),
    metavar="DIR",
    help="Where the results go; one that is there is gone on with.",
)
def campaign_command(
    cases: tuple[str, ...],
    faults: tuple[str, ...],
    seeds: int,
    sound: bool,
    until_found: bool,
    rig: str,
    workers: int,
    scheduler: str | None,
    out: Path,
) -> None:
    """Runs cases with many seeds on a sound and on broken controllers, and tells what they find and how often they cry wolf.

    DIR gets trials.jsonl, one line for every finished run: a campaign that was interrupted goes on where it was. Then campaign.csv,
    campaign.json, detection_power.md and detection_power.png, with 95 % bounds after Clopper and Pearson.
    """
    from mitl.campaign.execute import execute  # noqa: PLC0415 - heavy imports only when the command runs
    from mitl.campaign.plan import planned, quickest_first  # noqa: PLC0415
    from mitl.campaign.summary import detections, false_alarms, smallest_found  # noqa: PLC0415
    from mitl.campaign.tables import write_tables  # noqa: PLC0415
    from mitl.cli.verify import found_cases  # noqa: PLC0415
    from mitl.controllers.faults import KINDS  # noqa: PLC0415

    chosen = _chosen(found_cases(), cases)
    catches = {info.id: info.catches for info in chosen}
    sizes = _sizes(faults, {name: kind.size for name, kind in KINDS.items()})
    trials = planned(catches, sizes, rig=str(Path(rig).resolve()) if rig != "sim" else rig, seeds=range(1, seeds + 1), sound=sound)
    if until_found:
        trials = quickest_first(trials, {info.id: info.typical_s for info in chosen})
    if not trials:
        raise UsageError("there is nothing to run: none of these cases names one of these faults, and --no-sound was given")
    results = list(execute(trials, out, workers=workers, scheduler=scheduler, progress=_progress()).values())
    found, alarms = detections(results), false_alarms(results)
    paths = write_tables(out, found, alarms, {name: kind.unit for name, kind in KINDS.items()})
    for fault, size in smallest_found(found).items():
        told = "not found in 95 % of the runs at any of these sizes" if size is None else f"found from {size:g} {KINDS[fault].unit} on"
        click.echo(f"{fault}: {told}")
    for alarm in alarms:
        if alarm.rate.hits:
            click.echo(f"{alarm.case}: {alarm.rate.hits} false alarms in {alarm.rate.count} runs")
    if alarms:
        runs = alarms[0].rate.count
        click.echo(f"sound controller: {sum(alarm.rate.hits for alarm in alarms)} false alarms of {len(alarms)} cases in {runs} runs each")
    click.echo("written: " + ", ".join(str(path) for path in paths), err=True)


def _chosen(infos: Sequence[CaseInfo], wanted: tuple[str, ...]) -> list[CaseInfo]:
    from mitl.engine.selection import select  # noqa: PLC0415 - see above

    chosen = select(infos, wanted)
    return [info for info in infos if info.id in chosen]


def _sizes(asked: tuple[str, ...], defaults: dict[str, float]) -> dict[str, list[float]]:
    """Gives the sizes of each fault that was asked for. Raises UsageError for a name or size that is none."""
    from mitl.controllers.faults import parse_fault  # noqa: PLC0415 - see above

    if asked == ("none",):
        return {}
    if not asked:
        return {name: [size] for name, size in defaults.items()}
    sizes: dict[str, list[float]] = {}
    for text in asked:
        name, equals, given = text.partition("=")
        faults = [parse_fault(f"{name}={size}") for size in given.split(",")] if equals else [parse_fault(name)]
        sizes.setdefault(faults[0].kind.name, []).extend(fault.size for fault in faults)
    return sizes


def _progress() -> Callable[[int, int], None]:
    """Gives what tells the progress: a line that is written over on a terminal, every tenth of the way elsewhere."""
    told = -1

    def tell(done: int, total: int) -> None:
        nonlocal told
        if sys.stderr.isatty():
            click.echo(f"\r{done} of {total} runs", err=True, nl=done == total)
        elif 10 * done // max(total, 1) > told:
            told = 10 * done // max(total, 1)
            click.echo(f"{done} of {total} runs", err=True)

    return tell
