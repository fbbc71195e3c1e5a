"""A rig in closed form: a robot that moves along straight lines in smooth time, a tracker with white noise and scale, virtual time.

It implements the protocols honestly (what the tracker sees is where the robot is) and reads of a program only its variable poseCount.
Orders: 1 n: to calibration pose n. 2 0: .3 m along the work object's y and back. 8: stops by itself. 9: never ends.
"""

import re
import zlib
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from mitl.errors import RigError, UsageError
from mitl.paths import PosePath
from mitl.poses import pose_of, transform_of
from mitl.protocols import AveragedPoint, ExecutionState, LoggedEvent, Oracle, ProgrammedMove, Rig

X_BO = pose_of(RigidTransform.from_components([0.5, 0.0, 0.4], Rotation.from_euler("z", 45, degrees=True)))
X_FT = np.array([0.0, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0])
X_LB = RigidTransform.from_components([1.0, 0.5, -0.8], Rotation.from_euler("xyz", [90, 10, 30], degrees=True))
X_FM = RigidTransform.from_components([0.02, -0.03, 0.05], Rotation.from_euler("xyz", [5, 20, 100], degrees=True))
SCALE, RATE = 1.0055, 250.0
JUMP = np.array([0.004, -0.012, 0.005])
"""How far the tracker's frame jumps, m."""
HOME = np.array([0.0, 0.0, 0.2, 0.0, 1.0, 0.0, 0.0])
"""X_OT where the robot stands in the beginning: .2 m above the work object, tool down."""


@dataclass
class VirtualClock:
    time: float = 0.0

    def now(self):
        return self.time

    def wait(self, seconds):
        self.time += seconds


@dataclass
class Move:
    """A line from pose to pose (X_OT) with the smooth step 3 s^2 - 2 s^3."""

    start: np.ndarray
    end: np.ndarray
    begins: float
    ends: float

    def at(self, time):
        s = np.clip((np.asarray(time, dtype=float) - self.begins) / (self.ends - self.begins), 0.0, 1.0)
        share = (3 * s**2 - 2 * s**3)[..., None]
        turn = (transform_of(self.start).rotation.inv() * transform_of(self.end).rotation).as_rotvec()
        rotation = transform_of(self.start).rotation * Rotation.from_rotvec(share * turn)
        return RigidTransform.from_components(self.start[:3] + share * (self.end[:3] - self.start[:3]), rotation)


def calibration_pose(number):
    generator = np.random.default_rng(number)
    rotation = Rotation.from_quat(HOME[3:], scalar_first=True) * Rotation.from_rotvec(generator.uniform(-1.2, 1.2, 3))
    return pose_of(RigidTransform.from_components(generator.uniform([-0.2, -0.2, 0.0], [0.2, 0.2, 0.4]), rotation))


def moves_of(option, sub_option, start, now, offset=0.0):
    if option == 1:
        return [Move(start, calibration_pose(sub_option), now, now + 1.0)]
    if option == 2:
        there = HOME + np.array([0.0, 0.3 + offset, offset, 0.0, 0.0, 0.0, 0.0])
        return [Move(start, there, now, now + 2.0), Move(there, HOME, now + 2.0, now + 4.0)]
    return []


class LineRobot:
    def __init__(self, clock, offset):
        self.clock, self.offset = clock, offset
        self.reset()

    stops = 0

    def reset(self):
        self.moves = [Move(HOME, HOME, self.clock.now() - 1.0, self.clock.now())]
        self.done_at, self.failed, self.running, self.variables = 0.0, False, False, {}

    def truth(self, time):
        """X_OT at the times (N,)."""
        poses = np.empty((len(time), 7))
        upto = [move.begins for move in self.moves[1:]] + [np.inf]
        for move, since, until in zip(self.moves, [-np.inf, *upto], upto, strict=False):
            chosen = (time >= since) & (time < until)
            if chosen.any():
                poses[chosen] = pose_of(move.at(time[chosen]))
        return transform_of(poses)

    def load(self, sources):
        text = sources[0].read_text()
        found = re.search(r"poseCount\s*:=\s*(\d+)", text)
        self.variables = {"option": "0", "subOption": "0", "poseCount": found[1] if found else "0"}

    def start(self):
        self.running = True

    def stop(self):
        self.running = False
        self.stops += 1

    def state(self):
        self.read("option")
        return ExecutionState.RUNNING if self.running else ExecutionState.STOPPED

    def read(self, name):
        if name not in self.variables:
            raise RigError(f"no variable {name}")
        if self.variables["option"] == "8":
            self.running, self.failed = False, True
        if self.variables["option"] not in {"8", "9"} and self.clock.now() >= self.done_at:
            self.variables["option"] = "0"
        return self.variables[name]

    def write(self, name, literal):
        self.variables[name] = literal
        if name == "option" and self.running:
            start = pose_of(self.moves[-1].at(self.moves[-1].ends))
            self.moves += moves_of(int(literal), int(self.variables["subOption"]), start, self.clock.now(), self.offset)
            self.done_at = self.moves[-1].ends

    def read_signal(self, name):
        raise RigError(f"no signal {name}")

    def joints(self):
        return np.zeros(6)

    def flange(self):
        return pose_of(transform_of(X_BO) * self.truth(np.array([self.clock.now()]))[0] * transform_of(X_FT).inv())

    def set_motors(self, on):
        pass

    def set_speed_ratio(self, per_cent):
        pass

    def event_log(self):
        return [LoggedEvent(self.clock.now(), 40001, "error", "axis 3 out of range")] if self.failed else []


@dataclass
class WhiteTracker:
    clock: VirtualClock
    robot: LineRobot
    noise: float
    lost: bool = False
    jumps_at: float = np.inf
    generator: np.random.Generator = field(default_factory=lambda: np.random.default_rng(0))
    began: float | None = None

    def start(self):
        self.began = self.clock.now()

    def stop(self):
        found, self.began = self.path(), None
        return found

    def path(self):
        if self.began is None:
            raise RigError("the tracker was not started")
        return self._between(self.began, self.clock.now())

    def latest(self):
        return self._between(self.clock.now() - 1.5 / RATE, self.clock.now()).select(np.array([True]))

    def average(self, seconds):
        if self.lost:
            raise RigError("the tracker is lost")
        begins = self.clock.now()
        self.clock.wait(seconds)
        path = self._between(begins, self.clock.now())
        spread = np.linalg.norm(path.position[:, None] - path.position[None], axis=2).max()
        mean = Rotation.from_quat(path.quaternion_wxyz, scalar_first=True).mean().as_quat(scalar_first=True)
        return AveragedPoint(begins + seconds / 2, path.position.mean(axis=0), mean, float(spread), len(path))

    def _between(self, begins, ends):
        time = np.arange(np.ceil(begins * RATE), np.floor(ends * RATE)) / RATE
        X_LM = self.truth(time)
        position = (
            SCALE * X_LM.translation
            + np.where(time >= self.jumps_at, 1.0, 0.0)[:, None] * JUMP
            + self.generator.normal(0.0, self.noise, (len(time), 3))
        )
        rotation = X_LM.rotation * Rotation.from_rotvec(self.generator.normal(0.0, 1e-4, (len(time), 3)))
        return PosePath(time, position, rotation.as_quat(canonical=True, scalar_first=True), np.full(len(time), not self.lost))

    def truth(self, time):
        return X_LB * transform_of(X_BO) * self.robot.truth(time) * transform_of(X_FT).inv() * X_FM


class StandingTracker(WhiteTracker):
    """A second device that stands still in view."""

    def truth(self, time):
        return RigidTransform.from_components(np.tile([0.3, -0.2, 0.5], (len(time), 1)), Rotation.identity(len(time)))


class ClosedFormOracles:
    def oracle(self, sources, variables):  # noqa: ARG002 - knows the one program by heart
        moves = moves_of(int(variables["option"]), int(variables["subOption"]), HOME, 0.0)
        time = np.arange(0.0, moves[-1].ends if moves else 0.004, 1.0 / RATE)
        poses = np.empty((len(time), 7))
        poses[:] = HOME
        for move in moves:
            chosen = time >= move.begins
            poses[chosen] = pose_of(move.at(time[chosen]))
        path = PosePath(time, poses[:, :3], poses[:, 3:], np.full(len(time), True))
        programmed = tuple(ProgrammedMove("MoveL", m.start, None, m.end, 0.1, 0.0, "Line", 1, m.begins, m.ends) for m in moves)
        return Oracle(path, X_FT, X_BO, programmed)


def make_rig(seed=1, faults=(), noise=2e-4):
    """Gives the rig; faults: offset=MM, lost, unreachable (raises RigError), noisy, frame-jump=S after a case's beginning, no-reference."""
    offset, lost, jumps_at, watched = 0.0, False, np.inf, True
    for fault in faults:
        name, _, size = fault.partition("=")
        match name:
            case "offset":
                offset = float(size or 10.0) * 1e-3
            case "lost":
                lost = True
            case "unreachable":
                raise RigError("no controller answers at 192.0.2.1")
            case "frame-jump":
                jumps_at = float(size or 2.0)
            case "no-reference":
                watched = False
            case "noisy":
                noise = 3e-2
            case _:
                raise UsageError(f"unknown fault {name!r}")
    clock = VirtualClock()
    robot = LineRobot(clock, offset)
    tracker = WhiteTracker(clock, robot, noise)
    reference = StandingTracker(clock, robot, noise)

    def begin_case(case_id):
        clock.time = 0.0
        robot.reset()
        tracker.generator = np.random.default_rng([seed, zlib.crc32(case_id.encode())])
        reference.generator = np.random.default_rng([seed, zlib.crc32(case_id.encode()), 1])
        tracker.lost = lost and case_id != "calibration"
        tracker.jumps_at = reference.jumps_at = np.inf if case_id == "calibration" else jumps_at

    devices = {"reference": reference} if watched else {}
    return Rig("line", "none", seed, robot, tracker, clock, ClosedFormOracles(), begin_case, {"line_rig": "1"}, devices)
