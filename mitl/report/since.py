"""history.json: since when cases of a run are bad, written beside results.json by `mitl history add`, so that the report can say it.

Invariant: the report stays a pure function of the run's folder; without this file it says nothing of other runs.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path

from mitl.recording.atomic import replacing

FILE_NAME = "history.json"


@dataclass(frozen=True)
class Since:
    """The unbroken row of runs, up to this one, in which a case did not pass. started: of its first run, ISO 8601. runs: how many.

    known: comparable runs before this one in which the case was run; 0 for a case that is new.
    """

    started: str
    runs: int
    known: int

    @property
    def words(self) -> str:
        """The same in words."""
        if self.known == 0:
            return "first run of this case that is known"
        if self.runs == 1:
            return f"new in this run, after {self.known} before it"
        return f"since {self.started.replace('T', ' ')[:16]}, {self.runs} runs in a row"


def read_since(folder: Path) -> dict[str, Since]:
    """Gives what is known by case id; a file that is missing or does not fit counts as none, because nothing else depends on it."""
    try:
        content = json.loads((folder / FILE_NAME).read_text(encoding="utf-8"))
        return {str(case): Since(str(each["started"]), int(each["runs"]), int(each["known"])) for case, each in content["cases"].items()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return {}


def write_since(folder: Path, cases: dict[str, Since]) -> None:
    """Writes what is known. Raises UsageError where the folder cannot be written."""
    content = {"schema": 1, "cases": {case: asdict(since) for case, since in cases.items()}}
    with replacing(folder / FILE_NAME) as beside:
        beside.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
