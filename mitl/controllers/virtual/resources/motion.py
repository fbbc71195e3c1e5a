"""/rw/motionsystem: the mechanical unit's position."""

from __future__ import annotations

import numpy as np

from mitl.controllers.virtual.answers import NOT_FOUND, Answer, Dialect, Item, Refused, answered
from mitl.controllers.virtual.cell import TASK, UNIT, VirtualCell
from mitl.controllers.virtual.router import Call, Route
from mitl.paths import FloatArray
from mitl.poses import IDENTITY, pose_of

_NO_AXIS = "8.999999e+09"


class MotionResources:
    """Positions as the controller believes them."""

    def __init__(self, cell: VirtualCell) -> None:
        self._cell = cell

    def routes(self) -> list[Route]:
        """Gives the table."""
        unit = "rw/motionsystem/mechunits/{unit}"
        return [
            Route("GET", "rw/motionsystem/mechunits", self.units),
            Route("GET", unit, self.unit),
            Route("GET", f"{unit}/jointtarget", self.joints),
            Route("GET", f"{unit}/robtarget", self.target),
            Route("GET", f"{unit}/cartesian", self.cartesian),
            Route("GET", f"{unit}/baseframe", self.base_frame),
        ]

    def units(self, _call: Call) -> Answer:
        """The mechanical units."""
        return answered(Item("ms-mechunit-li", UNIT, {"mode": "Activated", "activation-allowed": "true", "drive-module": "1"}, UNIT))

    def unit(self, call: Call) -> Answer:
        """What the unit is."""
        self._known(call)
        fields = {
            "type": "TCPRobot",
            "task-name": TASK,
            "axes": "6",
            "axes-total": "6",
            "is-integrated-unit": "NoIntegratedUnit",
            "has-integrated-unit": "NoIntegratedUnit",
            "mode": "Activated",
            "status": "",
            "tool-name": "tool0",
            "wobj-name": "wobj0",
            "payload-name": "load0",
            "total-payload-name": "load0",
            "jog-mode": "AxisGroup1",
            "coord-system": "World",
            "robot-type": self._cell.model.description,
        }
        return answered(Item("ms-mechunit", UNIT, fields))

    def joints(self, call: Call) -> Answer:
        """The axes in deg."""
        self._known(call)
        angles = np.degrees(self._cell.joints())
        fields = {f"rax_{axis}": f"{angle:.8g}" for axis, angle in enumerate(angles, start=1)}
        return answered(Item("ms-jointtarget", "jointtarget", {**fields, **{f"eax_{axis}": _NO_AXIS for axis in "abcdef"}}))

    def target(self, call: Call) -> Answer:
        """The TCP as a robtarget. External axes are given in both spellings that clients read."""
        self._known(call)
        pose = pose_of(self._cell.pose(call.query.get("tool", ""), call.query.get("wobj", ""), call.query.get("coordinate", "Base")))
        configuration = self._cell.configuration()
        fields = {
            **_pose_fields(pose),
            "cf1": str(configuration.cf1),
            "cf4": str(configuration.cf4),
            "cf6": str(configuration.cf6),
            "cfx": str(configuration.cfx),
            **{f"eax_{axis}": _NO_AXIS for axis in "abcdef"},
            **{f"eax{axis}": _NO_AXIS for axis in "abcdef"},
        }
        return answered(Item("ms-robtargets", "robtarget", fields))

    def cartesian(self, call: Call) -> Answer:
        """The flange in the base frame."""
        self._known(call)
        kind = "ms-mechunit-cartesian" if call.dialect is Dialect.RWS1 else "ms-cartesian"
        return answered(Item(kind, "cartesian", _pose_fields(pose_of(self._cell.pose("", "", "Base")))))

    def base_frame(self, call: Call) -> Answer:
        """The base frame in the world: they are one."""
        self._known(call)
        return answered(Item("ms-baseframe", "baseframe", _pose_fields(IDENTITY)))

    def _known(self, call: Call) -> None:
        if call.names["unit"].upper() != UNIT:
            raise Refused(404, NOT_FOUND, f"No mechanical unit {call.names['unit']!r}: expected {UNIT}")


def _pose_fields(pose: FloatArray) -> dict[str, str]:
    millimetres, quaternion = 1000.0 * pose[:3], pose[3:]
    names = ("x", "y", "z", "q1", "q2", "q3", "q4")
    return {name: f"{value:.10g}" for name, value in zip(names, [*millimetres, *quaternion], strict=True)}
