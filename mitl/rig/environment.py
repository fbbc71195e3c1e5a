"""What a record says of the rig beside its packages: which files described robot, tracker and cell, told apart by their content."""

from __future__ import annotations

import hashlib
from pathlib import Path

_DIGITS = 16


def robot_files(folder: Path) -> dict[str, str]:
    """Gives what tells a robot model from another of its name, for `Rig.versions`: its folder's name and a hash of its files."""
    return {"robot model": folder_fingerprint(folder)}


def folder_fingerprint(folder: Path) -> str:
    """Gives a folder's name with a hash of the names and contents of all files in it, wherever the folder lies."""
    whole = hashlib.sha256()
    for file in sorted(file for file in folder.rglob("*") if file.is_file()):
        content = file.read_bytes()
        whole.update(f"{file.relative_to(folder).as_posix()}\0{len(content)}\0".encode() + content)
    return _told(folder.name, whole.hexdigest())


def text_fingerprint(name: str, text: str) -> str:
    """Gives a name with a hash of a text that says all that matters."""
    return _told(name, hashlib.sha256(text.encode()).hexdigest())


def _told(name: str, digest: str) -> str:
    return f"{name} sha256 {digest[:_DIGITS]}"
