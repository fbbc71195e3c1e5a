"""MoveSettings: what a program has said about how the moves after it go, besides their own arguments.

Invariant: a default MoveSettings is a controller's after PP to main.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeAlias

from rapid_interp import data, effects

GeometrySetting: TypeAlias = (
    effects.SetConfiguration | effects.SetSingularity | effects.SetCirclePathMode | effects.SetDisplacement | effects.SetLoad
)
"""The effects that `MoveSettings.after` understands."""

_NO_DISPLACEMENT = data.Pose(data.Pos(0.0, 0.0, 0.0), data.Orient(1.0, 0.0, 0.0, 0.0))


@dataclass(frozen=True)
class MoveSettings:
    """Settings that decide where a move goes.

    linear, joint: whether such moves must end in the programmed axis configuration (ConfL, ConfJ). singularity: "off", "wrist" or
    "lock_axis_4" (SingArea). circle: a mode of CirPathMode. displacement: X_OT becomes `displacement` X_OT (PDisp). load: what the
    gripper holds (GripLoad); None is load0.
    """

    linear: bool = True
    joint: bool = True
    singularity: str = "off"
    circle: str = "PathFrame"
    displacement: data.Pose = _NO_DISPLACEMENT
    load: data.LoadData | None = None

    def after(self, effect: GeometrySetting) -> MoveSettings:
        """Gives the settings after an effect that changes them."""
        match effect:
            case effects.SetConfiguration():
                return replace(self, joint=effect.on) if effect.joint_moves else replace(self, linear=effect.on)
            case effects.SetSingularity():
                return replace(self, singularity=effect.mode)
            case effects.SetCirclePathMode():
                return replace(self, circle=effect.mode)
            case effects.SetDisplacement():
                return replace(self, displacement=effect.displacement)
            case effects.SetLoad():
                return replace(self, load=effect.load)


DEFAULT = MoveSettings()
