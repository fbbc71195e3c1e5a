"""Tools and work objects of a program against those that the controller has: a wrong one would move another point than was pre-flown."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import rapid_interp
from mitl.controllers.virtual.literals import numbers, split
from mitl.errors import RigError


def compare_frames(sources: Sequence[Path], read: Callable[[str], str]) -> int:
    """Gives how many tools and work objects agree. read: gives the controller's literal of `module:name`.

    Raises RigError at the first that has other numbers on the controller than in the program.
    """
    program = rapid_interp.load(list(sources))
    task = program.start()
    count = 0
    for symbol in program.data:
        if symbol.type.name not in ("tooldata", "wobjdata") or symbol.storage == "CONST":
            continue
        name = f"{symbol.module}:{symbol.name}"
        ours, theirs = _frame(task.literal(name)), _frame(read(name))
        if len(ours) != len(theirs) or not all(math.isclose(a, b, rel_tol=1e-5, abs_tol=1e-3) for a, b in zip(ours, theirs, strict=True)):
            raise RigError(f"{symbol.type.name} {symbol.name} is {theirs} on the controller but {ours} in the program: nothing was moved")
        count += 1
    return count


def _frame(literal: str) -> list[float]:
    """Gives all poses, masses and centres of a tooldata or wobjdata as numbers."""
    tree = split(literal)
    return [number for item in tree if not isinstance(item, str) for number in numbers(item)]
