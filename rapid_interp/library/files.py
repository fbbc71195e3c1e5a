"""Files and folders, inside the folder that the caller of `Program.start` gives.

Invariant: without such a folder each of these is an error that the program may handle (`ERR_FILEOPEN`).
"""

from __future__ import annotations

import shutil
from collections.abc import Callable
from typing import TYPE_CHECKING

from rapid_interp.library.table import LibraryRoutine
from rapid_interp.meaning.types import BOOL, DNUM, NUM, ORIENT, POS, Value
from rapid_interp.running.format import printed
from rapid_interp.running.literals import value_of
from rapid_interp.running.sandbox import Sandbox, file_fault
from rapid_interp.running.values import MAX_STRING, Reference

if TYPE_CHECKING:
    from rapid_interp.running.task import Stepper

_CODE = "latin-1"


def device(task: Stepper) -> Sandbox:
    """Gives the folder that holds the program's files."""
    if task.files is None:
        raise file_fault("no folder was given for the program's files: start(..., files=FOLDER)", "ERR_FILEOPEN")
    return task.files


def _open(task: Stepper, where: str, name: str | None, handle: Reference, _read: bool, write: bool, append: bool, binary: bool) -> None:
    """ASSUMPTION A-82: without a mode a file is opened to be read and, if it is a text, written at its end."""
    files = device(task)
    path = files.path(where, name or "")
    mode = "wb" if write else "ab" if append else "rb" if _read else "r+b" if binary and path.exists() else "a+b"
    handle.put(float(files.open(path, mode)))


def _write(
    task: Stepper, handle: float, text: str, num: Value, truth: Value, pos: Value, orient: Value, dnum: Value, no_new_line: bool
) -> None:
    for kind, value in ((NUM, num), (BOOL, truth), (POS, pos), (ORIENT, orient), (DNUM, dnum)):
        if value is not None:
            text += printed(kind, value)
    device(task).write(handle, (text + "\n" * (not no_new_line)).encode(_CODE, errors="replace"))


def _read_until(task: Stepper, handle: float, stops: bytes) -> str | None:
    found = bytearray()
    while byte := device(task).read(handle, 1):
        if byte in stops:
            return found.decode(_CODE)
        found += byte
        if len(found) >= MAX_STRING:
            return found.decode(_CODE)
    return found.decode(_CODE) if found else None


def _read_str(task: Stepper, handle: float, delimiters: str | None, remove: bool, discard: bool, _time: Value) -> str:
    stops = b"\n" + (delimiters or "").encode(_CODE, errors="replace")
    while True:
        text = _read_until(task, handle, stops)
        if text is None:
            return "EOF"
        text = text.replace("\r", "") if remove else text.rstrip("\r")
        if text or not discard:
            return text


def _read_num(task: Stepper, handle: float, delimiters: str | None, _time: Value) -> float:
    text = _read_until(task, handle, b"\n" + (delimiters or "").encode(_CODE, errors="replace"))
    if text is None:
        return 9.998e36
    value = value_of(NUM, text.strip())
    if not isinstance(value, float):
        raise file_fault(f"{text!r} is no number", "ERR_RCVDATA")
    return value


def _read_bin(task: Stepper, handle: float, _time: Value) -> float:
    byte = device(task).read(handle, 1)
    return float(byte[0]) if byte else -1.0


def _read_str_bin(task: Stepper, handle: float, count: float, _time: Value) -> str:
    return device(task).read(handle, max(0, min(int(count), MAX_STRING))).decode(_CODE) or "EOF"


def _write_bin(task: Stepper, handle: float, buffer: Value, count: float) -> None:
    values = buffer[: int(count)]
    if any(value != int(value) or not 0 <= value <= 255 for value in values):
        raise file_fault("WriteBin needs whole numbers from 0 to 255", "ERR_ARGVALERR")
    device(task).write(handle, bytes(int(value) for value in values))


def _write_str_bin(task: Stepper, handle: float, text: str) -> None:
    device(task).write(handle, text.encode(_CODE, errors="replace"))


def _rewind(task: Stepper, handle: float) -> None:
    device(task).file(handle).stream.seek(0)


def _close(task: Stepper, handle: Reference) -> None:
    device(task).close(handle.get())
    handle.put(0.0)


def _is_file(task: Stepper, path: str, folder: bool, *_: bool) -> bool:
    place = device(task).path(path)
    return place.is_dir() if folder else place.exists()


def _file_size(task: Stepper, path: str) -> float:
    try:
        return float(device(task).path(path).stat().st_size)
    except OSError as problem:
        raise file_fault(f"{path!r}: {problem.strerror}", "ERR_FILEACC") from problem


def _file_time(task: Stepper, path: str, _modified: bool, access: bool, status: bool, *_: Value) -> float:
    try:
        found = device(task).path(path).stat()
    except OSError as problem:
        raise file_fault(f"{path!r}: {problem.strerror}", "ERR_FILEACC") from problem
    return float(int(found.st_atime if access else found.st_ctime if status else found.st_mtime))


def _done(action: Callable[..., object]) -> Callable[..., None]:
    """Gives the routine that does something to paths, with the operating system's refusal as a RAPID error."""

    def run(task: Stepper, *paths: str) -> None:
        places = [device(task).path(path) for path in paths]
        try:
            action(*places)
        except OSError as problem:
            raise file_fault(f"{paths[0]!r}: {problem.strerror}", "ERR_FILEACC") from problem

    return run


def _open_dir(task: Stepper, handle: Reference, path: str) -> None:
    files = device(task)
    try:
        names = sorted(child.name for child in files.path(path).iterdir())
    except OSError as problem:
        raise file_fault(f"{path!r}: {problem.strerror}", "ERR_FILEACC") from problem
    files.given += 1
    files.folders[files.given] = [".", "..", *names]
    handle.put(float(files.given))


def _read_dir(task: Stepper, handle: float, name: Reference) -> bool:
    names = device(task).folders.get(int(handle))
    if names is None:
        raise file_fault("the folder is not open", "ERR_FILEACC")
    if not names:
        return False
    name.put(names.pop(0)[:MAX_STRING])
    return True


def _close_dir(task: Stepper, handle: float) -> None:
    device(task).folders.pop(int(handle), None)


ROUTINES = (
    LibraryRoutine(
        r"PROC Open(string Object \string File, INOUT iodev IODevice \switch Read | switch Write | switch Append \switch Bin)",
        _open,
        task=True,
    ),
    LibraryRoutine("PROC Close(INOUT iodev IODevice)", _close, task=True),
    LibraryRoutine(
        r"PROC Write(iodev IODevice, string String \num Num | bool Bool | pos Pos | orient Orient | dnum Dnum \switch NoNewLine)",
        _write,
        task=True,
    ),
    LibraryRoutine(
        r"FUNC string ReadStr(iodev IODevice \string Delim \switch RemoveCR \switch DiscardHeaders \num Time)", _read_str, task=True
    ),
    LibraryRoutine(r"FUNC num ReadNum(iodev IODevice \string Delim \num Time)", _read_num, task=True),
    LibraryRoutine(r"FUNC num ReadBin(iodev IODevice \num Time)", _read_bin, task=True),
    LibraryRoutine(r"FUNC string ReadStrBin(iodev IODevice, num NoOfChars \num Time)", _read_str_bin, task=True),
    LibraryRoutine("PROC WriteBin(iodev IODevice, num Buffer{*}, num NChar)", _write_bin, task=True),
    LibraryRoutine("PROC WriteStrBin(iodev IODevice, string Str)", _write_str_bin, task=True),
    LibraryRoutine("PROC Rewind(iodev IODevice)", _rewind, task=True),
    LibraryRoutine("PROC ClearIOBuff(iodev IODevice)", lambda *_: None, task=True),
    LibraryRoutine(r"FUNC bool IsFile(string Path \switch Directory \switch Fifo \switch RegFile)", _is_file, task=True),
    LibraryRoutine("FUNC num FileSize(string Path)", _file_size, task=True),
    LibraryRoutine(r"FUNC num FileTime(string Path \switch ModifyTime | switch AccessTime | switch StatCTime)", _file_time, task=True),
    LibraryRoutine(r"FUNC dnum FileTimeDnum(string Path \switch ModifyTime | switch AccessTime | switch StatCTime)", _file_time, task=True),
    LibraryRoutine("PROC RemoveFile(string Path)", _done(lambda path: path.unlink()), task=True),
    LibraryRoutine("PROC RenameFile(string OldPath, string NewPath)", _done(lambda old, new: old.rename(new)), task=True),
    LibraryRoutine("PROC CopyFile(string OldPath, string NewPath)", _done(shutil.copyfile), task=True),
    LibraryRoutine("PROC MakeDir(string Path)", _done(lambda path: path.mkdir()), task=True),
    LibraryRoutine("PROC RemoveDir(string Path)", _done(lambda path: path.rmdir()), task=True),
    LibraryRoutine("PROC OpenDir(INOUT dir Dev, string Path)", _open_dir, task=True),
    LibraryRoutine("FUNC bool ReadDir(dir Dev, INOUT string FileName)", _read_dir, task=True),
    LibraryRoutine("PROC CloseDir(dir Dev)", _close_dir, task=True),
)
