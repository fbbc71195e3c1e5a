"""Answers: what a program is told about its robot, the date and the operator's mind.

Invariant: an answer depends on the motion so far and on what was given beforehand, never on wall time.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass, field
from datetime import datetime, timedelta
from typing import assert_never

import numpy as np
from scipy.spatial.transform import RigidTransform

from mitl.motion import bridge
from mitl.motion.chain import Planner
from mitl.motion.record import MotionRecord, View
from mitl.paths import FloatArray
from rapid_interp import data, effects

EPOCH = datetime(2000, 1, 1)  # noqa: DTZ001 - a robot's clock knows no zone
"""The date at 0 s of virtual time. ASSUMPTION A-135: any fixed one does; a program may print it."""
_NO_AXES = data.ExtJoint()


@dataclass
class Desk:
    """The operator's answers, in the order in which they will be asked for, and the date at 0 s."""

    answers: list[str] = field(default_factory=list)
    epoch: datetime = EPOCH

    def date(self, now: float) -> str:
        """Gives date and time at `now` s as `YYYY-MM-DD HH:MM:SS`."""
        return (self.epoch + timedelta(seconds=now)).strftime("%Y-%m-%d %H:%M:%S")

    def answer(self, question: effects.AskOperator) -> float | str | None:
        """Gives the next answer as the question wants it; None where there is none. Raises ValueError for one that does not fit."""
        if not self.answers:
            return None
        told = self.answers.pop(0)
        if question.wants == "text":
            return told
        if question.wants == "choice" and told in question.choices:
            return float(question.choices.index(told))
        try:
            number = float(told)
        except ValueError:
            choices = f" or one of {', '.join(question.choices)}" if question.choices else ""
            raise ValueError(f"the answer {told!r} to {question.text!r} is no number{choices}") from None
        if question.wants == "choice":
            if not (number.is_integer() and 1 <= number <= len(question.choices)):
                raise ValueError(f"the answer {told!r} to {question.text!r} is none of its {len(question.choices)} choices")
            return number - 1
        if (question.least is not None and number < question.least) or (question.most is not None and number > question.most):
            raise ValueError(f"the answer {told!r} to {question.text!r} is not from {question.least:g} to {question.most:g}")
        return number


class Position:
    """Where the robot says that it is: the controller's view at a time."""

    def __init__(self, planner: Planner, record: MotionRecord) -> None:
        self._planner = planner
        self._record = record

    def _joints(self, now: float) -> FloatArray:
        """Gives the reported joints (6,) rad; once the plan has ended, while the arm settles, those that it settles at."""
        chains = self._record.chains
        stopped = bool(chains) and chains[-1].end <= now
        return self._record.joints_at(max(now, self._record.end) if stopped else now, View.CONTROLLER)

    def answer(
        self, question: effects.ReadTarget | effects.ReadJoints | effects.SolveForward | effects.SolveInverse, now: float,
        last: effects.Motion | None, displacement: data.Pose | None,
    ) -> effects.Answer:  # fmt: skip
        """Gives the answer at `now` s. last: the last motion given, whose tool and work object hold. displacement: PDisp, if any."""
        match question:
            case effects.ReadJoints():
                return data.JointTarget(_robjoint(self._joints(now)), _NO_AXES)
            case effects.ReadTarget():
                tool = question.tool or (last.tool if last else data.ToolData())
                wobj = question.wobj or (last.wobj if last else data.WObjData())
                return self._target(self._joints(now), tool, wobj, displacement)
            case effects.SolveForward():
                return self._target(bridge.joints_of(question.joints), question.tool, question.wobj, displacement)
            case effects.SolveInverse():
                return self._solved(question, displacement)
            case _:
                assert_never(question)

    def _target(self, q: FloatArray, tool: data.ToolData, wobj: data.WObjData, displacement: data.Pose | None) -> effects.Answer:
        arm = self._planner.arm
        X_OT = self._object_frame(wobj, displacement).inv() * arm.flange(q) * bridge.tool_frame(tool)
        found = arm.configuration(q)
        x, y, z = (X_OT.translation / bridge.MM).tolist()
        w, i, j, k = X_OT.rotation.as_quat(canonical=True, scalar_first=True).tolist()
        configuration = data.ConfData(*(float(part) for part in astuple(found)))
        return data.RobTarget(data.Pos(x, y, z), data.Orient(w, i, j, k), configuration, _NO_AXES)

    def _solved(self, question: effects.SolveInverse, displacement: data.Pose | None) -> effects.Answer:
        arm = self._planner.arm
        try:
            X_BT = self._object_frame(question.wobj, displacement) * bridge.target_frame(question.target)
            X_BF = X_BT * bridge.tool_frame(question.tool).inv()
        except ValueError as error:
            return effects.Failed("", str(error))
        if len(arm.solutions(X_BF)) == 0:
            return effects.Failed("ERR_OUTSIDE_REACH", "the target is outside the robot's reach")
        q = arm.configured(X_BF, bridge.configuration_of(question.target))
        if q is None:
            return effects.Failed("ERR_ROBLIMIT", "the target cannot be reached in its configuration within the axis limits")
        return data.JointTarget(_robjoint(q), _NO_AXES)

    def _object_frame(self, wobj: data.WObjData, displacement: data.Pose | None) -> RigidTransform:
        X_BO = bridge.work_object_frame(wobj)
        return X_BO if displacement is None else X_BO * bridge.transform_of(displacement.trans, displacement.rot)


def _robjoint(q: FloatArray) -> data.RobJoint:
    return data.RobJoint(*np.degrees(q).tolist())
