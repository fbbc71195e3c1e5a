"""Strings. Positions are 1-based.

Invariant: pure functions; a position outside the string is a `Fault`.
"""

from __future__ import annotations

from rapid_interp.library.table import LibraryRoutine
from rapid_interp.meaning.types import RapidType, Value
from rapid_interp.running.format import decimals_printed, printed
from rapid_interp.running.literals import value_of
from rapid_interp.running.numbers import exact
from rapid_interp.running.values import MAX_STRING, Fault, Reference, error_number

MAX_DECIMALS = 15


def checked_length(text: str) -> str:
    """Gives a text that fits into a RAPID string."""
    if len(text) > MAX_STRING:
        message = f"the string would have {len(text)} characters, more than {MAX_STRING}"
        raise Fault(message, "RAPID-R303", number=error_number("ERR_STRTOOLNG"))
    return text


def _num_to_str(value: float, decimals: float, exponent: bool) -> str:
    """ASSUMPTION A-83: more than 15 decimals are refused."""
    if not 0 <= decimals <= MAX_DECIMALS:
        raise Fault(f"the number of decimals is 0 to {MAX_DECIMALS}, found {decimals:g}", "RAPID-R333")
    return checked_length(decimals_printed(value, int(decimals), exponent=exponent))


def _val_to_str(typed: tuple[RapidType, Value]) -> str:
    return checked_length(printed(*typed))


def _str_part(text: str, position: float, length: float) -> str:
    start = int(position) - 1
    if start < 0 or start > len(text) or length < 0 or start + int(length) > len(text):
        raise Fault(f"StrPart: {length:g} characters from {position:g} are not inside a string of {len(text)}", "RAPID-R333")
    return text[start : start + int(length)]


def _start(text: str, position: float) -> int:
    if not 1 <= position <= len(text) + 1 or position != int(position):
        raise Fault(f"position {position:g} is not inside a string of {len(text)}", "RAPID-R333")
    return int(position) - 1


def _str_memb(text: str, position: float, members: str) -> bool:
    place = _start(text, position)
    return place < len(text) and text[place] in members


def _str_find(text: str, position: float, characters: str, not_in: bool) -> float:
    for place in range(_start(text, position), len(text)):
        if (text[place] in characters) is not not_in:
            return float(place + 1)
    return float(len(text) + 1)


def _str_match(text: str, position: float, pattern: str) -> float:
    found = text.find(pattern, _start(text, position))
    return float(found + 1 if found >= 0 else len(text) + 1)


def _str_map(text: str, source: str, target: str) -> str:
    if len(source) != len(target):
        raise Fault("StrMap needs two strings of the same length", "RAPID-R333")
    return text.translate(str.maketrans(source, target))


def _str_to_val(text: str, target: tuple[RapidType, Reference]) -> bool:
    kind, reference = target
    value = value_of(kind, text)
    if value is not None:
        reference.put(value)
    return value is not None


def _str_order(first: str, second: str, order: str) -> bool:
    """Whether the first is not after the second in the given order; characters outside of it come after those in it."""

    def key(text: str) -> list[tuple[int, int]]:
        return [
            (order.find(character) if character in order else len(order), ord(character) * (character not in order)) for character in text
        ]

    return key(first) <= key(second)


def _str_format(text: str, *arguments: str | None) -> str:
    for place, argument in enumerate(arguments, start=1):
        text = text.replace(f"{{{place}}}", argument or "")
    return checked_length(text)


ROUTINES = (
    LibraryRoutine("FUNC bool StrOrder(string Str1, string Str2, string Order)", _str_order),
    LibraryRoutine(
        r"FUNC string StrFormat(string Str \string Arg1 \string Arg2 \string Arg3 \string Arg4 \string Arg5 \string Arg6)", _str_format
    ),
    LibraryRoutine("FUNC bool StrToVal(string Str, INOUT anydata Val)", _str_to_val),
    LibraryRoutine(
        r"FUNC string NumToStr(num Val, num Dec \switch Exp)", lambda value, decimals, exp: _num_to_str(exact(value), decimals, exp)
    ),
    LibraryRoutine(r"FUNC string DnumToStr(dnum Val, num Dec \switch Exp)", _num_to_str),
    LibraryRoutine("FUNC string ValToStr(anytype Val)", _val_to_str),
    LibraryRoutine("FUNC num StrLen(string Str)", lambda text: float(len(text))),
    LibraryRoutine("FUNC string StrPart(string Str, num ChPos, num Len)", _str_part),
    LibraryRoutine(r"FUNC num StrFind(string Str, num ChPos, string Set \switch NotInSet)", _str_find),
    LibraryRoutine("FUNC num StrMatch(string Str, num ChPos, string Pattern)", _str_match),
    LibraryRoutine("FUNC bool StrMemb(string Str, num ChPos, string Set)", _str_memb),
    LibraryRoutine("FUNC string StrMap(string Str, string FromMap, string ToMap)", _str_map),
)
