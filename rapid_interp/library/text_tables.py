"""Tables of texts in files of XML (`TextTabInstall`), and what they hold.

Invariant: a table is read whole when it is installed; document types are refused, so that no entity is ever expanded.
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.parsers import expat

from rapid_interp.library.files import device
from rapid_interp.library.table import LibraryRoutine
from rapid_interp.running.sandbox import file_fault
from rapid_interp.running.values import MAX_STRING, Fault, error_number

if TYPE_CHECKING:
    from rapid_interp.running.task import Stepper

MOST_BYTES = 1_000_000
_FIRST_TABLE = 1


def _tables(raw: bytes, name: str) -> dict[str, dict[int, str]]:
    """Gives the texts by resource and number: `<Resource Name="..."><Text Name="1"><Value>...</Value></Text></Resource>`."""
    found: dict[str, dict[int, str]] = {}
    state = {"resource": "", "text": "", "value": ""}

    def begin(tag: str, attributes: dict[str, str]) -> None:
        key = tag.lower()
        if key in ("resource", "text"):
            state[key] = attributes.get("Name", "")
        state["value"] = key if key == "value" else ""

    def text(data: str) -> None:
        if state["value"] and state["text"].isdigit():
            table = found.setdefault(state["resource"].lower(), {})
            table[int(state["text"])] = table.get(int(state["text"]), "") + data

    def end(_: str) -> None:
        state["value"] = ""

    def refuse(*_: object) -> None:
        raise file_fault(f"{name!r}: a document type has no place in a table of texts", "ERR_TXTTAB")

    parser = expat.ParserCreate()
    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.CharacterDataHandler, parser.StartDoctypeDeclHandler = text, refuse
    try:
        parser.Parse(raw, True)
    except expat.ExpatError as problem:
        raise file_fault(f"{name!r} is no table of texts: {problem}", "ERR_TXTTAB") from problem
    return found


def _install(task: Stepper, file: str) -> None:
    path = device(task).path(file)
    try:
        raw = path.read_bytes()[: MOST_BYTES + 1]
    except OSError as problem:
        raise file_fault(f"{file!r} cannot be read: {problem.strerror}", "ERR_FILEACC") from problem
    if len(raw) > MOST_BYTES:
        raise file_fault(f"{file!r} has more than {MOST_BYTES} bytes: it is no table of texts", "ERR_TXTTAB")
    for name, texts in _tables(raw, file).items():
        if name in task.text_tables:
            raise file_fault(f"the table of texts {name!r} is installed already", "ERR_TXTTAB")
        task.text_tables[name] = texts


def _get_table(task: Stepper, name: str) -> float:
    names = list(task.text_tables)
    if name.lower() not in names:
        raise Fault(f"the table of texts {name!r} is not installed", "RAPID-R355", number=error_number("ERR_TXTNOEXIST"))
    return float(names.index(name.lower()) + _FIRST_TABLE)


def _get_text(task: Stepper, table: float, index: float) -> str:
    tables = list(task.text_tables.values())
    place = int(table) - _FIRST_TABLE
    if not 0 <= place < len(tables) or int(index) not in tables[place]:
        raise Fault(f"there is no text {index:g} in table {table:g}", "RAPID-R355", number=error_number("ERR_TXTNOEXIST"))
    return tables[place][int(index)][:MAX_STRING]


ROUTINES = (
    LibraryRoutine("PROC TextTabInstall(string File)", _install, task=True),
    LibraryRoutine("FUNC bool TextTabFreeToUse(string TableName)", lambda task, name: name.lower() not in task.text_tables, task=True),
    LibraryRoutine("FUNC num TextTabGet(string TableName)", _get_table, task=True),
    LibraryRoutine("FUNC string TextGet(num Table, num Index)", _get_text, task=True),
)
