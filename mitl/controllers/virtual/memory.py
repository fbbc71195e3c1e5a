"""ProgramMemory: the modules loaded into the task, as a controller keeps them apart from the files they came from.

Invariant: names are unique without regard to case; a module with syntax errors never gets in.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from mitl.controllers.virtual.answers import BAD_MODULE, NO_MODULE, Refused
from rapid_interp.reading.modules import parse
from rapid_interp.source import SourceText


@dataclass(frozen=True)
class LoadedModule:
    """A module. file: name of the file it came from, which messages about it begin with."""

    name: str
    system: bool
    file: str
    text: str


class SyntaxFound(Exception):  # noqa: N818 - what was found, not a failure of this program
    """A text that is no module; `findings` are lines for the event log."""

    def __init__(self, findings: tuple[str, ...]) -> None:
        super().__init__(findings[0])
        self.findings = findings


def read_module(file: str, text: str) -> LoadedModule:
    """Gives the module of a text. Raises SyntaxFound."""
    parsed = parse(SourceText(file, text))
    if parsed.diagnostics or len(parsed.modules) != 1:
        found = tuple(f"{one.file}:{one.line}:{one.column}: {one.message}" for one in parsed.diagnostics)
        raise SyntaxFound(found or (f"{file}: expected one module, found {len(parsed.modules)}",))
    module = parsed.modules[0]
    return LoadedModule(module.name.text, "SYSMODULE" in (word.upper() for word in module.attributes), file, text)


class ProgramMemory:
    """The modules of the task T_ROB1, in the order in which they were loaded."""

    def __init__(self) -> None:
        self._modules: dict[str, LoadedModule] = {}
        self.version = 0
        """Grows with every change."""

    def __len__(self) -> int:
        return len(self._modules)

    def modules(self) -> tuple[LoadedModule, ...]:
        """Gives all modules."""
        return tuple(self._modules.values())

    def find(self, name: str) -> LoadedModule:
        """Gives the module of a name. Raises Refused."""
        module = self._modules.get(name.lower())
        if module is None:
            raise Refused(404, -1073414146, f"No module {name!r} is loaded")
        return module

    def add(self, module: LoadedModule, *, replace: bool) -> None:
        """Takes a module. Raises Refused where there is one of this name and it is not to be replaced."""
        if module.name.lower() in self._modules and not replace:
            raise Refused(400, BAD_MODULE, f"Module {module.name} is loaded already")
        self._modules[module.name.lower()] = module
        self.version += 1

    def remove(self, name: str) -> None:
        """Drops a module. Raises Refused where there is none."""
        if self._modules.pop(name.lower(), None) is None:
            raise Refused(400, NO_MODULE, f"No module {name!r} is loaded")
        self.version += 1

    def replace_program(self, modules: Iterable[LoadedModule]) -> None:
        """Takes these in place of all program modules; system modules stay."""
        kept = {name: module for name, module in self._modules.items() if module.system}
        self._modules = {**kept, **{module.name.lower(): module for module in modules}}
        self.version += 1

    def written_to(self, folder: Path) -> list[Path]:
        """Gives the modules as files in a folder of their own, under the names of the files they came from where these differ."""
        target = folder / f"program-{self.version}"
        target.mkdir(parents=True, exist_ok=True)
        paths: list[Path] = []
        for module in self._modules.values():
            path = target / module.file
            if path in paths:
                path = target / f"{module.name}.mod"
            path.write_text(module.text, encoding="utf-8")
            paths.append(path)
        return paths
