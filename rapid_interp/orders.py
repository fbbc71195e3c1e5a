"""The orders that a program takes: values of the data that a loop of it tests, as a test program waits for `option` and `subOption`.

Invariant: read from the text alone; nothing is run. What is found are the values that a CASE names or an array's bounds allow.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from rapid_interp.errors import RapidError
from rapid_interp.meaning.symbols import DataSymbol
from rapid_interp.meaning.types import Array
from rapid_interp.program import Program
from rapid_interp.reading import tree


@dataclass(frozen=True)
class Order:
    """Values of data by name, the one that the loop tests last: set in this order, they are an order to the running program."""

    values: tuple[tuple[str, float], ...]

    @property
    def name(self) -> str:
        """The data that the loop tests; the program gives it another value once the order is done."""
        return self.values[-1][0]

    @property
    def value(self) -> float:
        """The value of that data."""
        return self.values[-1][1]

    def __str__(self) -> str:
        return ", ".join(f"{name} = {value:g}" for name, value in reversed(self.values))


def orders(program: Program, routine: str = "main") -> tuple[Order, ...]:
    """Gives the orders of a program that is started at `routine`, in the order of its text; none where no loop tests module data.

    An order is a value of the data that a TEST in a WHILE loop is about, for each combination of values of other module data that is tested
    below that CASE, or that an array is indexed with there.
    """
    search = _Search(program)
    found: dict[Order, None] = {}
    for loop in search.loops(routine):
        for test in search.outermost(loop.body, set()):
            found.update(dict.fromkeys(search.orders_of(test)))
    return tuple(found)


class _Search:
    """Looks for tested data in the routines of a program."""

    def __init__(self, program: Program) -> None:
        self._program = program
        self._routines: dict[str, tree.Routine] = {
            part.name.text.lower(): part for module in program.trees for part in module.declarations if isinstance(part, tree.Routine)
        }

    def orders_of(self, test: tree.Test) -> Iterator[Order]:
        """Gives the orders that a TEST of a loop takes; none where it is about anything but module data that may be set."""
        subject = self._settable(test.subject)
        if subject is None:
            return
        for case in test.cases:
            below = self._below(case.body, subject)
            for value in self._numbers(case.values):
                for others in itertools.product(*below.values()):
                    yield Order((*zip(below, others, strict=True), (subject.name, value)))

    def loops(self, routine: str) -> Iterator[tree.While]:
        """Gives the WHILE loops of a procedure and of those that it calls."""
        begin = self._routines.get(routine.lower())
        for statement in self._with_calls(begin.body if begin is not None else (), set()):
            if isinstance(statement, tree.While):
                yield statement

    def outermost(self, body: Iterable[tree.Statement], seen: set[str]) -> Iterator[tree.Test]:
        """Gives the TESTs of a loop's body that are in no other TEST, those of the procedures that it calls too."""
        for statement in body:
            if isinstance(statement, tree.Test):
                yield statement
            else:
                for inner in _bodies(statement):
                    yield from self.outermost(inner, seen)
                if (called := self._called(statement, seen)) is not None:
                    yield from self.outermost(called.body, seen)

    def _below(self, body: tuple[tree.Statement, ...], subject: DataSymbol) -> dict[str, tuple[float, ...]]:
        """Gives the values of the further data that statements, and the procedures that they call, test or take as an index."""
        tested: dict[str, dict[float, None]] = {}
        indexed: dict[str, dict[float, None]] = {}
        for statement in self._with_calls(body, set()):
            if isinstance(statement, tree.Test):
                symbol = self._settable(statement.subject)
                if symbol is not None:
                    values = (value for case in statement.cases for value in self._numbers(case.values))
                    tested.setdefault(symbol.name, {}).update(dict.fromkeys(values))
            for index in (part for part in _parts(statement) if isinstance(part, tree.Index)):
                for symbol, bound in self._bounds(index):
                    indexed.setdefault(symbol.name, {}).update(dict.fromkeys(float(number) for number in range(1, bound + 1)))
        return {name: tuple(values) for name, values in {**indexed, **tested}.items() if name != subject.name and values}

    def _with_calls(self, body: Iterable[tree.Statement], seen: set[str]) -> Iterator[tree.Statement]:
        for statement in _all(body):
            yield statement
            if (called := self._called(statement, seen)) is not None:
                yield from self._with_calls(called.body, seen)

    def _called(self, statement: tree.Statement, seen: set[str]) -> tree.Routine | None:
        """Gives the program's own procedure that a statement calls, where it is not yet among those seen."""
        if not isinstance(statement, tree.CallStatement) or not isinstance(statement.name, tree.Name):
            return None
        name = statement.name.text.lower()
        if name in seen:
            return None
        seen.add(name)
        return self._routines.get(name)

    def _bounds(self, index: tree.Index) -> Iterator[tuple[DataSymbol, int]]:
        """Gives the settable data that an array is indexed with, and up to which."""
        array = self._data(index.base)
        if array is None or not isinstance(array.type, Array):
            return
        for one, size in zip(index.indices, array.type.dimensions, strict=False):
            symbol = self._settable(one)
            if symbol is not None:
                yield symbol, size

    def _data(self, expression: tree.Expression) -> DataSymbol | None:
        if not isinstance(expression, tree.Name):
            return None
        try:
            return self._program.find_data(expression.text)
        except RapidError:  # a local name, which is nobody's to set
            return None

    def _settable(self, expression: tree.Expression) -> DataSymbol | None:
        symbol = self._data(expression)
        return symbol if symbol is not None and symbol.storage != "CONST" and symbol.type.name in {"num", "dnum"} else None

    def _numbers(self, values: Iterable[tree.Expression]) -> Iterator[float]:
        for value in values:
            if isinstance(value, tree.Number):
                yield value.value
            elif isinstance(value, tree.Unary) and value.operator == "-" and isinstance(value.operand, tree.Number):
                yield -value.operand.value
            else:
                symbol = self._data(value)
                if symbol is not None and symbol.storage == "CONST" and symbol.fixed and isinstance(symbol.fixed[0], float):
                    yield symbol.fixed[0]


def _all(statements: Iterable[tree.Statement]) -> Iterator[tree.Statement]:
    """Gives statements with all those within them."""
    for statement in statements:
        yield statement
        for inner in _bodies(statement):
            yield from _all(inner)


def _bodies(statement: tree.Statement) -> Iterator[tuple[tree.Statement, ...]]:
    """Gives the lists of statements that a statement holds."""
    if isinstance(statement, tree.If):
        yield from (branch.body for branch in statement.branches)
        yield statement.otherwise or ()
    elif isinstance(statement, tree.While | tree.For):
        yield statement.body
    elif isinstance(statement, tree.Test):
        yield from (case.body for case in statement.cases)
        yield statement.default or ()


def _parts(statement: tree.Statement) -> Iterator[object]:
    """Gives the parts of a statement's own expressions, those of statements within it left out."""
    left: list[object] = [part for part in statement if not _holds_statements(part)]
    while left:
        part = left.pop()
        yield part
        if isinstance(part, tuple):
            left += part


def _holds_statements(part: object) -> bool:
    return isinstance(part, tuple) and any(isinstance(one, tree.Branch | tree.Case | tree.Statement) for one in part)
