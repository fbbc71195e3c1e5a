"""Bits of a byte (0 to 255) and of a dnum (52 bits), and digits in strings.

Invariant: bit positions are 1-based, as RAPID's.
"""

from __future__ import annotations

import operator
from collections.abc import Callable

from rapid_interp.library.table import LibraryRoutine
from rapid_interp.meaning.types import DNUM, RapidType
from rapid_interp.running.values import Fault, Reference, error_number

BYTE, LONG = 8, 52


def _whole(value: float, bits: int, what: str) -> int:
    if value != int(value) or not 0 <= value < 2**bits:
        message = f"{what} needs a whole number from 0 to {2**bits - 1}, found {value:g}"
        raise Fault(message, "RAPID-R336", number=error_number("ERR_ARGVALERR"))
    return int(value)


def _position(value: float, bits: int) -> int:
    if value != int(value) or not 1 <= value <= bits:
        message = f"a bit position is a whole number from 1 to {bits}, found {value:g}"
        raise Fault(message, "RAPID-R336", number=error_number("ERR_ARGVALERR"))
    return int(value) - 1


def _of_two(name: str, bits: int, combine: Callable[[int, int], int]) -> Callable[[float, float], float]:
    return lambda a, b: float(combine(_whole(a, bits, name), _whole(b, bits, name)))


def _shift(name: str, bits: int, *, left: bool) -> Callable[[float, float], float]:
    def run(value: float, steps: float) -> float:
        number, count = _whole(value, bits, name), _whole(steps, BYTE, name)
        return float((number << count) % 2**bits if left else number >> count)

    return run


def _negated(name: str, bits: int) -> Callable[[float], float]:
    return lambda value: float(2**bits - 1 - _whole(value, bits, name))


def _check(name: str, bits: int) -> Callable[[float, float], bool]:
    return lambda value, place: bool(_whole(value, bits, name) >> _position(place, bits) & 1)


def _changed(name: str, *, on: bool) -> Callable[[tuple[RapidType, Reference], float], None]:
    def run(data: tuple[RapidType, Reference], place: float) -> None:
        bits = LONG if data[0] is DNUM else BYTE
        mask = 1 << _position(place, bits)
        number = _whole(data[1].get(), bits, name)
        data[1].put(float(number | mask if on else number & ~mask))

    return run


def _byte_to_str(value: float, hexadecimal: bool, octal: bool, binary: bool, character: bool) -> str:
    number = _whole(value, BYTE, "ByteToStr")
    if character:
        return chr(number)
    return f"{number:02X}" if hexadecimal else f"{number:03o}" if octal else f"{number:08b}" if binary else str(number)


def _str_to_byte(text: str, hexadecimal: bool, octal: bool, binary: bool, character: bool) -> float:
    try:
        number = ord(text) if character else int(text, 16 if hexadecimal else 8 if octal else 2 if binary else 10)
    except (TypeError, ValueError):
        raise Fault(f"StrToByte: {text!r} is no byte", "RAPID-R336", number=error_number("ERR_ARGVALERR")) from None
    return float(_whole(float(number), BYTE, "StrToByte"))


def _digits(text: str, base: int, what: str) -> int:
    try:
        return int(text, base)
    except ValueError:
        message = f"{what} needs digits, found {text!r}"
        raise Fault(message, "RAPID-R336", number=error_number("ERR_INT_NOTVAL")) from None


_RELATIONS: dict[float, Callable[[int, int], bool]] = {
    -1.0: operator.lt, -2.0: operator.le, 0.0: operator.eq, 3.0: operator.ne, 1.0: operator.gt, 2.0: operator.ge,
}  # fmt: skip


def _str_dig_cmp(first: str, relation: float, second: str) -> bool:
    if relation not in _RELATIONS:
        raise Fault(f"{relation:g} is no relation", "RAPID-R336", number=error_number("ERR_ARGVALERR"))
    return _RELATIONS[relation](_digits(first, 10, "StrDigCmp"), _digits(second, 10, "StrDigCmp"))


_OPERATIONS: dict[float, Callable[[int, int], int]] = {
    1.0: operator.add, 2.0: operator.sub, 3.0: operator.mul, 4.0: operator.floordiv, 5.0: operator.mod,
}  # fmt: skip
"""ASSUMPTION A-47: the values of OpAdd, OpSub, OpMult, OpDiv, OpMod; programs use the names."""


def _str_dig_calc(first: str, sign: float, second: str) -> str:
    if sign not in _OPERATIONS:
        raise Fault(f"{sign:g} is no operation", "RAPID-R336", number=error_number("ERR_ARGVALERR"))
    a, b = _digits(first, 10, "StrDigCalc"), _digits(second, 10, "StrDigCalc")
    if sign >= 4 and b == 0:
        raise Fault("division by zero", "RAPID-R301", number=error_number("ERR_DIVZERO"))
    found = _OPERATIONS[sign](a, b)
    if not 0 <= found < 2**32:
        raise Fault(f"StrDigCalc: {found} is outside of 0 to {2**32 - 1}", "RAPID-R336", number=error_number("ERR_INT_MAXVAL"))
    return str(found)


def _family(suffix: str, kind: str, bits: int) -> tuple[LibraryRoutine, ...]:
    two: tuple[tuple[str, Callable[[int, int], int]], ...] = (("And", operator.and_), ("Or", operator.or_), ("XOr", operator.xor))
    return (
        *(
            LibraryRoutine(f"FUNC {kind} Bit{name}{suffix}({kind} BitData1, {kind} BitData2)", _of_two(f"Bit{name}", bits, combine))
            for name, combine in two
        ),
        LibraryRoutine(f"FUNC {kind} BitNeg{suffix}({kind} BitData)", _negated("BitNeg", bits)),
        LibraryRoutine(f"FUNC {kind} BitLSh{suffix}({kind} BitData, num ShiftSteps)", _shift("BitLSh", bits, left=True)),
        LibraryRoutine(f"FUNC {kind} BitRSh{suffix}({kind} BitData, num ShiftSteps)", _shift("BitRSh", bits, left=False)),
        LibraryRoutine(f"FUNC bool BitCheck{suffix}({kind} BitData, num BitPos)", _check("BitCheck", bits)),
    )


_FORM = r"\switch Hex | switch Okt | switch Bin | switch Char"
ROUTINES = (
    *_family("", "byte", BYTE),
    *_family("Dnum", "dnum", LONG),
    LibraryRoutine("PROC BitSet(INOUT numericdata BitData, num BitPos)", _changed("BitSet", on=True)),
    LibraryRoutine("PROC BitClear(INOUT numericdata BitData, num BitPos)", _changed("BitClear", on=False)),
    LibraryRoutine(rf"FUNC string ByteToStr(byte BitData {_FORM})", _byte_to_str),
    LibraryRoutine(rf"FUNC byte StrToByte(string ConStr {_FORM})", _str_to_byte),
    LibraryRoutine("FUNC string DecToHex(string Str)", lambda text: f"{_digits(text, 10, 'DecToHex'):X}"),
    LibraryRoutine("FUNC string HexToDec(string Str)", lambda text: str(_digits(text, 16, "HexToDec"))),
    LibraryRoutine("FUNC bool StrDigCmp(stringdig StrDig1, num Relation, stringdig StrDig2)", _str_dig_cmp),
    LibraryRoutine("FUNC stringdig StrDigCalc(stringdig StrDig1, num Operation, stringdig StrDig2)", _str_dig_calc),
)
