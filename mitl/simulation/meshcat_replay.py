"""A replay in Drake's Meshcat: the robot's motion as an animation with a time slider in the browser, paths as coloured lines.

Positions are in the base frame, which is Meshcat's world. Nothing here knows where the arrays come from.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.geometry import Cylinder, Meshcat, MeshcatParams, MeshcatVisualizer, Rgba, SceneGraph, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, MultibodyPlant
from pydrake.systems.framework import DiagramBuilder

from mitl.errors import UsageError
from mitl.paths import FloatArray
from mitl.simulation.cell import Cell

Colour = tuple[float, float, float]
_TOOL = (0.42, 0.29, 0.77, 1.0)


@dataclass(frozen=True, eq=False)
class Curve:
    """A line: points (N, 3) m, width in pixels, colour of 0 to 1."""

    name: str
    points: FloatArray
    width: float
    colour: Colour


@dataclass(frozen=True, eq=False)
class Marker:
    """A ball that moves: positions (N, 3) m at the replay's times; where they are nan it stays."""

    name: str
    positions: FloatArray
    radius: float
    colour: Colour


@dataclass(frozen=True, eq=False)
class Animation:
    """What is replayed. time: (N,) s from 0. joints: (N, 6) rad between the links, of the robot in `urdf`. tool: (3,) m in the flange.

    cell: what stands around the robot, whose base is the world.
    """

    time: FloatArray
    curves: Sequence[Curve]
    markers: Sequence[Marker]
    urdf: Path | None = None
    joints: FloatArray | None = None
    tool: FloatArray | None = None
    cell: Cell | None = None


def open_meshcat(port: int | None) -> Meshcat:
    """Gives a Meshcat server on this machine. Raises UsageError where the port is taken."""
    logging.getLogger("drake").setLevel(logging.WARNING)
    try:
        return Meshcat(MeshcatParams(host="localhost", port=port))
    except RuntimeError as error:
        raise UsageError(f"Meshcat cannot listen{'' if port is None else f' on port {port}'}: {error}") from error


def publish(meshcat: Meshcat, animation: Animation) -> None:
    """Shows an animation; the browser's controls play it and move its time."""
    middle = np.nanmean(np.vstack([curve.points for curve in animation.curves]), axis=0) if animation.curves else np.zeros(3)
    meshcat.SetCameraPose(_array(0.6 * middle + np.array([1.1, -1.3, 0.8])), _array(0.6 * middle))
    for curve in animation.curves:
        meshcat.SetLine(f"paths/{curve.name}", _array(curve.points.T), curve.width, Rgba(*curve.colour, 1.0))
    for marker in animation.markers:
        meshcat.SetObject(f"markers/{marker.name}", Sphere(marker.radius), Rgba(*marker.colour, 1.0))
    builder = DiagramBuilder()
    plant, scene = AddMultibodyPlantSceneGraph(builder, 0.0)
    if animation.urdf is not None and animation.joints is not None:
        _add_robot(plant, scene, animation)
    if animation.cell is not None:
        animation.cell.add_to(plant)
    plant.Finalize()
    visualizer = MeshcatVisualizer.AddToBuilder(builder, scene, meshcat)
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    plant_context = plant.GetMyMutableContextFromRoot(context)
    visualizer.StartRecording(False)
    for index, time in enumerate(animation.time.tolist()):
        context.SetTime(time)
        if plant.num_positions() and animation.joints is not None:
            plant.SetPositions(plant_context, animation.joints[index])
        diagram.ForcedPublish(context)
        for marker in animation.markers:
            if np.isfinite(marker.positions[index]).all():
                meshcat.SetTransform(f"markers/{marker.name}", RigidTransform(_array(marker.positions[index])), time)
    visualizer.StopRecording()
    visualizer.PublishRecording()


def _add_robot(plant: MultibodyPlant, scene: SceneGraph, animation: Animation) -> None:
    assert animation.urdf is not None  # noqa: S101 - the caller asked
    parser = Parser(plant, scene)
    parser.AddModels(animation.urdf)
    base = plant.GetBodyByName("base_link")
    plant.WeldFrames(plant.world_frame(), base.body_frame())
    length = 0.0 if animation.tool is None else float(np.linalg.norm(animation.tool))
    if animation.tool is None or length < 1e-3:
        return
    turn = Quaternion(_array(_turn_from_z(animation.tool / length)))
    X_FG = RigidTransform(turn, _array(animation.tool / 2.0))
    flange = plant.GetBodyByName("flange")
    plant.RegisterVisualGeometry(flange, X_FG, Cylinder(0.008, length), "tool", _array(np.array(_TOOL)))


def _array(values: FloatArray) -> Any:  # noqa: ANN401 - Drake's stubs give numpy's shape where its dtype belongs
    return np.asfortranarray(values)


def _turn_from_z(direction: FloatArray) -> FloatArray:
    """Gives the quaternion (4,) wxyz that turns z onto a unit direction (3,)."""
    w = 1.0 + float(direction[2])
    if w < 1e-9:
        return np.array([0.0, 1.0, 0.0, 0.0])
    quaternion = np.array([w, -direction[1], direction[0], 0.0])
    return np.asarray(quaternion / np.linalg.norm(quaternion))
