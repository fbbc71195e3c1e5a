"""Frames, axes and tools computed from measured points.

Invariant: nothing moves; tools that the robot holds ask the controller for the pose of its flange (`SolveForward`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import cast

from rapid_interp import effects as fx
from rapid_interp.data import JointTarget, RobTarget, ToolData, WObjData
from rapid_interp.effects import SourceLine
from rapid_interp.library.matrices import Matrix, decomposed, fitted_circle, least_squares, told
from rapid_interp.library.poses import (
    Frame,
    Quaternion,
    Vector,
    cross,
    dot,
    from_axes,
    magnitude,
    normalised,
    pose_inv,
    pose_mult,
    pose_vect,
    rotate,
)
from rapid_interp.library.table import Effects, LibraryRoutine, record_told
from rapid_interp.meaning.predefined import DATA
from rapid_interp.meaning.types import Value
from rapid_interp.running.values import Fault, Reference, error_number, to_record

_TOOL0, _WOBJ0 = DATA["tool0"][2], DATA["wobj0"][2]


def _wrong(message: str) -> Fault:
    return Fault(message, "RAPID-R339", number=error_number("ERR_ARGVALERR"))


def _mean(points: Sequence[Vector]) -> Vector:
    count = len(points)
    return (math.fsum(p[0] for p in points) / count, math.fsum(p[1] for p in points) / count, math.fsum(p[2] for p in points) / count)


def _def_acc_frame(first: Value, second: Value, count: float, most: Reference, mean: Reference) -> Frame:
    """The frame that takes the second list of targets to the first, with the least squares of distances."""
    number = int(count)
    if not 3 <= number <= min(len(first), len(second)):
        raise _wrong(f"DefAccFrame needs 3 to {min(len(first), len(second))} targets, found {number}")
    a, b = [target[0] for target in first[:number]], [target[0] for target in second[:number]]
    middle_a, middle_b = _mean(a), _mean(b)
    rot = _turn_of_points([_minus(p, middle_b) for p in b], [_minus(p, middle_a) for p in a])
    frame: Frame = (_minus(middle_a, rotate(rot, middle_b)), rot)
    told(lambda: [math.dist(p, pose_vect(frame, q)) for p, q in zip(a, b, strict=True)], most, mean)
    return frame


def _turn_of_points(before: Sequence[Vector], after: Sequence[Vector]) -> Quaternion:
    """Gives the rotation that takes vectors to others best (Horn 1987: the quaternion is the eigenvector of the largest eigenvalue)."""
    s = [[math.fsum(p[i] * q[j] for p, q in zip(before, after, strict=True)) for j in range(3)] for i in range(3)]
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = s
    form = [
        [xx + yy + zz, yz - zy, zx - xz, xy - yx],
        [yz - zy, xx - yy - zz, xy + yx, zx + xz],
        [zx - xz, xy + yx, yy - xx - zz, yz + zy],
        [xy - yx, zx + xz, yz + zy, zz - xx - yy],
    ]
    shift = sum(abs(value) for row in form for value in row)  # makes all eigenvalues positive, so that they are the singular values
    w, x, y, z = decomposed(tuple(tuple(value + shift * (i == j) for j, value in enumerate(row)) for i, row in enumerate(form)))[2][0]
    return normalised((w, x, y, z) if w >= 0 else (-w, -x, -y, -z))


def _axis_frame(targets: Value, count: float, positive_z: Vector | None, most: Reference, mean: Reference) -> Frame:
    """The frame of an axis that turned a point to these places: origin in the middle, z along the axis, x to the first point."""
    points = [target[0] for target in targets[: int(count)]]
    centre, radius, normal = fitted_circle(points)
    upwards = cross(_minus(points[0], centre), _minus(points[1], centre)) if positive_z is None else _minus(positive_z, centre)
    if dot(normal, upwards) < 0:
        normal = (-normal[0], -normal[1], -normal[2])
    away = _minus(points[0], centre)
    height = dot(away, normal)
    x = _unit((away[0] - height * normal[0], away[1] - height * normal[1], away[2] - height * normal[2]))
    told(lambda: [abs(math.dist(point, centre) - radius) for point in points], most, mean)
    return centre, from_axes(x, cross(normal, x), normal)


def _axis_of_unit(_unit: str, _axis: Value, targets: Value, count: float, most: Reference, mean: Reference) -> Frame:
    return _axis_frame(targets, count, None, most, mean)


def _mirrored(point: Value, plane: Value, about_y: bool) -> Value:
    r"""The point mirrored in the xy plane of a frame told in the point's own; with `\MirY` about y instead of x.

    ASSUMPTION A-172: the mirrored tool's z axis is the mirror image, its x axis too (`\MirY`: its y axis); the third makes it right-handed.
    """
    trans, rot, *rest = point
    w, x, y, z = plane[1]
    back = (w, -x, -y, -z)

    def mirror(vector: Vector) -> Vector:
        a, b, c = rotate(back, vector)
        return rotate(plane[1], (a, b, -c))

    offset = mirror(_minus(trans, plane[0]))
    axes = [mirror(rotate(normalised(rot), axis)) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
    if about_y:
        axes[0] = cross(axes[1], axes[2])
    else:
        axes[1] = cross(axes[2], axes[0])
    place = (plane[0][0] + offset[0], plane[0][1] + offset[1], plane[0][2] + offset[2])
    return (place, from_axes(axes[0], axes[1], axes[2]), *rest)


def _mir_pos(point: Value, plane: Value, wobj: Value, about_y: bool) -> Value:
    frame = pose_mult(plane[3], plane[4])
    if wobj is not None:
        outer = pose_mult(wobj[3], wobj[4])
        frame = pose_mult(pose_inv(outer), frame)
    return _mirrored(point, frame, about_y)


def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _unit(vector: Vector) -> Vector:
    length = magnitude(vector)
    if length < 1e-9:
        raise _wrong("two of the points are at the same place")
    return vector[0] / length, vector[1] / length, vector[2] / length


# ---------------------------------------------------------------- tools


def _tip(flanges: Sequence[Frame]) -> tuple[Vector, Vector]:
    """Gives the tip in the flange frame and the point that it touched: R_i t + p_i = c for every flange pose, by least squares."""
    rows: list[tuple[float, ...]] = []
    right: list[float] = []
    for trans, rot in flanges:
        columns = [rotate(rot, axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
        for place in range(3):
            fixed = [0.0, 0.0, 0.0]
            fixed[place] = -1.0
            rows.append((columns[0][place], columns[1][place], columns[2][place], *fixed))
            right.append(-trans[place])
    found = least_squares(cast(Matrix, tuple(rows)), right)
    return (found[0], found[1], found[2]), (found[3], found[4], found[5])


def _flange(at: SourceLine, joints: Value) -> Effects:
    tool = cast(ToolData, to_record("tooldata", _TOOL0))
    wobj = cast(WObjData, to_record("wobjdata", _WOBJ0))
    question = fx.SolveForward(at, cast(JointTarget, to_record("jointtarget", joints)), tool, wobj)
    target = record_told((yield question), RobTarget, "position")
    return target[0], normalised(target[1])


def _with_frame(tool: Value, frame: Frame) -> Value:
    return (tool[0], frame, *tool[2:])


def _tool_tip(at: SourceLine, *given: Value) -> Effects:
    """The tip touched one point from all four positions of the axes."""
    joints, (tool, most, mean) = given[:4], given[4:]
    flanges = []
    for target in joints:
        flanges.append((yield from _flange(at, target)))
    tip, point = _tip(flanges)
    tool.put(_with_frame(tool.get(), (tip, tool.get()[1][1])))
    told(lambda: [math.dist(point, pose_vect(flange, tip)) for flange in flanges], most, mean)


def _tool_axes(at: SourceLine, tip: Value, on_z: Value, on_x: Value, tool: Reference) -> Effects:
    """From the tip, the second position lies on the tool's z axis, the third, if given, on the positive side of x."""
    points: list[Frame] = []
    for joints in (tip, on_z) if on_x is None else (tip, on_z, on_x):
        points.append((yield from _flange(at, joints)))
    old = tool.get()[1]
    tips = [pose_vect(flange, old[0]) for flange in points]
    back = pose_inv(points[0])[1]
    # the tip went along z of the tool as it was held at first: what it moved by is that axis in the flange frame
    z = _unit(rotate(back, _minus(tips[1], tips[0])))
    x = rotate(back, _minus(tips[2], tips[0])) if on_x is not None else _least_along(z)
    tool.put(_with_frame(tool.get(), (old[0], _axes(z, x))))


def _axes(z: Vector, towards: Vector) -> Value:
    y = _unit(cross(z, towards))
    return from_axes(cross(y, z), y, z)


def _least_along(z: Vector) -> Vector:
    """ASSUMPTION A-173: without a point for x, the tool's x axis is as near to the flange's x axis as it can be."""
    return (1.0, 0.0, 0.0) if abs(z[0]) < 0.9 else (0.0, 1.0, 0.0)


def _fixed_tip(*given: Value) -> None:
    """A tool that stands: the robot held a point of its flange to the tip at four targets given with tool0."""
    targets, (tool, most, mean) = given[:4], given[4:]
    flanges = [(target[0], normalised(target[1])) for target in targets]
    held, point = _tip(flanges)
    tool.put(_with_frame(tool.get(), (point, tool.get()[1][1])))
    told(lambda: [math.dist(point, pose_vect(flange, held)) for flange in flanges], most, mean)


def _fixed_axes(tip: Value, on_z: Value, on_x: Value, tool: Reference) -> None:
    z = _unit(_minus(on_z[0], tip[0]))
    tool.put(_with_frame(tool.get(), (tool.get()[1][0], _axes(z, _minus(on_x[0], tip[0])))))


_ERRORS = "INOUT num MaxErr, INOUT num MeanErr"
_FOUR = "{kind} Pos1, {kind} Pos2, {kind} Pos3, {kind} Pos4"
ROUTINES = (
    LibraryRoutine(
        f"FUNC pose DefAccFrame(robtarget TargetListOne{{*}}, robtarget TargetListTwo{{*}}, num TargetsInList, {_ERRORS})", _def_acc_frame
    ),
    LibraryRoutine(f"FUNC pose CalcRotAxFrameZ(robtarget TargetList{{*}}, num TargetsInList, pos PositiveZPoint, {_ERRORS})", _axis_frame),
    LibraryRoutine(
        rf"FUNC pose CalcRotAxisFrame(mecunit MechUnit \num AxisNo, robtarget TargetList{{*}}, num TargetsInList, {_ERRORS})", _axis_of_unit
    ),
    LibraryRoutine(r"FUNC robtarget MirPos(robtarget Point, wobjdata MirPlane \wobjdata WObj \switch MirY)", _mir_pos),
    LibraryRoutine(f"PROC MToolTCPCalib({_FOUR.format(kind='jointtarget')}, INOUT tooldata Tool, {_ERRORS})", _tool_tip, True),
    LibraryRoutine(r"PROC MToolRotCalib(jointtarget RefTip, jointtarget ZPos \jointtarget XPos, INOUT tooldata Tool)", _tool_axes, True),
    LibraryRoutine(f"PROC SToolTCPCalib({_FOUR.format(kind='robtarget')}, INOUT tooldata Tool, {_ERRORS})", _fixed_tip),
    LibraryRoutine("PROC SToolRotCalib(robtarget RefTip, robtarget ZPos, robtarget XPos, INOUT tooldata Tool)", _fixed_axes),
)
