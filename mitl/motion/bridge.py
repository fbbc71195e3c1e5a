"""The one bridge between RAPID's units and records (mm, deg) and mitl's arrays and transforms (m, rad)."""

from __future__ import annotations

import math
from dataclasses import astuple
from functools import lru_cache

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from mitl.motion.kinematics import Configuration
from mitl.paths import FloatArray
from rapid_interp import data

MM = 1e-3


@lru_cache(maxsize=256)
def rotation_of(rot: data.Orient) -> Rotation:
    """Gives the rotation of an `orient`; RAPID rounds quaternions, so it is normalised.

    Raises ValueError if its length is not 1 within a hundredth: such an orientation was never taught.
    """
    quaternion = np.array([rot.q1, rot.q2, rot.q3, rot.q4])
    length = math.sqrt(float(quaternion @ quaternion))
    if not abs(length - 1) < 0.01:
        raise ValueError(f"orientation [{rot.q1:g},{rot.q2:g},{rot.q3:g},{rot.q4:g}] is not a unit quaternion (length {length:.4g})")
    return Rotation.from_quat(quaternion / length, scalar_first=True)


def transform_of(trans: data.Pos, rot: data.Orient) -> RigidTransform:
    """Gives a transform in m from a translation in mm and an orientation."""
    return RigidTransform.from_components([MM * trans.x, MM * trans.y, MM * trans.z], rotation_of(rot))


@lru_cache(maxsize=256)
def frame_of(pose: data.Pose) -> RigidTransform:
    """Gives the transform in m of a `pose` that many moves have in common."""
    return transform_of(pose.trans, pose.rot)


@lru_cache(maxsize=256)
def _user_and_object(uframe: data.Pose, oframe: data.Pose) -> RigidTransform:
    return frame_of(uframe) * frame_of(oframe)


def tool_frame(tool: data.ToolData) -> RigidTransform:
    """Gives X_FT of a `tooldata`."""
    return frame_of(tool.tframe)


def work_object_frame(wobj: data.WObjData) -> RigidTransform:
    """Gives X_WO = X_WU X_UO of a `wobjdata`; the base frame is the world frame."""
    return _user_and_object(wobj.uframe, wobj.oframe)


def target_frame(target: data.RobTarget) -> RigidTransform:
    """Gives X_OT of a `robtarget`."""
    return transform_of(target.trans, target.rot)


def displacement(pose: data.Pose) -> RigidTransform:
    """Gives X_OD of a program displacement: targets are in D."""
    return frame_of(pose)


@lru_cache(maxsize=256)
def displaced_frame(uframe: data.Pose, oframe: data.Pose, moved: data.Pose) -> RigidTransform:
    """Gives X_WD: the frame of a displaced work object, in which targets are."""
    return _user_and_object(uframe, oframe) * displacement(moved)


def joints_of(target: data.JointTarget) -> FloatArray:
    """Gives the joints (6,) in rad of a `jointtarget`."""
    return np.asarray(np.radians(np.array(astuple(target.robax))))


def configuration_of(target: data.RobTarget) -> Configuration:
    """Gives the configuration of a `robtarget`."""
    conf = target.robconf
    return Configuration(round(conf.cf1), round(conf.cf4), round(conf.cf6), round(conf.cfx))
