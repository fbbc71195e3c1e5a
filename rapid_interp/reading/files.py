"""Files and folders to texts.

Invariant: an unreadable file is an OSError that names it; text in any encoding is read, never refused.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from xml.parsers import expat

from rapid_interp.source import SourceText

SUFFIXES = frozenset({".mod", ".sys", ".prg", ".modx", ".sysx"})
BACKUP_PARTS = frozenset({"PROGMOD", "SYSMOD"})
"""Folders of a task in a controller's backup; together they are the task's program."""
_TASK = re.compile(r"TASK\d+", re.IGNORECASE)
MAX_PGF_BYTES = 1_000_000


def decoded(raw: bytes) -> str:
    """Gives the text of a file: UTF-8 with or without byte order mark, UTF-16 with one, otherwise the 8-bit code of old controllers."""
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return raw.decode("utf-16", errors="replace")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", errors="replace")


def read_text(path: Path) -> SourceText:
    """Gives the text of one file; OSError if it cannot be read or is no text."""
    text = decoded(path.read_bytes())
    if "\0" in text:
        raise OSError(22, "this is no text: it holds NUL bytes", str(path))
    return SourceText(str(path), text)


def read_texts(sources: Sequence[Path | str]) -> list[SourceText]:
    """Gives the texts of files, of the files that a `.pgf` lists, and of folders, each once; OSError at the first that cannot be read."""
    texts, problems = read_all(sources)
    if problems:
        raise problems[0]
    return texts


def read_all(sources: Sequence[Path | str]) -> tuple[list[SourceText], list[OSError]]:
    """Gives the texts of all that can be read, and why the rest cannot."""
    paths: dict[Path, None] = {}
    problems: list[OSError] = []
    for source in sources:
        try:
            paths |= dict.fromkeys(_files(Path(source)))
        except OSError as problem:
            problems.append(problem)
    texts: list[SourceText] = []
    for path in paths:
        try:
            texts.append(read_text(path))
        except OSError as problem:
            problems.append(problem)
    return texts, problems


def _files(path: Path) -> list[Path]:
    if path.is_dir():
        lists = sorted(child for child in path.iterdir() if child.suffix.lower() == ".pgf")
        if lists:
            return [member for listing in lists for member in listed(listing)]
        parts = [path, *(child for child in path.iterdir() if child.is_dir() and child.name.upper() in BACKUP_PARTS)]
        found = sorted(child for part in parts for child in part.iterdir() if child.suffix.lower() in SUFFIXES and child.is_file())
        if not found and (tasks := backup_tasks(path)):
            if len(tasks) == 1:
                return _files(tasks[0])
            names = ", ".join(str(task.relative_to(path)) for task in tasks)
            raise OSError(22, f"a backup of {len(tasks)} tasks, which are a program each: give one of {names}", str(path))
        if not found:
            raise FileNotFoundError(2, f"no RAPID file ({', '.join(sorted(SUFFIXES))}, .pgf) in the folder", str(path))
        return found
    return listed(path) if path.suffix.lower() == ".pgf" else [path]


def backup_tasks(folder: Path) -> list[Path]:
    """Gives the folders of the tasks in a controller's backup (`RAPID/TASK1`, or `RAPID` alone); none if the folder is no backup."""
    if not folder.is_dir():
        return []
    root = next((child for child in sorted(folder.iterdir()) if child.is_dir() and child.name.upper() == "RAPID"), None)
    inner = [child for child in sorted((root or folder).iterdir()) if child.is_dir()]
    tasks = [child for child in inner if _TASK.fullmatch(child.name)]
    if not tasks and root is not None and any(child.name.upper() in BACKUP_PARTS for child in inner):
        return [root]
    return tasks


def listed(listing: Path) -> list[Path]:
    """Gives the files that a `.pgf` lists in its `<Module>` elements, which must lie in its folder."""
    raw = listing.read_bytes()
    if len(raw) > MAX_PGF_BYTES:
        raise OSError(27, f"more than {MAX_PGF_BYTES} bytes: this is no list of modules", str(listing))
    beside = {child.name.lower(): child for child in listing.parent.iterdir()}
    found: list[Path] = []
    for name in _modules(raw, listing):
        if name.lower() not in beside:
            raise FileNotFoundError(2, f"module {name!r} is listed but does not lie beside the list", str(listing))
        found.append(beside[name.lower()])
    if not found:
        raise OSError(22, "the file lists no module", str(listing))
    return found


def _modules(raw: bytes, listing: Path) -> list[str]:
    """Gives the texts of the `<Module>` elements. Document types are refused, so that no entity is ever declared or expanded."""
    names: list[str] = []
    inside: list[str] = []

    def begin(name: str, _attributes: dict[str, str]) -> None:
        inside.append(name.lower())
        if inside[-1] == "module":
            names.append("")

    def text(data: str) -> None:
        if inside and inside[-1] == "module":
            names[-1] += data

    def refuse(*_: object) -> None:
        raise OSError(22, "a document type has no place in a list of modules", str(listing))

    parser = expat.ParserCreate()
    parser.StartElementHandler = begin
    parser.EndElementHandler = lambda _: inside.pop()
    parser.CharacterDataHandler = text
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(raw, True)
    except expat.ExpatError as problem:
        raise OSError(22, f"the list of modules cannot be read as XML: {problem}", str(listing)) from problem
    return [stripped for name in names if (stripped := name.strip())]
