"""Code for elements of arrays, and nums in single precision.

Invariant: an array is read by `raw` here, so that reading an element never copies the whole.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from rapid_interp.meaning.compiler import Operand, constant
from rapid_interp.meaning.symbols import Frame, Run
from rapid_interp.meaning.types import NUM, Value
from rapid_interp.running.numbers import num
from rapid_interp.running.values import ElementReference, Fault, error_number


def single(operand: Operand) -> Operand:
    """Gives a num operand with its value in single precision if it is a constant; literals are kept as written till then, for dnum."""
    if not operand.constant:
        return operand
    try:
        return replace(operand, run=constant(NUM, num(operand.run([]))).run)
    except (Fault, ArithmeticError, ValueError, LookupError):
        return operand


def checked(place: Run, at: int) -> Callable[[Frame, Value], int]:
    """Gives the code for a 0-based place inside an array, checked against its size."""

    def place_of(f: Frame, value: Value) -> int:
        number = place(f)
        try:
            found = int(number)
        except (OverflowError, ValueError):
            found = 0
        if found != number or not 0 < found <= len(value):
            raise Fault(f"index {number:g} is outside of 1..{len(value)}", "RAPID-R304", start=at, number=error_number("ERR_OUTOFBND"))
        return found - 1

    return place_of


def element(whole: Run, refer: Run | None, checks: list[Callable[[Frame, Value], int]]) -> tuple[Run, Run | None]:
    """Gives the code for an element's value, and for its reference if the array has one."""
    if len(checks) == 1:
        only = checks[0]

        def run(f: Frame) -> Value:
            value = whole(f)
            return value[only(f, value)]
    else:

        def run(f: Frame) -> Value:
            value = whole(f)
            for check in checks:
                value = value[check(f, value)]
            return value

    if refer is None:
        return run, None
    base = refer

    def reference(f: Frame) -> Value:
        found = base(f)
        value, places = found.raw(), []
        for check in checks:
            place = check(f, value)
            places.append(place)
            value = value[place]
        return ElementReference(found, tuple(places))

    return run, reference
