"""Runs a RAPID program without a rig, and samples what it did: the oracle.

Invariant: nothing here depends on wall time; the same program gives the same numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import RigidTransform, Rotation

from mitl.motion import bridge
from mitl.motion.answers import Desk
from mitl.motion.chain import Planner
from mitl.motion.conveyor import Belt, Conveyor
from mitl.motion.following import ConveyorUnits, Following
from mitl.motion.kinematics import Arm
from mitl.motion.program_run import ProgramRun, joints_home
from mitl.motion.record import TICK, ExecutedMove, MotionRecord, View
from mitl.motion.robot_model import RobotModel
from mitl.motion.signals import InputChange
from mitl.paths import FloatArray, IndexArray, PosePath
from mitl.poses import pose_of
from mitl.protocols import ProgrammedMove
from rapid_interp import effects


class Frame(Enum):
    """The frame in which a path is expressed; mitl's world is the robot's base."""

    WORLD = "world"
    WORK_OBJECT = "wobj"
    BASE = "base"


@dataclass(frozen=True, eq=False)
class Samples:
    """A motion at N times: path of the active TCP, speed (N,) m/s, joints (N, 6) rad, index (N,) of the executed move."""

    path: PosePath
    speed: FloatArray
    joints: FloatArray
    move: IndexArray


def start_run(
    generator: Generator[effects.Effect, effects.Reply, None],
    model: RobotModel,
    *,
    inputs: Sequence[InputChange] = (),
    planner: Planner | None = None,
    answers: Sequence[str] = (),
    conveyors: Sequence[Conveyor] = (),
) -> ProgramRun:
    """Gives a program run from the robot's rest position at time 0, not yet begun.

    planner: another than the model's ordinary one. answers: what the operator will answer, in order. conveyors: belts, at home.
    """
    desk, record = Desk(answers=list(answers)), MotionRecord(model, joints_home())
    units = ConveyorUnits([Belt(conveyor) for conveyor in conveyors], horizon=record.half_filter)
    return ProgramRun(generator, planner or Planner(model), record, inputs=inputs, desk=desk, units=units)


def run_until(
    run: ProgramRun, time: float, done: Callable[[float], bool] = lambda _: False, progress: Callable[[float], None] | None = None
) -> float:
    """Lets a program run until it ends, `done` says so, or its next event lies at or after `time` s; gives the time in s it got to."""
    now = 0.0
    while (following := run.next_event()) < time and not done(following):
        now = following
        run.run(now)
        if progress is not None:
            progress(now)
    return now


def duration_of(run: ProgramRun) -> float:
    """Gives the time in s at which motion and program have ended, as far as the program has run."""
    outputs = [change[0] for changes in run.signals.values() for change in changes]
    return max([run.record.end, run.ended, *outputs])


def path_length(run: ProgramRun, view: View, until: float) -> float:
    """Gives the way in m of the active TCP up to `until` s, by ticks; a change of tool is no way."""
    ticks: FloatArray = TICK * np.arange(int(np.ceil(min(until, run.record.end) / TICK)) + 1, dtype=np.float64)
    if not run.record.moves or len(ticks) < 2:
        return 0.0
    X_BF = run.planner.arm.flange(run.record.joints(np.minimum(ticks, until), view))
    tools = RigidTransform.concatenate([executed.move.leg.X_FT for executed in run.record.moves])[run.record.move_at(ticks[:-1])]
    steps = (X_BF[1:] * tools).translation - (X_BF[:-1] * tools).translation
    return float(np.linalg.norm(steps, axis=1).sum())


def sample(run: ProgramRun, times: FloatArray, view: View, frame: Frame) -> Samples:
    """Gives what a run did at ascending times (N,) in s.

    Planned positions, orientations and speeds are exact; the other views come from joints at ticks of `record.TICK`.
    """
    record = run.record
    move = record.move_at(times)
    joints = record.joints(times, view)
    if view is View.PLANNED and record.chains:
        position, rotation, speed = record.planned_tcp(times)
    else:
        position, rotation = _tcp(run, joints, move)
        speed = _speeds(run, times, view)
    if frame is Frame.WORK_OBJECT and record.moves:
        beside = RigidTransform.from_components(position - _object_ways(record.moves, move, times), rotation)
        X_OT = RigidTransform.concatenate([executed.move.X_BO for executed in record.moves])[move].inv() * beside
        position, rotation = X_OT.translation, X_OT.rotation
    return Samples(_path(times, position, rotation), speed, joints, move)


def fixed_tool_path(
    run: ProgramRun, times: FloatArray, X_FT: RigidTransform, X_BO: RigidTransform, following: Following | None = None
) -> PosePath:
    """Gives X_OT of one tool in one work object over ascending times (N,) in s, whichever are active; the tool view.

    following: by which a conveyor carries the work object; X_BO is its place at the sensor then.
    """
    X_BT = run.planner.arm.flange(run.record.joints(times, View.TOOL)) * X_FT
    if following is not None:
        connection = following.connection
        X_BT = RigidTransform.from_translation(-connection.passed(times)[:, None] * connection.belt.conveyor.direction) * X_BT
    X_OT = X_BO.inv() * X_BT
    return _path(times, X_OT.translation, X_OT.rotation)


def _object_ways(moves: Sequence[ExecutedMove], move: IndexArray, times: FloatArray) -> FloatArray:
    """Gives how far (N, 3) in m the work objects of the moves under way (N,) have been carried past their sensors, in the base."""
    ways = np.zeros((len(times), 3))
    for number in np.unique(move):
        following = moves[number].move.following
        if following is not None and following.end > 0:
            connection, here = following.connection, move == number
            ways[here] = connection.passed(times[here])[:, None] * connection.belt.conveyor.direction
    return ways


def programmed_moves(run: ProgramRun, moves: Sequence[ExecutedMove], origin: float) -> tuple[ProgrammedMove, ...]:
    """Gives executed moves as programmed, in their work objects, with times counted from `origin` s."""
    return tuple(_programmed(run.planner.arm, executed, origin) for executed in moves)


def _programmed(arm: Arm, executed: ExecutedMove, origin: float) -> ProgrammedMove:
    move = executed.move
    effect, leg = move.effect, move.leg
    X_OB = move.X_BO.inv()
    if move.following is not None and move.following.end > 0:  # the leg lies where the work object was connected
        connection = move.following.connection
        X_OB = X_OB * RigidTransform.from_translation(-connection.begin * connection.belt.conveyor.direction)
    return ProgrammedMove(
        kind=type(effect).__name__,
        start=pose_of(X_OB * arm.flange(leg.q_start) * leg.X_FT),
        via=pose_of(bridge.target_frame(effect.via)) if isinstance(effect, effects.MoveC) else None,
        end=pose_of(X_OB * arm.flange(leg.q_end) * leg.X_FT),
        tcp_speed=move.speed.tcp if move.speed.duration is None else leg.travel / move.speed.duration,
        zone=move.zone.radius,
        module=effect.at.module,
        line=effect.at.line,
        begins=executed.begins - origin,
        ends=executed.ends - origin,
    )


def _path(times: FloatArray, position: FloatArray, rotation: Rotation) -> PosePath:
    quaternion = rotation.as_quat(canonical=True, scalar_first=True)
    return PosePath(times, position, _continuous(quaternion), np.ones(len(times), dtype=bool))


def _tips(run: ProgramRun, joints: FloatArray, tool: IndexArray) -> tuple[FloatArray, FloatArray]:
    """Gives positions (N, 3) m and rotations (N, 3, 3) in the base frame of the tools of moves (N,), for joints (N, 6)."""
    position, R_BF = run.planner.arm.flange_places(joints)
    if not run.record.moves:
        return position, R_BF
    used, of_place = np.unique(tool, return_inverse=True)
    X_FT = np.stack([run.record.moves[index].move.leg.X_FT.as_matrix() for index in used])[of_place]
    return position + np.einsum("nij,nj->ni", R_BF, X_FT[:, :3, 3]), R_BF @ X_FT[:, :3, :3]


def _tcp(run: ProgramRun, joints: FloatArray, move: IndexArray) -> tuple[FloatArray, Rotation]:
    """Gives positions (N, 3) m and rotations of the active TCP in the base frame for joints (N, 6)."""
    tool_of = run.record.tool_indices()
    position, R_BT = _tips(run, joints, tool_of[move] if len(tool_of) else move)
    return position, Rotation.from_matrix(R_BT)


def _speeds(run: ProgramRun, times: FloatArray, view: View) -> FloatArray:
    """Gives TCP speeds (N,) m/s: the derivative of a spline through the TCP at ticks, tool by tool."""
    last = max(float(times[-1]), run.record.end) if len(times) else 0.0
    tick = np.arange(-2, int(np.ceil(last / TICK)) + 3)
    joints = run.record.joints_of_ticks(tick, view)
    speed: FloatArray = np.zeros(len(times))
    tool_of = run.record.tool_indices()
    active = tool_of[run.record.move_at(times)] if len(tool_of) else np.zeros(len(times), dtype=np.intp)
    for tool in np.unique(active):
        position, _ = _tips(run, joints, np.full(len(tick), tool))
        velocity = CubicSpline(TICK * tick, position)(times, 1)
        speed[active == tool] = np.linalg.norm(velocity[active == tool], axis=1)
    return speed


def _continuous(quaternion: FloatArray) -> FloatArray:
    """Gives quaternions (N, 4) with signs chosen so that neighbours lie on the same side; qw of the first is not negative."""
    flips = np.sum(quaternion[1:] * quaternion[:-1], axis=1) < 0
    signs = np.concatenate([[1.0], np.where(np.cumsum(flips) % 2, -1.0, 1.0)])
    return np.asarray(quaternion * signs[:, None])
