"""The arm as a Drake system with one output port, `X_WF`: the pose of the flange in the world, (7,) x y z qw qx qy qz.

Invariant: whoever reads the port cannot know how the arm moves; a dynamic arm is another system with the same port.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import BasicVector, Context, LeafSystem, System

from mitl.errors import UsageError
from mitl.paths import FloatArray
from mitl.poses import transform_of
from mitl.simulation.process import JointSource

ArmFactory = Callable[[Path, JointSource, FloatArray], System]


@runtime_checkable
class SettlingArm(Protocol):
    """An arm with a state of its own, which the world puts to rest before time begins or goes on from elsewhere."""

    def settle(self, root: Context) -> None:
        """Puts the arm at rest where its joint source is at the time of the whole diagram's context."""
        ...


def kinematic_arm(urdf: Path, joint_source: JointSource, X_WB: FloatArray) -> KinematicArm:
    """Gives an arm that is at every instant where the joint source says: no dynamics, no servo."""
    return KinematicArm(urdf, joint_source, X_WB)


class KinematicArm(LeafSystem):
    """Outputs `X_WF` (7,) for the joint angles that a source gives for the context's time; the URDF's base stands at X_WB."""

    def __init__(self, urdf: Path, joint_source: JointSource, X_WB: FloatArray) -> None:
        super().__init__()
        self.set_name("kinematic_arm")
        self._joint_source = joint_source
        self._plant = load_plant(urdf, X_WB)
        self._plant_context = self._plant.CreateDefaultContext()
        self._flange = self._plant.GetBodyByName("flange")
        self._known: tuple[bytes, FloatArray] = (b"", np.zeros(7))
        self.DeclareVectorOutputPort("X_WF", 7, self._calc_pose)

    def _calc_pose(self, context: Context, output: BasicVector) -> None:
        joints = np.asarray(self._joint_source.joints_at(context.get_time()))
        key = joints.tobytes()
        if key != self._known[0]:  # at rest, which an arm mostly is, the pose is known
            self._plant.SetPositions(self._plant_context, for_drake(joints))
            X_WF = self._plant.EvalBodyPoseInWorld(self._plant_context, self._flange)
            self._known = key, np.concatenate([X_WF.translation(), X_WF.rotation().ToQuaternion().wxyz()])
        output.SetFromVector(for_drake(self._known[1]))


class PoseSource(LeafSystem):
    """Outputs the pose (7,) that a function gives for the context's time."""

    def __init__(self, pose: Callable[[float], FloatArray]) -> None:
        super().__init__()
        self._pose = pose
        self.DeclareVectorOutputPort("X_WM", 7, self._calc_pose)

    def _calc_pose(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(for_drake(self._pose(context.get_time())))


def load_plant(urdf: Path, X_WB: FloatArray) -> MultibodyPlant:
    """Gives a finalized plant of the robot with `base_link` welded at X_WB. UsageError where the file cannot be read."""
    plant = MultibodyPlant(time_step=0.0)
    try:
        Parser(plant).AddModels(urdf)
    except RuntimeError as error:
        raise UsageError(f"{urdf}: cannot read robot model: {error}") from error
    base = RigidTransform(for_drake(transform_of(X_WB).as_matrix()))
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base_link"), base)
    plant.Finalize()
    return plant


def for_drake(array: object) -> Any:  # noqa: ANN401 - that is its purpose
    """Gives the same array without its type: the stubs of pydrake 1.51 call arrays ndarray[float64, dtype[Any]], which no array is."""
    return array
