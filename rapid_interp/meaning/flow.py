"""Where a routine goes: labels and jumps, and what is never reached.

Invariant: a jump goes to a block that it stands in, never into another one.
"""

from __future__ import annotations

from typing import NamedTuple

from rapid_interp.meaning.compiler import Compiler
from rapid_interp.meaning.symbols import did_you_mean
from rapid_interp.reading.tree import CallStatement, Goto, If, Label, Name, Placeholder, Raise, Return, Simple, Statement, Test, While

Path = tuple[int, ...]


class _Target(NamedTuple):
    step: int
    path: Path
    node: Label


class Jumps:
    """The labels and the GOTOs of a routine. `enter` and `leave` tell where blocks begin and end."""

    def __init__(self, unit: Compiler) -> None:
        self._unit = unit
        self._path: Path = ()
        self._blocks = 0
        self._labels: dict[str, _Target] = {}
        self._jumps: list[tuple[int, Goto, Path]] = []

    def enter(self) -> None:
        """Begins a block; those of the routine itself count as one."""
        self._blocks += 1
        self._path = (*self._path, self._blocks)

    def leave(self) -> None:
        """Ends a block."""
        self._path = self._path[:-1]

    def label(self, node: Label) -> None:
        """Puts a label before the next step."""
        key = node.name.lower()
        if key in self._labels:
            self._unit.error("RAPID-E105", f"the label {node.name!r} is set twice", node.start)
        self._labels[key] = _Target(self._unit.here, self._path[1:], node)

    def jump(self, node: Goto) -> None:
        """Adds the step of a GOTO."""
        self._jumps.append((self._unit.reserve(), node, self._path[1:]))

    def finish(self) -> None:
        """Completes the jumps once all labels are known."""
        reached: set[str] = set()
        for step, node, path in self._jumps:
            name = node.label.text
            target = self._labels.get(name.lower())
            if target is None:
                known = [found.node.name for found in self._labels.values()]
                message = f"no label {name!r} in this routine{did_you_mean(name, known)}"
                self._unit.error("RAPID-E106", message, node.label.start)
                reached.update(self._labels)  # any of them may have been meant
                continue
            reached.add(name.lower())
            if path[: len(target.path)] != target.path:
                message = f"the label {name!r} cannot be reached: it is inside of an IF, FOR, WHILE or TEST that this GOTO is not in"
                self._unit.error("RAPID-E133", message, node.label.start)
            self._unit.jump(step, target.step)
        for key, target in self._labels.items():
            if key not in reached:
                self._unit.warn("RAPID-W206", f"no GOTO goes to the label {target.node.name!r}", target.node.start)


def is_left_behind(node: Statement) -> bool:
    """Gives whether nothing goes on after this statement."""
    return isinstance(node, Return | Raise | Goto | Simple)


def always_leaves(body: tuple[Statement, ...]) -> bool:
    """Gives whether the end of these statements cannot be reached, as far as is sure; loops and jumps count as leaving."""
    for node in body:
        match node:
            case Return() | Raise() | Goto() | While() | Simple() | Placeholder() | Label():
                return True
            case If(compact=False, otherwise=otherwise) if otherwise is not None:
                if all(always_leaves(branch.body) for branch in node.branches) and always_leaves(otherwise):
                    return True
            case Test(default=default) if default is not None:
                if all(always_leaves(case.body) for case in node.cases) and always_leaves(default):
                    return True
            case CallStatement(name=Name(text=text)) if text.lower() in ("stop", "exitcycle"):
                return True
            case _:
                continue
    return False
