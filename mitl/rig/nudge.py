"""The nudge: a small turn of axis 6, to and fro, that wakes a tracker which fell asleep on a robot that stood still.

Invariant: it begins and ends where the robot stands, moves no other axis, and stays within the axis's limits.
"""

from __future__ import annotations

import numpy as np

from mitl.motion.robot_model import RobotModel
from mitl.paths import FloatArray

TURN = 6.0
"""Degrees. ASSUMPTION A-333: enough for any tracked device to wake, and little enough for any cable on the flange."""
WAKES = 3.0
"""Seconds after a nudge within which a tracker is awake (facts/tracker.md: 1.5 to 2.0)."""
NAME = "MitlNudge.mod"
_TIMES = 3
_LEFT = "[9E9,9E9,9E9,9E9,9E9,9E9]"


def nudge_program(model: RobotModel, joints: FloatArray) -> str:
    """Gives the RAPID program for a robot that stands at joints (6,) in rad: 20 deg/s, away from the nearer limit of axis 6."""
    there = np.degrees(joints)
    middle = 0.5 * float(np.degrees(model.lower[5] + model.upper[5]))
    there[5] += TURN if there[5] < middle else -TURN
    away, back = (f"[[{','.join(f'{angle:.9g}' for angle in q)}],{_LEFT}]" for q in (there, np.degrees(joints)))
    return f"""MODULE MitlNudge
  PROC main()
    FOR i FROM 1 TO {_TIMES} DO
      MoveAbsJ {away}, [20,20,20,20], fine, tool0;
      MoveAbsJ {back}, [20,20,20,20], fine, tool0;
    ENDFOR
  ENDPROC
ENDMODULE
"""
