"""Files and folders to texts.

Invariant: an unreadable file is an OSError that names it; text in any encoding is read, never refused.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from html import unescape
from pathlib import Path

from rapid_interp.source import SourceText

SUFFIXES = frozenset({".mod", ".sys", ".prg", ".modx", ".sysx"})
BACKUP_PARTS = frozenset({"PROGMOD", "SYSMOD"})
"""Folders of a task in a controller's backup; together they are the task's program."""
MAX_PGF_BYTES = 1_000_000
_LISTED = re.compile(r"<Module\b[^>]*>\s*([^<>]+?)\s*</Module\s*>", re.IGNORECASE)


def decoded(raw: bytes) -> str:
    """Gives the text of a file: UTF-8 with or without byte order mark, otherwise the 8-bit code of old controllers."""
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", errors="replace")


def read_texts(sources: Sequence[Path | str]) -> list[SourceText]:
    """Gives the texts of files, of the files that a `.pgf` lists, and of folders, each once."""
    paths: dict[Path, None] = {}
    for source in sources:
        for path in _files(Path(source)):
            paths.setdefault(path)
    return [SourceText(str(path), decoded(path.read_bytes())) for path in paths]


def _files(path: Path) -> list[Path]:
    if path.is_dir():
        lists = sorted(child for child in path.iterdir() if child.suffix.lower() == ".pgf")
        if lists:
            return [member for listing in lists for member in listed(listing)]
        parts = [path, *(child for child in path.iterdir() if child.is_dir() and child.name.upper() in BACKUP_PARTS)]
        found = sorted(child for part in parts for child in part.iterdir() if child.suffix.lower() in SUFFIXES and child.is_file())
        if not found:
            raise FileNotFoundError(2, f"no RAPID file ({', '.join(sorted(SUFFIXES))}, .pgf) in the folder", str(path))
        return found
    return listed(path) if path.suffix.lower() == ".pgf" else [path]


def listed(listing: Path) -> list[Path]:
    """Gives the files that a `.pgf` lists, which must lie in its folder.

    The list is read by its `<Module>` elements alone, not as XML: no entity is ever expanded, none is needed.
    """
    raw = listing.read_bytes()
    if len(raw) > MAX_PGF_BYTES:
        raise OSError(27, f"more than {MAX_PGF_BYTES} bytes: this is no list of modules", str(listing))
    text = decoded(raw)
    if "<!DOCTYPE" in text.upper() or "<!ENTITY" in text.upper():
        raise OSError(22, "a document type or entities have no place in a list of modules", str(listing))
    beside = {child.name.lower(): child for child in listing.parent.iterdir()}
    found: list[Path] = []
    for name in map(unescape, _LISTED.findall(text)):
        if name.lower() not in beside:
            raise FileNotFoundError(2, f"module {name!r} is listed but does not lie beside the list", str(listing))
        found.append(beside[name.lower()])
    if not found:
        raise OSError(22, "the file lists no module", str(listing))
    return found
