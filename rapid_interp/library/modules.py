"""Modules that a program loads, saves and takes away while it runs, and data that it finds by name.

Invariant: all modules are the task's own, in its `ModuleTable`; their files lie in the folder of the program's files.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rapid_interp.library.files import device
from rapid_interp.library.table import LibraryRoutine
from rapid_interp.meaning.symbols import DataSymbol
from rapid_interp.meaning.types import Array, RapidType, Value, fits
from rapid_interp.reading.files import read_text
from rapid_interp.running.sandbox import file_fault
from rapid_interp.running.values import Fault, Reference, SlotReference, error_number
from rapid_interp.source import SourceText

if TYPE_CHECKING:
    from pathlib import Path

    from rapid_interp.running.task import Stepper


def _path(task: Stepper, folder: str | None, file: str | None) -> Path:
    return device(task).path(folder or "", file or "")


def _text(task: Stepper, folder: str, file: str | None) -> SourceText:
    path = _path(task, folder, file)
    try:
        return SourceText(device(task).name(path), read_text(path).text)
    except FileNotFoundError as problem:
        raise file_fault(f"there is no file {path.name!r} to load", "ERR_FILNOTFND") from problem
    except OSError as problem:
        raise file_fault(f"{path.name!r} cannot be read: {problem.strerror}", "ERR_IOERROR") from problem


def _load(task: Stepper, _dynamic: bool, folder: str, file: str | None, _check: bool) -> None:
    task.modules.load(_text(task, folder, file))


def _unload(task: Stepper, _if_changed: bool, save: bool, folder: str, file: str | None) -> None:
    path = _path(task, folder, file)
    name = device(task).name(path)
    if save:
        text = task.modules.text_of_file(name)
        if text is not None:
            path.write_text(text, encoding="utf-8")
    if not task.modules.unload(name):
        raise Fault(f"no module was loaded from {name!r}", "RAPID-R345", number=error_number("ERR_UNLOAD"))


def _start_load(task: Stepper, _dynamic: bool, folder: str, file: str | None, session: Reference) -> None:
    """The file is read at once and its modules are there after WaitLoad."""
    task.loading.append(_text(task, folder, file))
    session.put(float(len(task.loading)))


def _session(task: Stepper, session: Reference) -> SourceText:
    number = int(session.get())
    if not 1 <= number <= len(task.loading) or (source := task.loading[number - 1]) is None:
        raise Fault("the loading session is not known: StartLoad comes first", "RAPID-R345", number=error_number("ERR_LOADNO_NOUSE"))
    task.loading[number - 1] = None
    session.put(0.0)
    return source


def _wait_load(task: Stepper, unload_path: str | None, unload_file: str | None, session: Reference, _check: bool) -> None:
    if unload_path or unload_file:
        _unload(task, False, False, unload_path or "", unload_file)
    task.modules.load(_session(task, session))


def _cancel_load(task: Stepper, session: Reference) -> None:
    _session(task, session)


def _erase(task: Stepper, module: str) -> None:
    if not task.modules.erase(module):
        raise Fault(f"there is no module {module!r}", "RAPID-R345", number=error_number("ERR_MODULE"))


def _save(task: Stepper, _task_ref: Value, _task_name: Value, module: str, folder: str | None, file: str | None) -> None:
    text = task.modules.text(module)
    if text is None:
        raise Fault(f"there is no module {module!r}", "RAPID-R345", number=error_number("ERR_MODULE"))
    path = _path(task, folder, file) if folder or file else _path(task, None, f"{module}.mod")
    if path.is_dir():
        path = path / f"{module}.mod"
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as problem:
        raise file_fault(f"{path.name!r} cannot be written: {problem.strerror}", "ERR_PATH") from problem


# ---------------------------------------------------------------- data by name


def _symbol(task: Stepper, name: str, module: str) -> DataSymbol:
    found = task.modules.find_data(name.rpartition(":")[2], module or task.entry.module)
    if found is None or not found.is_global:
        raise Fault(f"the program has no data {name!r}", "RAPID-R353", number=error_number("ERR_SYM_ACCESS"))
    return found


def _typed(task: Stepper, name: str, module: str, kind: RapidType) -> DataSymbol:
    symbol = _symbol(task, name, module)
    if not fits(symbol.type, kind):
        raise Fault(f"{name} is {symbol.type.name}, not {kind.name}", "RAPID-R353", number=error_number("ERR_INVDIM"))
    return symbol


def _get_value(task: Stepper, name: str, place: Value, _task_ref: Value, _task_name: Value, target: tuple[RapidType, Reference]) -> None:
    symbol = _typed(task, name, place or "", target[0])
    target[1].put(SlotReference(task.globals, symbol.slot).get())


def _set_value(task: Stepper, name: str, place: Value, _task_ref: Value, _task_name: Value, typed: tuple[RapidType, Value]) -> None:
    symbol = _typed(task, name, place or "", typed[0])
    if symbol.storage == "CONST":
        raise Fault(f"{name} is a constant and cannot be changed", "RAPID-R353", number=error_number("ERR_SYM_ACCESS"))
    task.globals[symbol.slot] = typed[1]


def _pattern(text: str | None) -> re.Pattern[str]:
    try:
        return re.compile(text or ".*", re.IGNORECASE)
    except re.error as problem:
        raise Fault(f"{text!r} is no pattern of names: {problem}", "RAPID-R353") from problem


def _element_name(kind: RapidType) -> str:
    return kind.element.name if isinstance(kind, Array) else kind.name


def _matching(task: Stepper, type_name: str, pattern: re.Pattern[str]) -> list[DataSymbol]:
    return [
        symbol for symbol in task.modules.data if _element_name(symbol.type).lower() == type_name.lower() and pattern.fullmatch(symbol.name)
    ]


def _set_all(task: Stepper, type_name: str, _mod: Value, name: str | None, _hidden: bool, typed: tuple[RapidType, Value]) -> None:
    for symbol in _matching(task, type_name, _pattern(name)):
        if symbol.storage != "CONST" and fits(symbol.type, typed[0]):
            task.globals[symbol.slot] = typed[1]


def _search(
    task: Stepper, type_name: str, _type_module: Value, name: Value, persistent: bool, variable: bool, constant: bool, _task: bool,
    module: Value, routine: Value, public: bool, local: bool,
) -> None:  # fmt: skip
    """ASSUMPTION A-178: without any of PersSym, VarSym and ConstSym all are searched; data of routines are not found."""
    kinds = {kind for kind, on in (("PERS", persistent), ("VAR", variable), ("CONST", constant)) if on} or {"PERS", "VAR", "CONST"}
    found = [symbol for symbol in _matching(task, type_name, _pattern(name)) if symbol.storage in kinds and not routine]
    if module:
        found = [symbol for symbol in found if symbol.module.lower() == module.lower()]
    if public is not local:
        found = [symbol for symbol in found if (symbol.scope == "LOCAL") is local]
    task.searched = [(symbol.name, symbol.module) for symbol in found]


def _next(task: Stepper, name: Reference, place: Reference, _recursive: bool) -> bool:
    if not task.searched:
        return False
    found, module = task.searched.pop(0)
    name.put(found)
    place.put(module)
    return True


_FILE = r"string FilePath \string File"
_OBJECT = r"string Object \datapos Block | taskid TaskRef | string TaskName"
_TASK = r"\taskid TaskRef | string TaskName"
ROUTINES = (
    LibraryRoutine(rf"PROC Load(\switch Dynamic, {_FILE} \switch CheckRef)", _load, task=True),
    LibraryRoutine(rf"PROC UnLoad(\switch ErrIfChanged | switch Save, {_FILE})", _unload, task=True),
    LibraryRoutine(rf"PROC StartLoad(\switch Dynamic, {_FILE}, INOUT loadsession LoadNo)", _start_load, task=True),
    LibraryRoutine(
        r"PROC WaitLoad(\string UnloadPath \string UnloadFile, INOUT loadsession LoadNo \switch CheckRef)", _wait_load, task=True
    ),
    LibraryRoutine("PROC CancelLoad(INOUT loadsession LoadNo)", _cancel_load, task=True),
    LibraryRoutine("PROC CheckProgRef()", lambda: None),
    LibraryRoutine("PROC EraseModule(string ModuleName)", _erase, task=True),
    LibraryRoutine(rf"PROC Save({_TASK}, string ModuleName \string FilePath \string File)", _save, task=True),
    LibraryRoutine("FUNC bool ModExist(string ModuleName)", lambda task, name: task.modules.has(name), task=True),
    LibraryRoutine(
        r"PROC SetDataSearch(string Type \string TypeMod \string Object \switch PersSym \switch VarSym \switch ConstSym"
        r" \switch InTask | string InMod \string InRout \switch GlobalSym | switch LocalSym)",
        _search,
        task=True,
    ),
    LibraryRoutine(r"FUNC bool GetNextSym(INOUT string Object, INOUT datapos Block \switch Recursive)", _next, task=True),
    LibraryRoutine(rf"PROC GetDataVal({_OBJECT}, INOUT anydata Value)", _get_value, task=True),
    LibraryRoutine(rf"PROC SetDataVal({_OBJECT}, anytype Value)", _set_value, task=True),
    LibraryRoutine(r"PROC SetAllDataVal(string Type \string TypeMod \string Object \switch Hidden, anytype Value)", _set_all, task=True),
)
