"""EGM's datagrams as frozen records: decoded and encoded by protobuf, from a schema that is made here.

The schema has a file, a package and a pool of its own, because two libraries in one process that both register ABB's "egm.proto" clash
(facts: rig); on the wire it is ABB's `abb.egm`. Source of the field numbers: RobotWare's egm.proto as abb_libegm and abbegm-rs carry it.
Invariant: what is decoded is finite and has six axes, whatever the network sends.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from google.protobuf import descriptor_pb2, descriptor_pool, message, message_factory

from mitl.errors import MitlError
from mitl.paths import FloatArray

FILE, PACKAGE = "mitl/egm_wire.proto", "mitl.egm"
LARGEST = 4096
"""Bytes of the largest datagram that is looked at; the controller's have some three hundred."""
AXES = 6
_DATA = 2
"""Header.mtype: sent by the controller."""
_ON, _RUNNING = 1, 2
_Field = descriptor_pb2.FieldDescriptorProto
_KINDS = {"double": _Field.TYPE_DOUBLE, "uint32": _Field.TYPE_UINT32, "uint64": _Field.TYPE_UINT64, "bool": _Field.TYPE_BOOL}
# ABB's enumerations are plain numbers here: the same varint on the wire. "*" repeated and not packed, as proto2 has it; "!" required.
_MESSAGES: dict[str, tuple[tuple[int, str, str], ...]] = {
    "Header": ((1, "seqno", "uint32"), (2, "tm", "uint32"), (3, "mtype", "uint32")),
    "Cartesian": ((1, "x", "double!"), (2, "y", "double!"), (3, "z", "double!")),
    "Quaternion": ((1, "u0", "double!"), (2, "u1", "double!"), (3, "u2", "double!"), (4, "u3", "double!")),
    "Euler": ((1, "x", "double!"), (2, "y", "double!"), (3, "z", "double!")),
    "Clock": ((1, "sec", "uint64!"), (2, "usec", "uint64!")),
    "Pose": ((1, "pos", "Cartesian"), (2, "orient", "Quaternion"), (3, "euler", "Euler")),
    "Joints": ((1, "joints", "double*"),),
    "View": ((1, "joints", "Joints"), (2, "cartesian", "Pose"), (3, "externalJoints", "Joints"), (4, "time", "Clock")),
    "State": ((1, "state", "uint32!"),),
    "Numbers": ((1, "values", "double*"),),
    "Robot": (
        (1, "header", "Header"),
        (2, "feedBack", "View"),
        (3, "planned", "View"),
        (4, "motorState", "State"),
        (5, "mciState", "State"),
        (6, "mciConvergenceMet", "bool"),
        (7, "testSignals", "Numbers"),
        (8, "rapidExecState", "State"),
        (9, "measuredForce", "Numbers"),
        (10, "utilizationRate", "double"),
    ),
}


class MalformedFeedbackError(MitlError):
    """A datagram that is none of EGM's feedback."""


@dataclass(frozen=True, eq=False)
class Feedback:
    """One datagram. sequence: the controller's number; time: s on the controller's clock. joints, planned: (6,) rad.

    pose: (7,) m, qw qx qy qz, as the controller reports its cartesian position. planned is joints where the controller sent none.
    """

    sequence: int
    time: float
    joints: FloatArray
    planned: FloatArray
    pose: FloatArray
    motors_on: bool
    running: bool


def schema() -> descriptor_pb2.FileDescriptorProto:
    """Gives the schema."""
    file = descriptor_pb2.FileDescriptorProto(name=FILE, package=PACKAGE, syntax="proto2")
    for name, fields in _MESSAGES.items():
        made = file.message_type.add(name=name)
        for number, field, kind in fields:
            plain = kind.rstrip("*!")
            label = {"*": _Field.LABEL_REPEATED, "!": _Field.LABEL_REQUIRED}.get(kind[-1], _Field.LABEL_OPTIONAL)
            if plain in _KINDS:
                made.field.add(name=field, number=number, label=label, type=_KINDS[plain])
            else:
                made.field.add(name=field, number=number, label=label, type=_Field.TYPE_MESSAGE, type_name=f".{PACKAGE}.{plain}")
    return file


def _robot_class() -> Any:  # noqa: ANN401 - a class that protobuf makes at run time
    pool = descriptor_pool.DescriptorPool()
    pool.Add(schema())
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(f"{PACKAGE}.Robot"))


_Robot = _robot_class()


def encode(feedback: Feedback) -> bytes:
    """Gives the datagram as a controller sends it."""
    made = _Robot()
    made.header.seqno, made.header.tm, made.header.mtype = feedback.sequence, round(feedback.time * 1e3) & 0xFFFFFFFF, _DATA
    micros = round(feedback.time * 1e6)
    for view, joints in ((made.feedBack, feedback.joints), (made.planned, feedback.planned)):
        view.joints.joints.extend(np.degrees(joints).tolist())
        view.time.sec, view.time.usec = divmod(micros, 1_000_000)
    place, turn = made.feedBack.cartesian.pos, made.feedBack.cartesian.orient
    place.x, place.y, place.z = (1000.0 * feedback.pose[:3]).tolist()
    turn.u0, turn.u1, turn.u2, turn.u3 = feedback.pose[3:].tolist()
    made.motorState.state = _ON if feedback.motors_on else 2
    made.mciState.state = 2  # stopped: nothing guides it
    made.mciConvergenceMet = False
    made.rapidExecState.state = _RUNNING if feedback.running else 1
    return bytes(made.SerializeToString())


def decode(datagram: bytes) -> Feedback:
    """Gives what a datagram tells. Raises MalformedFeedbackError."""
    if len(datagram) > LARGEST:
        raise MalformedFeedbackError(f"a datagram of {len(datagram)} bytes or more, expected at most {LARGEST}")
    made = _Robot()
    try:
        made.ParseFromString(datagram)
    except message.DecodeError as error:
        raise MalformedFeedbackError(f"no EgmRobot: {error}") from error
    view = made.feedBack
    joints = _joints(view)
    if joints is None or not made.header.HasField("seqno"):
        raise MalformedFeedbackError(f"expected a number and {AXES} axes, got {len(view.joints.joints)} axes")
    planned = _joints(made.planned)
    place, turn = view.cartesian.pos, view.cartesian.orient
    pose = np.array([place.x / 1e3, place.y / 1e3, place.z / 1e3, turn.u0, turn.u1, turn.u2, turn.u3])
    if not view.HasField("cartesian"):
        pose[:] = math.nan
    elif not np.all(np.isfinite(pose)):
        raise MalformedFeedbackError("a position that is no number")
    # ASSUMPTION A-351: where the controller stamps no feedback (before RobotWare 6.10), the header's milliseconds are its clock
    time = view.time.sec + view.time.usec * 1e-6 if view.HasField("time") else made.header.tm * 1e-3
    return Feedback(
        made.header.seqno,
        float(time),
        joints,
        joints if planned is None else planned,
        pose,
        made.motorState.state == _ON,
        made.rapidExecState.state == _RUNNING,
    )


def _joints(view: Any) -> FloatArray | None:  # noqa: ANN401 - see above
    """Gives the axes (6,) in rad. ASSUMPTION A-352: a seven-axis arm is none that mitl knows."""
    values = np.radians(np.array(view.joints.joints, dtype=np.float64))
    return values if values.shape == (AXES,) and np.all(np.isfinite(values)) else None
