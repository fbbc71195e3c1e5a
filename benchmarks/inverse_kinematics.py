"""Prints how fast joints are found for the poses of a path, beside roboticstoolbox's C++ Levenberg-Marquardt where its Python is given.

Run: python benchmarks/inverse_kinematics.py [PYTHON_WITH_ROBOTICSTOOLBOX]. The IRB 140's flange follows a path of joints in 20,000 poses;
both sides get the same poses and begin each near the last. The other side's arm is put together from our URDF; it runs in a process of its
own, because it brings many packages along. Times are those of the processor; the path's own joints tell how exact both are.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from defusedxml import ElementTree

from mitl.motion.kinematics import Arm
from mitl.motion.robot_model import load_robot_model
from mitl.paths import FloatArray

COUNT = 20_000
THEIRS = 2_000
"""Poses that the other side gets: its solver is called pose by pose."""
TURNS = 5
_ROBOTICSTOOLBOX = """
import sys, time
import numpy as np
from roboticstoolbox import ET, ETS
data = np.load(sys.argv[1])
parts = []
for x, y, z, axis in data["links"]:
    parts += [ET.tx(x), ET.ty(y), ET.tz(z), (ET.Rx, ET.Ry, ET.Rz)[int(axis)]()]
x, y, z, pitch = data["flange"]
arm = ETS([*parts, ET.tx(x), ET.ty(y), ET.tz(z), ET.Ry(pitch)])
poses, q = data["poses"], data["near"]
far = np.abs(np.asarray(arm.fkine(data["first"])) - poses[0]).max()
found = np.empty((len(poses), 6))
begin = time.process_time()
for number, pose in enumerate(poses):
    solution = arm.ik_LM(pose, q0=q, tol=1e-12, joint_limits=False)
    q = solution.q
    if not solution.success:
        raise SystemExit(f"no joints found for pose {number}")
    found[number] = q
spent = time.process_time() - begin
off = found - data["joints"]
print(spent, np.abs(off - 2 * np.pi * np.round(off / (2 * np.pi))).max(), far)
"""


def way(count: int = COUNT) -> FloatArray:
    """Gives joints (N, 6) in rad of a smooth path through the middle of the arm's space, clear of the wrist's singularity."""
    t = np.linspace(0.0, 40.0, count)[:, None]
    rates = np.array([0.31, 0.43, 0.37, 0.53, 0.29, 0.61])
    return np.array([0.0, 0.2, 0.1, 0.3, 0.9, -0.2]) + np.array([0.8, 0.3, 0.3, 0.6, 0.4, 1.0]) * np.sin(rates * t)


def links(urdf: Path) -> tuple[FloatArray, FloatArray]:
    """Gives of each axis its origin in m and the number of its axis (6, 4), and of the flange x, y, z in m and pitch in rad (4,)."""
    joints = {joint.get("name"): joint for joint in ElementTree.parse(urdf).getroot().iter("joint") if joint.find("origin") is not None}

    def words(name: str, tag: str, attribute: str) -> list[float]:
        return [float(word) for word in joints[name].find(tag).get(attribute).split()]

    rows = [[*words(f"joint_{n}", "origin", "xyz"), float(np.argmax(words(f"joint_{n}", "axis", "xyz")))] for n in range(1, 7)]
    flange = [*words("joint_6-flange", "origin", "xyz"), words("joint_6-flange", "origin", "rpy")[1]]
    return np.array(rows), np.array(flange)


def ours(arm: Arm, position: FloatArray, R_BF: FloatArray, near: FloatArray) -> tuple[float, FloatArray]:
    """Gives the seconds, best of some turns, and the joints (N, 6)."""
    best, found = np.inf, np.empty(0)
    for _ in range(TURNS):
        begin = time.process_time()
        found = arm.joints_of_flange(position, R_BF, near)
        best = min(best, time.process_time() - begin)
    return best, found


def roboticstoolbox(python: str, arm: Arm, between: FloatArray, poses: FloatArray) -> tuple[float, float]:
    """Gives the other side's seconds for poses (N, 4, 4) and its greatest error in rad against the links' own angles (N, 6)."""
    chain, flange = links(arm.model.urdf)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "poses.npz"
        np.savez(file, links=chain, flange=flange, poses=poses, joints=between, near=between[0] + 0.01, first=between[0])
        words = subprocess.run(  # noqa: S603 - as told by the user
            [python, "-c", _ROBOTICSTOOLBOX, str(file)], check=True, stdout=subprocess.PIPE, text=True
        ).stdout.split()
    spent, off, far = (float(word) for word in words)
    if far > 1e-9:
        raise RuntimeError(f"the other side's arm is not ours: its first pose is {far:.1e} off")
    return spent, off


def table(python: str | None) -> list[str]:
    """Gives the benchmark's lines."""
    arm = Arm(load_robot_model("irb140"))
    q = way()
    position, R_BF = arm.flange_places(q)
    seconds, found = ours(arm, position, R_BF, q[0] + 0.01)
    per_pose = seconds / COUNT
    lines = [f"mitl: {1e6 * per_pose:.2f} us a pose of {COUNT:,}, joints within {np.abs(found - q).max():.1e} rad"]
    if python is not None:
        poses = np.tile(np.eye(4), (THEIRS, 1, 1))
        poses[:, :3, :3], poses[:, :3, 3] = R_BF[:: COUNT // THEIRS], position[:: COUNT // THEIRS]
        spent, off = roboticstoolbox(python, arm, arm.model.between_links(q[:: COUNT // THEIRS]), poses)
        ratio = spent / THEIRS / per_pose
        lines.append(
            f"roboticstoolbox: {1e6 * spent / THEIRS:.2f} us a pose of {THEIRS:,}, {ratio:.0f} times as long, joints within {off:.1e} rad"
        )
    return lines


if __name__ == "__main__":
    print("\n".join(table(sys.argv[1] if len(sys.argv) > 1 else None)))  # noqa: T201 - a benchmark prints
