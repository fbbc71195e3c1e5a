"""`mitl oracle bless`: the only writer of the stored oracles. It shows first what would change.

Invariant: nothing is written without a reason and a yes.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:  # heavy imports only when the command runs
    from collections.abc import Mapping, Sequence

    from mitl.cli.progress import Progress
    from mitl.motion.oracles import PlannedOracles
    from mitl.paths import PosePath
    from mitl.protocols import Oracle
    from mitl.recording.oracle_store import Entry, Kind

_CLOSED_FORM = {"atc_1.mod": ("1.1", "1.2", "2.1", "2.2")}
"""Orders whose path is known in closed form: lines and circles alone, after a first move to their start."""
_SEEN = 1e-5
_SEEN_TIME = 1e-4
"""m and s from which on a change is shown: rounding on another processor is far below."""


@dataclass(frozen=True, eq=False)
class _Made:
    """What would be stored in one file, and the program's hash."""

    file: str
    program: Path
    sha256: str
    kind: Kind
    source: str
    paths: Mapping[str, PosePath]


@click.command("oracle bless", epilog='Example:  mitl oracle bless --reason "corner zones after the new fit of the IRB 140"')
@click.option("--reason", required=True, help="Why what changed is right; kept in the index.")
@click.option("--robot", default="irb140", show_default=True, help="Robot model.")
@click.option("--cell", default="line", show_default=True, metavar="NAME|FOLDER", help="The cell with the conveyors.")
@click.option(
    "--programs",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    metavar="FOLDER",
    help="RAPID programs that loop around TEST option, instead of those of mitl's cases.",
)
@click.option(
    "--store", type=click.Path(file_okay=False, path_type=Path), metavar="FOLDER", help="Where they are stored, instead of oracles/."
)
@click.option("--yes", is_flag=True, help="Write without being asked again.")
def bless_command(reason: str, robot: str, cell: str, programs: Path | None, store: Path | None, yes: bool) -> None:
    """Store the oracles of all test programs, after showing how they differ from the stored ones.

    A stored oracle is what later versions are compared with: bless it only where you know why it changed.
    """
    from mitl.cli.progress import Progress  # noqa: PLC0415 - see above
    from mitl.errors import UsageError  # noqa: PLC0415 - see above
    from mitl.recording.oracle_store import Entry, read_index, remove_oracles, write_oracles  # noqa: PLC0415 - see above
    from mitl.resources import oracles_folder  # noqa: PLC0415 - see above

    if not reason.strip():
        raise UsageError("--reason must say why the oracles are right")
    folder = store or oracles_folder()
    folder.mkdir(parents=True, exist_ok=True)
    with Progress("computing oracles") as progress:
        made = _all(robot, cell, programs or _own_programs(), progress)
    known = {entry.file: entry for entry in read_index(folder)}
    changed = [one for one in made if _shows(folder, known.get(one.file), one)]
    gone = [entry for file, entry in known.items() if file not in {one.file for one in made}]
    for entry in gone:
        click.echo(f"{entry.file}: no program of this name any more: will be taken out")
    if not changed and not gone:
        click.echo("nothing changed: nothing to bless")
        return
    if not yes and not click.confirm(f"Store {len(changed)} files in {folder}?", err=True):
        click.echo("nothing was written", err=True)
        return
    for one in changed:
        entry = Entry(one.file, one.program.name, one.sha256, robot, one.kind, one.source, reason.strip(), _today(), "", ())
        write_oracles(folder, entry, one.paths)
    for entry in gone:
        remove_oracles(folder, entry)
    click.echo(f"{len(changed)} files stored, {len(gone)} taken out")


def planned_orders(source: PlannedOracles, program: Path) -> dict[str, Oracle]:
    """Gives the oracle of every order of a program that can be moved, by order."""
    from mitl.errors import MotionError  # noqa: PLC0415 - see above
    from mitl.motion.orders import orders_of  # noqa: PLC0415 - see above

    found: dict[str, Oracle] = {}
    for order in orders_of(program):
        try:
            found[str(order)] = source.oracle([program], {"option": str(order.option), "subOption": str(order.sub_option)})
        except MotionError as error:  # an order that a controller must refuse has no path
            click.echo(f"{program.name} {order}: no oracle: {error}", err=True)
    return found


def _all(robot: str, cell: str, programs: Path, progress: Progress) -> list[_Made]:
    from mitl import __version__  # noqa: PLC0415 - see above
    from mitl.motion.oracles import PlannedOracles  # noqa: PLC0415 - see above
    from mitl.motion.robot_model import load_robot_model  # noqa: PLC0415 - see above
    from mitl.recording.oracle_store import Kind, sha256_of, thinned  # noqa: PLC0415 - see above
    from mitl.simulation.cell import load_cell  # noqa: PLC0415 - see above

    model = load_robot_model(robot)
    source = PlannedOracles(model, load_cell(cell).conveyors)
    settings = sha256_of(model.folder / "motion.toml")[:12]
    made: list[_Made] = []
    for program in sorted(programs.glob("*.mod")):
        progress.at(program.name)
        oracles = planned_orders(source, program)
        if not oracles:
            continue
        sha256 = sha256_of(program)
        paths = {order: thinned(oracle.tcp) for order, oracle in oracles.items()}
        planner = f"mitl {__version__}, models/{robot}/motion.toml {settings}"
        made.append(_Made(f"{program.stem}.mcap", program, sha256, Kind.REGRESSION, planner, paths))
        exact = {order: programmed_lines(oracles[order]) for order in _CLOSED_FORM.get(program.name, ()) if order in oracles}
        if exact:
            text = "closed form: lines and circles through the programmed points"
            made.append(_Made(f"{program.stem}.closed-form.mcap", program, sha256, Kind.INDEPENDENT, text, exact))
    return made


def programmed_lines(oracle: Oracle) -> PosePath:
    """Gives the closed form of an oracle's lines and circles between its first move, to their start, and its last, back home."""
    from mitl.metrics.programmed import programmed_path  # noqa: PLC0415 - see above

    return programmed_path([move for move in oracle.moves if move.kind in ("MoveL", "MoveC")])


def _shows(folder: Path, entry: Entry | None, made: _Made) -> bool:
    """Prints how a file differs from the stored one; gives whether it does."""
    from mitl.errors import UsageError  # noqa: PLC0415 - see above
    from mitl.recording.oracle_store import difference, read_oracles  # noqa: PLC0415 - see above

    if entry is None:
        click.echo(f"{made.file}: new, {len(made.paths)} orders")
        return True
    try:
        stored = read_oracles(folder, entry)
    except UsageError as error:
        click.echo(f"{error}: will be written anew")
        return True
    lines: list[str] = []
    for order, path in made.paths.items():
        if order not in stored:
            lines.append(f"  {order}: new")
            continue
        found = difference(stored[order], path)
        if found.distance > _SEEN or abs(found.longer) > _SEEN_TIME:
            lines.append(f"  {order}: up to {1e3 * found.distance:.3f} mm away at the same time, {1e3 * found.longer:+.1f} ms longer")
    lines += [f"  {order}: gone" for order in _missing(stored, made.paths)]
    if entry.program_sha256 != made.sha256 and not lines:
        lines.append("  the program's text changed, its paths did not")
    if lines:
        click.echo("\n".join([f"{made.file}: changed", *lines]))
    return bool(lines)


def _missing(stored: Mapping[str, PosePath], made: Mapping[str, PosePath]) -> Sequence[str]:
    return [order for order in stored if order not in made]


def _own_programs() -> Path:
    from mitl import atc  # noqa: PLC0415 - see above

    return Path(atc.__file__).resolve().parent


def _today() -> str:
    from datetime import UTC, datetime  # noqa: PLC0415 - see above

    return datetime.now(UTC).date().isoformat()
