"""Which orders a test program takes: the values of `option` and `subOption` that its text tells apart.

Invariant: an order that is given here is one that the program's text names; one that only a calculation can reach is not found.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from rapid_interp.reading import tree
from rapid_interp.reading.files import read_text
from rapid_interp.reading.modules import parse_any

_OPTION, _SUB_OPTION = "option", "suboption"
_Node: TypeAlias = object


@dataclass(frozen=True, order=True)
class Order:
    """An order to a program that loops around `TEST option`."""

    option: int
    sub_option: int

    def __str__(self) -> str:
        return f"{self.option}.{self.sub_option}"


def orders_of(program: Path) -> tuple[Order, ...]:
    """Gives all orders of a program, ascending; none where it does not loop around `TEST option`. Raises OSError."""
    modules = parse_any(read_text(program)).modules
    declarations = [declaration for module in modules for declaration in module.declarations]
    routines = {found.name.text.lower(): found for found in declarations if isinstance(found, tree.Routine)}
    arrays = {
        found.name.text.lower(): len(found.value.items)
        for found in declarations
        if isinstance(found, tree.Data) and found.dimensions and isinstance(found.value, tree.Aggregate)
    }
    orders: set[Order] = set()
    for routine in routines.values():
        for node in _nodes(routine.body):
            if isinstance(node, tree.Test) and _is(node.subject, _OPTION):
                for case in node.cases:
                    subs = set(_sub_options(case.body, routines, arrays, frozenset())) or {0}
                    orders |= {Order(option, sub) for option in map(_whole, case.values) if option for sub in subs}
    return tuple(sorted(orders))


def _sub_options(
    body: tuple[_Node, ...], routines: dict[str, tree.Routine], arrays: dict[str, int], inside: frozenset[str]
) -> Iterator[int]:
    """Gives the values of subOption that statements, and the procedures that they call, tell apart."""
    for node in _nodes(body):
        match node:
            case tree.Test() if _is(node.subject, _SUB_OPTION):
                yield from (value for case in node.cases for value in map(_whole, case.values) if value)
            case tree.Binary() if _is(node.left, _SUB_OPTION):
                yield from (1, _whole(node.right) or 1)
            case tree.Index() if any(_is(index, _SUB_OPTION) for index in node.indices) and isinstance(node.base, tree.Name):
                yield from range(1, arrays.get(node.base.text.lower(), 1) + 1)
            case tree.CallStatement() if isinstance(node.name, tree.Name):
                name = node.name.text.lower()
                if name in routines and name not in inside:
                    yield from _sub_options(routines[name].body, routines, arrays, inside | {name})
            case _:
                continue


def _nodes(node: _Node) -> Iterator[_Node]:
    """Gives a node of the tree and all in it."""
    if isinstance(node, tuple):
        yield node
        for part in node:
            yield from _nodes(part)


def _is(node: _Node, name: str) -> bool:
    return isinstance(node, tree.Name) and node.text.lower() == name


def _whole(node: _Node) -> int:
    """Gives the whole number that an expression is, 0 where it is none."""
    return int(node.value) if isinstance(node, tree.Number) and float(node.value).is_integer() else 0
