"""`mitl fit-motion`: an arm's motion parameters from controller logs. A thin wrapper over `motion.fit`.

Invariant: the model is written whole at the end; whoever interrupts the fit leaves nothing behind.
"""

from __future__ import annotations

from pathlib import Path

import click


@click.command(
    "fit-motion",
    short_help="Fit a robot's motion parameters to controller logs.",
    epilog="Example: mitl fit-motion run1.csv run2.csv --program moves.mod --robot irb140 --output my_irb140",
)
@click.argument("logs", nargs=-1, required=True, metavar="LOG...", type=click.Path(path_type=Path))
@click.option(
    "--program",
    "programs",
    multiple=True,
    required=True,
    type=click.Path(path_type=Path),
    help="The RAPID that ran; one for all logs, or one a log in their order.",
)
@click.option("--routine", default="main", show_default=True, help="Procedure that ran.")
@click.option("--robot", default="irb140", show_default=True, help="Robot model that the fit begins with.")
@click.option("--output", type=click.Path(file_okay=False, path_type=Path), metavar="FOLDER", help="Write the fitted model here.")
@click.option("--format", "form", type=click.Choice(("text", "json")), default="text", show_default=True, help="Form of the output.")
def fit_motion_command(
    logs: tuple[Path, ...], programs: tuple[Path, ...], routine: str, robot: str, output: Path | None, form: str
) -> None:
    """Fits filters, lag, accelerations and fine-point pause of an arm to logs of its axes, and tells what is left unexplained.

    A LOG is MCAP with /robot/egm or /robot/joints, or CSV with t_s and j1_deg to j6_deg, from before the program began to after its end.
    Every third move of a kind and speed is held out of the fit; its residuals become the bounds of the model's oracles. Use the model by
    --robot ./FOLDER. Takes about a minute for a minute of motion.
    """
    # heavy imports only when the command runs: `mitl --help` loads neither SciPy nor MCAP
    import json  # noqa: PLC0415 - see above

    import numpy as np  # noqa: PLC0415 - see above

    import rapid_interp  # noqa: PLC0415 - see above
    from mitl.cli.progress import Progress  # noqa: PLC0415 - see above
    from mitl.errors import UsageError  # noqa: PLC0415 - see above
    from mitl.motion.accuracy import load_accuracy  # noqa: PLC0415 - see above
    from mitl.motion.fit import JointLog, fit_motion  # noqa: PLC0415 - see above
    from mitl.motion.fit_residuals import fitted_accuracy, residual_bands  # noqa: PLC0415 - see above
    from mitl.motion.model_files import write_model  # noqa: PLC0415 - see above
    from mitl.motion.robot_model import load_robot_model  # noqa: PLC0415 - see above
    from mitl.recording.joint_log import read_joint_log  # noqa: PLC0415 - see above

    if len(programs) not in (1, len(logs)):
        raise UsageError(f"--program: expected one for all logs or one a log, got {len(programs)} for {len(logs)} logs")
    base = load_robot_model(robot)
    loaded = [rapid_interp.load([program]) for program in programs]
    with Progress("fit-motion") as progress:
        progress.at("reading")
        read = [
            JointLog(file.name, *read_joint_log(file), loaded[min(number, len(loaded) - 1)], routine) for number, file in enumerate(logs)
        ]
        fit = fit_motion(read, base, progress.at)
        bands = residual_bands(fit, read)
        if output is not None:
            source = f"mitl fit-motion, {', '.join(file.name for file in logs)}; residuals of held-out moves"
            write_model(output, base, fit, fitted_accuracy(bands, load_accuracy(base.folder)), source)
    if form == "json":
        told = {
            "rms_deg": float(np.degrees(fit.rms)),
            "noise_deg": float(np.degrees(fit.misfit.noise)),
            "held_out_rms_deg": float(np.degrees(fit.misfit.held_out)),
            "trusted": fit.misfit.trusted,
            "offsets_s": list(fit.offsets),
            "parameters": [
                {"name": p.parameter.name, "keys": list(p.parameter.keys), "factor": p.factor, "sigma": p.sigma if p.told else None}
                for p in fit.parameters
            ],
            "residuals": [
                {
                    "kind": band.kind.value,
                    "up_to_mm_s": 1e3 * band.up_to,
                    "path_mm": 1e3 * band.path,
                    "turn_deg": float(np.degrees(band.turn)),
                    "time_ms": 1e3 * band.time,
                }
                for band in bands
            ],
        }
        click.echo(json.dumps(told, indent=2))
    else:
        for p in fit.parameters:
            value = f"{p.factor:6.3f} +- {p.sigma:.3f} times {robot}'s" if p.told else f"as {robot}: these logs do not tell it"
            click.echo(f"{p.parameter.name:26} {value}")
        for file, offset in zip(logs, fit.offsets, strict=True):
            click.echo(f"{file.name:26} program begins at {offset:.4f} s of the log's clock, up to the start latency")
        click.echo(f"left unexplained           {np.degrees(fit.rms):.4f} deg rms; of held-out moves, standard uncertainties:")
        for band in bands:
            click.echo(
                f"  {band.kind.value:7} up to {1e3 * band.up_to:6.0f} mm/s   path {1e3 * band.path:.3f} mm, "
                f"turn {np.degrees(band.turn):.4f} deg, time {1e3 * band.time:.1f} ms"
            )
    if not fit.misfit.trusted:
        click.echo(
            f"warning: {np.degrees(fit.misfit.held_out):.4f} deg rms are left on the held-out moves, {fit.misfit.ratio:.0f} times "
            f"the log's noise: the model does not describe this arm or program, and its factors are no measurements. Their uncertainties "
            f"have been widened by {fit.misfit.widening:.1f}; the bounds of held-out moves hold. Is it the right program, robot, tool?",
            err=True,
        )
    if output is not None:
        click.echo(
            f"{output}: use it by --robot ./{output}" if not output.is_absolute() else f"{output}: use it by --robot {output}", err=True
        )
