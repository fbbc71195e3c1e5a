"""RAPID's num: single precision.

Invariant: a num is held as the shortest decimal number that names its single-precision value, as a Python float. So 0.1 stays 0.1 for
everyone who reads it, no two such floats stand for the same num, and comparing them compares the nums; arithmetic is done on the
single-precision values themselves (`exact`).
"""

from __future__ import annotations

import math
from struct import Struct

from rapid_interp.meaning.types import NUM, Array, RapidType, Record, Value
from rapid_interp.running.values import Fault, error_number

_ONE, _TWO = Struct("<f"), Struct("<ff")
_pack, _unpack = _ONE.pack, _ONE.unpack
_pack2, _unpack2 = _TWO.pack, _TWO.unpack
_WHOLE = 16777216.0


def _too_large() -> Fault:
    return Fault("the number is too large for num", "RAPID-R305", number=error_number("ERR_NUM_LIMIT"))


def exact(value: float) -> float:
    """Gives the single-precision value that is nearest to a number."""
    try:
        found: float = _unpack(_pack(value))[0]
    except OverflowError:
        raise _too_large() from None
    if math.isinf(found):
        raise _too_large()
    return found


def num(value: float) -> float:
    """Gives the num that is nearest to a number."""
    if -_WHOLE <= value <= _WHOLE and value.is_integer():
        return value
    single = exact(value)
    for digits in (6, 7, 8):
        short = float(f"{single:.{digits}g}")
        try:
            if _unpack(_pack(short))[0] == single:
                return short
        except OverflowError:
            continue
    return float(f"{single:.9g}")


def add(a: float, b: float) -> float:
    """Gives the sum of two nums."""
    x, y = _unpack2(_pack2(a, b))
    return num(x + y)


def subtract(a: float, b: float) -> float:
    """Gives the difference of two nums."""
    x, y = _unpack2(_pack2(a, b))
    return num(x - y)


def times(a: float, b: float) -> float:
    """Gives the product of two nums."""
    x, y = _unpack2(_pack2(a, b))
    return num(x * y)


def divide(a: float, b: float) -> float:
    """Gives the quotient of two nums."""
    if b == 0:
        raise Fault("division by zero", "RAPID-R301", number=error_number("ERR_DIVZERO"))
    x, y = _unpack2(_pack2(a, b))
    return num(x / y)


def rounded(kind: RapidType, value: Value) -> Value:
    """Gives a value with all its nums in single precision."""
    if kind is NUM:
        return num(float(value))
    match kind:
        case Record():
            return tuple([rounded(part, item) for (_, part), item in zip(kind.components, value, strict=True)])
        case Array():
            inner = kind.element if len(kind.dimensions) == 1 else Array(kind.element, kind.dimensions[1:])
            return tuple([rounded(inner, item) for item in value])
        case _:
            return value


def has_nums(kind: RapidType) -> bool:
    """Gives whether a value of this type has nums in it."""
    match kind:
        case Record():
            return any(has_nums(part) for _, part in kind.components)
        case Array():
            return has_nums(kind.element)
        case _:
            return kind is NUM
