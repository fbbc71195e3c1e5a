"""`mitl rig dry-run`: rehearses a run on a physical rig: everything but motion."""

from __future__ import annotations

import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mitl.cli.doctor import tell
from mitl.cli.verify import Observer, run_pytest
from mitl.errors import UsageError

if TYPE_CHECKING:
    from mitl.protocols import Rig
    from mitl.rig.order_spy import OrderSpy, Told


@click.group(
    "rig",
    short_help="Rehearse a run on a physical rig: everything but motion.",
    epilog="Example: mitl rig dry-run --rig cell.toml atc-1/linear",
)
def rig_command() -> None:
    """What is done with a physical rig besides `mitl verify` and `mitl doctor`."""


@rig_command.command("dry-run", epilog="Example: mitl rig dry-run --rig cell.toml atc-0 atc-1/linear")
@click.argument("cases", nargs=-1, metavar="[CASE]...")
@click.option(
    "--rig", required=True, metavar="FILE.toml", type=click.Path(exists=True, dir_okay=False, path_type=Path), help="The rig file."
)
@click.option(
    "--out", default=".", show_default=True, type=click.Path(file_okay=False, path_type=Path), help="Folder that the run will be kept in."
)
@click.option("--seconds", default=2.0, show_default=True, type=click.FloatRange(0.5, 60.0), help="How long the tracker is watched.")
@click.option("--format", "form", type=click.Choice(("text", "json")), default="text", show_default=True, help="Form of the output.")
@click.pass_context
def dry_run_command(context: click.Context, cases: tuple[str, ...], rig: Path, out: Path, seconds: float, form: str) -> None:
    """Does all that a run of the cases would do to the rig, but starts nothing: checks it as `mitl doctor` does, loads every program on the
    controller, compares tools and work objects, and pre-flies every order from where the robot stands. The controller's own program comes
    back at the end.

    What the cases order is learnt by running them on the simulated rig first. Exit code: 0 fit, 4 something would keep it from a run.
    """
    from mitl.rig.dry_run import dry_run  # noqa: PLC0415 - heavy imports only when the command runs
    from mitl.rig.physical_config import is_physical, read_physical  # noqa: PLC0415 - see above

    if not is_physical(str(rig)):
        raise UsageError(f'{rig}: expected a rig file of kind = "physical"; on a simulated rig nothing needs a rehearsal')
    config = read_physical(rig)
    told = _told(cases, config.robot)
    context.exit(tell(dry_run(config, told, out, seconds), form))


def _told(cases: tuple[str, ...], robot: str) -> list[Told]:
    """Gives what a run of the cases tells a controller, from a run on the simulated rig."""
    with tempfile.TemporaryDirectory(prefix="mitl-rehearsal-") as folder:
        file = Path(folder) / "rehearsal.toml"
        file.write_text(f'[rig]\nkind = "simulation"\nrobot = "{robot}"\n', encoding="utf-8")
        observer = _Spying(progress=sys.stderr.isatty())
        run_pytest(None, [f"--mitl-rig={file}", *(f"--mitl-case={case}" for case in cases)], observer)
    return observer.spy.told if observer.spy is not None else []


class _Spying(Observer):
    """Gives the run a simulated rig whose controller is overheard."""

    spy: OrderSpy | None = None

    def pytest_mitl_load_rig(self, name: str, seed: int, faults: tuple[str, ...]) -> Rig | None:
        """Gives the rig."""
        from mitl.rig import load_rig  # noqa: PLC0415 - see above
        from mitl.rig.order_spy import OrderSpy  # noqa: PLC0415 - see above

        rig = load_rig(name, seed, faults)
        self.spy = OrderSpy(rig.controller)
        return replace(rig, controller=self.spy)
