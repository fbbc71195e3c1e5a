"""JsonValue: JSON read strictly: what does not fit is refused with the place where it stands."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TypeVar

from mitl.errors import UsageError
from mitl.outcome import Outcome

_Kind = TypeVar("_Kind")


def read_json(file: Path, expected: str) -> JsonValue:
    """Gives the JSON of a file. Raises UsageError where it cannot be read, telling what was expected there, or is no JSON."""
    try:
        value = json.loads(file.read_text(encoding="utf-8"), parse_constant=_no_constant)
    except OSError as error:
        raise UsageError(f"{file}: {error.strerror}; {expected}") from error
    except (ValueError, RecursionError) as error:
        raise UsageError(f"{file}: not JSON: {error}") from error
    return JsonValue(value, str(file))


class JsonValue:
    """A JSON value with the place where it stands, so that a message can name it."""

    def __init__(self, value: object, where: str) -> None:
        """value: as json gives it. where: begins every message."""
        self.value = value
        self.where = where

    def at(self, key: str) -> JsonValue:
        """Gives a value that must be there."""
        inner = self._a(dict, "an object")
        if key not in inner:
            raise UsageError(f"{self.where}: {key!r} is missing")
        return JsonValue(inner[key], f"{self.where}: {key}")

    def optional(self, key: str, default: object) -> JsonValue:
        """Gives a value that may be left out."""
        inner = self._a(dict, "an object")
        return JsonValue(inner.get(key, default), f"{self.where}: {key}")

    def items(self) -> list[JsonValue]:
        """Gives the values of a list."""
        return [JsonValue(item, f"{self.where}[{number}]") for number, item in enumerate(self._a(list, "a list"))]

    def pairs(self) -> list[tuple[str, JsonValue]]:
        """Gives names and values of an object."""
        return [(name, JsonValue(item, f"{self.where}.{name}")) for name, item in self._a(dict, "an object").items()]

    def text(self) -> str:
        """Gives a text."""
        return self._a(str, "text")

    def text_or_none(self) -> str | None:
        """Gives a text, or None for null."""
        return None if self.value is None else self.text()

    def file_name(self) -> str | None:
        """Gives a name in the same folder: a record must not make the report read elsewhere."""
        name = self.text_or_none()
        if name is not None and (Path(name).name != name or name in {".", ".."}):
            raise UsageError(f"{self.where}: expected the name of a file in the run's folder, found {name!r}")
        return name

    def number(self) -> float:
        """Gives a number."""
        if isinstance(self.value, int) and not isinstance(self.value, bool):
            return float(self.value)
        return self._a(float, "a number")

    def number_or_none(self) -> float | None:
        """Gives a number, or None for null."""
        return None if self.value is None else self.number()

    def whole(self) -> int:
        """Gives a whole number."""
        if isinstance(self.value, bool):
            raise self._unexpected("a whole number")
        return self._a(int, "a whole number")

    def truth(self) -> bool:
        """Gives true or false."""
        return self._a(bool, "true or false")

    def outcome(self) -> Outcome:
        """Gives an outcome by its name."""
        try:
            return Outcome(self.text())
        except ValueError:
            raise self._unexpected("one of " + ", ".join(outcome.value for outcome in Outcome)) from None

    def _a(self, kind: type[_Kind], name: str) -> _Kind:
        if not isinstance(self.value, kind):
            raise self._unexpected(name)
        return self.value

    def _unexpected(self, expected: str) -> UsageError:
        shown = json.dumps(self.value, ensure_ascii=False)
        return UsageError(f"{self.where}: expected {expected}, found {shown[:60]}{'...' if len(shown) > 60 else ''}")


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is no JSON number")
