"""FileService: the controller's disk, a folder of the computer that no path leaves.

Invariant: every path is resolved, with its links, before anything is touched, and must lie inside the volume it names.
"""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from mitl.controllers.virtual.answers import BAD_VOLUME, NOT_ALLOWED, NOT_FOUND, Refused, invalid

VOLUMES = ("HOME", "TEMP", "BACKUP", "RAMDISK", "DATA")
MOST_BYTES = 64 * 1024 * 1024
"""Bytes that the disk holds at most. ASSUMPTION A-231: a VC's is only as small as the computer's."""


@dataclass(frozen=True)
class FileEntry:
    """A file or folder. changed: local time."""

    name: str
    folder: bool
    size: int
    changed: datetime


class FileService:
    """The disk in a folder, which is made where it is missing."""

    def __init__(self, root: Path) -> None:
        self._root = root.resolve()
        for volume in VOLUMES:
            (self._root / volume).mkdir(parents=True, exist_ok=True)

    def path(self, address: str) -> Path:
        """Gives the path that `$HOME/a/b.mod`, `HOME:/a/b.mod` or `home/a` means. Raises Refused."""
        parts = [part for part in address.replace(":/", "/").replace(":", "/").split("/") if part not in ("", ".")]
        if not parts:
            return self._root
        if "\0" in address or "\\" in address or ".." in parts:
            raise Refused(403, NOT_ALLOWED, "A path may neither go up nor use backslashes")
        volume = parts[0].lstrip("$").upper()
        if volume not in VOLUMES:
            raise Refused(400, BAD_VOLUME, f"No volume {parts[0]!r}: expected {', '.join(VOLUMES)}")
        base = self._root / volume
        try:
            resolved = base.joinpath(*parts[1:]).resolve()
        except (OSError, RuntimeError, ValueError) as error:
            raise invalid(f"{address!r} is no path") from error
        if resolved != base and not resolved.is_relative_to(base):
            raise Refused(403, NOT_ALLOWED, "A path may not leave its volume")
        return resolved

    def existing(self, address: str) -> Path:
        """Gives the path of something that is there. Raises Refused 404."""
        path = self.path(address)
        try:
            there = path.exists()
        except OSError as error:
            raise invalid(f"{address!r} is no path") from error
        if not there:
            raise Refused(404, NOT_FOUND, f"No such file or directory: {address}")
        return path

    def listing(self, address: str) -> list[FileEntry]:
        """Gives what is in a folder. Raises Refused."""
        path = self.existing(address)
        if not path.is_dir():
            raise invalid(f"{address} is no directory")
        return [self._entry(child) for child in sorted(path.iterdir())]

    def read(self, address: str) -> bytes | None:
        """Gives a file's bytes, or None for a folder. Raises Refused."""
        path = self.existing(address)
        return None if path.is_dir() else path.read_bytes()

    def write(self, address: str, content: bytes) -> bool:
        """Writes a file and gives whether it is new. Raises Refused."""
        path = self._writable(address)
        if path.is_dir():
            raise invalid(f"{address} is a directory")
        self._require_room(len(content))
        new = not path.exists()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        except OSError as error:
            raise invalid(f"{address}: {error.strerror}") from error
        return new

    def remove(self, address: str) -> None:
        """Removes a file or a folder with all that is in it. Raises Refused."""
        path = self._writable(address)
        self.existing(address)
        if path.is_dir():
            shutil.rmtree(path)
        else:
            path.unlink()

    def make_folder(self, address: str, name: str) -> None:
        """Makes a folder. Raises Refused."""
        path = self._writable(f"{address}/{name}")
        if path.exists():
            raise invalid(f"{name} is there already")
        try:
            path.mkdir(parents=True)
        except OSError as error:
            raise invalid(f"{name}: {error.strerror}") from error

    def copy(self, address: str, name: str, *, move: bool) -> None:
        """Copies or renames a file or folder; a plain name stays in its folder. Raises Refused."""
        source = self.existing(address)
        self._writable(address)
        beside = address.rpartition("/")[0]
        target = self._writable(name if "/" in name or ":" in name else f"{beside}/{name}")
        if target.exists() or target.is_relative_to(source):
            raise invalid(f"{name} is there already")
        if not move:
            self._require_room(_size(source))
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            if move:
                source.rename(target)
            elif source.is_dir():
                shutil.copytree(source, target, symlinks=True)  # what a link leads to may lie outside the volume
            else:
                shutil.copy2(source, target)
        except OSError as error:
            raise invalid(f"{name}: {error.strerror}") from error

    def _writable(self, address: str) -> Path:
        path = self.path(address)
        if self._root in (path, path.parent):
            raise Refused(403, NOT_ALLOWED, "A volume cannot be changed itself")
        return path

    def _require_room(self, size: int) -> None:
        if _size(self._root) + size > MOST_BYTES:
            raise Refused(507, NOT_ALLOWED, "The disk is full")

    def _entry(self, path: Path) -> FileEntry:
        found = path.lstat() if path.is_symlink() else path.stat()
        return FileEntry(path.name, path.is_dir(), found.st_size, datetime.fromtimestamp(found.st_mtime).astimezone())


def _size(path: Path) -> int:
    """Gives the bytes of a file or of all files in a folder, links not followed."""
    files = path.rglob("*") if path.is_dir() else [path]
    return sum(file.lstat().st_size for file in files if file.is_file())
