"""Files of a program, all of them inside one folder that the caller gives.

Invariant: no path leads out of the folder, also not over links; without a folder every file is refused.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from rapid_interp.running.values import Fault, error_number

MAX_OPEN = 8
MAX_FILE = 50_000_000
"""Bytes that a program may write into one file."""
_DEVICES = ("home:", "ramdisk:", "temp:", "flp1:", "bd0:", "usbdisk1:", "usbdisk2:", "/hd0a")


def file_fault(message: str, name: str) -> Fault:
    """Gives the fault for a file, with its RAPID error."""
    return Fault(message, "RAPID-R344", number=error_number(name))


@dataclass(slots=True)
class OpenFile:
    """A file that the program has opened."""

    stream: BinaryIO
    name: str
    written: int = 0


@dataclass(slots=True)
class Sandbox:
    """The folder, and what is open in it by handle. Handle 0 is data that was never opened."""

    folder: Path
    files: dict[int, OpenFile] = field(default_factory=dict)
    folders: dict[int, list[str]] = field(default_factory=dict)
    given: int = 0

    def path(self, *parts: str) -> Path:
        """Gives the place of a RAPID path such as `HOME:/logs/a.txt`; its device is the folder itself."""
        text = "/".join(part for part in parts if part).replace("\\", "/")
        for device in _DEVICES:
            if text.lower().startswith(device):
                text = text[len(device) :]
        root = self.folder.resolve()
        if "\0" in text:
            raise file_fault(f"{text!r} is no path", "ERR_FILEACC")
        try:
            found = (root / text.lstrip("/")).resolve()
        except (OSError, RuntimeError) as problem:
            raise file_fault(f"{text!r} is no path: {problem}", "ERR_FILEACC") from problem
        if found != root and root not in found.parents:
            raise file_fault(f"{text!r} leads out of the folder given for files", "ERR_FILEACC")
        return found

    def name(self, path: Path) -> str:
        """Gives the place of a path inside the folder, the same for all ways of writing it."""
        return path.relative_to(self.folder.resolve()).as_posix()

    def open(self, path: Path, mode: str) -> int:
        """Opens a file and gives its handle."""
        if len(self.files) >= MAX_OPEN:
            raise file_fault(f"more than {MAX_OPEN} files are open", "ERR_FILEOPEN")
        if "r" not in mode:
            path.parent.mkdir(parents=True, exist_ok=True)
        try:
            stream: BinaryIO = path.open(mode)  # type: ignore[assignment] # the mode always has a b
        except OSError as problem:
            raise file_fault(f"{path.name!r} cannot be opened: {problem.strerror}", "ERR_FILEOPEN") from problem
        self.given += 1
        self.files[self.given] = OpenFile(stream, path.name)
        return self.given

    def file(self, handle: float) -> OpenFile:
        """Gives an open file."""
        found = self.files.get(int(handle))
        if found is None:
            raise file_fault("the file is not open", "ERR_FILEACC")
        return found

    def write(self, handle: float, data: bytes) -> None:
        """Writes to an open file."""
        target = self.file(handle)
        target.written += len(data)
        if target.written > MAX_FILE:
            raise file_fault(f"{target.name!r} would have more than {MAX_FILE} bytes", "ERR_DISKFULL")
        try:
            target.stream.write(data)
        except (OSError, ValueError) as problem:
            raise file_fault(f"{target.name!r} cannot be written: {problem}", "ERR_FILEACC") from problem

    def read(self, handle: float, count: int) -> bytes:
        """Reads up to `count` bytes of an open file."""
        source = self.file(handle)
        try:
            return source.stream.read(count)
        except (OSError, ValueError) as problem:
            raise file_fault(f"{source.name!r} cannot be read: {problem}", "ERR_FILEACC") from problem

    def close(self, handle: float) -> None:
        """Closes a file; one that is not open is no error."""
        found = self.files.pop(int(handle), None)
        if found is not None:
            found.stream.close()

    def close_all(self) -> None:
        """Closes what the program left open."""
        for handle in list(self.files):
            self.close(handle)
