"""The finished trials of a campaign: one JSON line each, appended as they finish.

Invariant: a line that was cut off by a crash is dropped when read; its trial is run again.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

from mitl.campaign.trial import TrialResult
from mitl.errors import UsageError

FILE_NAME = "trials.jsonl"


def read_results(folder: Path) -> dict[str, TrialResult]:
    """Gives the finished trials of a folder by key; none where there is no campaign yet. Raises UsageError for a file that is no such."""
    file = folder / FILE_NAME
    if not file.exists():
        return {}
    lines = file.read_text(encoding="utf-8").splitlines()
    found: dict[str, TrialResult] = {}
    for number, line in enumerate(lines, start=1):
        try:
            result = TrialResult(**json.loads(line))
        except (ValueError, TypeError) as error:
            if number == len(lines):
                break
            raise UsageError(f"{file}:{number}: no finished trial: {error}; is this the folder of a campaign?") from error
        found[result.key] = result
    return found


class ResultFile:
    """The file, open for appending."""

    def __init__(self, folder: Path) -> None:
        kept = read_results(folder)
        folder.mkdir(parents=True, exist_ok=True)
        self._file = (folder / FILE_NAME).open("w", encoding="utf-8")
        for result in kept.values():
            self.add(result)

    def add(self, result: TrialResult) -> None:
        """Keeps a finished trial, at once."""
        self._file.write(json.dumps(asdict(result)) + "\n")
        self._file.flush()

    def close(self) -> None:
        """Closes the file."""
        self._file.close()
