"""`mitl record`: tracker and robot of a rig, or another tracker's file, to MCAP."""

from __future__ import annotations

from pathlib import Path

import click


@click.command(
    "record",
    short_help="Record the tracker (and robot) to MCAP.",
    epilog="Example: mitl record --rig sim --calibration --output calibration.mcap",
)
@click.option("--output", required=True, type=click.Path(dir_okay=False, path_type=Path), metavar="FILE.mcap", help="Where to.")
@click.option("--rig", default="sim", show_default=True, metavar="sim|FILE.toml", help="The simulated rig, or a rig file.")
@click.option("--seed", default=1, show_default=True, type=click.IntRange(min=0), metavar="N", help="Seed of the simulated rig.")
@click.option("--seconds", default=10.0, show_default=True, type=click.FloatRange(min=0.1), help="How long, in the rig's time.")
@click.option("--program", type=click.Path(path_type=Path), help="RAPID module to load and start first; it is stopped at the end.")
@click.option("--calibration", is_flag=True, help="Drive through the calibration poses instead, for `mitl calibrate`.")
@click.option("--from", "source", type=click.Path(path_type=Path), help="Take this file instead of a rig: any format that mitl reads.")
@click.option(
    "--columns",
    metavar="MAP",
    help="For --from: t=COLUMN,x=COLUMN,... or vicon, optitrack, laser, egm.",
)
def record_command(
    output: Path,
    rig: str,
    seed: int,
    seconds: float,
    program: Path | None,
    calibration: bool,
    source: Path | None,
    columns: str | None,
) -> None:
    """Records the poses of the tracker with result codes, buttons and velocities, the robot's joints and flange, each on its own clock.

    The file grows while it is recorded: a process that is killed leaves all but the last second.
    """
    from mitl.errors import UsageError  # noqa: PLC0415 - heavy imports only when the command runs

    if output.suffix.lower() != ".mcap":
        raise UsageError(
            f"{output}: recordings are written as .mcap, not {output.suffix or 'without an ending'}; mitl export makes CSV of one"
        )
    if not output.resolve().parent.is_dir():
        raise UsageError(f"{output}: there is no folder {output.parent}")
    if source is not None:
        _take_over(source, columns, output)
        return
    if columns is not None:
        raise UsageError("--columns needs --from FILE")
    if program is not None and calibration:
        raise UsageError("expected --program or --calibration, got both")
    if program is not None and not program.exists():
        raise UsageError(f"{program}: cannot be read: No such file or directory")

    from mitl.cli.progress import Progress  # noqa: PLC0415 - see above
    from mitl.engine.calibration_session import calibration_program  # noqa: PLC0415 - see above
    from mitl.rig import load_rig  # noqa: PLC0415 - see above
    from mitl.trackers.recorder import RigRecorder  # noqa: PLC0415 - see above

    built = load_rig(rig, seed, ())
    poses = calibration_program(built) if calibration else None
    if program is not None:
        built.controller.load([program])  # before the file is begun: a program that is refused leaves none
    with Progress("record") as progress, RigRecorder(built, output, {"command": "mitl record"}) as recorder:
        if poses is not None:
            progress.at("calibration poses")
            recorder.calibration_poses(poses)
        else:
            if program is not None:
                built.controller.start()
            progress.at(f"{seconds:g} s")
            try:
                recorder.run(seconds)
            finally:
                built.controller.stop()
    click.echo(f"{output}: {built.clock.now():.6g} s of rig {built.name}")


def _take_over(source: Path, columns: str | None, output: Path) -> None:
    from mitl.errors import UsageError  # noqa: PLC0415 - heavy imports only when the command runs
    from mitl.recording import ColumnMap, PoseTrack, Recording, write_recording  # noqa: PLC0415 - see above
    from mitl.recording.read import read_tracker_recordings  # noqa: PLC0415 - see above
    from mitl.recording.records import TRACKER  # noqa: PLC0415 - see above

    found = read_tracker_recordings(source, columns=None if columns is None else ColumnMap.parse(columns))
    if len(found) > 1:
        raise UsageError(f"{source}: expected one path, got {len(found)}: {', '.join(each.name for each in found)}")
    path = found[0].path
    shift = -min(0.0, float(path.time[0]))
    metadata = {"command": "mitl record", "source": str(source), **({"times shifted by s": repr(shift)} if shift else {})}
    write_recording(output, Recording({TRACKER: PoseTrack(path.shifted(shift), "tracker", "body")}, metadata=metadata))
    click.echo(f"{output}: {len(path)} samples of {source}")
