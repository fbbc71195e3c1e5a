"""`mitl calibrate`: robot-world and hand-eye with scale, from recordings or a rig. A thin wrapper over `mitl.calibration`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from mitl.calibration import Calibration, CalibrationPoses, Distortion, TimeOffset
    from mitl.protocols import AveragedPoint

_MODELS = ("auto", "rigid", "scale", "affine")


@click.command(
    "calibrate",
    short_help="Calibrate tracker against robot.",
    epilog="Example: mitl calibrate run/calibration.mcap --output calibration.toml",
)
@click.argument("recordings", nargs=-1, metavar="[RECORDING]...", type=click.Path(path_type=Path))
@click.option("--rig", metavar="sim|FILE.toml", help="Drive this rig through the calibration poses, instead of recordings.")
@click.option("--seed", default=1, show_default=True, type=click.IntRange(min=0), metavar="N", help="Seed of the simulated rig.")
@click.option(
    "--flange",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Where the robot's flange was: RECORDING is then one path of the tracker, both of any format that mitl reads.",
)
@click.option("--columns", metavar="MAP", help="For --flange: columns of RECORDING, t=COLUMN,x=COLUMN,... or vicon, optitrack, laser, egm.")
@click.option("--flange-columns", metavar="MAP", help="The same for the table given as --flange.")
@click.option(
    "--model",
    type=click.Choice(_MODELS),
    default="auto",
    show_default=True,
    help="What the tracker does to positions; auto: what the poses justify.",
)
@click.option("--plan", is_flag=True, help="Make the RAPID program with the poses to calibrate at, for --robot, and drive nothing.")
@click.option("--robot", default="irb140", show_default=True, metavar="NAME", help="For --plan: a folder in models/, or a path to one.")
@click.option("--poses", "count", default=30, show_default=True, type=click.IntRange(12, 200), help="For --plan: how many.")
@click.option("--cell", metavar="NAME|FOLDER|FILE", help="For --plan: what stands around the robot, to keep away from.")
@click.option(
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    metavar="FILE",
    help="Where to write the calibration or plan.",
)
@click.option("--format", "form", type=click.Choice(("text", "json")), default="text", show_default=True, help="Form of the output.")
def calibrate_command(
    recordings: tuple[Path, ...],
    rig: str | None,
    seed: int,
    flange: Path | None,
    columns: str | None,
    flange_columns: str | None,
    model: str,
    plan: bool,
    robot: str,
    count: int,
    cell: str | None,
    output: Path | None,
    form: str,
) -> None:
    """Solves where the tracker's base stands and how its body sits on the flange; prints residuals, covariance and what was rejected.

    RECORDING is a calibration.mcap of `mitl verify`, or one of `mitl record --calibration`: robot and tracker over time, from which the
    clocks' offset comes too. Several recordings of poses are taken together. A degenerate set of poses is refused, saying what is missing.

    Of another tracker, and of a robot without mitl: RECORDING --flange FILE, each over time on a clock of its own.
    """
    # heavy imports only when the command runs
    import json  # noqa: PLC0415 - see above

    from mitl.calibration import Distortion, calibrate, choose_distortion, save_calibration  # noqa: PLC0415 - see above
    from mitl.cli.progress import Progress  # noqa: PLC0415 - see above
    from mitl.errors import UsageError  # noqa: PLC0415 - see above

    if sum((rig is not None, bool(recordings), plan)) != 1:
        raise UsageError("expected one of: recordings, --rig, --plan")
    if flange is None and (columns is not None or flange_columns is not None):
        raise UsageError("--columns and --flange-columns need --flange FILE")
    if flange is not None and len(recordings) != 1:
        raise UsageError(f"--flange: expected one RECORDING, the tracker's, got {len(recordings)}")
    if cell is not None and not plan:
        raise UsageError("--cell needs --plan: a rig file names its cell and its poses itself")
    if plan:
        from mitl.cli.calibration_plan import write_plan  # noqa: PLC0415 - see above

        write_plan(robot, count, cell, output)
        return
    wanted = None if model == "auto" else Distortion(model)
    offset: TimeOffset | None = None
    reference: AveragedPoint | None = None
    with Progress("calibrate") as progress:
        progress.at("reading" if rig is None else "driving through the poses")
        if rig is not None:
            poses, streams, reference = _from_rig(rig, seed, wanted)
            solved, offset = streams
        elif flange is not None:
            poses, (solved, offset) = _from_two_files(flange, flange_columns, recordings[0], columns, wanted)
        else:
            poses, one = _from_recordings(recordings, wanted)
            if one is None:
                progress.at("solving")
                solved = calibrate(poses, distortion=wanted or choose_distortion(poses))
            else:
                solved, offset = one
    files = recordings if flange is None else (*recordings, flange)
    provenance = {"recordings": ", ".join(str(file) for file in files)} if rig is None else {"rig": rig, "seed": str(seed)}
    if output is not None:
        save_calibration(output, solved, provenance, reference)
    told = _as_json(solved, poses, offset)
    click.echo(json.dumps(told) if form == "json" else _text(told))
    if output is not None:
        click.echo(f"calibration: {output}", err=True)


def _from_rig(
    rig: str, seed: int, model: Distortion | None
) -> tuple[CalibrationPoses, tuple[Calibration, TimeOffset], AveragedPoint | None]:
    """Gives the poses, the calibration with the clocks' offset, and what the device that stands still showed, if there is one."""
    import tempfile  # noqa: PLC0415 - heavy imports only when the command runs

    from mitl.calibration.frame_check import change_of_device  # noqa: PLC0415 - see above
    from mitl.engine.calibration_session import AVERAGE, REFERENCE, calibration_program  # noqa: PLC0415 - see above
    from mitl.errors import RigError  # noqa: PLC0415 - see above
    from mitl.metrics.uncertainty import DRIFT_SD, DRIFT_TAU, drift_sigma  # noqa: PLC0415 - see above
    from mitl.rig import load_rig  # noqa: PLC0415 - see above
    from mitl.trackers.recorder import RigRecorder  # noqa: PLC0415 - see above

    built = load_rig(rig, seed, ())
    device = built.devices.get(REFERENCE)
    began = built.clock.now()
    before = device.average(AVERAGE) if device is not None else None
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "calibration.mcap"
        with RigRecorder(built, file, {"command": "mitl calibrate"}) as recorder:
            recorder.calibration_poses(calibration_program(built))
        poses, one = _from_recordings((file,), model)
    assert one is not None  # noqa: S101 - our own recording has both streams
    reference = None
    if device is not None and before is not None:
        reference, elapsed = device.average(AVERAGE), built.clock.now() - began
        change = change_of_device(before, reference, drift=drift_sigma(DRIFT_SD, DRIFT_TAU, elapsed), elapsed=elapsed)
        if change.moved:
            raise RigError(f"the tracker's frame moved while it was calibrated, calibrate again: {change.told()}")
    return poses, one, reference


def _from_recordings(files: tuple[Path, ...], model: Distortion | None) -> tuple[CalibrationPoses, tuple[Calibration, TimeOffset] | None]:
    """Gives the poses of recordings; for one of robot and tracker over time the calibration and the clocks' offset too."""
    import numpy as np  # noqa: PLC0415 - heavy imports only when the command runs

    from mitl.calibration import CalibrationPoses  # noqa: PLC0415 - see above
    from mitl.calibration.streams import calibrate_streams  # noqa: PLC0415 - see above
    from mitl.errors import UsageError  # noqa: PLC0415 - see above
    from mitl.recording import read_recording  # noqa: PLC0415 - see above
    from mitl.recording.read import samples_of  # noqa: PLC0415 - see above
    from mitl.recording.records import TRACKER  # noqa: PLC0415 - see above
    from mitl.trackers.recorder import FLANGE  # noqa: PLC0415 - see above

    parts: list[CalibrationPoses] = []
    for file in files:
        recording = read_recording(file)
        if recording.damage:
            click.echo(f"warning: {file}: {recording.damage}; what was before is used", err=True)
        tracks = {topic: track.path for topic, track in recording.paths.items()}
        flange, tracked = (tracks.get(f"/calibration/{name}") for name in ("flange", "tracker"))
        if flange is not None and tracked is not None:
            if len(flange) != len(tracked):
                raise UsageError(f"{file}: {len(flange)} poses of the robot, {len(tracked)} of the tracker: they do not belong together")
            as_rows = [np.concatenate([path.position, path.quaternion_wxyz], axis=1) for path in (flange, tracked)]
            parts.append(CalibrationPoses(as_rows[0], as_rows[1], np.zeros(len(flange))))
        elif FLANGE in tracks and TRACKER in tracks:
            found = calibrate_streams(tracks[FLANGE], samples_of(recording, TRACKER).trusted(), model)
            if len(files) == 1:
                return found.poses, (found.calibration, found.offset)
            parts.append(found.poses)
        else:
            expected = f"/calibration/flange and /calibration/tracker (mitl verify), or {FLANGE} and {TRACKER} (mitl record --calibration)"
            raise UsageError(f"{file}: expected the topics {expected}; it has {', '.join(tracks) or 'none'}")
    joined = [np.concatenate([getattr(part, name) for part in parts]) for name in ("flange", "tracked", "jitter")]
    return CalibrationPoses(*joined), None


def _from_two_files(
    flange: Path, flange_columns: str | None, tracker: Path, columns: str | None, model: Distortion | None
) -> tuple[CalibrationPoses, tuple[Calibration, TimeOffset]]:
    """Gives the poses, the calibration and the clocks' offset of a flange's path X_BF and a tracker's X_LM, each from a file."""
    from mitl.calibration.streams import calibrate_streams  # noqa: PLC0415 - heavy imports only when the command runs
    from mitl.errors import UsageError  # noqa: PLC0415 - see above
    from mitl.recording import ColumnMap  # noqa: PLC0415 - see above
    from mitl.recording.read import read_tracker_recordings  # noqa: PLC0415 - see above

    paths = []
    for file, given in ((flange, flange_columns), (tracker, columns)):
        found = read_tracker_recordings(file, columns=None if given is None else ColumnMap.parse(given))
        if len(found) > 1:
            raise UsageError(f"{file}: expected one path, got {len(found)}: {', '.join(each.name for each in found)}")
        if found[0].damage:
            click.echo(f"warning: {file}: {found[0].damage}; what was before is used", err=True)
        paths.append(found[0].path)
    solved = calibrate_streams(paths[0], paths[1], model)
    return solved.poses, (solved.calibration, solved.offset)


def _as_json(c: Calibration, poses: CalibrationPoses, offset: TimeOffset | None) -> dict[str, Any]:
    import numpy as np  # noqa: PLC0415 - heavy imports only when the command runs

    deg = 180.0 / np.pi
    sd = np.sqrt(np.diag(c.covariance))
    residuals = {
        name: {
            "position_rms_m": r.position_rms,
            "position_max_m": r.position_max,
            "rotation_rms_deg": r.rotation_rms * deg,
            "rotation_max_deg": r.rotation_max * deg,
            "count": r.count,
        }
        for name, r in (("residuals", c.training), ("held_out", c.held_out))
    }
    return {
        "model": c.distortion.value,
        "positions_only": c.positions_only,
        "poses": len(poses),
        "used": c.pose_count,
        "X_LB": c.X_LB.tolist(),
        "X_FM": c.X_FM.tolist(),
        "scale": c.scale.tolist(),
        "skew_deg": (c.skew * deg).tolist(),
        **residuals,
        "X_LB_sd": {"rotation_deg": (sd[0:3] * deg).tolist(), "position_m": sd[3:6].tolist()},
        "X_FM_sd": {"rotation_deg": (sd[6:9] * deg).tolist(), "position_m": sd[9:12].tolist()},
        "distortion_sd": sd[12:].tolist(),
        "covariance": c.covariance.tolist(),
        "registration_m": c.position_uncertainty(),
        "registration_deg": c.rotation_uncertainty() * deg,
        "time_offset_s": None if offset is None else offset.seconds,
        "time_offset_sd_s": None if offset is None else offset.sigma,
        "rejected": [{"pose": r.index + 1, "reason": r.reason} for r in c.rejected],
    }


def _text(told: dict[str, Any]) -> str:
    def row(values: list[float], factor: float = 1.0, digits: int = 3) -> str:
        return " ".join(f"{value * factor:.{digits}f}" for value in values)

    alone = ", positions alone: the tracker tells no orientation" if told["positions_only"] else ""
    lines = [f"model         {told['model']}; {told['used']} of {told['poses']} poses used{alone}"]
    for name in ("X_LB", "X_FM"):
        sd = told[f"{name}_sd"]
        pose = told[name]
        lines.append(
            f"{name}          {row(pose[:3], 1e3)} mm, quaternion {row(pose[3:], 1.0, 6)};"
            f" sd {row(sd['position_m'], 1e3)} mm, {row(sd['rotation_deg'])} deg"
        )
    lines.append(
        f"scale         {row(told['scale'], 1.0, 5)}, skew {row(told['skew_deg'])} deg; sd {row(told['distortion_sd'], 1.0, 5) or 'none'}"
    )
    for key, name in (("residuals", "residuals"), ("held_out", "held out")):
        r = told[key]
        lines.append(
            f"{name:<13} rms {r['position_rms_m'] * 1e3:.3f} mm, {r['rotation_rms_deg']:.4f} deg;"
            f" max {r['position_max_m'] * 1e3:.3f} mm, {r['rotation_max_deg']:.4f} deg"
        )
    lines.append(f"registration  {told['registration_m'] * 1e3:.3f} mm, {told['registration_deg']:.4f} deg per axis at the flange, 1 sd")
    if told["time_offset_s"] is not None:
        lines.append(
            f"time offset   {told['time_offset_s']:.6f} s to add to the tracker's times, sd {told['time_offset_sd_s'] * 1e3:.3f} ms"
        )
    else:
        lines.append("time offset   not in these recordings: they hold still poses only")
    lines += [f"rejected      pose {r['pose']}: {r['reason']}" for r in told["rejected"]] or ["rejected      none"]
    return "\n".join(lines)
