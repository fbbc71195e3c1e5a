"""Allure result files of a run: one JSON a case, for servers that keep a history of their own. Format: Allure 2 result files."""

from __future__ import annotations

import hashlib
import json
import shutil
import uuid
from datetime import datetime
from pathlib import Path
from typing import Any

from mitl.engine.record import CaseRecord, RunRecord
from mitl.engine.wording import reason, sentence
from mitl.errors import UsageError
from mitl.outcome import Outcome
from mitl.recording.atomic import replacing

_STATUS = {
    Outcome.PASS: "passed",
    Outcome.FAIL: "failed",
    Outcome.ERROR: "broken",
    Outcome.INCONCLUSIVE: "skipped",
    Outcome.SKIPPED: "skipped",
}


def write_allure(run: RunRecord, source: Path, target: Path) -> int:
    """Writes the result files of a run into a folder, recordings and logs copied beside them; gives how many cases.

    An inconclusive case is `skipped` there, as in JUnit, and its message says so. Raises UsageError where the folder cannot be written.
    """
    try:
        target.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"{target}: cannot be made: {error.strerror or error}") from error
    started = _milliseconds(run.started)
    at = started
    for case in run.cases:
        until = at + round(1e3 * case.duration_s)
        name = uuid.uuid5(uuid.NAMESPACE_URL, f"mitl:{run.started}:{run.seed}:{case.id}")
        result = _result(run, case, at, until) | {"uuid": str(name), "attachments": _attachments(case, source, target, str(name))}
        _write(target / f"{name}-result.json", result)
        at = until
    facts = {"rig": run.rig, "robot": run.robot, "seed": str(run.seed), "faults": " ".join(run.faults) or "none", **run.versions}
    text = "".join(f"{_property(key)}={_property(value)}\n" for key, value in facts.items())
    with replacing(target / "environment.properties") as beside:
        beside.write_text(text, encoding="utf-8")
    return len(run.cases)


def _result(run: RunRecord, case: CaseRecord, start: int, stop: int) -> dict[str, Any]:
    group, _, name = case.id.rpartition("/")
    parameters = [{"name": "rig", "value": run.rig}, {"name": "seed", "value": str(run.seed), "excluded": True}]
    history = hashlib.sha256("\0".join([case.id, run.rig, run.robot, *run.faults]).encode()).hexdigest()[:32]
    why = reason(case)
    return {
        "historyId": history,
        "testCaseId": hashlib.sha256(case.id.encode()).hexdigest()[:32],
        "fullName": case.id,
        "name": case.title or name,
        "description": case.purpose,
        "status": _STATUS[case.outcome],
        "statusDetails": {"message": f"{case.outcome.value}: {why}" if why else "", "known": False, "flaky": False},
        "stage": "finished",
        "start": start,
        "stop": stop,
        "labels": [
            {"name": "suite", "value": group or "mitl"},
            {"name": "framework", "value": "mitl"},
            {"name": "host", "value": run.rig},
            *({"name": "tag", "value": fault} for fault in case.catches),
        ],
        "parameters": parameters,
        "steps": [
            {"name": sentence(check), "status": _STATUS[check.outcome], "stage": "finished", "start": start, "stop": stop}
            for check in case.checks
        ],
    }


def _attachments(case: CaseRecord, source: Path, target: Path, name: str) -> list[dict[str, str]]:
    found = []
    for file, title, kind in ((case.recording, "recording", "application/octet-stream"), (case.log, "log", "text/plain")):
        if file is not None and (source / file).is_file():
            copied = f"{name}-attachment{Path(file).suffix}"
            shutil.copyfile(source / file, target / copied)
            found.append({"name": title, "source": copied, "type": kind})
    return found


def _write(path: Path, value: dict[str, Any]) -> None:
    with replacing(path) as beside:
        beside.write_text(json.dumps(value, ensure_ascii=False, indent=1), encoding="utf-8")


def _milliseconds(started: str) -> int:
    try:
        return round(1e3 * datetime.fromisoformat(started).timestamp())
    except ValueError:
        return 0


def _property(text: str) -> str:
    """Gives text for a Java properties file, in one line."""
    return " ".join(text.split()).replace("\\", "\\\\").replace("=", "\\=").replace(":", "\\:")
