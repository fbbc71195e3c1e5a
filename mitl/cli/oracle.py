"""`mitl oracle`: where a program's tool should be, and when. A thin wrapper over `motion.offline`.

Invariant: OUT is written whole or not at all, and a program that fails leaves no earlier OUT behind to be taken for its path.
"""

from __future__ import annotations

import re
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:  # heavy imports only when the command runs
    from collections.abc import Sequence

    from mitl.cli.progress import Progress
    from mitl.motion.conveyor import Conveyor
    from mitl.motion.offline import Samples
    from mitl.motion.program_run import ProgramRun
    from mitl.motion.robot_model import RobotModel
    from mitl.motion.signals import InputChange
    from mitl.paths import FloatArray
    from rapid_interp import Program

_LONGEST = 600.0
_LEFT_OUT = "RAPID-W202"
_MOST_TOLD = 8
_MOST_SAMPLES = 5e7
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_SUFFIXES = (".csv", ".mcap")


@click.command("oracle", epilog="Example:  mitl oracle cell.mod --robot irb140 --frame wobj --rate 250 --output path.csv")
@click.argument("sources", nargs=-1, required=True, metavar="FILE|FOLDER...", type=click.Path(path_type=Path))
@click.option("--routine", default="main", show_default=True, help="Procedure to run.")
@click.option("--set", "presets", multiple=True, metavar="VAR=VALUE", help="Set RAPID data before the start, e.g. --set option=3.")
@click.option("--input", "inputs", multiple=True, metavar="SIGNAL=VALUE@SECONDS", help="Give an input signal a value from a time on.")
@click.option("--answer", "answers", multiple=True, metavar="TEXT", help="What the operator answers; once for every question, in order.")
@click.option("--robot", default="irb140", show_default=True, help="Robot model.")
@click.option("--cell", metavar="NAME|FOLDER", help="The cell around the robot, for its conveyors: a name in models/cells/ or a folder.")
@click.option("--rate", type=click.FloatRange(min=0, min_open=True), default=250.0, show_default=True, help="Samples per second, exact.")
@click.option("--frame", type=click.Choice(("world", "wobj", "base")), default="world", show_default=True, help="Frame of the path.")
@click.option(
    "--view",
    type=click.Choice(("tool", "controller", "planned")),
    default="tool",
    show_default=True,
    help="Where the tool goes, what the controller reports (joint logs, EGM), or what was planned.",
)
@click.option(
    "--max-time",
    type=click.FloatRange(min=0, min_open=True),
    help=f"Cut the program off after so many seconds of the robot's time. Without it, one that runs on after {_LONGEST:g} s is an error.",
)
@click.option(
    "--lenient",
    is_flag=True,
    help="Leave out instructions that can change neither motion nor data and are not carried out, with a warning.",
)
@click.option("--bounds", is_flag=True, help="Add columns to the CSV: how far the real arm may be from each sample (MCAP always has it).")
@click.option("--output", type=click.Path(path_type=Path, dir_okay=False), metavar="OUT.mcap|.csv", help="Write the path here.")
def oracle_command(
    sources: tuple[Path, ...],
    routine: str,
    presets: tuple[str, ...],
    inputs: tuple[str, ...],
    answers: tuple[str, ...],
    robot: str,
    cell: str | None,
    rate: float,
    frame: str,
    view: str,
    max_time: float | None,
    lenient: bool,
    bounds: bool,
    output: Path | None,
) -> None:
    """Run a RAPID program without a rig and write the path of its tool.

    `mitl oracle bless` stores the oracles of the test programs, see its own --help.

    Prints duration, path length, number of moves, the peak share of each joint's speed limit, the signals that were set and what
    TPWrite wrote. A program that cannot move as told ends with the line and the reason, exit code 1, and nothing is left at OUT.

    \b
    CSV columns: t_s, x_mm, y_mm, z_mm, qw, qx, qy, qz, speed_mm_s, j1_deg .. j6_deg, move, module, line,
    then one column per output signal that was set; with --bounds, bound_mm, bound_deg and bound_ms: the standard uncertainty of the
    sample's position, orientation and time against the real arm, from what the robot's model is known to be worth.
    """  # noqa: D301 - click wants the character \b before a block that it must not wrap
    from mitl.cli.progress import Progress  # noqa: PLC0415 - see above
    from mitl.errors import MotionError, UsageError  # noqa: PLC0415 - see above
    from mitl.motion.robot_model import load_robot_model  # noqa: PLC0415 - see above
    from rapid_interp import RapidError, RapidErrors  # noqa: PLC0415 - see above

    if output is not None and output.suffix.lower() not in _SUFFIXES:
        raise UsageError(f"{output}: the path is written as .csv or .mcap, not {output.suffix or 'without an ending'}")
    if output is not None and not output.resolve().parent.is_dir():
        raise UsageError(f"{output}: there is no folder {output.parent}")
    for name, number in (("--rate", rate), ("--max-time", max_time)):
        if number is not None and not isfinite(number):
            raise UsageError(f"{name} {number}: expected a finite number")
    assignments = [read_assignment(text) for text in presets]
    changes = [read_input_change(text) for text in inputs]
    model = load_robot_model(robot)
    try:
        with Progress("computing the path") as progress:
            program = _loaded(sources, changes, lenient=lenient)
            run, samples = _computed(program, routine, assignments, changes, answers, cell, model, rate, frame, view, max_time, progress)
            if output is not None:
                names = " ".join(source.name for source in sources)
                _write(
                    output,
                    run,
                    samples,
                    {"robot": model.name, "routine": routine, "view": view, "frame": frame, "sources": names},
                    bounds=bounds,
                )
    except (MotionError, RapidError, RapidErrors):
        if output is not None:
            output.unlink(missing_ok=True)
        raise
    _print_summary(run, view, max_time)
    if output is not None:
        click.echo(f"{output}: {len(samples.path)} samples", err=True)
    if run.stopped_at is not None:
        at = run.stopped_at
        click.echo(f"mitl oracle: {at.file}:{at.line}: Stop ended the run here; what comes after it was not executed", err=True)
    if not run.finished:
        click.echo(f"mitl oracle: cut off at --max-time {max_time:g} s while the program was still running", err=True)


def _loaded(sources: tuple[Path, ...], changes: list[InputChange], *, lenient: bool) -> Program:
    """Gives the program, and tells what is left out of it. Raises RapidErrors."""
    import rapid_interp  # noqa: PLC0415 - see above

    program = rapid_interp.load(sources, signals=[change.name for change in changes], lenient=lenient)
    for warning in program.warnings if lenient else ():
        if warning.code == _LEFT_OUT:
            click.echo(warning.format(), err=True)
    return program


def _computed(
    program: Program,
    routine: str,
    assignments: list[tuple[str, str]],
    changes: list[InputChange],
    answers: tuple[str, ...],
    cell: str | None,
    model: RobotModel,
    rate: float,
    frame: str,
    view: str,
    max_time: float | None,
    progress: Progress,
) -> tuple[ProgramRun, Samples]:
    """Runs the program and samples what it did. Raises RapidErrors, RapidError or MotionError."""
    import math  # noqa: PLC0415 - see above

    import numpy as np  # noqa: PLC0415 - see above

    from mitl.errors import MotionError, UsageError  # noqa: PLC0415 - see above
    from mitl.motion.loop_watch import MOST, LoopWatch  # noqa: PLC0415 - see above
    from mitl.motion.offline import Frame, duration_of, run_until, sample, start_run  # noqa: PLC0415 - see above
    from mitl.motion.record import View  # noqa: PLC0415 - see above
    from rapid_interp import RapidError  # noqa: PLC0415 - see above

    try:
        task = program.start(routine)
    except RapidError as error:
        raise UsageError(f"--routine {routine}: {error.message}") from error
    for name, value in assignments:
        try:
            task.set(name, value)
        except RapidError as error:
            raise UsageError(f"--set {name}={value}: {error.message}") from error
    run = start_run(task.run(), model, inputs=changes, answers=answers, conveyors=_conveyors(cell))
    watch = LoopWatch(run)
    longest, done = (_LONGEST, watch) if max_time is None else (max_time, lambda _: False)
    run_until(run, longest, done, progress=lambda now: progress.at(f"{now:.1f} s of the robot's time"))
    if watch.endless is not None:
        at = watch.endless.at
        reason = f"endless loop: this move was made more than {MOST} times; cut the program off with --max-time"
        raise MotionError(reason, module=at.module, line=at.line, file=at.file, column=at.column)
    if not run.finished and max_time is None and run.at is not None:
        remedy = "give the inputs that it waits for with --input, or cut it off with --max-time"
        reason = f"the program is still running after {_LONGEST:g} s of the robot's time; {remedy}"
        raise MotionError(reason, module=run.at.module, line=run.at.line, file=run.at.file, column=run.at.column)
    ends = duration_of(run) if run.finished else math.inf
    if max_time is not None:
        ends = min(ends, max_time)
    progress.at("sampling")
    if ends * rate > _MOST_SAMPLES:
        raise UsageError(f"{ends:.0f} s at --rate {rate:g} are {ends * rate:.3g} samples, more than {_MOST_SAMPLES:.0e}")
    times = np.arange(math.floor(ends * rate + 1e-9) + 1) / rate
    return run, sample(run, times, View(view), Frame(frame))


def _conveyors(cell: str | None) -> Sequence[Conveyor]:
    """Gives the conveyors of a cell by its name or folder; none without a cell. Raises UsageError."""
    if cell is None:
        return ()
    from mitl.simulation.cell import load_cell  # noqa: PLC0415 - loads Drake

    return load_cell(cell).conveyors


def read_assignment(text: str) -> tuple[str, str]:
    """Gives name and value of `VAR=VALUE`. Raises UsageError."""
    from mitl.errors import UsageError  # noqa: PLC0415 - see above

    name, equals, value = text.partition("=")
    if not equals or not name.strip() or not value.strip():
        raise UsageError(f"--set {text}: expected VAR=VALUE, e.g. --set option=3 or --set speed=[200,500,5000,1000]")
    return name.strip(), value.strip()


def read_input_change(text: str) -> InputChange:
    """Gives the change that `SIGNAL=VALUE@SECONDS` means. Raises UsageError."""
    from mitl.errors import UsageError  # noqa: PLC0415 - see above
    from mitl.motion.signals import InputChange  # noqa: PLC0415 - see above

    match = re.fullmatch(rf"\s*(\w+)\s*=\s*({_NUMBER})\s*@\s*({_NUMBER})\s*", text)
    if match is None:
        raise UsageError(f"--input {text}: expected SIGNAL=VALUE@SECONDS, e.g. --input diStart=1@0.5")
    return InputChange(match[1], float(match[2]), float(match[3]))


def _signal_values(run: ProgramRun, samples: Samples) -> dict[str, FloatArray]:
    """Gives for every output that was set its value (N,) at the samples."""
    import numpy as np  # noqa: PLC0415 - see above

    values = {}
    for name, changes in sorted(run.signals.items()):
        times = np.array([time for time, _ in changes])
        known = np.array([0.0, *(value for _, value in changes)])
        values[name] = known[np.searchsorted(times, samples.path.time, side="right")]
    return values


def _write(output: Path, run: ProgramRun, samples: Samples, metadata: dict[str, str], *, bounds: bool) -> None:
    """Writes the samples as CSV or MCAP, by the file's ending; bounds: into the CSV too."""
    import numpy as np  # noqa: PLC0415 - see above

    from mitl import __version__  # noqa: PLC0415 - see above
    from mitl.motion.accuracy import load_accuracy  # noqa: PLC0415 - see above
    from mitl.motion.bounds import bounds_at  # noqa: PLC0415 - see above
    from mitl.recording import OracleTable, PoseTrack, Recording, Series, write_csv, write_recording  # noqa: PLC0415 - see above
    from mitl.recording.records import BOUND_COLUMNS, BOUNDS, JOINTS, MOVES, ORACLE, SIGNALS  # noqa: PLC0415 - see above

    lines = [executed.move.effect.at for executed in run.record.moves]
    line = np.array([at.line for at in lines] or [0], dtype=np.int64)[samples.move]
    signals = _signal_values(run, samples)
    known = bounds_at(run.record, run.planner.arm, load_accuracy(run.record.model.folder), samples.path.time)
    if output.suffix.lower() == ".csv":
        module = tuple(lines[index].module if lines else "" for index in samples.move)
        extra = {"bound_mm": 1e3 * known.path, "bound_deg": np.degrees(known.turn), "bound_ms": 1e3 * known.time} if bounds else {}
        write_csv(output, OracleTable(samples.path, samples.speed, samples.joints, samples.move, module, line, {**signals, **extra}))
        return
    time = samples.path.time
    series = {
        JOINTS: Series(time, samples.joints, tuple(f"j{axis}" for axis in range(1, 7))),
        MOVES: Series(time, np.stack([samples.move.astype(np.float64), line.astype(np.float64)], axis=1), ("move", "line")),
        BOUNDS: Series(time, np.stack([known.path, known.turn, known.time], axis=1), BOUND_COLUMNS),
        "/tool/speed": Series(time, samples.speed[:, None], ("speed",)),
    }
    if signals:
        series[SIGNALS] = Series(time, np.stack(list(signals.values()), axis=1), tuple(signals))
    paths = {ORACLE: PoseTrack(samples.path, metadata["frame"], "tool")}
    write_recording(output, Recording(paths=paths, series=series, metadata={**metadata, "mitl": __version__}))


def _print_summary(run: ProgramRun, view: str, max_time: float | None) -> None:
    """Prints what the program did."""
    import math  # noqa: PLC0415 - see above

    import numpy as np  # noqa: PLC0415 - see above

    from mitl.motion.offline import duration_of, path_length  # noqa: PLC0415 - see above
    from mitl.motion.record import TICK, View  # noqa: PLC0415 - see above

    record = run.record
    duration = min(duration_of(run) if run.finished else math.inf, math.inf if max_time is None else max_time)
    speeds = record.joint_speeds(View(view))[: int(duration / TICK) + 1 if math.isfinite(duration) else None]
    shares = np.abs(speeds).max(axis=0, initial=0.0) / record.model.speed
    click.echo(f"duration      {duration:.3f} s")
    click.echo(f"path length   {1e3 * path_length(run, View(view), duration):.1f} mm")
    click.echo(f"moves         {sum(executed.begins <= duration for executed in record.moves)}")
    click.echo("joint speed   " + ", ".join(f"J{axis} {100 * share:.1f} %" for axis, share in enumerate(shares, 1)) + " of the limit")
    for name, changes in sorted(run.signals.items()):
        told = ", ".join(f"{value:g} at {time:.3f} s" for time, value in changes[:_MOST_TOLD])
        more = f", and {len(changes) - _MOST_TOLD} more" if len(changes) > _MOST_TOLD else ""
        click.echo(f"signal        {name}: {told}{more}")
    for line in run.written:
        click.echo(f"TPWrite       {line.time:.3f} s: {line.text}")
    for event in run.events:
        click.echo(f"event         {event.time:.3f} s: {event.text}")
