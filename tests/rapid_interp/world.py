"""A small world that drives a task: time, signals, timers, an operator; it tells what the task asked for, one short line an effect.

A program may script it in comments: `! @ 0.5 di1=1` changes a signal after 0.5 s, `! answer 2` is what the operator answers next.
Moves to stop points take 1 s, fly-by moves no time.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import fields, is_dataclass

from rapid_interp import Task
from rapid_interp import effects as fx
from rapid_interp.data import JointTarget, Pos, RobJoint, RobTarget, ToolData, WObjData

MOVE_S = 1.0
_INPUT = re.compile(r"! @ ([\d.]+) (\w+)=([\d.]+)")
_ANSWER = re.compile(r"! answer (.+)")


def numbers(*values: float) -> str:
    return " ".join(f"{value + 0.0:.6g}" for value in values)


def target(value: RobTarget | JointTarget) -> str:
    if isinstance(value, JointTarget):
        axes = value.robax
        return numbers(axes.rax_1, axes.rax_2, axes.rax_3, axes.rax_4, axes.rax_5, axes.rax_6)
    return numbers(value.trans.x, value.trans.y, value.trans.z)


def plain(value: object) -> str:
    """Gives any effect, or what is in it, in short: its fields that are not at their defaults."""
    if isinstance(value, RobTarget | JointTarget):
        return target(value)
    if isinstance(value, ToolData | WObjData):
        return type(value).__name__
    if isinstance(value, bool | str) or value is None:
        return str(value).replace("\n", " / ")
    if isinstance(value, int | float):
        return f"{value:g}"
    if isinstance(value, tuple):
        return "[" + ", ".join(plain(item) for item in value) + "]"
    if isinstance(value, fx.MoveAbsJ | fx.MoveJ | fx.MoveL | fx.MoveC):
        return shown(value)
    assert is_dataclass(value)
    parts = [
        plain(getattr(value, field.name)) for field in fields(value) if field.name != "at" and getattr(value, field.name) != field.default
    ]
    return " ".join([type(value).__name__, *parts])


def shown(effect: fx.Effect) -> str:
    match effect:
        case fx.MoveAbsJ() | fx.MoveJ() | fx.MoveL():
            zone = "fine" if effect.zone.finep else f"z{effect.zone.pzone_tcp:g}"
            return f"{type(effect).__name__} {target(effect.target)} v{effect.speed.v_tcp:g} {zone}"
        case fx.MoveC():
            return f"MoveC {target(effect.via)} / {target(effect.target)}"
        case fx.Wait():
            return f"wait {effect.seconds:g}" + " in position" * effect.in_position
        case fx.SetSignal():
            return f"{effect.name}={effect.value:g}" + f" after {effect.delay:g}" * bool(effect.delay)
        case fx.ReadSignal():
            return f"read {effect.name}"
        case fx.ReadClock():
            return "clock"
        case fx.Write():
            return effect.text
        case fx.SetConfiguration():
            return f"Conf{'J' if effect.joint_moves else 'L'} {'on' if effect.on else 'off'}"
        case fx.StopProgram():
            return "exit" if effect.exits else "stop" + " at once" * effect.at_once
        case _:
            return plain(effect)


class World:
    def __init__(self, script: str = "", replies: Iterable[float] = ()) -> None:
        self.time = 0.0
        self.signals: dict[str, float] = {}
        self.inputs = sorted((float(time), name, float(value)) for time, name, value in _INPUT.findall(script))
        self.answers = [answer.strip() for answer in _ANSWER.findall(script)]
        self.replies = iter(replies)
        self.subscribed: dict[int, fx.Subscribe] = {}
        self.timers: dict[int, float] = {}
        self.until = 0.0
        self.lines: list[str] = []
        self.refused: dict[str, fx.Failed] = {}

    def run(self, task: Task, most: int = 100_000) -> list[str]:
        """Gives the lines of a run."""
        run = task.run()
        reply: fx.Reply = None
        for _ in range(most):
            try:
                effect = run.send(reply)
            except StopIteration:
                return self.lines
            if not isinstance(effect, fx.Resume):
                self.lines.append(shown(effect))
            reply = self.reply(effect)
        raise AssertionError(f"more than {most} effects")

    def reply(self, effect: fx.Effect) -> fx.Reply:
        if (refusal := self.refused.get(type(effect).__name__)) is not None:
            return refusal
        match effect:
            case fx.ReadSignal():
                return next(self.replies, self.signals.get(effect.name, 0.0))
            case fx.ReadClock():
                return next(self.replies, self.time)
            case fx.ReadDate():
                return "2026-11-23 07:32:40"
            case fx.ReadTarget():
                return RobTarget(Pos(100, 200, 300))
            case fx.ReadJoints():
                return JointTarget(RobJoint(1, 2, 3, 4, 5, 6))
            case fx.ReadTool():
                return ToolData()
            case fx.ReadWorkObject():
                return WObjData()
            case fx.SolveForward():
                return RobTarget(Pos(effect.joints.robax.rax_1, 0, 0))
            case fx.SolveInverse():
                if effect.target.trans.z > 1000:
                    return fx.Failed("ERR_ROBLIMIT", "the target is out of reach")
                return JointTarget(RobJoint(effect.target.trans.x))
            case fx.ReadSpeedOverride():
                return 100.0
            case fx.ReadSystem():
                return f"a {effect.what}"
            case fx.ReadGuidanceState():
                return 1.0
            case fx.ReadEvent():
                return fx.Event(1, 10, 3, "title", ("one", "two"))
            case fx.AskOperator() if not self.answers:
                return fx.Failed("ERR_TP_MAXTIME", "nobody answered")
            case fx.AskOperator():
                answer = self.answers.pop(0)
                return answer if effect.wants == "text" else float(answer)
            case fx.SetSignal():
                return self.changed({effect.name: effect.value})
            case fx.Subscribe():
                self.subscribed[effect.interrupt] = effect
                if isinstance(effect.source, fx.Elapsed):
                    self.timers[effect.interrupt] = self.time + effect.source.seconds
            case fx.Unsubscribe():
                self.subscribed.pop(effect.interrupt, None)
                self.timers.pop(effect.interrupt, None)
            case fx.Wait():
                self.until = self.time + effect.seconds
                return self.wait()
            case fx.MoveAbsJ() | fx.MoveJ() | fx.MoveL() | fx.MoveC():
                self.until = self.time + MOVE_S * effect.zone.finep
                return self.wait()
            case fx.TriggerMove():
                raised = [trigger.action.interrupt for trigger in effect.triggers if isinstance(trigger.action, fx.RaiseInterrupt)]
                return fx.Interrupted(tuple(raised)) if raised else None
            case fx.Resume():
                return self.wait()
            case _:
                pass
        return None

    def changed(self, values: dict[str, float]) -> fx.Reply:
        raised: list[int] = []
        for name, value in values.items():
            before = self.signals.get(name, 0.0)
            self.signals[name] = value
            for number, subscription in list(self.subscribed.items()):
                source = subscription.source
                if isinstance(source, fx.SignalChange) and source.name == name and value != before and source.value in (None, value):
                    raised.append(number)
                    if subscription.single:
                        del self.subscribed[number]
        return fx.Interrupted(tuple(raised)) if raised else None

    def wait(self) -> fx.Reply:
        """Lets time pass until the wait is over or something raises an interrupt."""
        while True:
            timer = min(((time, number) for number, time in self.timers.items()), default=(float("inf"), 0))
            change = self.inputs[0] if self.inputs else (float("inf"), "", 0.0)
            if min(timer[0], change[0]) > self.until:
                self.time = max(self.time, self.until)
                return None
            if timer[0] <= change[0]:
                self.time = max(self.time, timer[0])
                subscription = self.subscribed[timer[1]]
                assert isinstance(subscription.source, fx.Elapsed)
                if subscription.single:
                    del self.timers[timer[1]]
                else:
                    self.timers[timer[1]] = timer[0] + subscription.source.seconds
                return fx.Interrupted((timer[1],), finished=False)
            self.inputs.pop(0)
            self.time = max(self.time, change[0])
            reply = self.changed({change[1]: change[2]})
            if isinstance(reply, fx.Interrupted):
                return fx.Interrupted(reply.interrupts, finished=False)
