"""Operators: which operand types they take, what they give, and the code for it.

Invariant: a function here gets compiled operands and gives a compiled result; type errors are told by giving None.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import TypeAlias

from rapid_interp.library.poses import cross, multiply
from rapid_interp.meaning.symbols import Frame, Run
from rapid_interp.meaning.types import ANY, BOOL, DNUM, NUM, ORIENT, POS, STRING, Atomic, RapidType, Value, fits, is_opaque
from rapid_interp.running.numbers import add, divide, rounded, subtract, times
from rapid_interp.running.values import MAX_STRING, Fault, error_number

Combine: TypeAlias = Callable[[Value, Value], Value]


def _add(a: Run, b: Run) -> Run:
    return lambda f: a(f) + b(f)


def _subtract(a: Run, b: Run) -> Run:
    return lambda f: a(f) - b(f)


def _times(a: Run, b: Run) -> Run:
    return lambda f: a(f) * b(f)


def _num_add(a: Run, b: Run) -> Run:
    return lambda f: add(a(f), b(f))


def _num_subtract(a: Run, b: Run) -> Run:
    return lambda f: subtract(a(f), b(f))


def _num_times(a: Run, b: Run) -> Run:
    return lambda f: times(a(f), b(f))


def _less(a: Run, b: Run) -> Run:
    return lambda f: a(f) < b(f)


def _greater(a: Run, b: Run) -> Run:
    return lambda f: a(f) > b(f)


def _equal(a: Run, b: Run) -> Run:
    return lambda f: a(f) == b(f)


def _and(a: Run, b: Run) -> Run:
    return lambda f: a(f) and b(f)


def _or(a: Run, b: Run) -> Run:
    return lambda f: a(f) or b(f)


def _general(combine: Combine) -> Callable[[Run, Run], Run]:
    def make(a: Run, b: Run) -> Run:
        def run(f: Frame) -> Value:
            return combine(a(f), b(f))

        return run

    return make


def _divide(a: float, b: float) -> float:
    if b == 0:
        raise Fault("division by zero", "RAPID-R301", number=error_number("ERR_DIVZERO"))
    return a / b


def _whole(a: float, b: float, sign: str) -> tuple[int, int]:
    if a != int(a) or b != int(b):
        raise Fault(f"{sign} needs whole numbers, found {a:g} and {b:g}", "RAPID-R302")
    if b == 0:
        raise Fault("division by zero", "RAPID-R301", number=error_number("ERR_DIVZERO"))
    return int(a), int(b)


def _div(a: float, b: float) -> float:
    """Towards zero. ASSUMPTION A-35: DIV and MOD refuse numbers that are not whole; the sign of MOD is the dividend's."""
    x, y = _whole(a, b, "DIV")
    return float(abs(x) // abs(y) * (1 if (x < 0) == (y < 0) else -1))


def _mod(a: float, b: float) -> float:
    x, y = _whole(a, b, "MOD")
    return math.copysign(float(abs(x) % abs(y)), x) + 0.0


def _concatenate(a: str, b: str) -> str:
    text = a + b
    if len(text) > MAX_STRING:
        raise Fault(
            f"the string would have {len(text)} characters, more than {MAX_STRING}", "RAPID-R303", number=error_number("ERR_STRTOOLNG")
        )
    return text


def _pos_add(a: Value, b: Value) -> Value:
    return add(a[0], b[0]), add(a[1], b[1]), add(a[2], b[2])


def _pos_subtract(a: Value, b: Value) -> Value:
    return subtract(a[0], b[0]), subtract(a[1], b[1]), subtract(a[2], b[2])


def _scale(a: Value, b: Value) -> Value:
    return times(a[0], b), times(a[1], b), times(a[2], b)


def _shrink(a: Value, b: Value) -> Value:
    return divide(a[0], b), divide(a[1], b), divide(a[2], b)


def _cross(a: Value, b: Value) -> Value:
    return rounded(POS, cross(a, b))


def _turn(a: Value, b: Value) -> Value:
    return rounded(ORIENT, multiply(a, b))


_N, _P, _S, _B, _Q = "num", "pos", "string", "bool", "orient"
_TABLE: dict[tuple[str, str, str], tuple[RapidType, Callable[[Run, Run], Run]]] = {
    ("+", _N, _N): (NUM, _num_add),
    ("-", _N, _N): (NUM, _num_subtract),
    ("*", _N, _N): (NUM, _num_times),
    ("/", _N, _N): (NUM, _general(divide)),
    ("DIV", _N, _N): (NUM, _general(_div)),
    ("MOD", _N, _N): (NUM, _general(_mod)),
    ("+", _S, _S): (STRING, _general(_concatenate)),
    ("+", _P, _P): (POS, _general(_pos_add)),
    ("-", _P, _P): (POS, _general(_pos_subtract)),
    ("*", _P, _N): (POS, _general(_scale)),
    ("*", _N, _P): (POS, _general(lambda a, b: _scale(b, a))),
    ("*", _P, _P): (POS, _general(_cross)),
    ("/", _P, _N): (POS, _general(_shrink)),
    ("*", _Q, _Q): (ORIENT, _general(_turn)),
    ("<", _N, _N): (BOOL, _less),
    (">", _N, _N): (BOOL, _greater),
    ("<=", _N, _N): (BOOL, _general(operator.le)),
    (">=", _N, _N): (BOOL, _general(operator.ge)),
    # ASSUMPTION A-21: AND and OR do not look at their right side when the left one decides.
    ("AND", _B, _B): (BOOL, _and),
    ("OR", _B, _B): (BOOL, _or),
    ("XOR", _B, _B): (BOOL, _general(operator.ne)),
}


_DOUBLE = {"+": _add, "-": _subtract, "*": _times, "/": _general(_divide)}
"""Arithmetic of dnum; the table has that of num."""


def binary(sign: str, left: RapidType, right: RapidType, a: Run, b: Run) -> tuple[RapidType, Run] | None:
    """Gives type and code of an operation, or None if the operands' types do not suit it."""
    if sign in ("=", "<>"):
        # ASSUMPTION A-240: arrays of the same size can be compared whole, as they can be assigned.
        doubles = isinstance(left, Atomic) and isinstance(right, Atomic) and {left.name, right.name} == {"num", "dnum"}
        if not (doubles or fits(left, right)):
            return None
        return (BOOL, _equal(a, b)) if sign == "=" else (BOOL, _general(operator.ne)(a, b))
    is_dnum = DNUM in (left, right)
    keys = ("num" if left is DNUM else left.name), ("num" if right is DNUM else right.name)
    found = _TABLE.get((sign, *keys))
    if found is not None:
        kind, make = found
        if is_dnum and kind is NUM:
            return DNUM, _DOUBLE.get(sign, make)(a, b)
        return kind, make(a, b)
    if is_opaque(left) or is_opaque(right):
        known = keys[1] if is_opaque(left) else keys[0]
        guess = _TABLE.get((sign, known, known)) or next((entry for key, entry in _TABLE.items() if key[0] == sign), None)
        return (BOOL if guess and guess[0] is BOOL else ANY), _unknown
    return None


def _unknown(_: Frame) -> Value:
    raise Fault("not executed yet: an operation on data whose type is not known", "RAPID-R390")


def unary(sign: str, kind: RapidType, run: Run) -> tuple[RapidType, Run] | None:
    """Gives type and code of a sign or NOT, or None if the operand's type does not suit it."""
    if is_opaque(kind):
        return (BOOL if sign == "NOT" else ANY), _unknown
    if sign == "NOT":
        return (BOOL, lambda f: not run(f)) if kind is BOOL else None
    if kind in (NUM, DNUM):
        return kind, (run if sign == "+" else lambda f: -run(f))
    if kind is POS:
        return kind, (run if sign == "+" else lambda f: _scale(run(f), -1.0))
    return None
