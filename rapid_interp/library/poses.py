"""Positions, orientations and poses, in mm and degrees; quaternions w x y z.

Invariant: pure functions of tuples. Euler angles are ZYX: first about z, then the new y, then the new x.
"""

from __future__ import annotations

import math
from typing import TypeAlias

from rapid_interp.library.table import LibraryRoutine
from rapid_interp.meaning.types import Value
from rapid_interp.running.values import Fault

Vector: TypeAlias = tuple[float, float, float]
Quaternion: TypeAlias = tuple[float, float, float, float]
Frame: TypeAlias = tuple[Vector, Quaternion]


def multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    """Gives the product of two quaternions: first b, then a."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def rotate(rot: Quaternion, vector: Vector) -> Vector:
    """Gives a vector turned by a unit quaternion."""
    w, x, y, z = rot
    _, rx, ry, rz = multiply(multiply(rot, (0.0, *vector)), (w, -x, -y, -z))
    return rx, ry, rz


def normalised(rot: Quaternion) -> Quaternion:
    """Gives the unit quaternion of the same direction."""
    length = math.sqrt(sum(part * part for part in rot))
    if length < 1e-9:
        raise Fault("a quaternion of zeros is no orientation", "RAPID-R311")
    w, x, y, z = (part / length for part in rot)
    return w, x, y, z


def from_euler_zyx(z_deg: float, y_deg: float, x_deg: float) -> Quaternion:
    """Gives the quaternion of ZYX Euler angles in degrees."""
    half = [math.radians(angle) / 2 for angle in (z_deg, y_deg, x_deg)]
    turn_z = (math.cos(half[0]), 0.0, 0.0, math.sin(half[0]))
    turn_y = (math.cos(half[1]), 0.0, math.sin(half[1]), 0.0)
    turn_x = (math.cos(half[2]), math.sin(half[2]), 0.0, 0.0)
    return multiply(multiply(turn_z, turn_y), turn_x)


def _offs(target: Value, dx: float, dy: float, dz: float) -> Value:
    (x, y, z), *rest = target
    return ((x + dx, y + dy, z + dz), *rest)


def _rel_tool(target: Value, dx: float, dy: float, dz: float, rx: float | None, ry: float | None, rz: float | None) -> Value:
    """Displacement in the tool frame, then turns about its x, y, z axes in this order.

    ASSUMPTION A-34: each turn is about the axis as the turn before has left it.
    """
    trans, rot, *rest = target
    turn: Quaternion = (1.0, 0.0, 0.0, 0.0)
    for place, angle in enumerate((rx, ry, rz), start=1):
        if angle:
            half = math.radians(angle) / 2
            axis = [0.0, 0.0, 0.0, 0.0]
            axis[0], axis[place] = math.cos(half), math.sin(half)
            turn = multiply(turn, (axis[0], axis[1], axis[2], axis[3]))
    shift = rotate(normalised(rot), (dx, dy, dz))
    moved = tuple(a + b for a, b in zip(trans, shift, strict=True))
    return (moved, rot if turn == (1.0, 0.0, 0.0, 0.0) else multiply(rot, turn), *rest)


def pose_mult(first: Frame, second: Frame) -> Frame:
    """Gives the second frame, told in the first, in the frame around both."""
    return pose_vect(first, second[0]), multiply(first[1], second[1])


def pose_inv(pose: Frame) -> Frame:
    """Gives the frame around, told in this one."""
    w, x, y, z = pose[1]
    back = (w, -x, -y, -z)
    px, py, pz = rotate(back, pose[0])
    return (-px, -py, -pz), back


def pose_vect(pose: Frame, pos: Vector) -> Vector:
    """Gives a point of the frame in the frame around it."""
    x, y, z = rotate(pose[1], pos)
    tx, ty, tz = pose[0]
    return x + tx, y + ty, z + tz


def _euler_zyx(about_x: bool, about_y: bool, about_z: bool, rot: Quaternion) -> float:
    w, x, y, z = normalised(rot)
    if about_x:
        return math.degrees(math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)))
    if about_y:
        return math.degrees(math.asin(max(-1.0, min(1.0, 2 * (w * y - z * x)))))
    if about_z:
        return math.degrees(math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))
    raise Fault("EulerZYX needs \\X, \\Y or \\Z", "RAPID-R334")


def from_axes(x: Vector, y: Vector, z: Vector) -> Quaternion:
    """Gives the quaternion of the rotation with these unit axes as columns."""
    trace = x[0] + y[1] + z[2]
    largest = max(trace, x[0], y[1], z[2])  # dividing by the largest part keeps half turns exact
    if largest == trace:
        return normalised((1 + trace, y[2] - z[1], z[0] - x[2], x[1] - y[0]))
    if largest == x[0]:
        return normalised((y[2] - z[1], 1 + x[0] - y[1] - z[2], x[1] + y[0], z[0] + x[2]))
    if largest == y[1]:
        return normalised((z[0] - x[2], x[1] + y[0], 1 - x[0] + y[1] - z[2], y[2] + z[1]))
    return normalised((x[1] - y[0], z[0] + x[2], y[2] + z[1], 1 - x[0] - y[1] + z[2]))


def _def_frame(first: Vector, second: Vector, third: Vector, origin: float | None) -> Frame:
    r"""The x axis goes from the first to the second point, the third lies on the side of positive y.

    The origin is the first point, with `\Origin:=2` the second, with 3 the foot of the third on the x axis.
    """
    along, aside = _minus(second, first), _minus(third, first)
    normal = cross(along, aside)
    if magnitude(normal) < 1e-6:
        raise Fault("DefFrame needs three points that are not in a line", "RAPID-R335")
    x, z = _scaled(along, 1 / magnitude(along)), _scaled(normal, 1 / magnitude(normal))
    rot = from_axes(x, cross(z, x), z)
    if origin in (None, 1.0):
        return first, rot
    if origin == 2:
        return second, rot
    foot = _scaled(x, dot(aside, x))
    return (first[0] + foot[0], first[1] + foot[1], first[2] + foot[2]), rot


def _def_dframe(a: Vector, b: Vector, c: Vector, new_a: Vector, new_b: Vector, new_c: Vector) -> Frame:
    """The displacement that takes three points to three others."""
    return pose_mult(_def_frame(new_a, new_b, new_c, None), pose_inv(_def_frame(a, b, c, None)))


def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _scaled(a: Vector, factor: float) -> Vector:
    return a[0] * factor, a[1] * factor, a[2] * factor


def magnitude(vector: Vector) -> float:
    """Gives the length of a vector."""
    return math.sqrt(dot(vector, vector))


def dot(a: Vector, b: Vector) -> float:
    """Gives the scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Gives the vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _distance(a: Vector, b: Vector) -> float:
    return math.dist(a, b)


ROUTINES = (
    LibraryRoutine("FUNC robtarget Offs(robtarget Point, num XOffset, num YOffset, num ZOffset)", _offs),
    LibraryRoutine(r"FUNC robtarget RelTool(robtarget Point, num Dx, num Dy, num Dz \num Rx \num Ry \num Rz)", _rel_tool),
    LibraryRoutine("FUNC pose PoseMult(pose Pose1, pose Pose2)", pose_mult),
    LibraryRoutine("FUNC pose PoseInv(pose Pose)", pose_inv),
    LibraryRoutine("FUNC pos PoseVect(pose Pose, pos Pos)", pose_vect),
    LibraryRoutine("FUNC orient OrientZYX(num ZAngle, num YAngle, num XAngle)", from_euler_zyx),
    LibraryRoutine(r"FUNC num EulerZYX(\switch X | switch Y | switch Z, orient Rotation)", _euler_zyx),
    LibraryRoutine(r"FUNC pose DefFrame(pos NewP1, pos NewP2, pos NewP3 \num Origin)", _def_frame),
    LibraryRoutine("FUNC pose DefDFrame(pos OldP1, pos OldP2, pos OldP3, pos NewP1, pos NewP2, pos NewP3)", _def_dframe),
    LibraryRoutine("FUNC orient NOrient(orient Rotation)", normalised),
    LibraryRoutine("FUNC num VectMagn(pos Vector)", magnitude),
    LibraryRoutine("FUNC num DotProd(pos Vector1, pos Vector2)", dot),
    LibraryRoutine("FUNC pos CrossProd(pos Vector1, pos Vector2)", cross),
    LibraryRoutine("FUNC num Distance(pos Point1, pos Point2)", _distance),
)
