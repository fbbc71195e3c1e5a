"""`mitl calibrate --plan`: a RAPID program with calibration poses for any robot."""

from __future__ import annotations

from pathlib import Path

import click


def write_plan(robot: str, count: int, cell: str | None, output: Path | None) -> None:
    """Makes the plan, clear of the cell if there is one, and writes the program, or prints it; says how much the poses spread."""
    import numpy as np  # noqa: PLC0415 - heavy imports only when the command runs

    from mitl.calibration.pose_set import position_extents, rotation_spread  # noqa: PLC0415 - see above
    from mitl.cli.progress import Progress  # noqa: PLC0415 - see above
    from mitl.motion.robot_model import load_robot_model  # noqa: PLC0415 - see above
    from mitl.recording.atomic import replacing  # noqa: PLC0415 - see above
    from mitl.rig.pose_plan import clear_of_all, plan_poses, rapid_of  # noqa: PLC0415 - see above
    from mitl.simulation.cell import load_cell  # noqa: PLC0415 - see above

    model = load_robot_model(robot)
    around = None if cell is None else load_cell(cell)
    with Progress("calibrate") as progress:
        progress.at("choosing poses")
        plan = plan_poses(model, clear_of_all(model, around), count=count)
    text = rapid_of(plan, model.description, "the floor" if around is None else f"the cell {around.name}")
    if output is None:
        click.echo(text, nl=False)
    else:
        with replacing(output) as beside:
            beside.write_text(text, encoding="utf-8")
    about, across = np.degrees(rotation_spread(plan.flange))
    extents = " x ".join(f"{1e3 * extent:.0f}" for extent in position_extents(plan.flange))
    told = f"{len(plan.joints)} poses over {extents} mm, turning by {about:.0f} deg about one axis and {across:.0f} deg across it"
    click.echo(told if output is None else f"{output}: {told}", err=True)
