"""HealthRecord: what a health check of a rig found, as a JSON file; and whether a run may rely on the latest one.

Invariant: a file that does not fit the schema is refused, never read in part: a run must not be let through by a damaged record.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from mitl.engine.json_value import JsonValue, read_json
from mitl.engine.record import RunRecord
from mitl.errors import RigError, UsageError
from mitl.outcome import Outcome
from mitl.protocols import HealthGate, Rig
from mitl.recording.atomic import replacing

SCHEMA = 1
KIND = "mitl health"
CHANGE = ", worse than the baseline by"
"""Ends the name of a check that compares a figure with the baseline."""
MARK, IGNORE = "mark", "ignore"
_SERIAL = "serial"
_AHEAD = timedelta(minutes=5)
"""By how much the clocks of two computers may differ."""


@dataclass(frozen=True)
class Figure:
    """One check of the health check, in `unit`. value, uncertainty: None where it was no number, or is unknown."""

    name: str
    value: float | None
    unit: str
    limit: float
    uncertainty: float | None
    outcome: Outcome


@dataclass(frozen=True)
class HealthRecord:
    """A health check of a rig. date: ISO 8601 with offset, when it began. case_outcomes: of every case. versions: with the serials of
    controller and tracker. baseline: date of the baseline that it was judged by, or "". reason: why it is a baseline, or "".
    """

    rig: str
    robot: str
    seed: int
    date: str
    case_outcomes: dict[str, Outcome]
    figures: tuple[Figure, ...]
    versions: dict[str, str]
    faults: tuple[str, ...] = ()
    baseline: str = ""
    reason: str = ""
    outcome: Outcome = Outcome.ERROR

    def figure(self, name: str) -> Figure | None:
        """Gives a figure by its name, or None."""
        return next((figure for figure in self.figures if figure.name == name), None)

    @property
    def identity(self) -> dict[str, str]:
        """What must be the same for two records to be of one rig: its name, its robot, and the serials that were told."""
        return {"rig": self.rig, "robot": self.robot, **{name: text for name, text in self.versions.items() if _SERIAL in name}}


def health_of(run: RunRecord, *, baseline: HealthRecord | None = None, reason: str = "") -> HealthRecord:
    """Gives the health record of a run of the health check's cases."""
    figures = tuple(
        Figure(check.name, check.value, check.unit, check.limit, check.uncertainty, check.outcome)
        for case in run.cases
        for check in case.checks
    )
    return HealthRecord(
        rig=run.rig,
        robot=run.robot,
        seed=run.seed,
        date=run.started,
        case_outcomes={case.id: case.outcome for case in run.cases},
        figures=figures,
        versions=dict(run.versions),
        faults=run.faults,
        baseline=baseline.date if baseline else "",
        reason=reason,
        outcome=run.outcome,
    )


def other_rig(record: HealthRecord, baseline: HealthRecord) -> str:
    """Gives in what two records are of different rigs, or "" where they are of one. A serial that only one of them tells does not count."""
    mine, theirs = record.identity, baseline.identity
    different = [name for name in mine if name in theirs and mine[name] != theirs[name]]
    return ", ".join(f"{name} {theirs[name]!r}, now {mine[name]!r}" for name in different)


def sickness(gate: HealthGate, rig: str, robot: str, now: datetime) -> str:
    """Gives why a run should not rely on a rig's latest health check, or "" where it may."""
    if not gate.record.is_file():
        return f"there is no health check of this rig: {gate.record} is missing"
    try:
        record = read_health(gate.record)
    except UsageError as error:
        return f"the health check cannot be read: {error}"
    date = datetime.fromisoformat(record.date)
    if (record.rig, record.robot) != (rig, robot):
        return f"{gate.record} is a health check of {record.rig} with {record.robot}, not of {rig} with {robot}"
    if now - date > timedelta(hours=gate.max_age_h):
        hours = (now - date) / timedelta(hours=1)
        return f"the health check of {record.date} is {hours:.0f} h old; at most {gate.max_age_h:g} h are allowed"
    if date - now > _AHEAD:
        return f"the health check is dated {record.date}, which is in the future: one of the clocks is wrong"
    if record.outcome is not Outcome.PASS:
        bad = [figure.name for figure in record.figures if figure.outcome is not Outcome.PASS]
        bad = bad or [case for case, outcome in record.case_outcomes.items() if outcome is not Outcome.PASS]
        return f"the health check of {record.date} is {record.outcome.value}: {', '.join(bad)}"
    return ""


def ask(rig: Rig, wanted: str | None) -> tuple[str, RigError | None]:
    """Gives why the rig's health check does not vouch for it, or "", and the error where the run is refused for it; then it is closed.

    wanted: refuse, mark or ignore; what the rig file says where it is None.
    """
    what = wanted or (rig.health.on_sick if rig.health is not None else IGNORE)
    if rig.health is None or what == IGNORE:
        return "", None
    sick = sickness(rig.health, rig.name, rig.robot, datetime.now(UTC))
    if not sick or what == MARK:
        return sick, None
    rig.close()
    return sick, RigError(f"{sick}; run mitl health on it, or let the run be marked with --health mark")


def write_health(file: Path, record: HealthRecord) -> None:
    """Writes a record as a whole or not at all. Raises UsageError where it cannot be written."""
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        with replacing(file) as beside:
            beside.write_text(text_of(record), encoding="utf-8")
    except OSError as error:
        raise UsageError(f"{file}: the health record cannot be written: {error.strerror or error}") from error


def text_of(record: HealthRecord) -> str:
    """Gives the text of the file."""
    return json.dumps(_to_json(record), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _to_json(record: HealthRecord) -> dict[str, Any]:
    return {
        "schema": SCHEMA,
        "kind": KIND,
        "outcome": record.outcome.value,
        "rig": record.rig,
        "robot": record.robot,
        "seed": record.seed,
        "date": record.date,
        "faults": list(record.faults),
        "baseline": record.baseline,
        "reason": record.reason,
        "cases": {case: outcome.value for case, outcome in record.case_outcomes.items()},
        "figures": [
            {
                "name": figure.name,
                "value": figure.value,
                "unit": figure.unit,
                "limit": figure.limit,
                "uncertainty": figure.uncertainty,
                "outcome": figure.outcome.value,
            }
            for figure in record.figures
        ],
        "versions": dict(record.versions),
    }


def read_health(file: Path) -> HealthRecord:
    """Gives a health record. Raises UsageError where it is missing, no JSON, or does not fit the schema."""
    value = read_json(file, "expected a health record made by mitl health")
    if value.at("kind").text() != KIND or value.at("schema").whole() != SCHEMA:
        raise UsageError(f"{file}: expected a health record of schema {SCHEMA}, made by mitl health")
    date = value.at("date").text()
    try:
        aware = datetime.fromisoformat(date).tzinfo is not None
    except ValueError:
        aware = False
    if not aware:
        raise UsageError(f"{file}: date: expected a time with its offset from UTC, found {date!r}")
    return HealthRecord(
        rig=value.at("rig").text(),
        robot=value.at("robot").text(),
        seed=value.at("seed").whole(),
        date=date,
        case_outcomes={name: item.outcome() for name, item in value.at("cases").pairs()},
        figures=tuple(_figure(item) for item in value.at("figures").items()),
        versions={name: item.text() for name, item in value.at("versions").pairs()},
        faults=tuple(item.text() for item in value.at("faults").items()),
        baseline=value.at("baseline").text(),
        reason=value.at("reason").text(),
        outcome=value.at("outcome").outcome(),
    )


def _figure(value: JsonValue) -> Figure:
    return Figure(
        name=value.at("name").text(),
        value=value.at("value").number_or_none(),
        unit=value.at("unit").text(),
        limit=value.at("limit").number(),
        uncertainty=value.at("uncertainty").number_or_none(),
        outcome=value.at("outcome").outcome(),
    )
