"""Arithmetic functions. Angles are degrees.

Invariant: pure functions of floats; a value outside the domain is a `Fault`, raised by the task for ValueError too.
"""

from __future__ import annotations

import math

from rapid_interp.library.table import LibraryRoutine
from rapid_interp.running.numbers import exact
from rapid_interp.running.values import Fault, error_number


def _sqrt(value: float) -> float:
    if value < 0:
        raise Fault(f"square root of the negative number {value:g}", "RAPID-R332")
    return math.sqrt(value)


def _inverse(function: str, value: float) -> float:
    if not -1.0 <= value <= 1.0:
        raise Fault(f"{function} needs a value from -1 to 1, found {value:g}", "RAPID-R332")
    return math.degrees(math.asin(value) if function == "ASin" else math.acos(value))


def _round(value: float, decimals: float | None) -> float:
    r"""Half away from zero. ASSUMPTION A-33: a tie in decimal notation counts as a tie (`Round(0.285\Dec:=2)` is 0.29)."""
    scale = 10.0 ** int(decimals or 0)
    scaled = abs(value) * scale
    nearest = math.floor(scaled + 0.5)
    if nearest + 0.5 - scaled < 1e-9 * max(1.0, scaled):
        nearest += 1
    return math.copysign(nearest / scale, value) + 0.0


def _trunc(value: float, decimals: float | None) -> float:
    scale = 10.0 ** int(decimals or 0)
    whole = math.floor(abs(value) * scale * (1.0 + 1e-12))
    return math.copysign(whole / scale, value) + 0.0


def _pow(base: float, exponent: float) -> float:
    if base < 0 and exponent != int(exponent):
        raise Fault(f"Pow of the negative base {base:g} needs a whole exponent, found {exponent:g}", "RAPID-R332")
    return math.pow(base, exponent)


def _dnum_to_num(value: float, whole: bool) -> float:
    if whole and value != int(value):
        raise Fault(f"{value:g} is no integer", "RAPID-R331", number=error_number("ERR_ARGVALERR"))
    return float(value)


def _tan(angle: float) -> float:
    return math.tan(math.radians(angle))


def _sin(angle: float) -> float:
    """Exact at multiples of 90 deg, so that programs that build paths from angles meet their own points."""
    quarter, rest = divmod(angle, 90.0)
    return (0.0, 1.0, 0.0, -1.0)[int(quarter) % 4] if rest == 0 else math.sin(math.radians(angle))


def _cos(angle: float) -> float:
    return _sin(angle + 90.0) if angle % 90.0 == 0 else math.cos(math.radians(angle))


ROUTINES = (
    LibraryRoutine("FUNC num Abs(num Value)", abs),
    LibraryRoutine("FUNC dnum AbsDnum(dnum Value)", abs),
    LibraryRoutine("FUNC num Sqrt(num Value)", _sqrt),
    LibraryRoutine("FUNC num Sin(num Angle)", _sin),
    LibraryRoutine("FUNC num Cos(num Angle)", _cos),
    LibraryRoutine("FUNC num Tan(num Angle)", _tan),
    LibraryRoutine("FUNC num ASin(num Value)", lambda value: _inverse("ASin", value)),
    LibraryRoutine("FUNC num ACos(num Value)", lambda value: _inverse("ACos", value)),
    LibraryRoutine("FUNC num ATan(num Value)", lambda value: math.degrees(math.atan(value))),
    LibraryRoutine("FUNC num ATan2(num Y, num X)", lambda y, x: math.degrees(math.atan2(y, x))),
    LibraryRoutine("FUNC num Pow(num Base, num Exponent)", _pow),
    LibraryRoutine("FUNC num Exp(num Exponent)", math.exp),
    # ASSUMPTION A-242: Max and Min of RobotWare 7 take two numbers.
    LibraryRoutine("FUNC num Max(num A, num B)", max),
    LibraryRoutine("FUNC num Min(num A, num B)", min),
    LibraryRoutine(r"FUNC num Round(num Val \num Dec)", _round),
    LibraryRoutine(r"FUNC num Trunc(num Val \num Dec)", _trunc),
    LibraryRoutine(r"FUNC dnum RoundDnum(dnum Val \num Dec)", _round),
    LibraryRoutine(r"FUNC dnum TruncDnum(dnum Val \num Dec)", _trunc),
    *(
        LibraryRoutine(f"FUNC dnum {name}Dnum(dnum Value)", run)
        for name, run in (
            ("Sqrt", _sqrt),
            ("Sin", _sin),
            ("Cos", _cos),
            ("Tan", _tan),
            ("Exp", math.exp),
            ("ASin", lambda value: _inverse("ASin", value)),
            ("ACos", lambda value: _inverse("ACos", value)),
            ("ATan", lambda value: math.degrees(math.atan(value))),
        )
    ),
    LibraryRoutine("FUNC dnum ATan2Dnum(dnum Y, dnum X)", lambda y, x: math.degrees(math.atan2(y, x))),
    LibraryRoutine("FUNC dnum PowDnum(dnum Base, dnum Exponent)", _pow),
    LibraryRoutine("FUNC dnum NumToDnum(num Value)", exact),
    LibraryRoutine(r"FUNC num DnumToNum(dnum Value \switch Integer)", _dnum_to_num),
)
