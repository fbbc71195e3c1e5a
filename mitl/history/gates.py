"""Quality gates: which failures are expected, until when, and what fails the build, from a TOML file read strictly.

[gate]
fail_on = ["fail", "error"]     # outcomes of a case that fail the build unless known; these two where it is left out
inconclusive_at_most = 3        # more inconclusive cases than so many fail the build; any number where it is left out
skipped_at_most = 0             # the same for cases that were not run

[[known]]                       # a failure that is expected
case = "atc-2/zone-speed"       # id of the case, * stands for anything
outcome = "inconclusive"        # expected outcome; any that is not pass where it is left out
reason = "the tracker cannot judge it"
until = 2027-01-31              # from the next day on it is no longer expected
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from datetime import date
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from mitl.engine.record import CaseRecord, RunRecord
from mitl.errors import UsageError
from mitl.outcome import Outcome


@dataclass(frozen=True)
class Known:
    """A failure that is expected until the end of a day (None: for ever)."""

    case: str
    reason: str
    outcome: Outcome | None = None
    until: date | None = None

    def fits(self, case: CaseRecord) -> bool:
        """Gives whether this is the failure of the case, whatever the day."""
        return fnmatchcase(case.id, self.case) and case.outcome is not Outcome.PASS and self.outcome in {None, case.outcome}


@dataclass(frozen=True)
class Gates:
    """What fails the build."""

    fail_on: tuple[Outcome, ...] = (Outcome.FAIL, Outcome.ERROR)
    inconclusive_at_most: int | None = None
    skipped_at_most: int | None = None
    known: tuple[Known, ...] = ()


@dataclass(frozen=True)
class GateResult:
    """broken: what fails the build, in words. expected: cases with the known issue that excuses them. expired: known issues past their
    day. fixed: known issues whose cases all pass now, to be taken out of the file.
    """

    broken: tuple[str, ...]
    expected: tuple[tuple[CaseRecord, Known], ...]
    expired: tuple[tuple[CaseRecord, Known], ...]
    fixed: tuple[Known, ...]

    @property
    def open(self) -> bool:
        """Whether the build may go on."""
        return not self.broken


def judge(run: RunRecord, gates: Gates, today: date) -> GateResult:
    """Gives what the gates say of a run; an interrupted run is never let through, because it judged only a part."""
    broken = ["the run was interrupted: it judged only a part of the cases"] if run.interrupted else []
    expected, expired, counted = [], [], []
    for case in run.cases:
        if case.outcome is Outcome.PASS:
            continue
        fitting = [known for known in gates.known if known.fits(case)]
        current = [known for known in fitting if known.until is None or today <= known.until]
        if current:
            expected.append((case, current[0]))
            continue
        counted.append(case)
        if fitting:
            expired.append((case, fitting[0]))
        if case.outcome in gates.fail_on:
            until = f"; it was expected until {fitting[0].until}" if fitting else ""
            broken.append(f"{case.id}: {case.outcome.value}{until}")
    for outcome, most in ((Outcome.INCONCLUSIVE, gates.inconclusive_at_most), (Outcome.SKIPPED, gates.skipped_at_most)):
        number = sum(case.outcome is outcome for case in counted)
        if most is not None and number > most:
            broken.append(f"{number} cases {outcome.value}, at most {most} are let through")
    fixed = [
        known
        for known in gates.known
        if (mine := [case for case in run.cases if fnmatchcase(case.id, known.case)]) and all(c.outcome is Outcome.PASS for c in mine)
    ]
    return GateResult(tuple(broken), tuple(expected), tuple(expired), tuple(fixed))


def read_gates(file: Path) -> Gates:
    """Reads a gates file. Raises UsageError naming file and key."""
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise UsageError(f"{file}: cannot be read: {error.strerror or error}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"{file}: not valid TOML: {error}") from error
    _only(file, "", table, {"gate", "known"})
    gate, known = table.get("gate", {}), table.get("known", [])
    if not isinstance(gate, dict) or not isinstance(known, list) or not all(isinstance(each, dict) for each in known):
        raise UsageError(f"{file}: expected a section [gate] and sections [[known]]")
    _only(file, "[gate] ", gate, {"fail_on", "inconclusive_at_most", "skipped_at_most"})
    fail_on = gate.get("fail_on", ["fail", "error"])
    if not isinstance(fail_on, list):
        raise UsageError(f"{file}: [gate] fail_on: expected a list of outcomes, found {fail_on!r}")
    return Gates(
        tuple(_outcome(file, "[gate] fail_on", value) for value in fail_on),
        _count(file, gate, "inconclusive_at_most"),
        _count(file, gate, "skipped_at_most"),
        tuple(_known(file, number, each) for number, each in enumerate(known, start=1)),
    )


def _known(file: Path, number: int, table: dict[str, Any]) -> Known:
    where = f"[[known]] {number} "
    _only(file, where, table, {"case", "outcome", "reason", "until"})
    texts = [table.get(key) for key in ("case", "reason")]
    if not all(isinstance(text, str) and text.strip() for text in texts):
        raise UsageError(f"{file}: {where}needs a case and a reason, both text")
    until = table.get("until")
    if until is not None and type(until) is not date:
        raise UsageError(f"{file}: {where}until: expected a day such as 2027-01-31, found {until!r}")
    outcome = table.get("outcome")
    return Known(str(texts[0]), str(texts[1]), None if outcome is None else _outcome(file, f"{where}outcome", outcome), until)


def _outcome(file: Path, where: str, value: object) -> Outcome:
    try:
        return Outcome(value)
    except ValueError:
        expected = ", ".join(outcome.value for outcome in Outcome)
        raise UsageError(f"{file}: {where}: expected one of {expected}, found {value!r}") from None


def _count(file: Path, table: dict[str, Any], key: str) -> int | None:
    value = table.get(key)
    if value is not None and (isinstance(value, bool) or not isinstance(value, int) or value < 0):
        raise UsageError(f"{file}: [gate] {key}: expected a whole number from 0 on, found {value!r}")
    return value


def _only(file: Path, where: str, table: dict[str, Any], known: set[str]) -> None:
    for key in table:
        if key not in known:
            raise UsageError(f"{file}: {where}unknown key {key!r}, known are {', '.join(sorted(known))}")
