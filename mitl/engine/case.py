"""`@case` turns a pytest function into a test case: it attaches frozen metadata as the mark `mitl_case` and changes nothing else."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

import pytest

from mitl.errors import UsageError

MARK = "mitl_case"
_ID = re.compile(r"[a-z0-9][a-z0-9-]*(/[a-z0-9][a-z0-9-]*)*")
_Function = TypeVar("_Function", bound=Callable[..., None])


@dataclass(frozen=True)
class CaseInfo:
    """What a case says about itself.

    program: the RAPID file, or None. catches: names of the faults that must make it FAIL. typical_s: how long it usually takes at the rig.
    long: it takes hours, and is run only where it is asked for by its id or with --long.
    """

    id: str
    title: str
    purpose: str = ""
    requirement: str = ""
    limit_source: str = ""
    catches: tuple[str, ...] = ()
    program: Path | None = None
    typical_s: float = 60.0
    long: bool = False


def case(
    case_id: str,
    *,
    title: str,
    purpose: str,
    requirement: str = "",
    limit_source: str = "",
    catches: Sequence[str] = (),
    program: str | None = None,
    typical_s: float = 60.0,
    long: bool = False,
) -> Callable[[_Function], _Function]:
    """Gives the decorator that declares a test function as the case `case_id`, e.g. "atc-1/linear".

    program is a RAPID file beside the Python file. Raises UsageError where the id is malformed or the program is missing, at import,
    because a case that cannot run should not look as if it could.
    """
    if not _ID.fullmatch(case_id):
        raise UsageError(f"case id {case_id!r}: expected lower-case words joined by - and /, for example atc-1/linear")

    def declare(function: _Function) -> _Function:
        file = None
        if program is not None:
            file = Path(inspect.getfile(function)).resolve().parent / program
            if not file.is_file():
                raise UsageError(f"case {case_id}: its program {file} does not exist")
        info = CaseInfo(case_id, title, purpose, requirement, limit_source, tuple(catches), file, typical_s, long)
        marked: _Function = pytest.mark.mitl_case(info)(function)
        return marked

    return declare


def case_of(item: pytest.Item) -> CaseInfo | None:
    """Gives the metadata of a collected test, or None where it is no case; a parametrized case gets its parameters into its id."""
    mark = item.get_closest_marker(MARK)
    if mark is None:
        return None
    info = mark.args[0]
    assert isinstance(info, CaseInfo)  # noqa: S101 - only `case` sets the mark
    parameters = getattr(item, "callspec", None)
    return replace(info, id=f"{info.id}[{parameters.id}]") if parameters is not None else info


def undeclared(item: pytest.Item) -> CaseInfo:
    """Gives metadata for a test that uses our fixtures without `@case`: its node id, and its docstring as the purpose."""
    doc = inspect.getdoc(getattr(item, "function", None)) or ""
    return CaseInfo(id=item.nodeid, title=item.name, purpose=doc)


def matches(case_id: str, wanted: str) -> bool:
    """Gives whether a case is meant by `wanted`: its id, or leading parts of it; atc-1 does not mean atc-10/any."""
    return case_id == wanted or case_id.startswith((f"{wanted}/", f"{wanted}["))
