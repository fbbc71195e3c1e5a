"""The one bridge between RAPID's units and records (mm, deg) and mitl's arrays and transforms (m, rad)."""

from __future__ import annotations

from dataclasses import astuple

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from mitl.motion.kinematics import Configuration
from mitl.paths import FloatArray
from rapid_interp import data

MM = 1e-3


def rotation_of(rot: data.Orient) -> Rotation:
    """Gives the rotation of an `orient`; RAPID rounds quaternions, so it is normalised.

    Raises ValueError if its length is not 1 within a hundredth: such an orientation was never taught.
    """
    quaternion = np.array(astuple(rot))
    length = float(np.linalg.norm(quaternion))
    if not abs(length - 1) < 0.01:
        raise ValueError(f"orientation [{rot.q1:g},{rot.q2:g},{rot.q3:g},{rot.q4:g}] is not a unit quaternion (length {length:.4g})")
    return Rotation.from_quat(quaternion / length, scalar_first=True)


def transform_of(trans: data.Pos, rot: data.Orient) -> RigidTransform:
    """Gives a transform in m from a translation in mm and an orientation."""
    return RigidTransform.from_components(MM * np.array(astuple(trans)), rotation_of(rot))


def tool_frame(tool: data.ToolData) -> RigidTransform:
    """Gives X_FT of a `tooldata`."""
    return transform_of(tool.tframe.trans, tool.tframe.rot)


def work_object_frame(wobj: data.WObjData) -> RigidTransform:
    """Gives X_WO = X_WU X_UO of a `wobjdata`; the base frame is the world frame."""
    X_WU = transform_of(wobj.uframe.trans, wobj.uframe.rot)
    return X_WU * transform_of(wobj.oframe.trans, wobj.oframe.rot)


def target_frame(target: data.RobTarget) -> RigidTransform:
    """Gives X_OT of a `robtarget`."""
    return transform_of(target.trans, target.rot)


def displacement(pose: data.Pose) -> RigidTransform:
    """Gives X_OD of a program displacement: targets are in D."""
    return transform_of(pose.trans, pose.rot)


def joints_of(target: data.JointTarget) -> FloatArray:
    """Gives the joints (6,) in rad of a `jointtarget`."""
    return np.asarray(np.radians(np.array(astuple(target.robax))))


def configuration_of(target: data.RobTarget) -> Configuration:
    """Gives the configuration of a `robtarget`."""
    conf = target.robconf
    return Configuration(round(conf.cf1), round(conf.cf4), round(conf.cf6), round(conf.cfx))
