"""`mitl judge`: judges an old run again, without its rig."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mitl.errors import UsageError

if TYPE_CHECKING:
    from mitl.engine.calibration_session import SessionCalibration


@click.command(
    "judge",
    short_help="Judge an old run again, without the rig.",
    epilog="Example: mitl judge mitl-run --calibration better.toml --out judged-again",
)
@click.argument("run", type=click.Path(exists=True, file_okay=False, path_type=Path), metavar="RUN")
@click.argument("cases", nargs=-1, metavar="[CASE]...")
@click.option(
    "--out",
    default="mitl-judged",
    show_default=True,
    type=click.Path(file_okay=False, path_type=Path),
    metavar="DIR",
    help="Where the new results go; not RUN itself.",
)
@click.option("--tests", type=click.Path(exists=True, file_okay=False, path_type=Path), metavar="FOLDER", help="Cases of your own, as run.")
@click.option(
    "--calibration",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    metavar="FILE.toml",
    help="Another calibration (mitl calibrate) instead of the recorded one.",
)
@click.option("--recalibrate", is_flag=True, help="Solve the calibration again from its recorded poses.")
@click.option(
    "--rig", metavar="sim|FILE.toml", help="The rig whose robot and conveyors the oracles are computed for; the run's own by default."
)
@click.option("--robot", metavar="NAME", help="Another robot model for the oracles, e.g. after it was corrected.")
@click.option("--format", "form", type=click.Choice(("text", "json")), default="text", show_default=True, help="Form of the output.")
@click.pass_context
def judge_command(
    context: click.Context,
    run: Path,
    cases: tuple[str, ...],
    out: Path,
    tests: Path | None,
    calibration: Path | None,
    recalibrate: bool,
    rig: str | None,
    robot: str | None,
    form: str,
) -> None:
    """Runs the cases' checks again on what the rig told them in RUN: after a limit, the calibration, the oracle or the robot model changed.

    Nothing moves and no rig is needed. The cases are those of today's code, the oracles are computed by today's planner; without a change
    the numbers are the same. DIR gets a run whose results.json names RUN in `judged_from`.

    Exit code: that of mitl verify.
    """
    from mitl.cli import verify_output  # noqa: PLC0415 - heavy imports only when the command runs
    from mitl.cli.verify import Observer, exit_code, run_pytest  # noqa: PLC0415 - see above
    from mitl.engine.results import read_run, text_of  # noqa: PLC0415 - see above
    from mitl.rig.judged import oracles_for, recorded_rig  # noqa: PLC0415 - see above

    if out.resolve() == run.resolve():
        raise UsageError(f"--out {out} is the run that is judged: the new record must not replace the old one")
    if calibration is not None and recalibrate:
        raise UsageError("--calibration and --recalibrate exclude each other")
    recorded = recorded_rig(run)
    facts = recorded.first_tape().facts
    oracles, model = oracles_for(recorded.run, rig, robot)
    played = recorded.rig(oracles, facts, model)

    class Judging(Observer):
        """Gives pytest the recorded rig and the calibration to judge by."""

        def pytest_mitl_load_rig(self, name: str, seed: int, faults: tuple[str, ...]) -> object:  # type: ignore[override]
            """Gives the recorded rig, whatever it is called."""
            del name, seed, faults
            return played

        def pytest_mitl_calibration(self, case_id: str) -> SessionCalibration:
            """Gives the calibration for a case."""
            return _calibration(case_id)

    def _calibration(case_id: str) -> SessionCalibration:
        from mitl.calibration.choice import choose_distortion  # noqa: PLC0415 - see above
        from mitl.calibration.solve import calibrate  # noqa: PLC0415 - see above
        from mitl.calibration.store import load_calibration_and_reference  # noqa: PLC0415 - see above
        from mitl.engine.replaying import session_of  # noqa: PLC0415 - see above

        session = session_of(recorded.tape_of(case_id), case_id)
        if calibration is not None:
            return replace(session, calibration=load_calibration_and_reference(calibration)[0])
        if recalibrate:
            if not len(session.poses):
                raise UsageError(f"{run}: the calibration was a stored one, whose poses the recording does not have")
            distortion = choose_distortion(session.poses)
            return replace(session, calibration=calibrate(session.poses, distortion=distortion, provenance=session.calibration.provenance))
        return session

    wanted = cases or tuple(case.id for case in recorded.run.cases if case.recording is not None)
    options = [
        f"--mitl-rig={recorded.run.rig}",
        f"--mitl-seed={recorded.run.seed}",
        f"--mitl-repeats={facts['repeats']}",
        "--mitl-long",
        f"--mitl-judged-from={run.resolve().name} of {recorded.run.started}",
        *(f"--mitl-fault={fault}" for fault in recorded.run.faults),
        *(f"--mitl-case={case}" for case in wanted),
        f"--mitl-out={out}",
    ]
    observer = Judging(progress=sys.stderr.isatty())
    run_pytest(tests, options, observer)
    judged = observer.run or read_run(out)
    click.echo(text_of(judged), nl=False) if form == "json" else verify_output.print_table(judged)
    click.echo(f"report: {out / 'report.html'}; what changed: mitl diff {run} {out}", err=True)
    context.exit(exit_code(judged))
