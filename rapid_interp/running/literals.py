"""Text to a value of a given type, for literals only (`StrToVal`).

Invariant: nothing is looked up or computed; what is no literal of the type gives None.
"""

from __future__ import annotations

from rapid_interp.meaning.types import BOOL, DNUM, NUM, STRING, Array, Atomic, RapidType, Record, Value
from rapid_interp.reading.expressions import ExpressionParser, SyntaxProblem
from rapid_interp.reading.lexer import END
from rapid_interp.reading.tree import Aggregate, Expression, Number, Text, Truth, Unary
from rapid_interp.running.numbers import num
from rapid_interp.source import SourceText


def value_of(kind: RapidType, text: str) -> Value | None:
    """Gives the value that a text is a literal of, or None. A string needs no quotes."""
    if kind is STRING:
        return text
    parser = ExpressionParser(SourceText("", text))
    try:
        node = parser.expression()
    except SyntaxProblem:
        return None
    return None if parser.diagnostics or parser.kinds[parser.at] != END else _converted(kind, node)


def _converted(kind: RapidType, node: Expression) -> Value | None:
    match kind, node:
        case Atomic(), Number() if kind in (NUM, DNUM):
            return num(node.value) if kind is NUM else node.value
        case Atomic(), Unary(operator="-" | "+", operand=Number() as number) if kind in (NUM, DNUM):
            value = -number.value if node.operator == "-" else number.value
            return num(value) if kind is NUM else value
        case Atomic(), Truth() if kind is BOOL:
            return node.value
        case Atomic(), Text() if kind is STRING:
            return node.value
        case Record(), Aggregate() if len(kind.components) == len(node.items):
            parts = tuple(_converted(part, item) for (_, part), item in zip(kind.components, node.items, strict=True))
            return None if None in parts else parts
        case Array(), Aggregate() if kind.dimensions[0] == len(node.items):
            inner = kind.element if len(kind.dimensions) == 1 else Array(kind.element, kind.dimensions[1:])
            parts = tuple(_converted(inner, item) for item in node.items)
            return None if None in parts else parts
        case _:
            return None
