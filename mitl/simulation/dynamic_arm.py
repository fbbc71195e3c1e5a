"""The arm with dynamics: MultibodyPlant with gravity, inverse-dynamics servo, torque and speed limits, tracker on a compliant mount.

Invariant: `X_WF` is where the flange would have to be for a rigid mount to put the tracker where it is: its vibration and sag reach the
sensor, and whoever reads the port cannot tell (arm.py).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import DiscreteContactApproximation, MultibodyPlant
from pydrake.systems.controllers import InverseDynamicsController
from pydrake.systems.framework import Context, Diagram, DiagramBuilder, DiscreteValues, EventStatus, LeafSystem
from pydrake.systems.primitives import Demultiplexer, Saturation
from scipy.linalg import expm

from mitl.errors import UsageError
from mitl.paths import FloatArray
from mitl.poses import transform_of
from mitl.simulation.arm import ArmFactory, for_drake
from mitl.simulation.process import JointSource

STEP = 0.004
"""Time step of plant, servo and mount in s. The mount is linear and its step exact, so that 25 Hz need no finer one."""
# ASSUMPTION A-104: the servo's bandwidth, 12 Hz critically damped. What a real servo leaves of the plan is in the executed trajectory
# already (motion.toml, [executed]), which this one is told to follow, with its acceleration.
_BANDWIDTH = 2.0 * math.pi * 12.0
_AHEAD = STEP
"""The servo takes a step to follow, so the reference looks so far ahead. A stop may thus begin 4 ms late."""
_GRAVITY = np.array([0.0, 0.0, -9.81])


@dataclass(frozen=True)
class Mount:
    """What holds the tracker: natural frequencies in Hz of shifts and turns, share of critical damping.

    ASSUMPTION A-103: a Vive controller of .2 kg on 3 mm of felt under rubber bands (thesis 3.3) swings at 25 Hz, turns at 30 Hz and
    loses it within some periods. No measurement is known; the thesis only says that vibration disturbed the tracker. It is light
    against the arm, so that the arm does not feel it; its centre of mass is where it is held, so that it does not tilt of itself.
    """

    frequency: float = 25.0
    turning_frequency: float = 30.0
    damping: float = 0.15


def dynamic_arm(X_FM: FloatArray, mount: Mount | None = None) -> ArmFactory:
    """Gives a factory of arms with dynamics whose tracker sits at X_FM (7,) on a mount."""

    def make(urdf: Path, joint_source: JointSource, X_WB: FloatArray) -> DynamicArm:
        return DynamicArm(urdf, joint_source, X_WB, X_FM, mount or Mount())

    return make


class DynamicArm(Diagram):
    """The diagram of reference, servo, plant and mount. Output `X_WF` (7,). `settle` puts it at rest where the reference is."""

    def __init__(self, urdf: Path, joint_source: JointSource, X_WB: FloatArray, X_FM: FloatArray, mount: Mount) -> None:
        super().__init__()
        builder = DiagramBuilder()
        self._plant = _arm(urdf, X_WB)
        stiffness, damping = (for_drake(np.full(6, gain)) for gain in (_BANDWIDTH**2, 2.0 * _BANDWIDTH))
        servo = InverseDynamicsController(_arm(urdf, X_WB), stiffness, for_drake(np.zeros(6)), damping, has_reference_acceleration=True)
        self._reference = Reference(joint_source, np.asarray(self._plant.GetVelocityUpperLimits(), dtype=np.float64))
        effort: FloatArray = np.asarray(self._plant.GetEffortUpperLimits(), dtype=np.float64)
        limit = Saturation(for_drake(-effort), for_drake(effort))
        self._mounted = MountedTracker(int(self._plant.GetBodyByName("flange").index()), X_FM, mount)
        split, seen = Demultiplexer(output_ports_sizes=[12, 6]), Demultiplexer(output_ports_sizes=[7, 25])
        for system in (self._plant, servo, self._reference, limit, self._mounted, split, seen):
            builder.AddSystem(system)
        builder.Connect(self._reference.get_output_port(), split.get_input_port())
        builder.Connect(split.get_output_port(0), servo.get_input_port_desired_state())
        builder.Connect(split.get_output_port(1), servo.get_input_port_desired_acceleration())
        builder.Connect(self._plant.get_state_output_port(), servo.get_input_port_estimated_state())
        builder.Connect(servo.get_output_port_generalized_force(), limit.get_input_port())
        builder.Connect(limit.get_output_port(), self._plant.get_actuation_input_port())
        builder.Connect(self._plant.GetOutputPort("body_poses"), self._mounted.get_input_port())
        builder.Connect(self._mounted.get_output_port(), seen.get_input_port())
        builder.ExportOutput(seen.get_output_port(0), "X_WF")
        builder.BuildInto(self)
        self.set_name("dynamic_arm")

    def settle(self, root: Context) -> None:
        """Puts arm and tracker at rest where the reference is at the time of the whole diagram's context."""
        q = self._reference.settle(self._reference.GetMyMutableContextFromRoot(root))
        plant = self._plant.GetMyMutableContextFromRoot(root)
        self._plant.SetPositionsAndVelocities(plant, for_drake(np.concatenate([q, np.zeros(6)])))
        self._mounted.settle(self._mounted.GetMyMutableContextFromRoot(root))


class Reference(LeafSystem):
    """Joint angles of a source, no faster than the limits, every STEP. Output `q_v_a` (18,): rad, rad/s, rad/s^2."""

    def __init__(self, joint_source: JointSource, speed_limit: FloatArray) -> None:
        super().__init__()
        self.set_name("reference")
        self._joint_source = joint_source
        self._most = np.asarray(speed_limit) * STEP
        state = self.DeclareDiscreteState(18)  # q, v, a
        self.DeclareStateOutputPort("q_v_a", state)
        self.DeclarePeriodicDiscreteUpdateEvent(STEP, 0.0, self._update)

    def settle(self, context: Context) -> FloatArray:
        """Puts the reference at rest; gives its joints (6,)."""
        q = np.asarray(self._joint_source.joints_at(context.get_time()))
        context.SetDiscreteState(for_drake(np.concatenate([q, np.zeros(12)])))
        return q

    def _update(self, context: Context, state: DiscreteValues) -> EventStatus:
        before = context.get_discrete_state_vector().value()
        wanted = self._joint_source.joints_at(context.get_time() + _AHEAD)
        step = np.minimum(np.maximum(wanted - before[:6], -self._most), self._most)
        velocity = step / STEP
        state.set_value(for_drake(np.concatenate([before[:6] + step, velocity, (velocity - before[6:12]) / STEP])))
        return EventStatus.Succeeded()


class MountedTracker(LeafSystem):
    """The tracker on its spring and damper. Input: the plant's body poses. Output `state` (32,): its first 7 are X_WM X_FM^-1.

    Shift u in W and turn w in F of the tracker against its place: u'' = g - a - 2 d W u' - W^2 u with the place's acceleration a, and
    alike for the turn with the flange's angular acceleration. Exact for accelerations that are constant over a step.
    """

    def __init__(self, flange: int, X_FM: FloatArray, mount: Mount) -> None:
        super().__init__()
        self.set_name("mounted_tracker")
        self._flange = flange
        self._p_FM: FloatArray = np.asarray(X_FM[:3], dtype=np.float64)
        self._sag = _GRAVITY / (2.0 * math.pi * mount.frequency) ** 2
        steps = [_exact(2.0 * math.pi * frequency, mount.damping) for frequency in (mount.frequency, mount.turning_frequency)]
        # rows of (x, x', f), columns of three shifts and three turns: how x and x' go on from x, x' and the force
        self._to_x, self._to_rate = (np.repeat(np.array([step[row] for step in steps]).T, 3, axis=1) for row in (0, 1))
        self._poses = self.DeclareAbstractInputPort("poses", Value([RigidTransform()]))
        # seen pose (7); shift and turn (6), their rates (6); velocity of the place and angular velocity (6); place (3), quaternion (4)
        state = self.DeclareDiscreteState(32)
        self.DeclareStateOutputPort("state", state)
        self.DeclarePeriodicDiscreteUpdateEvent(STEP, 0.0, self._update)

    def settle(self, context: Context) -> None:
        """Puts the tracker at rest, sagging."""
        R_WF, place, quaternion = self._pose(context)
        rest = np.zeros(32)
        rest[7:10] = self._sag
        rest[25:28], rest[28:32] = place, quaternion
        rest[:7] = self._seen(R_WF, place, quaternion, rest[7:13])
        context.SetDiscreteState(for_drake(rest))

    def _update(self, context: Context, state: DiscreteValues) -> EventStatus:
        old: FloatArray = np.asarray(context.get_discrete_state_vector().value(), dtype=np.float64)
        R_WF, place, quaternion = self._pose(context)
        new = np.empty(32)
        new[25:28], new[28:32] = place, quaternion
        new[19:22] = (place - old[25:28]) / STEP
        new[22:25] = _turn(old[28:32], quaternion) / STEP
        force = (old[19:25] - new[19:25]) / STEP
        force[2] += _GRAVITY[2]
        offset, rate = old[7:13], old[13:19]
        new[7:13] = self._to_x[0] * offset + self._to_x[1] * rate + self._to_x[2] * force
        new[13:19] = self._to_rate[0] * offset + self._to_rate[1] * rate + self._to_rate[2] * force
        new[:7] = self._seen(R_WF, place, quaternion, new[7:13])
        state.set_value(for_drake(new))
        return EventStatus.Succeeded()

    def _pose(self, context: Context) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Gives the plant's R_WF (3, 3), the tracker's place in W (3,), and R_WF as a quaternion (4,)."""
        poses: Any = self._poses.Eval(context)  # a list; pydrake calls abstract values objects
        rotation = poses[self._flange].rotation()
        R_WF: FloatArray = rotation.matrix()
        return R_WF, poses[self._flange].translation() + R_WF @ self._p_FM, rotation.ToQuaternion().wxyz()

    def _seen(self, R_WF: FloatArray, place: FloatArray, q: FloatArray, offset: FloatArray) -> FloatArray:
        """Gives X_WM X_FM^-1 (7,): X_WF turned by the small `offset[3:]` about the place and shifted by `offset[:3]`."""
        x, y, z = 0.5 * offset[3:]
        w, a, b, c = q
        turned = np.array([w - a * x - b * y - c * z, a + w * x + b * z - c * y, b + w * y + c * x - a * z, c + w * z + a * y - b * x])
        # the flange is seen where the turned lever leads back to: R (1 + [w]) p_MF from the place
        lever = self._p_FM
        wx, wy, wz = offset[3:]
        swept = np.array([wy * lever[2] - wz * lever[1], wz * lever[0] - wx * lever[2], wx * lever[1] - wy * lever[0]])
        return np.concatenate([place + offset[:3] - R_WF @ (lever + swept), turned / math.sqrt(turned @ turned)])


def _exact(frequency: float, damping: float) -> FloatArray:
    """Gives the matrix (2, 3) of one step of x'' = f - 2 d W x' - W^2 x: (x, x') from (x, x', f) for a constant f."""
    system = np.array([[0.0, 1.0, 0.0], [-(frequency**2), -2.0 * damping * frequency, 1.0], [0.0, 0.0, 0.0]])
    return np.asarray(expm(system * STEP)[:2])


def _turn(from_wxyz: FloatArray, to_wxyz: FloatArray) -> FloatArray:
    """Gives the small rotation vector (3,) in the body's axes from one unit quaternion to another, to first order."""
    w, v, s, u = from_wxyz[0], from_wxyz[1:], to_wxyz[0], to_wxyz[1:]
    real = w * s + v @ u
    imaginary = w * u - s * v - np.array([v[1] * u[2] - v[2] * u[1], v[2] * u[0] - v[0] * u[2], v[0] * u[1] - v[1] * u[0]])
    return np.asarray(imaginary * math.copysign(2.0, real))


def _arm(urdf: Path, X_WB: FloatArray) -> MultibodyPlant:
    """Gives a finalized plant of the robot, its base welded at X_WB. UsageError where it cannot be read or has no motors."""
    plant = MultibodyPlant(STEP)
    plant.set_discrete_contact_approximation(DiscreteContactApproximation.kTamsi)
    try:
        Parser(plant).AddModels(urdf)
    except RuntimeError as error:
        raise UsageError(f"{urdf}: cannot read robot model: {error}") from error
    base = RigidTransform(for_drake(transform_of(X_WB).as_matrix()))
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base_link"), base)
    plant.Finalize()
    if plant.num_actuators() != plant.num_positions():
        raise UsageError(f"{urdf}: {plant.num_actuators()} motors for {plant.num_positions()} joints: give every joint a transmission")
    return plant
