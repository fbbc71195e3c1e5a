"""The modules of a running task: those of its program, and those that it loads while it runs.

Invariant: the program is never changed; what a task loads is its own. Slots of data that was unloaded are not used again.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rapid_interp.errors import Severity
from rapid_interp.meaning.compiler import Findings
from rapid_interp.meaning.declarations import Declarations
from rapid_interp.meaning.resolving import resolve
from rapid_interp.meaning.symbols import DataSymbol, RoutineSymbol, Scope
from rapid_interp.meaning.types import Value
from rapid_interp.reading.modules import Parsed, parse_any
from rapid_interp.reading.tree import Data, Module
from rapid_interp.running.format import literal
from rapid_interp.running.values import Fault, error_number, frozen
from rapid_interp.source import SourceText


class ModuleTable:
    """Finds routines, data and texts by name."""

    def __init__(
        self,
        scopes: Mapping[str, Scope],
        everywhere: Scope,
        data: Sequence[DataSymbol],
        parsed: Sequence[Parsed],
        values: list[Value],
    ) -> None:
        self.data: list[DataSymbol] = list(data)
        self._values = values
        self._scopes = dict(scopes)
        self._loaded = Scope(everywhere)
        """Names that modules loaded by this task declare for all."""
        self._texts = {module.name.text.lower(): (text.source, module) for text in parsed for module in text.modules}
        self._files: dict[str, list[str]] = {}
        """Modules that came from a file, by the file as the program named it."""

    def find(self, name: str, module: str) -> RoutineSymbol | None:
        """Gives the routine that `name` means in a module; `module:name` names the module."""
        owner, colon, plain = name.rpartition(":")
        scope = self._scopes.get((owner if colon else module).lower())
        found = scope.find_routine(plain) if scope else None
        return found or (None if colon else self._loaded.find_routine(plain))

    def find_data(self, name: str, module: str = "") -> DataSymbol | None:
        """Gives the data of a name, seen from a module."""
        scope = self._scopes.get(module.lower())
        return (scope.find_data(name) if scope else None) or self._loaded.find_data(name)

    def has(self, module: str) -> bool:
        """Gives whether a module is there."""
        return module.lower() in self._texts

    def by_slot(self, slot: int) -> DataSymbol | None:
        """Gives the module data of a slot."""
        return next((symbol for symbol in self.data if symbol.slot == slot), None)

    # ---------------------------------------------------------------- loading

    def load(self, source: SourceText) -> None:
        """Adds the modules of a text; errors in it are a `Fault` with the first of them."""
        parsed = parse_any(source)
        taken = [module.name.text for module in parsed.modules if self.has(module.name.text)]
        if taken:
            raise Fault(f"the module {taken[0]!r} is loaded already", "RAPID-R345", number=error_number("ERR_LOADED"))
        findings = Findings(diagnostics=list(parsed.diagnostics))
        declarations = Declarations(findings, Scope(self._loaded), self._values)
        known = len(self._values)
        if not parsed.diagnostics:
            resolve([parsed], declarations)
        wrong = [found for found in findings.finish() if found.severity is Severity.ERROR]
        if wrong:
            first = wrong[0]
            message = f"{source.file!r} cannot be loaded: line {first.line}: {first.message} [{first.code}]"
            raise Fault(message, "RAPID-R345", number=error_number("ERR_SYNTAX"))
        self._values.extend([declarations.globals[slot] for slot in range(known, len(declarations.globals))])
        self.data += declarations.data
        self._scopes |= declarations.scopes
        names = declarations.everywhere
        self._loaded.data |= names.data
        self._loaded.routines |= names.routines
        self._loaded.types |= names.types
        self._texts |= {module.name.text.lower(): (source, module) for module in parsed.modules}
        self._files[source.file.lower()] = [module.name.text for module in parsed.modules]

    def unload(self, file: str) -> bool:
        """Takes the modules of a file away that was loaded under this name; False if none was."""
        modules = self._files.pop(file.lower(), None)
        for module in modules or ():
            self.erase(module)
        return modules is not None

    def erase(self, module: str) -> bool:
        """Takes a module away; False if there is none."""
        key = module.lower()
        if self._texts.pop(key, None) is None:
            return False
        self._scopes.pop(key, None)
        self.data = [symbol for symbol in self.data if symbol.module.lower() != key]
        for names in (self._loaded.data, self._loaded.routines):
            for name in [name for name, symbol in names.items() if symbol.module.lower() == key]:
                del names[name]
        return True

    # ---------------------------------------------------------------- saving

    def text(self, module: str) -> str | None:
        """Gives the text of one module with the values of its PERS data as initial values."""
        found = self._texts.get(module.lower())
        if found is None:
            return None
        source, node = found
        return _written(source.text, self._edits(node, None), node.start, node.end) + "\n"

    def text_of_file(self, file: str) -> str | None:
        """Gives the text of the modules that were loaded under this name."""
        modules = self._files.get(file.lower())
        return None if modules is None else "".join(self.text(module) or "" for module in modules)

    def saved_files(self, initial: Sequence[Value]) -> dict[str, str]:
        """Gives the texts of the files whose PERS data have other values than `initial`, by slot."""
        edits: dict[str, list[tuple[int, int, str]]] = {}
        sources: dict[str, SourceText] = {}
        for source, node in self._texts.values():
            if changed := self._edits(node, initial):
                sources[source.file] = source
                edits.setdefault(source.file, []).extend(changed)
        return {file: _written(source.text, edits[file], 0, len(source.text)) for file, source in sources.items()}

    def _edits(self, node: Module, initial: Sequence[Value] | None) -> list[tuple[int, int, str]]:
        """Gives what to exchange (begin, end, new text) for the PERS data of a module to have its values."""
        scope = self._scopes.get(node.name.text.lower())
        edits: list[tuple[int, int, str]] = []
        for data in node.declarations:
            if not isinstance(data, Data) or data.storage != "PERS" or scope is None:
                continue
            symbol = scope.data.get(data.name.text.lower())
            if symbol is None:
                continue
            value = frozen(self._values[symbol.slot])
            if initial is not None and symbol.slot < len(initial) and value == initial[symbol.slot]:
                continue
            if data.value is not None:
                edits.append((data.value.start, data.value.end, literal(value)))
            elif value != ():
                edits.append((data.end - 1, data.end - 1, f" := {literal(value)}"))
        return edits


def _written(text: str, edits: list[tuple[int, int, str]], begin: int, end: int) -> str:
    parts: list[str] = []
    for start, stop, new in sorted(edits):
        parts += [text[begin:start], new]
        begin = stop
    return "".join([*parts, text[begin:end]])
