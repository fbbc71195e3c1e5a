"""Prints how fast recordings are written and read, and two long paths compared, beside evo where its Python is given.

Run: python benchmarks/recording_and_comparing.py [PYTHON_WITH_EVO]. evo is GPL: a cross-check from outside, in a process of its own, never
a dependency. Both do the same: association by time, rigid alignment, errors of position and rotation. Times are those of the processor.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.metrics.compare import Align, Comparison, compare
from mitl.paths import PosePath
from mitl.recording import PoseTrack, Recording, read_recording, write_recording
from mitl.recording.records import TRACKER

COUNT = 1_000_000
_EVO = """
import sys, time
import numpy as np
from evo.core import metrics, sync
from evo.core.trajectory import PoseTrajectory3D
data = np.load(sys.argv[1])
reference, measured = (PoseTrajectory3D(data[n + "_p"], data[n + "_q"], data["time"]) for n in ("reference", "measured"))
begin = time.process_time()
reference, measured = sync.associate_trajectories(reference, measured, max_diff=0.001)
measured.align(reference, correct_scale=False)
found = []
for relation in (metrics.PoseRelation.translation_part, metrics.PoseRelation.rotation_angle_deg):
    ape = metrics.APE(relation)
    ape.process_data((reference, measured))
    s = ape.get_all_statistics()
    found += [s["rmse"], s["mean"], s["max"]]
print(time.process_time() - begin, *found)
"""


def paths(count: int = COUNT) -> tuple[PosePath, PosePath]:
    """Gives a path of `count` samples at 250 Hz, and the same seen from another frame with noise."""
    random = np.random.default_rng(1)
    t = np.arange(count) / 250.0
    position = np.stack([np.sin(0.7 * t), np.cos(0.9 * t), 0.3 * np.sin(0.2 * t)], axis=1)
    turn = Rotation.from_rotvec(np.stack([0.5 * np.sin(0.3 * t), 0.4 * np.cos(0.5 * t), 0.2 * t % 1.0], axis=1))
    frame = Rotation.from_euler("xyz", [10.0, 20.0, 30.0], degrees=True)
    seen = frame.apply(position) + np.array([0.5, -0.2, 1.0]) + random.normal(0.0, 1e-3, (count, 3))
    seen_turn = frame * turn * Rotation.from_rotvec(random.normal(0.0, 1e-3, (count, 3)))
    valid = np.ones(count, dtype=np.bool_)
    return (
        PosePath(t, position, turn.as_quat(scalar_first=True), valid),
        PosePath(t, seen, seen_turn.as_quat(scalar_first=True), valid),
    )


def comparing(reference: PosePath, measured: PosePath) -> tuple[float, Comparison]:
    """Gives the seconds, best of three, and the numbers."""
    seconds = []
    for _ in range(3):
        begin = time.process_time()
        found = compare(reference, measured, Align.RIGID)
        seconds.append(time.process_time() - begin)
    return min(seconds), found


def evo(python: str, reference: PosePath, measured: PosePath) -> list[float]:
    """Gives evo's seconds, and rms, mean and greatest error of position in m and rotation in deg."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "paths.npz"
        named = {"reference": reference, "measured": measured}
        arrays = {f"{name}_p": path.position for name, path in named.items()}
        arrays |= {f"{name}_q": path.quaternion_wxyz for name, path in named.items()}
        np.savez(file, time=reference.time, **arrays)
        printed = subprocess.run([python, "-c", _EVO, str(file)], check=True, capture_output=True, text=True).stdout  # noqa: S603
    return [float(word) for word in printed.split()]


def recording(path: PosePath) -> tuple[float, float, float]:
    """Gives poses written and read a second, and the file's bytes a pose."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "long.mcap"
        begin = time.process_time()
        write_recording(file, Recording({TRACKER: PoseTrack(path, "tracker", "body")}))
        written = len(path) / (time.process_time() - begin)
        begin = time.process_time()
        found = read_recording(file).paths[TRACKER].path
        read = len(path) / (time.process_time() - begin)
        if not np.array_equal(found.position, path.position):
            raise RuntimeError("what was read is not what was written")
        return written, read, file.stat().st_size / len(path)


def table(python: str | None) -> list[str]:
    """Gives the benchmark's lines."""
    reference, measured = paths()
    written, read, size = recording(measured)
    seconds, ours = comparing(reference, measured)
    lines = [
        f"MCAP, {COUNT:,} poses: {written:,.0f} written a second (asked for: 100,000), {size:.0f} bytes a pose",
        f"MCAP, {COUNT:,} poses: {read:,.0f} read a second into arrays (asked for: 300,000)",
        f"compare, 2 x {COUNT:,} samples: {seconds:.2f} s",
    ]
    if python is not None:
        theirs, *numbers = evo(python, reference, measured)
        pairs = (
            ("position rms", ours.position_rmse_m, numbers[0]),
            ("position mean", ours.position_mean_m, numbers[1]),
            ("position max", ours.position_max_m, numbers[2]),
            ("rotation rms", ours.rotation_rmse_deg, numbers[3]),
        )
        ratio = theirs / seconds
        lines.append(f"evo: {theirs:.1f} s, {ratio:.0f} times as long (asked for: 60) {'ok' if ratio >= 60 else 'MISS'}")
        for name, mine, other in pairs:
            same = abs(mine - other) <= 5e-7 * abs(other)
            lines.append(f"  {name:<14}{mine:.9g} ours, {other:.9g} evo: {'same to 6 digits' if same else 'DIFFERENT'}")
    return lines


if __name__ == "__main__":
    print("\n".join(table(sys.argv[1] if len(sys.argv) > 1 else None)))  # noqa: T201 - a benchmark prints
