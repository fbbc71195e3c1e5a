"""The pose plan of a calibration for any robot, and the RAPID program that drives a real or simulated controller through it.

Invariant: every pose and every joint move between two of them, and from and to home, keeps its distance from the arm itself and the cell.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mitl.calibration.distortion import Distortion
from mitl.calibration.pose_choice import most_telling
from mitl.calibration.pose_set import CalibrationPoses, require_enough
from mitl.errors import UsageError
from mitl.motion.kinematics import Arm
from mitl.motion.program_run import joints_home
from mitl.motion.robot_model import RobotModel
from mitl.motion.spread_poses import spread_poses
from mitl.paths import FloatArray
from mitl.simulation.arm_gaps import ArmGaps
from mitl.simulation.cell import Cell

POSES = 30
"""Facts/tracker.md: 20 to 40. With 30, half of the registrations leave less than .25 mm at the thesis's points (benchmarks)."""
_CANDIDATES = 400
_LEAST_GAP = 0.04
_STEPS = 12
"""Points of a joint move that are looked at, besides its ends."""

Clear = Callable[[FloatArray], bool]
"""Gives whether the arm at joints (6,) in rad keeps its distance from itself and all else."""


@dataclass(frozen=True, eq=False)
class PosePlan:
    """Calibration poses in the order in which they are driven: joints (N, 6) in rad, flange X_BF (N, 7). home: joints (6,)."""

    home: FloatArray
    joints: FloatArray
    flange: FloatArray


def plan_poses(model: RobotModel, clear: Clear, *, count: int = POSES, seed: int = 1) -> PosePlan:
    """Gives the plan: of many poses that are clear, those that tell the most, in an order whose moves are clear too.

    Raises UsageError where there are too few, saying how many, and CalibrationError where they would not do.
    """
    arm, home = Arm(model), joints_home()
    spread = spread_poses(arm, home, _CANDIDATES, seed)
    usable = np.array([clear(q) for q in spread.joints], dtype=np.bool_)
    joints, flange = spread.joints[usable], spread.flange[usable]
    # a few more than wanted, so that those that no clear move leads to can be left out
    wanted = min(len(joints), count + count // 3)
    order = _tour(home, joints, most_telling(flange, wanted), clear)[:count] if len(joints) >= count else []
    if len(order) < count:
        raise UsageError(
            f"{model.name}: only {len(order) or len(joints)} of {len(spread.joints)} reachable poses keep their distance, expected {count}:"
            " ask for fewer poses, or make room in the cell"
        )
    none = np.zeros(count)
    require_enough(CalibrationPoses(flange[order], flange[order], none), Distortion.AFFINE)
    return PosePlan(home, joints[order], flange[order])


def clear_of_all(model: RobotModel, cell: Cell | None = None) -> Clear:
    """Gives whether the arm with a tracked body on its flange keeps its distance from itself, from the floor and from what is around."""
    gaps = ArmGaps(model.urdf, cell)
    return lambda q: gaps.smallest(model.between_links(q), _LEAST_GAP) >= _LEAST_GAP


def rapid_of(plan: PosePlan, robot: str, around: str = "the floor") -> str:
    """Gives the program: option 1 moves to the pose whose number is subOption; joint targets, as neither tool nor work object matter.

    around: what the poses were looked at for, told in the program's head.
    """
    rows = ",\n".join(f"      {_target(q)}" for q in plan.joints)
    return _PROGRAM.format(robot=robot, around=around, count=len(plan.joints), home=_target(plan.home), rows=rows)


def _target(q: FloatArray) -> str:
    angles = ",".join(f"{round(float(np.degrees(angle)), 1):g}" for angle in q)
    return f"[[{angles}],[9E9,9E9,9E9,9E9,9E9,9E9]]"


def _tour(home: FloatArray, joints: FloatArray, numbers: list[int], clear: Clear) -> list[int]:
    """Gives the numbers in an order of short moves, each clear, as are those from and to home; what cannot be reached so is left out."""
    if not clear(home):
        raise UsageError("the arm does not keep its distance where it begins, at its home [0, 0, 0, 0, 30, 0]: make room in the cell")
    left = [number for number in numbers if _way_is_clear(home, joints[number], clear)]
    order: list[int] = []
    here = home
    while left:
        for number in sorted(left, key=lambda n: float(np.abs(joints[n] - here).max())):
            if _way_is_clear(here, joints[number], clear):
                break
        else:
            return order
        order.append(number)
        left.remove(number)
        here = joints[number]
    return order


def _way_is_clear(start: FloatArray, end: FloatArray, clear: Clear) -> bool:
    """Gives whether a joint move, along which all axes move in proportion, is clear."""
    return all(clear(start + share * (end - start)) for share in np.linspace(0.0, 1.0, _STEPS + 2))


_PROGRAM = """MODULE Calibration
  ! Poses for the registration of tracker and robot: option 1 moves to pose number subOption.
  ! Made by `mitl calibrate --plan` for {robot}. Joint targets: neither work object nor tool
  ! data take part. They keep the axis limits, and the arm away from itself and {around}, also on the
  ! way from home to the first and from pose to pose in this order. Run it at low speed first.
  CONST num poseCount := {count};
  CONST jointtarget home := {home};
  CONST jointtarget poses{{{count}}} := [
{rows}];
  VAR num option := 0;
  VAR num subOption := 0;

  PROC main()
    MoveAbsJ home, v500, fine, tool0;
    WHILE TRUE DO
      TEST option
      CASE 1:
        MoveAbsJ poses{{subOption}}, v500, fine, tool0;
        done;
      DEFAULT:
        WaitTime 0.05;
      ENDTEST
    ENDWHILE
  ENDPROC

  PROC done()
    subOption := 0;
    option := 0;
  ENDPROC
ENDMODULE
"""
