"""The thesis's path file (3.2.2.2, StoreAsXml): a Path of Points with time stamp, position, orientation, speeds and input.

ASSUMPTION A-100: the thesis shows no such file. Its API is in C#, whose serializer writes a member as an element of its name: Path >
Points > Point > TimeStamp (ms), Position > X Y Z (mm), Orientation > X Y Z W, Input (buttons as bits). Reading also takes attributes
instead of elements, any case of names, and the units that the root's attributes TimeUnit (s, ms) and LengthUnit (m, mm) name.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree.ElementTree import ParseError

import numpy as np
from defusedxml.common import DefusedXmlException  # type: ignore[import-untyped] # ships no types
from defusedxml.ElementTree import fromstring  # type: ignore[import-untyped] # ships no types

from mitl.errors import UsageError
from mitl.paths import FloatArray, PosePath
from mitl.recording.atomic import replacing
from mitl.recording.tum import checked_path
from mitl.samples import TrackerSamples, TrackingResult

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

_TIME = {"s": 1.0, "ms": 1e-3}
_LENGTH = {"m": 1.0, "mm": 1e-3}


def write_thesis_xml(path: Path, samples: TrackerSamples) -> None:
    """Writes the valid samples. Raises UsageError where the file cannot be written."""
    chosen = samples.select(samples.path.valid)
    poses = chosen.path
    lines = ['<?xml version="1.0" encoding="utf-8"?>', '<Path TimeUnit="ms" LengthUnit="mm">', "  <Points>"]
    speed = np.nan_to_num(chosen.velocity)
    for time, p, q, v, bits in zip(
        (poses.time * 1e3).tolist(),
        (poses.position * 1e3).tolist(),
        poses.quaternion_wxyz.tolist(),
        (speed * 1e3).tolist(),
        chosen.buttons.tolist(),
        strict=True,
    ):
        lines.append(
            f"    <Point><TimeStamp>{time:.6f}</TimeStamp>{_vector('Position', p, 'XYZ')}"
            f"{_vector('Orientation', [*q[1:], q[0]], 'XYZW')}{_vector('Speed', v, 'XYZ')}<Input>{bits}</Input></Point>"
        )
    lines += ["  </Points>", "</Path>"]
    with replacing(path) as beside:
        beside.write_text("\n".join(lines) + "\n", encoding="utf-8")


def read_thesis_xml(path: Path) -> TrackerSamples:
    """Reads a path file; without speeds, velocities are not a number. Raises UsageError naming the file and the point."""
    try:
        root = fromstring(path.read_bytes())
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (ParseError, DefusedXmlException, ValueError) as error:
        raise UsageError(f"{path}: not an XML file that can be read: {error}") from error
    if _name(root) != "path":
        raise UsageError(f"{path}: expected a root element Path, got {root.tag}")
    time_unit, length_unit = (_attribute(root, name, default) for name, default in (("timeunit", "ms"), ("lengthunit", "mm")))
    if time_unit not in _TIME or length_unit not in _LENGTH:
        raise UsageError(f"{path}: expected TimeUnit s or ms and LengthUnit m or mm, got {time_unit!r} and {length_unit!r}")
    points = [element for element in root.iter() if _name(element) == "point"]
    if not points:
        raise UsageError(f"{path}: no Point in this file")
    rows = np.array([_row(path, number, point) for number, point in enumerate(points, start=1)])
    quaternion = np.concatenate([rows[:, 7:8], rows[:, 4:7]], axis=1)
    numbers = np.arange(1, len(rows) + 1)
    poses: PosePath = checked_path(path, numbers, rows[:, 0] * _TIME[time_unit], rows[:, 1:4] * _LENGTH[length_unit], quaternion)
    result = np.full(len(rows), TrackingResult.RUNNING_OK, dtype=np.int16)
    velocity: FloatArray = rows[:, 8:11] * _LENGTH[length_unit]
    return TrackerSamples(poses, result, rows[:, 11].astype(np.int16), velocity)


def _vector(name: str, values: list[float], axes: str) -> str:
    return f"<{name}>" + "".join(f"<{axis}>{value:.12g}</{axis}>" for axis, value in zip(axes, values, strict=True)) + f"</{name}>"


def _row(path: Path, number: int, point: Element) -> list[float]:
    def part(owner: Element | None, name: str, default: str | None = None) -> float:
        text = default if owner is None else _text(owner, name, default)
        if text is None:
            raise UsageError(f"{path}: point {number}: {name} is missing")
        try:
            return float(text)
        except ValueError as error:
            raise UsageError(f"{path}: point {number}: {name}: expected a number, got {text!r}") from error

    position, orientation, speed = (_child(point, name) for name in ("position", "orientation", "speed"))
    return [
        part(point, "timestamp"),
        *(part(position, axis) for axis in "xyz"),
        *(part(orientation, axis) for axis in "xyzw"),
        *(part(speed, axis, "nan") for axis in "xyz"),
        part(point, "input", "0"),
    ]


def _name(element: Element) -> str:
    return str(element.tag).rpartition("}")[2].lower()


def _child(element: Element, name: str) -> Element | None:
    return next((child for child in element if _name(child) == name), None)


def _attribute(element: Element, name: str, default: str | None) -> str | None:
    return next((value for key, value in element.attrib.items() if key.lower() == name), default)


def _text(element: Element, name: str, default: str | None) -> str | None:
    child = _child(element, name)
    return child.text if child is not None else _attribute(element, name, default)
