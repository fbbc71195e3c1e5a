"""What stands around the robot: a cell, read from a folder in models/cells/ or from one URDF or SDF file.

cell.toml:
  [cell]
  description = "..."
  model = "cell.urdf"            # or .sdf, in the same folder
  position_mm = [0, 0, 0]        # of the model's origin in the robot's base frame
  roll_pitch_yaw_deg = [0, 0, 0]
  [[conveyor]]
  name = "belt"
  unit = "CNV1"                  # the mechanical unit that RAPID's work objects name
  start_mm = [0, 0, 0]           # where the conveyor's frame stands at an encoder value of 0, in the model's frame
  direction_deg = 0              # the belt runs along x of this frame, turned about z
  counts_per_m = 10000.0         # of the encoder
  speed_m_s = 0.1                # from the beginning on
  # these need not be there:
  speed_signal = "aoBelt"        # the output that commands the drive, in mm/s; such a belt stops at its home and at its length
  position_signal = "aiBelt"     # the input that tells how far the belt is, in mm
  acceleration_m_s2 = 0.5        # of the drive
  length_mm = 800.0
  farthest_mm = 700.0            # behind the sensor; farther a work piece cannot be followed
  pieces_mm = [0.0]              # before the sensor, where work pieces lie at an encoder value of 0

Invariant: everything in a cell stands still in the world; only a conveyor's frame moves, and not its geometry.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from scipy.spatial.transform import RigidTransform as Frame
from scipy.spatial.transform import Rotation

from mitl.errors import UsageError
from mitl.motion.conveyor import Conveyor
from mitl.resources import models_folder

_MODELS = (".urdf", ".sdf")
_KEYS = {"cell": {"description", "model", "position_mm", "roll_pitch_yaw_deg"}}
_HERE = 1e-9
_CONVEYOR_OPTIONS = {"speed_signal", "position_signal", "acceleration_m_s2", "length_mm", "farthest_mm", "pieces_mm"}
_CONVEYOR_KEYS = {"name", "unit", "start_mm", "direction_deg", "counts_per_m", "speed_m_s"} | _CONVEYOR_OPTIONS


@dataclass(frozen=True, eq=False)
class Cell:
    """A cell: its model file, where that stands in the robot's base, and its conveyors."""

    name: str
    description: str
    model: Path
    X_BC: RigidTransform
    conveyors: tuple[Conveyor, ...] = ()

    def add_to(self, plant: MultibodyPlant, X_WB: RigidTransform | None = None) -> list[ModelInstanceIndex]:
        """Adds the cell to a plant that is not finalized, welded to the world; gives its model instances.

        Raises UsageError where the file cannot be read.
        """
        parser = Parser(plant, "cell")
        try:
            instances = parser.AddModels(self.model)
        except RuntimeError as error:
            raise UsageError(f"{self.model}: cannot read cell model: {error}") from error
        if not instances:
            raise UsageError(f"{self.model}: expected a model, found none")
        X_WC: RigidTransform = (X_WB or RigidTransform()).multiply(self.X_BC)
        for instance in instances:
            joints = [plant.get_joint(joint) for joint in plant.GetJointIndices(instance)]
            children = {joint.child_body().index() for joint in joints}
            if any(joint.parent_body().index() == plant.world_body().index() for joint in joints) and not X_WC.IsNearlyIdentity(_HERE):
                raise UsageError(
                    f"{self.model}: a static model cannot be placed elsewhere: leave <static> out, everything in a cell stands still"
                )
            for index in plant.GetBodyIndices(instance):
                body = plant.get_body(index)
                if index not in children:
                    X_CA = plant.GetDefaultFloatingBaseBodyPose(body)
                    plant.WeldFrames(plant.world_frame(), body.body_frame(), X_WC.multiply(X_CA))
        return list(instances)


def cell_names() -> list[str]:
    """Gives the names of the cells that come with mitl."""
    return sorted(file.parent.name for file in (models_folder() / "cells").glob("*/cell.toml"))


def load_cell(name_or_path: str) -> Cell:
    """Gives the cell of a name in models/cells/, a folder with cell.toml, or one URDF or SDF file.

    Raises UsageError naming the file and the key where something is missing, unknown or of the wrong kind.
    """
    path = Path(name_or_path)
    if path.suffix.lower() in _MODELS:
        if not path.is_file():
            raise UsageError(f"no cell {name_or_path!r}: there is no such file")
        return Cell(path.stem, "", path.resolve(), RigidTransform())
    folder = path if (path / "cell.toml").is_file() else models_folder() / "cells" / name_or_path
    file = folder / "cell.toml"
    if not file.is_file():
        raise UsageError(
            f"no cell {name_or_path!r}: known are {', '.join(cell_names())}; or give a folder with cell.toml, a .urdf or an .sdf"
        )
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"{file}: not valid TOML: {error}") from error
    return _cell(file, table)


def _cell(file: Path, table: dict[str, Any]) -> Cell:
    cell = table.get("cell")
    if not isinstance(cell, dict):
        raise UsageError(f"{file}: expected a section [cell]")
    conveyors = table.get("conveyor", [])
    if not isinstance(conveyors, list):
        raise UsageError(f"{file}: expected conveyors as [[conveyor]]")
    for section, known, found in (
        ("", {"cell", "conveyor"}, table),
        ("[cell] ", _KEYS["cell"], cell),
        *(("[[conveyor]] ", _CONVEYOR_KEYS, belt) for belt in conveyors),
    ):
        unknown = sorted(set(found) - known)
        if unknown:
            raise UsageError(f"{file}: {section}unknown key {unknown[0]!r}, known are {', '.join(sorted(known))}")
    model = file.parent / _text(file, cell, "model")
    if model.suffix.lower() not in _MODELS or not model.is_file():
        raise UsageError(f"{file}: [cell] model must be a .urdf or .sdf file in the same folder, is {model.name!r}")
    turn = np.radians(_numbers(file, cell, "roll_pitch_yaw_deg", [0.0, 0.0, 0.0]))
    X_BC = RigidTransform(RollPitchYaw(*turn.tolist()), 1e-3 * _numbers(file, cell, "position_mm", [0.0, 0.0, 0.0]))
    return Cell(file.parent.name, _text(file, cell, "description"), model, X_BC, tuple(_conveyor(file, belt, X_BC) for belt in conveyors))


def _conveyor(file: Path, belt: dict[str, Any], X_BC: RigidTransform) -> Conveyor:
    direction = float(np.radians(_number(file, belt, "direction_deg")))
    X_CU = RigidTransform(RollPitchYaw(0.0, 0.0, direction), 1e-3 * _numbers(file, belt, "start_mm", None))
    counts = _number(file, belt, "counts_per_m")
    if counts <= 0:
        raise UsageError(f"{file}: counts_per_m must be positive, is {counts:g}")
    options: dict[str, Any] = {key: _text(file, belt, key) for key in ("speed_signal", "position_signal") if key in belt}
    for key, name, unit in (("acceleration_m_s2", "acceleration", 1.0), ("length_mm", "length", 1e-3), ("farthest_mm", "farthest", 1e-3)):
        if key in belt:
            options[name] = unit * _number(file, belt, key)
            if options[name] <= 0:
                raise UsageError(f"{file}: {key} must be positive, is {belt[key]!r}")
    if "pieces_mm" in belt:
        pieces = belt["pieces_mm"]
        if not isinstance(pieces, list) or not pieces or any(isinstance(v, bool) or not isinstance(v, int | float) for v in pieces):
            raise UsageError(f"{file}: pieces_mm must be a list of numbers, is {pieces!r}")
        options["pieces"] = tuple(sorted(1e-3 * float(piece) for piece in pieces))
    X_BU = X_BC.multiply(X_CU)
    return Conveyor(
        name=_text(file, belt, "name"),
        unit=_text(file, belt, "unit"),
        X_BU=Frame.from_components(X_BU.translation(), Rotation.from_matrix(X_BU.rotation().matrix())),
        counts_per_m=counts,
        speed=_number(file, belt, "speed_m_s"),
        **options,
    )


def _text(file: Path, table: dict[str, Any], key: str) -> str:
    value = table.get(key)
    if not isinstance(value, str):
        raise UsageError(f"{file}: {key} must be a string, is {value!r}")
    return value


def _number(file: Path, table: dict[str, Any], key: str) -> float:
    value = table.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise UsageError(f"{file}: {key} must be a number, is {value!r}")
    return float(value)


def _numbers(file: Path, table: dict[str, Any], key: str, default: list[float] | None) -> Any:  # noqa: ANN401 - goes to Drake, see for_drake
    value = table.get(key, default)
    if not isinstance(value, list) or len(value) != 3 or not all(isinstance(v, int | float) and np.isfinite(v) for v in value):
        raise UsageError(f"{file}: {key} must be a list of 3 numbers, is {value!r}")
    return np.array(value, dtype=np.float64)
