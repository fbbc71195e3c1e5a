"""How near an arm with a tracked body on its flange comes to itself, to the floor and to its cell, by the shapes in their models.

Invariant: links that share a joint are not compared, nor what axis 6 turns with link 5; the axis limits keep them apart.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from pydrake.geometry import Capsule, CollisionFilterDeclaration, GeometrySet
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction
from pydrake.systems.framework import DiagramBuilder

from mitl.errors import UsageError
from mitl.paths import FloatArray
from mitl.simulation.arm import for_drake
from mitl.simulation.cell import Cell

# ASSUMPTION A-189: a Vive controller or puck on its bracket fits into a capsule of 60 mm radius that ends 160 mm before the flange.
_RADIUS, _LENGTH = 0.06, 0.16


class ArmGaps:
    """An arm whose tracked body stands for a capsule before the flange. Raises UsageError where the URDF or the cell cannot be read.

    cell: what stands around it, if anything.
    """

    def __init__(self, urdf: Path, cell: Cell | None = None) -> None:
        builder = DiagramBuilder()
        self._plant, self._scene_graph = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
        try:
            (robot,) = Parser(self._plant).AddModels(urdf)
        except RuntimeError as error:
            raise UsageError(f"{urdf}: cannot read robot model: {error}") from error
        self._plant.WeldFrames(self._plant.world_frame(), self._plant.GetFrameByName("base_link", robot))
        self._plant.RegisterCollisionGeometry(
            self._plant.GetBodyByName("flange"),
            RigidTransform(for_drake(np.array([0.0, 0.0, 0.5 * _LENGTH]))),
            Capsule(_RADIUS, _LENGTH - 2.0 * _RADIUS),
            "tracked_body",
            CoulombFriction(0.0, 0.0),
        )
        if cell is not None:
            cell.add_to(self._plant)
        self._robot = robot
        self._plant.Finalize()
        # axis 6 turns the body about itself: its distance from link 5 is always the same
        near = [GeometrySet(self._plant.GetCollisionGeometriesForBody(self._plant.GetBodyByName(name))) for name in ("link_5", "flange")]
        self._scene_graph.collision_filter_manager().Apply(CollisionFilterDeclaration().ExcludeBetween(*near))
        self._context = builder.Build().CreateDefaultContext()
        self._plant_context = self._plant.GetMyMutableContextFromRoot(self._context)
        self._scene_context = self._scene_graph.GetMyContextFromRoot(self._context)

    def smallest(self, q: FloatArray, within: float) -> float:
        """Gives the smallest gap in m at angles (6,) rad between the links, negative for an overlap; inf where none is below `within` m.

        The base stands still as the cell does, so that between these two no gap counts.
        """
        self._plant.SetPositions(self._plant_context, self._robot, for_drake(q))
        pairs = self._scene_graph.get_query_output_port().Eval(self._scene_context).ComputeSignedDistancePairwiseClosestPoints(within)
        X_WF = self._plant.EvalBodyPoseInWorld(self._plant_context, self._plant.GetBodyByName("flange"))
        floor = min(float(X_WF.translation()[2]), float(X_WF.multiply(for_drake(np.array([0.0, 0.0, _LENGTH])))[2])) - _RADIUS
        return min([float(pair.distance) for pair in pairs] + [floor if floor < within else math.inf])
