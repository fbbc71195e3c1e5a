"""/rw/rapid/symbol and /rw/rapid/symbols: data of the program, read, set and searched."""

from __future__ import annotations

import re

from mitl.controllers.virtual.answers import DONE, NOT_ALLOWED, NOT_FOUND, Answer, Dialect, Item, Refused, answered, invalid
from mitl.controllers.virtual.cell import TASK, VirtualCell
from mitl.controllers.virtual.literals import element, join, split, with_element
from mitl.controllers.virtual.mastership import Mastership
from mitl.controllers.virtual.router import RWS1, RWS2, Call, Route
from mitl.errors import RigError
from rapid_interp.meaning.symbols import DataSymbol
from rapid_interp.meaning.types import Array

_NAME = re.compile(r"^([A-Za-z]\w*)((?:\{\d+(?:,\d+)*\})*)$", re.ASCII)
_LONGEST = 100_000
_KINDS = {"PERS": "per", "VAR": "var", "CONST": "con"}


class SymbolResources:
    """Data of the program."""

    def __init__(self, cell: VirtualCell, mastership: Mastership) -> None:
        self._cell = cell
        self._mastership = mastership

    def routes(self) -> list[Route]:
        """Gives the table."""
        return [
            Route("GET", "rw/rapid/symbol/data/RAPID/{path*}", self.read, RWS1),
            Route("POST", "rw/rapid/symbol/data/RAPID/{path*}", self.write, RWS1, "set"),
            Route("GET", "rw/rapid/symbol/properties/RAPID/{path*}", self.properties, RWS1),
            Route("POST", "rw/rapid/symbols", self.search, RWS1, "search-symbols"),
            Route("GET", "rw/rapid/symbol/RAPID/{path*}", self.get2, RWS2),
            Route("POST", "rw/rapid/symbol/RAPID/{path*}", self.post2, RWS2),
            Route("POST", "rw/rapid/symbols/search", self.search, RWS2),
        ]

    def get2(self, call: Call) -> Answer:
        """Data or properties, 2.0."""
        path, _, what = call.names["path"].rpartition("/")
        if what == "properties":
            return self._properties(call, path)
        if what != "data":
            raise Refused(404, NOT_FOUND, f"expected .../data or .../properties, got .../{what}")
        return self._read(call, path)

    def post2(self, call: Call) -> Answer:
        """Sets data, 2.0."""
        path, _, what = call.names["path"].rpartition("/")
        if what != "data":
            raise Refused(404, NOT_FOUND, f"expected .../data, got .../{what}")
        return self._write(call, path)

    def read(self, call: Call) -> Answer:
        """Data, 1.0; a literal `;value` at the end is left out."""
        return self._read(call, call.names["path"])

    def write(self, call: Call) -> Answer:
        """Sets data, 1.0."""
        return self._write(call, call.names["path"])

    def properties(self, call: Call) -> Answer:
        """Properties, 1.0."""
        return self._properties(call, call.names["path"])

    def value(self, path: str, dialect: Dialect) -> str:
        """Gives the literal of `T_ROB1/module/name{1}` or `T_ROB1/name`. Raises Refused."""
        symbol, indices = self._find(path, dialect)
        literal = self._cell.read(f"{symbol.module}:{symbol.name}")
        if not indices:
            return literal
        try:
            return join(element(split(literal), indices))
        except ValueError as error:
            raise invalid(f"{path}: {error}") from error

    def _read(self, call: Call, path: str) -> Answer:
        return answered(Item("rap-data", f"RAPID/{path.removesuffix(';value')}", {"value": self.value(path, call.dialect)}))

    def _write(self, call: Call, path: str) -> Answer:
        self._mastership.require_edit(call.session, implicit=call.implicit)
        symbol, indices = self._find(path, call.dialect)
        if symbol.storage == "CONST":
            raise Refused(403, NOT_ALLOWED, f"{symbol.name} is a constant and cannot be set")
        text = call.wanted("value")
        if len(text) > _LONGEST:
            raise invalid(f"a value has at most {_LONGEST} characters, got {len(text)}")
        name = f"{symbol.module}:{symbol.name}"
        try:
            if indices:
                text = join(with_element(split(self._cell.read(name)), indices, split(text)))
            self._cell.write(name, text)
        except (RigError, ValueError) as error:
            raise invalid(str(error)) from error
        return DONE

    def _properties(self, call: Call, path: str) -> Answer:
        symbol, _ = self._find(path, call.dialect)
        return answered(_described(symbol, "rap-symprop"))

    def search(self, call: Call) -> Answer:
        """The data below a block; symtyp chooses per, var or con."""
        self._cell.ensure_linked()
        wanted = {kind.strip().lower() for kind in call.form.get("symtyp", "any").split("|")}
        parts = [part for part in call.form.get("blockurl", "RAPID").split("/") if part]
        if len(parts) > 1 and parts[1].upper() != TASK:
            raise self._unknown("/".join(parts), call.dialect)
        module = parts[2].lower() if len(parts) > 2 else None
        pattern = call.form.get("regexp", "")
        try:
            matching = re.compile(pattern, re.IGNORECASE) if len(pattern) <= 100 else None
        except re.error:
            matching = None
        if matching is None:
            raise invalid("regexp is no regular expression of at most 100 characters")
        found = [
            symbol
            for symbol in self._cell.data
            if (wanted & {"any", "", _KINDS[symbol.storage]})
            and (module is None or symbol.module.lower() == module)
            and (not pattern or matching.fullmatch(symbol.name) is not None)
        ]
        return answered(*(_described(symbol, f"rap-symprop{_KINDS[symbol.storage]}-li") for symbol in found))

    def _find(self, path: str, dialect: Dialect) -> tuple[DataSymbol, list[int]]:
        self._cell.ensure_linked()
        parts = path.removesuffix(";value").split("/")
        match = _NAME.match(parts[-1])
        if match is None or not 1 < len(parts) < 4 or parts[0].upper() != TASK:
            raise self._unknown(path, dialect)
        module = parts[1].lower() if len(parts) == 3 else None
        found = [
            symbol
            for symbol in self._cell.data
            if symbol.name.lower() == match[1].lower() and (symbol.module.lower() == module if module is not None else True)
        ]
        if not found:
            raise self._unknown(path, dialect)
        public = [symbol for symbol in found if symbol.scope != "LOCAL"]
        indices = [int(index) for index in re.findall(r"\d+", match[2])]
        return (public or found)[0], indices

    def _unknown(self, path: str, dialect: Dialect) -> Refused:
        return Refused(400 if dialect is Dialect.RWS1 else 404, NOT_FOUND, f"No such RAPID symbol: RAPID/{path}")


def _described(symbol: DataSymbol, kind: str) -> Item:
    sizes = symbol.type.dimensions if isinstance(symbol.type, Array) else ()
    element_type = symbol.type.element.name if isinstance(symbol.type, Array) else symbol.type.name
    fields = {
        "symburl": f"RAPID/{TASK}/{symbol.module}/{symbol.name}",
        "name": symbol.name,
        "symtyp": _KINDS[symbol.storage],
        "named": "true",
        "dattyp": element_type,
        "ndim": str(len(sizes)),
        "dim": " ".join(str(size) for size in sizes),
        "heap": "false",
        "linked": "true",
        "local": str(symbol.scope == "LOCAL").lower(),
        "ro": str(symbol.storage == "CONST").lower(),
        "taskvar": str(symbol.scope == "TASK").lower(),
        "typurl": f"RAPID/{element_type}",
    }
    return Item(kind, fields["symburl"], fields)
