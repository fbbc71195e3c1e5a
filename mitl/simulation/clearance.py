"""How far an arm with its tool is from itself and from its cell, by Drake's SceneGraph.

Invariant: two links that share a joint are not compared, nor is what is welded together: the angle of one joint alone decides how they
stand to each other, and the axis limits keep them apart. Every other pair is.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydrake.geometry import Capsule, GeometryId, SceneGraphInspector, Sphere
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import DiagramBuilder

from mitl.errors import UsageError
from mitl.paths import FloatArray
from mitl.simulation.arm import for_drake
from mitl.simulation.cell import Cell

TOOL_RADIUS = 0.02
"""Radius in m of the capsule that stands for a tool, from the flange to its tip; slimmer for tools shorter than 80 mm. ASSUMPTION A-156."""
_TOOL = "tool"


@dataclass(frozen=True)
class Gap:
    """The distance in m between two bodies, negative if they overlap.

    with_cell: whether one of them is the cell's. within_wrist: whether both belong to links 4 to 6 or the tool, which are always close.
    """

    distance: float
    bodies: tuple[str, str]
    with_cell: bool
    within_wrist: bool


@dataclass(frozen=True)
class _Body:
    name: str
    of_cell: bool
    of_wrist: bool


class Clearance:
    """An arm in its cell with one tool: the tip p_FT (3,) m stands for a capsule from the flange, unless a model of the tool is given."""

    def __init__(self, urdf: Path, p_FT: FloatArray, *, cell: Cell | None = None, tool: Path | None = None) -> None:
        builder = DiagramBuilder()
        self._plant, self._scene_graph = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
        plant = self._plant
        (robot,) = Parser(plant).AddModels(urdf)
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base_link", robot))
        if tool is None:
            self._add_capsule(p_FT)
        tools = [] if tool is None else self._add_tool(tool)
        instances = set() if cell is None else set(cell.add_to(plant))
        plant.Finalize()
        self._robot = robot
        diagram = builder.Build()
        self._context = diagram.CreateDefaultContext()
        self._plant_context = plant.GetMyMutableContextFromRoot(self._context)
        self._scene_context = self._scene_graph.GetMyContextFromRoot(self._context)
        self._of_cell = {int(body) for instance in instances for body in plant.GetBodyIndices(instance)}
        wrist = [plant.GetBodyByName(name, robot).index() for name in ("link_4", "link_5", "link_6", "flange")]
        self._of_wrist = {int(body) for body in (*wrist, *(body for instance in tools for body in plant.GetBodyIndices(instance)))}
        self._known: dict[GeometryId, _Body] = {}

    def gaps(self, q: FloatArray, within: float) -> list[Gap]:
        """Gives the gaps of less than `within` m at angles (6,) rad between the links, one a pair of bodies, the smallest first."""
        self._plant.SetPositions(self._plant_context, self._robot, for_drake(q))
        query = self._scene_graph.get_query_output_port().Eval(self._scene_context)
        inspector = query.inspector()
        found: dict[tuple[str, str], Gap] = {}
        for pair in query.ComputeSignedDistancePairwiseClosestPoints(within):
            a, b = sorted(
                (self._body(inspector, geometry) for geometry in (pair.id_A, pair.id_B)), key=lambda body: (body.of_cell, body.name)
            )
            gap = Gap(float(pair.distance), (a.name, b.name), a.of_cell or b.of_cell, a.of_wrist and b.of_wrist)
            if gap.bodies not in found or gap.distance < found[gap.bodies].distance:
                found[gap.bodies] = gap
        return sorted(found.values(), key=lambda gap: gap.distance)

    def _body(self, inspector: SceneGraphInspector, geometry: GeometryId) -> _Body:
        if geometry not in self._known:
            body = self._plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))
            tool = inspector.GetName(geometry).endswith(f"::{_TOOL}")
            index = int(body.index())
            self._known[geometry] = _Body(_TOOL if tool else body.name(), index in self._of_cell, index in self._of_wrist)
        return self._known[geometry]

    def _add_capsule(self, p_FT: FloatArray) -> None:
        length = float(np.linalg.norm(p_FT))
        radius = min(TOOL_RADIUS, length / 4)
        if length < 1e-3:
            return
        R_FG = RotationMatrix.MakeFromOneVector(for_drake(p_FT), 2)
        X_FG = RigidTransform(R_FG, for_drake(0.5 * p_FT))
        rod = length - 2 * radius
        shape = Capsule(radius, rod) if rod > 0 else Sphere(radius)
        self._plant.RegisterCollisionGeometry(self._plant.GetBodyByName("flange"), X_FG, shape, _TOOL, CoulombFriction(0.0, 0.0))

    def _add_tool(self, file: Path) -> list[ModelInstanceIndex]:
        plant = self._plant
        try:
            instances = Parser(plant, _TOOL).AddModels(file)
        except RuntimeError as error:
            raise UsageError(f"{file}: cannot read tool model: {error}") from error
        for instance in instances:
            children = {plant.get_joint(joint).child_body().index() for joint in plant.GetJointIndices(instance)}
            for index in plant.GetBodyIndices(instance):
                if index not in children:
                    plant.WeldFrames(plant.GetFrameByName("flange"), plant.get_body(index).body_frame())
        return list(instances)
