r"""Prints how long planning takes, in processor time, beside toppra and Drake's Toppra on the same path; how it grows, and what it holds.

Run: python benchmarks/planning_speed.py [TARGETS]. Ours is everything: effects -> legs by inverse kinematics -> zones -> limits -> pace ->
lag and averages -> samples of the tool at 250 Hz. toppra and Drake's Toppra get the joints of the same path, for the pace alone.
Needs `pip install toppra`; without it only Drake is beside us. The best of several turns in one process counts, so that ratios hold.
"""

from __future__ import annotations

import functools
import gc
import importlib.util
import math
import statistics
import sys
import time
import tracemalloc
from collections.abc import Callable, Generator, Sequence

import numpy as np
from pydrake.multibody.optimization import Toppra
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.trajectories import PiecewisePolynomial
from scipy.spatial.transform import RigidTransform, Rotation

import rapid_interp
from mitl.motion.chain import Planner
from mitl.motion.offline import Frame, run_until, sample
from mitl.motion.program_run import ProgramRun
from mitl.motion.record import MotionRecord, View
from mitl.motion.robot_model import RobotModel, load_robot_model
from mitl.paths import FloatArray
from rapid_interp import effects

RATE = 250.0
GRIDPOINTS = 400
TURNS = 15
SIZES = (250, 1_000, 4_000, 10_000)
START = np.radians([17.881572, 15.864548, 23.056389, 38.254369, -28.621519, -29.914229])
CORNER = r"""MODULE M
PERS tooldata probe := [TRUE,[[75,0,493.30127019],[0.965925826,0,0.258819045,0]],[1,[0,0,0.001],[1,0,0,0],0,0,0]];
CONST extjoint e := [9E9,9E9,9E9,9E9,9E9,9E9];
PROC main()
ConfL\Off; ConfJ\Off;
MoveL [[2200.1,-0.173205,1000],[0.555570232,0,0.831469613,0],[0,0,0,0],e],v500,z10,probe;
MoveL [[2450,-433.012702,1000],[0.707106781,0,0.707106781,0],[0,0,0,0],e],v500,fine,probe;
ENDPROC
ENDMODULE
"""
CAM_START = np.array([400.0, -200.0, 400.0])


def cam(count: int) -> str:
    """Gives RAPID that follows a wavy line back and forth over a sheet by targets 3 mm apart, z5, as CAM writes it."""
    lines = []
    for index in range(count):
        row, along = divmod(index, 130)
        y = -200.0 + 3.0 * (along if row % 2 == 0 else 129 - along)
        x = 400.0 + (row % 30) * 3.0 + 6.0 * math.sin(y / 15.0)
        z = 400.0 + 4.0 * math.cos(y / 20.0)
        zone = "fine" if index == count - 1 else "z5"
        lines.append(f"MoveL [[{x:.4f},{y:.4f},{z:.4f}],[0,0,1,0],[0,0,0,0],e],v200,{zone},tool0;")
    return (
        "MODULE M\nCONST extjoint e := [9E9,9E9,9E9,9E9,9E9,9E9];\nPROC main()\nConfL\\Off; ConfJ\\Off;\n"
        + "\n".join(lines)
        + "\nENDPROC\nENDMODULE\n"
    )


def recorded(text: str) -> list[effects.Effect]:
    """Gives the effects of a program that waits for no reply: the interpreter's own time is not planning."""
    run = rapid_interp.load_text(text, "program.mod").start().run()
    found: list[effects.Effect] = []
    try:
        effect = run.send(None)
        while True:
            found.append(effect)
            effect = run.send(None)
    except StopIteration:
        return found


def played(given: Sequence[effects.Effect]) -> Generator[effects.Effect, effects.Reply, None]:
    """Gives effects as a program does."""
    yield from given


def executed(given: Sequence[effects.Effect], planner: Planner, start: FloatArray) -> ProgramRun:
    """Gives the run of effects from rest at joints (6,) rad, with the tool's path sampled at RATE."""
    run = ProgramRun(played(given), planner, MotionRecord(planner.model, start))
    run_until(run, math.inf)
    sample(run, np.arange(math.ceil(run.record.end * RATE) + 1) / RATE, View.TOOL, Frame.WORLD)
    return run


def seconds(work: Callable[[], object], turns: int = TURNS) -> tuple[float, float]:
    """Gives the best and the median processor time in s of some turns of work, after one to warm up."""
    work()
    found = []
    for _ in range(turns):
        gc.collect()
        begin = time.process_time()
        work()
        found.append(time.process_time() - begin)
    return min(found), statistics.median(found)


def drake_pace(model: RobotModel, joints: FloatArray, s: FloatArray) -> Callable[[], object]:
    """Gives the work of Drake's Toppra on a path's joints (N, 6) at s (N,)."""
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModels(str(model.urdf))
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base_link"))
    plant.Finalize()

    def pace() -> object:
        path = PiecewisePolynomial.CubicWithContinuousSecondDerivatives(s, joints.T)
        toppra = Toppra(path, plant, np.linspace(s[0], s[-1], GRIDPOINTS))
        toppra.AddJointVelocityLimit(-model.speed, model.speed)
        toppra.AddJointAccelerationLimit(-model.acceleration, model.acceleration)
        found = toppra.SolvePathParameterization()
        if found is None:
            raise RuntimeError("Drake's Toppra found no way")
        return found

    return pace


def toppra_pace(model: RobotModel, joints: FloatArray, s: FloatArray) -> Callable[[], object]:
    """Gives the work of toppra on a path's joints (N, 6) at s (N,)."""
    toppra, algorithm, constraint = (importlib.import_module(name) for name in ("toppra", "toppra.algorithm", "toppra.constraint"))
    toppra.setup_logging("WARNING")

    def pace() -> object:
        path = toppra.SplineInterpolator(s, joints)
        limits = [
            constraint.JointVelocityConstraint(np.stack([-model.speed, model.speed], axis=1)),
            constraint.JointAccelerationConstraint(np.stack([-model.acceleration, model.acceleration], axis=1)),
        ]
        found = algorithm.TOPPRA(limits, path, gridpoints=np.linspace(s[0], s[-1], GRIDPOINTS), parametrizer="ParametrizeConstAccel")
        if found.compute_trajectory() is None:
            raise RuntimeError("toppra found no way")
        return found

    return pace


def corner() -> None:
    """Prints the 30 deg corner's times and ratios."""
    model = load_robot_model("irb6640_180_255")
    planner, given = Planner(model), recorded(CORNER)
    path = executed(given, planner, START).record.chains[0].chain.path
    s = np.linspace(0.0, path.length, GRIDPOINTS)
    joints = path.sample(s).joints
    rows: list[tuple[str, Callable[[], object]]] = [
        ("mitl, effects to samples", lambda: executed(given, planner, START)),
        ("Drake's Toppra, pace alone", drake_pace(model, joints, s)),
    ]
    if importlib.util.find_spec("toppra"):
        rows.append(("toppra, pace alone", toppra_pace(model, joints, s)))
    times = [seconds(work) for _, work in rows]
    sys.stdout.write("30 deg corner, v500, z10\n")
    for (name, _), (best, median) in zip(rows, times, strict=True):
        sys.stdout.write(
            f"  {name:28} {1e3 * best:6.1f} ms at best, {1e3 * median:6.1f} median; ours takes {times[0][0] / best:.2f} times as long\n"
        )


def growth(sizes: Sequence[int]) -> None:
    """Prints times and memory of CAM paths of some sizes."""
    planner = Planner(load_robot_model("irb140"))
    X_BF = RigidTransform.from_components(1e-3 * CAM_START, Rotation.from_quat([0.0, 1.0, 0.0, 0.0]))
    start = planner.arm.nearest(X_BF, np.zeros(6))
    if start is None:
        raise RuntimeError("the CAM path begins out of reach")
    sys.stdout.write("CAM path, targets 3 mm apart, v200, z5\n")
    for count in sizes:
        given = recorded(cam(count))
        best, _ = seconds(functools.partial(executed, given, planner, start), 5 if count <= 1000 else 1)
        tracemalloc.start()
        end = executed(given, planner, start).record.end
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        sys.stdout.write(
            f"  {count:6} targets: {best:6.2f} s, {1e3 * best / count:5.2f} ms a target; {end:6.1f} s of motion; "
            f"{peak / count / 1024:5.1f} KiB a target at the peak\n"
        )


def main() -> None:
    """Prints all of it."""
    corner()
    growth(SIZES if len(sys.argv) < 2 else [int(size) for size in sys.argv[1:]])


if __name__ == "__main__":
    main()
