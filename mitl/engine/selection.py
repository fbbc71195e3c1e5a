"""Which cases are meant by what the user typed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches

from mitl.engine.case import CaseInfo, matches
from mitl.errors import UsageError


def select(cases: Sequence[CaseInfo], wanted: Sequence[str], *, long: bool = False) -> set[str]:
    """Gives the ids that are meant; without `wanted`, all.

    Cases that take hours are left out unless `long`, or asked for by their own id. Raises UsageError for a name that means none, with
    those that are near.
    """
    ids = [case.id for case in cases]
    usual = {case.id for case in cases if long or not case.long}
    chosen: set[str] = set()
    for name in wanted:
        meant = {case_id for case_id in ids if matches(case_id, name.strip().rstrip("/"))}
        if not meant:
            raise UsageError(f"unknown case {name!r}: {_hint(ids, name)}")
        chosen |= (meant & usual) or meant
    return chosen if wanted else usual


def refuse_used_twice(cases: Iterable[tuple[str, str]]) -> None:
    """Raises UsageError for an id that two tests have; cases: id and the test's name."""
    seen: dict[str, str] = {}
    for case_id, name in cases:
        if case_id in seen:
            raise UsageError(f"case id {case_id!r} is used twice: by {seen[case_id]} and by {name}")
        seen[case_id] = name


def place(case_id: str, wanted: Sequence[str]) -> int:
    """Gives which of `wanted` means the case first, or their number where none does."""
    return next((number for number, name in enumerate(wanted) if matches(case_id, name.strip().rstrip("/"))), len(wanted))


def _hint(ids: Sequence[str], name: str) -> str:
    groups = {case_id.rpartition("/")[0] for case_id in ids} - {""}
    near = get_close_matches(name, [*ids, *groups], n=3, cutoff=0.7) or sorted(case_id for case_id in ids if name in case_id)[:3]
    if near:
        return "did you mean " + " or ".join(near) + "?"
    return "expected one of " + ", ".join(sorted(groups)) + ", or a case below it (mitl verify --list)" if groups else "there are no cases"
