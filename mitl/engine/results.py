"""results.json: run record to JSON and back. The writer is the contract (CONTRACT.md, schema 1); the reader refuses what does not fit."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from mitl.engine.json_value import JsonValue, read_json
from mitl.engine.record import SCHEMA, BudgetTerm, CaseRecord, CheckRecord, Message, RunRecord, SubtestRecord
from mitl.errors import UsageError
from mitl.metrics.decision import GUARD

FILE_NAME = "results.json"


def to_json(run: RunRecord) -> dict[str, Any]:
    """Gives the run record as JSON values."""
    return {
        "schema": SCHEMA,
        "outcome": run.outcome.value,
        "rig": run.rig,
        "robot": run.robot,
        "seed": run.seed,
        "faults": list(run.faults),
        "started": run.started,
        "wall_s": run.wall_s,
        "interrupted": run.interrupted,
        "judged_from": run.judged_from,
        "health": run.health,
        "versions": dict(run.versions),
        "cases": [case_to_json(case) for case in run.cases],
    }


def case_to_json(case: CaseRecord) -> dict[str, Any]:
    """Gives one case as JSON values."""
    return {
        "id": case.id,
        "title": case.title,
        "outcome": case.outcome.value,
        "duration_s": case.duration_s,
        "checks": [_check_to_json(check) for check in case.checks],
        "messages": [{"level": message.level, "text": message.text} for message in case.messages],
        "recording": case.recording,
        "purpose": case.purpose,
        "requirement": case.requirement,
        "limit_source": case.limit_source,
        "catches": list(case.catches),
        "program": case.program,
        "source": case.source,
        "log": case.log,
        "subtests": [{"name": part.name, "outcome": part.outcome.value} for part in case.subtests],
    }


def _check_to_json(check: CheckRecord) -> dict[str, Any]:
    return {
        "name": check.name,
        "value": check.value,
        "unit": check.unit,
        "limit": check.limit,
        "uncertainty": check.uncertainty,
        "outcome": check.outcome.value,
        "at_least": check.at_least,
        "warning": check.warning,
        "series": check.series,
        "budget": [{"name": term.name, "value": term.value, "source": term.source} for term in check.budget],
        "looks": check.looks,
        "guard": check.guard,
        "subtest": check.subtest,
    }


def text_of(run: RunRecord) -> str:
    """Gives the text of results.json."""
    return json.dumps(to_json(run), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def read_run(folder: Path) -> RunRecord:
    """Gives the record of a run's folder. Raises UsageError where results.json is missing, no JSON, or not of schema 1."""
    path = folder / FILE_NAME
    return run_of(read_json(path, "expected the folder of a run made by mitl verify").value, str(path))


def case_of_json(value: object) -> CaseRecord:
    """Gives one case from the JSON values of `case_to_json`."""
    return _case(JsonValue(value, "case"))


def run_of(content: object, where: str) -> RunRecord:
    """Gives the run record of JSON values; `where` begins the message where they do not fit."""
    value = JsonValue(content, where)
    schema = value.at("schema").whole()
    if schema != SCHEMA:
        raise UsageError(f"{value.where}: schema {schema}; this mitl reads schema {SCHEMA}")
    run = RunRecord(
        rig=value.at("rig").text(),
        robot=value.optional("robot", "").text(),
        seed=value.at("seed").whole(),
        cases=tuple(_case(item) for item in value.at("cases").items()),
        versions={name: item.text() for name, item in value.at("versions").pairs()},
        faults=tuple(item.text() for item in value.optional("faults", []).items()),
        started=value.optional("started", "").text(),
        wall_s=value.optional("wall_s", 0.0).number(),
        interrupted=value.optional("interrupted", False).truth(),
        judged_from=value.optional("judged_from", None).text_or_none(),
        health=value.optional("health", "").text(),
    )
    said = value.at("outcome").outcome()
    if said is not run.outcome:
        raise UsageError(f"{value.where}: outcome is {said.value!r}, but its cases make it {run.outcome.value!r}")
    return run


def _case(value: JsonValue) -> CaseRecord:
    return CaseRecord(
        id=value.at("id").text(),
        title=value.at("title").text(),
        outcome=value.at("outcome").outcome(),
        duration_s=value.at("duration_s").number(),
        checks=tuple(_check(item) for item in value.at("checks").items()),
        messages=tuple(Message(item.at("level").text(), item.at("text").text()) for item in value.at("messages").items()),
        recording=value.at("recording").file_name(),
        purpose=value.optional("purpose", "").text(),
        requirement=value.optional("requirement", "").text(),
        limit_source=value.optional("limit_source", "").text(),
        catches=tuple(item.text() for item in value.optional("catches", []).items()),
        program=value.optional("program", None).text_or_none(),
        source=value.optional("source", None).text_or_none(),
        log=value.optional("log", None).file_name(),
        subtests=tuple(
            SubtestRecord(item.at("name").text(), item.at("outcome").outcome()) for item in value.optional("subtests", []).items()
        ),
    )


def _check(value: JsonValue) -> CheckRecord:
    return CheckRecord(
        name=value.at("name").text(),
        value=value.at("value").number_or_none(),
        unit=value.at("unit").text(),
        limit=value.at("limit").number(),
        uncertainty=value.at("uncertainty").number_or_none(),
        outcome=value.at("outcome").outcome(),
        at_least=value.optional("at_least", False).truth(),
        warning=value.optional("warning", False).truth(),
        series=value.optional("series", None).text_or_none(),
        budget=tuple(
            BudgetTerm(item.at("name").text(), item.at("value").number(), item.optional("source", "").text())
            for item in value.optional("budget", []).items()
        ),
        looks=value.optional("looks", 1).whole(),
        guard=value.optional("guard", GUARD).number(),
        subtest=value.optional("subtest", None).text_or_none(),
    )
