"""Values as text: as RAPID prints them, and as RAPID literals that give the same value again.

Invariant: `literal` loses nothing; `printed` shows what a single-precision num shows.
"""

from __future__ import annotations

from rapid_interp.meaning.types import DNUM, Array, Atomic, RapidType, Record, Value


def number_printed(value: float, digits: int = 6) -> str:
    """Gives a num as TPWrite and ValToStr show it: six significant digits, `1E+07`.

    ASSUMPTION A-24: six digits for num, fifteen for dnum.
    """
    return f"{value + 0.0:.{digits}G}"  # + 0.0 turns -0 into 0


def decimals_printed(value: float, decimals: int, *, exponent: bool = False) -> str:
    """Gives a number with a fixed number of decimals (`NumToStr`)."""
    if exponent:
        return f"{value:.{decimals}E}"
    text = f"{value:.{decimals}f}"
    return text[1:] if text.startswith("-") and not text.strip("-0.") else text


def printed(kind: RapidType, value: Value) -> str:
    """Gives a value as `ValToStr` shows it."""
    match kind:
        case Atomic():
            if isinstance(value, bool):
                return "TRUE" if value else "FALSE"
            if isinstance(value, str):
                return f'"{value}"'
            if isinstance(value, float):
                return number_printed(value, 15 if kind is DNUM else 6)
            if isinstance(value, tuple):  # data of a type whose components are not known
                return "[" + ",".join(printed(kind, item) for item in value) + "]"
            return "[]"
        case Record():
            return "[" + ",".join(printed(part, item) for (_, part), item in zip(kind.components, value, strict=True)) + "]"
        case Array():
            inner = kind.element if len(kind.dimensions) == 1 else Array(kind.element, kind.dimensions[1:])
            return "[" + ",".join(printed(inner, item) for item in value) + "]"


def number_literal(value: float) -> str:
    """Gives the shortest RAPID literal that reads as this number again."""
    text = repr(float(value) + 0.0)  # + 0.0 turns -0 into 0
    if text.endswith(".0"):
        text = text[:-2]
    if len(text.lstrip("-")) > 7 and text.endswith("0000") and "." not in text and "e" not in text:
        text = f"{value:.15E}"
    if "e" in text or "E" in text:
        mantissa, _, exponent = text.upper().partition("E")
        mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
        return f"{mantissa}E{int(exponent):+03d}"
    return text


def literal(value: Value) -> str:
    """Gives a value as a RAPID literal."""
    if isinstance(value, bool):
        return "TRUE" if value else "FALSE"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '""') + '"'
    if isinstance(value, tuple):
        return "[" + ",".join(literal(item) for item in value) + "]"
    return number_literal(value)
