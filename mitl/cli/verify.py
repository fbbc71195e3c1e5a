"""`mitl verify`: runs mitl's own test cases through pytest, whatever folder, pytest.ini or conftest.py the user stands in."""

from __future__ import annotations

import io
import json
import os
import signal
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, redirect_stderr
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mitl.cli.duration import duration
from mitl.cli.store_option import store_option
from mitl.errors import MitlError, UsageError

if TYPE_CHECKING:
    from types import FrameType

    import pytest
    from rich.progress import Progress, TaskID

    from mitl.engine.case import CaseInfo
    from mitl.engine.record import RunRecord
    from mitl.protocols import Rig


@click.command("verify", short_help="Run test cases on a rig and judge them.", epilog="Example: mitl verify atc-1 --seed 7 --out run-7")
@click.argument("cases", nargs=-1, metavar="[CASE]...")
@click.option("--rig", default="sim", show_default=True, metavar="sim|FILE.toml", help="The simulated rig, or a rig file.")
@click.option(
    "--seed",
    default=1,
    show_default=True,
    type=click.IntRange(min=0),
    metavar="N",
    help="Seed of the simulated rig: same seed, same numbers.",
)
@click.option("--fault", "faults", multiple=True, metavar="NAME[=SIZE]", help="Break the simulated controller on purpose (mitl faults).")
@click.option(
    "--out",
    default="mitl-run",
    show_default=True,
    type=click.Path(file_okay=False, path_type=Path),
    metavar="DIR",
    help="Folder of the run: report.html, results.json, junit.xml and a recording a case. An earlier run in it is replaced.",
)
@click.option(
    "--tests",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    metavar="FOLDER",
    help="Cases of your own (test_*.py, and a conftest.py if there is one) instead of mitl's.",
)
@click.option(
    "--repeats",
    default=3,
    show_default=True,
    type=click.IntRange(1, 10),
    metavar="N",
    help="Run an inconclusive case at most N times: a sequential test, 5 % wrong verdicts at the limit over all rounds.",
)
@click.option("--long", "long", is_flag=True, help="Also run the cases that take hours of the rig's time (seconds in simulation).")
@click.option(
    "--budget",
    callback=duration,
    metavar="TIME",
    help="Choose and order the cases that find most in so much of the rig's time, such as 45min or 8h, and say what was left out.",
)
@store_option("For --budget: the history that tells how long cases took and which failed.")
@click.option(
    "--power",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    metavar="FILE",
    help="For --budget: campaign.json of mitl campaign, which tells what the cases find; what they say of themselves without it.",
)
@click.option("--resume", is_flag=True, help="Go on with the run in --out: what was judged there stays, the rest is run.")
@click.option(
    "--health",
    type=click.Choice(("refuse", "mark", "ignore")),
    help="What becomes of the run where the rig file asks for a good health check and there is none; the rig file says it by default.",
)
@click.option("--arm", is_flag=True, help="Let a physical rig move. Needs a terminal, unless the rig file allows unattended runs.")
@click.option("--list", "only_list", is_flag=True, help="List the cases and run none.")
@click.option(
    "--format",
    "form",
    type=click.Choice(("text", "json", "markdown")),
    default="text",
    show_default=True,
    help="Form of the output; markdown is for --list.",
)
@click.pass_context
def verify_command(
    context: click.Context,
    cases: tuple[str, ...],
    rig: str,
    seed: int,
    faults: tuple[str, ...],
    out: Path,
    tests: Path | None,
    budget: float | None,
    store: Path,
    power: Path | None,
    resume: bool,
    health: str | None,
    arm: bool,
    repeats: int,
    long: bool,
    only_list: bool,
    form: str,
) -> None:
    """Runs test cases on a rig, judges the recordings and keeps the run in a folder.

    CASE is the id of a case or the beginning of several: atc-1/linear, atc-0. Without CASE all are run.

    Exit code: 0 all passed, 1 something failed, 2 usage, 3 nothing failed but something is inconclusive, 4 it could not be judged.
    """
    from mitl.cli import verify_output  # noqa: PLC0415 - heavy imports only when the command runs
    from mitl.cli.verify_night import planned_night  # noqa: PLC0415 - see above
    from mitl.engine.results import FILE_NAME, read_run, text_of  # noqa: PLC0415 - see above
    from mitl.night.kept import as_json, in_words, write_night  # noqa: PLC0415 - see above

    if form == "markdown" and not only_list:
        raise UsageError("--format markdown lists the cases: give --list too")
    options = [
        f"--mitl-rig={rig}",
        f"--mitl-seed={seed}",
        f"--mitl-repeats={repeats}",
        *(["--mitl-resume", f"--mitl-out={out}"] if resume else []),
        *([f"--mitl-health={health}"] if health else []),
        *(["--mitl-long"] if long or only_list else []),
        *(f"--mitl-fault={fault}" for fault in faults),
    ]
    asked = [f"--mitl-case={case}" for case in cases]
    night = None
    if budget is not None:
        night = planned_night(found_cases(tests, [*options, *asked, "--mitl-long"]), budget, rig=rig, store=store, power=power)
        if form == "json" and only_list:
            click.echo(json.dumps(as_json(night), indent=2))
        else:
            click.echo(in_words(night), err=not only_list)
        if not night.chosen:
            raise UsageError("--budget: no case fits into the time")
        asked = ["--mitl-in-order", *(f"--mitl-case={offer.case}" for offer in night.chosen)]
    if only_list:
        if night is None:
            click.echo(verify_output.listed(found_cases(tests, [*options, *asked]), form))
        return
    observer = Observer(progress=sys.stderr.isatty(), arm=arm)
    try:
        run_pytest(tests, [*options, *asked, f"--mitl-out={out}"], observer, done=resume and (out / FILE_NAME).is_file())
    finally:
        if night is not None and observer.run is not None:  # the run has got as far as its folder
            write_night(out, night)
    run = observer.run or read_run(out)
    if observer.unwritten:
        click.echo(f"mitl: warning: {observer.unwritten}", err=True)
    click.echo(text_of(run), nl=False) if form == "json" else verify_output.print_table(run)
    if (out / "report.html").is_file():
        click.echo(f"report: {out / 'report.html'}", err=True)
    else:
        click.echo(f"the report could not be made; the run is kept, try: mitl report {out}", err=True)
    context.exit(exit_code(run))


def found_cases(tests: Path | None = None, options: Sequence[str] = ("--mitl-long",)) -> list[CaseInfo]:
    """Gives the cases in a folder, or mitl's own, as the plug-in's options choose them."""
    observer = Observer(progress=False)
    run_pytest(tests, [*options, "--collect-only"], observer)
    return observer.found


def exit_code(run: RunRecord) -> int:
    """Gives the exit code of a run (CONTRACT.md)."""
    return {"pass": 0, "skipped": 0, "fail": 1, "inconclusive": 3, "error": 4}[run.outcome.value]


class Observer:
    """Pytest plug-in of one run: remembers what was collected and shows progress on standard error."""

    def __init__(self, *, progress: bool, arm: bool = False) -> None:
        self._arm = arm
        self.found: list[CaseInfo] = []
        self.broken: list[str] = []
        self.run: RunRecord | None = None
        self.unwritten = ""
        self._progress: Progress | None = _progress_bar() if progress else None
        self._task: TaskID | None = None

    def pytest_mitl_load_rig(self, name: str, seed: int, faults: tuple[str, ...]) -> Rig | None:
        """Gives an armed physical rig where --arm asks for it, otherwise leaves the rig to others."""
        if not self._arm:
            return None
        from mitl.rig.physical import load_physical, may_arm  # noqa: PLC0415 - see above
        from mitl.rig.physical_config import is_physical  # noqa: PLC0415 - see above

        if not is_physical(name):
            raise UsageError(f"--arm lets a physical rig move; {name} is none: leave it out")
        may_arm(Path(name))
        return load_physical(Path(name), seed, faults, armed=True)

    def pytest_mitl_run_finished(self, run: RunRecord, unwritten: str) -> None:
        """Takes the record from memory: the disk may be full."""
        self.run, self.unwritten = run, unwritten

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """Remembers test files that cannot be read."""
        if report.failed:
            self.broken.append(f"{report.nodeid}: {report.longreprtext.strip().splitlines()[-1]}")

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        """Takes the cases that will run."""
        from mitl.engine.case import case_of  # noqa: PLC0415 - see above

        self.found = [info for item in session.items if (info := case_of(item)) is not None]
        if self._progress is not None and not session.config.option.collectonly:
            self._task = self._progress.add_task("preparing", total=len(self.found))
            self._progress.start()

    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        """Shows the case that runs."""
        from mitl.engine.case import case_of  # noqa: PLC0415 - see above

        info = case_of(item)
        if self._progress is not None and self._task is not None and info is not None:
            self._progress.update(self._task, description=info.id)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Moves the bar on when a case is done."""
        if self._progress is not None and self._task is not None and report.when == "teardown":
            self._progress.advance(self._task)

    def pytest_unconfigure(self) -> None:
        """Ends the bar."""
        if self._progress is not None:
            self._progress.stop()


def _progress_bar() -> Progress:
    """Gives a bar on a copy of standard error, because pytest captures the original while a case runs."""
    from rich.console import Console  # noqa: PLC0415 - see above
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn  # noqa: PLC0415 - see above

    stream = os.fdopen(os.dup(sys.stderr.fileno()), "w", encoding="utf-8")
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    return Progress(
        *columns, console=Console(file=stream, force_terminal=True), transient=True, redirect_stdout=False, redirect_stderr=False
    )


def run_pytest(tests: Path | None, options: list[str], observer: Observer, *, done: bool = False) -> None:
    """Runs the cases in the folder `tests`, or else mitl's own, in this process. done: whether it may be that none is left to run.

    Raises UsageError where options are wrong or there is nothing to run, MitlError where cases cannot be read or pytest breaks down.
    """
    import pytest  # noqa: PLC0415 - see above

    if tests is None:
        from mitl import atc  # noqa: PLC0415 - see above

        folder, conftest = Path(atc.__file__).resolve().parent, "--noconftest"
    else:
        folder = tests.resolve()
        conftest = f"--confcutdir={folder}"
    own = ["-c", os.devnull, f"--rootdir={folder}", conftest, "--import-mode=importlib", "-p", "mitl.pytest_plugin"]
    quiet = ["-p", "no:cacheprovider", "-p", "no:terminal"]
    told = io.StringIO()
    with _own_environment(), _terminate_as_interrupt(), redirect_stderr(told):
        code = pytest.main([str(folder), *own, *quiet, *options], plugins=[observer])
    if code is pytest.ExitCode.USAGE_ERROR:
        raise UsageError(told.getvalue().removeprefix("ERROR: ").strip())
    click.echo(told.getvalue(), err=True, nl=False)
    if observer.broken:
        raise MitlError("cases cannot be read: " + "; ".join(observer.broken))
    if code is pytest.ExitCode.NO_TESTS_COLLECTED and not done:
        raise UsageError(f"there are no cases in {folder}")
    if code is pytest.ExitCode.INTERNAL_ERROR:
        raise MitlError(f"pytest broke down; run pytest {folder} --mitl-rig=... to see where")


@contextmanager
def _own_environment() -> Iterator[None]:
    """Hides what would bring the user's own pytest options and plug-ins into this run."""
    hidden = {name: os.environ.pop(name, None) for name in ("PYTEST_ADDOPTS", "PYTEST_PLUGINS", "PYTEST_DISABLE_PLUGIN_AUTOLOAD")}
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    try:
        yield
    finally:
        del os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"]
        os.environ.update({name: value for name, value in hidden.items() if value is not None})


@contextmanager
def _terminate_as_interrupt() -> Iterator[None]:
    """Lets SIGTERM end a run as Ctrl-C does, so that the robot is stopped and the record kept."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def interrupt(_number: int, _frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
