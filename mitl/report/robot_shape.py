"""A robot's shape for the replay: links, joints and simple visuals out of its URDF, as JSON values.

Invariant: a joint's frame is its origin in the frame of the one before it; the chain ends at the flange.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import ParseError

from defusedxml.common import DefusedXmlException  # type: ignore[import-untyped] # ships no types
from defusedxml.ElementTree import fromstring  # type: ignore[import-untyped] # ships no types
from scipy.spatial.transform import Rotation

from mitl.errors import UsageError

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

_GREY = [0.7, 0.7, 0.7]


def robot_shape(urdf: Path) -> list[dict[str, Any]]:
    """Gives the links from the base to the end of the chain.

    Each: "origin" of its joint as [x, y, z, qx, qy, qz, qw] in m, "axis" (None: fixed), "visuals" with "kind" (box, cylinder, sphere),
    "size" in m, "origin" and "colour" (r, g, b of 0 to 1). Raises UsageError where the file is no URDF with one chain.
    """
    try:
        root = fromstring(urdf.read_bytes())
        links = {link.get("name", ""): link for link in root.findall("link")}
        after = {_name(joint, "parent"): joint for joint in root.findall("joint") if joint.find("parent") is not None}
        children = {_name(joint, "child") for joint in after.values()}
        colours = {material.get("name", ""): _colour(material) for material in root.findall("material")}
        (at,) = [name for name in links if name not in children]
        chain = [{"origin": _origin(None), "axis": None, "visuals": _visuals(links[at], colours)}]
        while at in after:
            joint = after.pop(at)
            at = _name(joint, "child")
            axis = joint.find("axis")
            moves = joint.get("type") in {"revolute", "continuous"}
            chain.append(
                {
                    "origin": _origin(joint.find("origin")),
                    "axis": _numbers(axis, "xyz", "1 0 0") if moves else None,
                    "visuals": _visuals(links[at], colours),
                }
            )
    except OSError as error:
        raise UsageError(f"{urdf}: cannot be read: {error.strerror or error}") from error
    except (ParseError, DefusedXmlException, ValueError, KeyError) as error:
        raise UsageError(f"{urdf}: not a robot description with one chain of links: {error}") from error
    return chain


def _visuals(link: Element, colours: dict[str, list[float]]) -> list[dict[str, Any]]:
    found = []
    for visual in link.findall("visual"):
        geometry = visual.find("geometry")
        shape = None if geometry is None else next(iter(geometry), None)
        if shape is None or shape.tag not in {"box", "cylinder", "sphere"}:
            continue  # a mesh of one's own robot: its frame and the other shapes are still drawn
        size = _numbers(shape, "size", "") if shape.tag == "box" else [float(shape.get("radius", "")), float(shape.get("length", "0"))]
        material = visual.find("material")
        colour = _GREY if material is None else colours.get(material.get("name", ""), _colour(material))
        found.append({"kind": shape.tag, "size": size, "origin": _origin(visual.find("origin")), "colour": colour})
    return found


def _name(joint: Element, end: str) -> str:
    element = joint.find(end)
    return "" if element is None else element.get("link", "")


def _origin(element: Element | None) -> list[float]:
    xyz, rpy = _numbers(element, "xyz", "0 0 0"), _numbers(element, "rpy", "0 0 0")
    return [*xyz, *(float(value) for value in Rotation.from_euler("xyz", rpy).as_quat())]


def _numbers(element: Element | None, attribute: str, default: str) -> list[float]:
    values = [float(word) for word in (default if element is None else element.get(attribute, default)).split()]
    if len(values) != 3:
        raise ValueError(f"expected three numbers in {attribute}, got {values}")
    return values


def _colour(material: Element) -> list[float]:
    colour = material.find("color")
    return _GREY if colour is None else [float(word) for word in colour.get("rgba", "0.7 0.7 0.7 1").split()[:3]]
