"""The store: runs in one SQLite file. Invariant: a run is in it whole or not at all, and the same run is in it once."""

from __future__ import annotations

import hashlib
import json
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from mitl.calibration.store import load_calibration
from mitl.engine.record import BudgetTerm, CheckRecord, RunRecord
from mitl.engine.results import FILE_NAME, read_run
from mitl.engine.wording import reason
from mitl.errors import UsageError
from mitl.outcome import Outcome

VERSION = 1
_SCHEMA = """
CREATE TABLE runs (id TEXT PRIMARY KEY, started TEXT NOT NULL, rig TEXT NOT NULL, robot TEXT NOT NULL, seed INTEGER NOT NULL,
  faults TEXT NOT NULL, outcome TEXT NOT NULL, wall_s REAL NOT NULL, versions TEXT NOT NULL, folder TEXT NOT NULL, calibration TEXT);
CREATE TABLE cases (run TEXT NOT NULL REFERENCES runs ON DELETE CASCADE, position INTEGER NOT NULL, id TEXT NOT NULL, title TEXT NOT NULL,
  outcome TEXT NOT NULL, duration_s REAL NOT NULL, reason TEXT NOT NULL, PRIMARY KEY (run, id));
CREATE TABLE checks (run TEXT NOT NULL REFERENCES runs ON DELETE CASCADE, case_id TEXT NOT NULL, position INTEGER NOT NULL,
  name TEXT NOT NULL, value REAL, unit TEXT NOT NULL, bound REAL NOT NULL, uncertainty REAL, outcome TEXT NOT NULL,
  at_least INTEGER NOT NULL, warning INTEGER NOT NULL, guard REAL NOT NULL, budget TEXT NOT NULL, PRIMARY KEY (run, case_id, name));
CREATE INDEX checks_by_name ON checks (case_id, name);
"""


@dataclass(frozen=True)
class KeptRun:
    """A run in the store. id: 10 letters of the hash of its results. folder: the name of its folder as it was added.

    calibration: position rms of the held-out poses (mm), then x y z of X_LB (mm) and the mean scale; None where there was none.
    """

    id: str
    started: str
    rig: str
    robot: str
    seed: int
    faults: tuple[str, ...]
    outcome: Outcome
    wall_s: float
    versions: dict[str, str]
    folder: str
    calibration: tuple[float, ...] | None


@dataclass(frozen=True)
class KeptCase:
    """A case of a kept run. reason: why it is not PASS."""

    run: KeptRun
    id: str
    title: str
    outcome: Outcome
    duration_s: float
    reason: str


@dataclass(frozen=True)
class KeptCheck:
    """A check of a kept run."""

    run: KeptRun
    case_id: str
    check: CheckRecord


class Store:
    """The runs in a file. Use as a context manager. Raises UsageError where the file is no store or cannot be written."""

    def __init__(self, file: Path) -> None:
        self._file = file
        self._open = sqlite3.connect(file)

    def __enter__(self) -> Store:
        with self._telling():
            self._open.execute("PRAGMA foreign_keys = ON")
            (version,) = self._open.execute("PRAGMA user_version").fetchone()
            if version == 0 and not self._open.execute("SELECT 1 FROM sqlite_master").fetchone():
                self._open.executescript(_SCHEMA + f"PRAGMA user_version = {VERSION};")
            elif version != VERSION:
                raise UsageError(f"{self._file}: a store of version {version}; this mitl reads version {VERSION}")
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    def add(self, folder: Path) -> tuple[KeptRun, bool]:
        """Keeps the run of a folder; gives it, and whether it is new. Raises UsageError where the folder holds no run."""
        run = read_run(folder)
        key = run_id(folder)
        known = [kept for kept in self.runs() if kept.id == key]
        if known:
            return known[0], False
        made = (key, run.started, run.rig, run.robot, run.seed, json.dumps(run.faults), run.outcome.value, run.wall_s)
        with self._telling(), self._open:
            more = (json.dumps(run.versions), folder.name or str(folder), json.dumps(_calibration(folder)))
            self._open.execute("INSERT INTO runs VALUES (?,?,?,?,?,?,?,?,?,?,?)", (*made, *more))
            for position, case in enumerate(run.cases):
                row = (key, position, case.id, case.title, case.outcome.value, case.duration_s, reason(case))
                self._open.execute("INSERT INTO cases VALUES (?,?,?,?,?,?,?)", row)
                rows = [_row(key, case.id, number, check) for number, check in enumerate(case.checks)]
                self._open.executemany("INSERT INTO checks VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?)", rows)
        return next(kept for kept in self.runs() if kept.id == key), True

    def remove(self, key: str) -> None:
        """Forgets a run."""
        with self._telling(), self._open:
            self._open.execute("DELETE FROM runs WHERE id = ?", (key,))

    def runs(self) -> list[KeptRun]:
        """Gives all runs, oldest first."""
        with self._telling():
            return [_run(row) for row in self._open.execute("SELECT * FROM runs ORDER BY started, rowid")]

    def run(self, name: str) -> KeptRun:
        """Gives the run whose id begins with `name`, or `last`. Raises UsageError where there is none, or several."""
        runs = self.runs()
        found = runs[-1:] if name == "last" else [run for run in runs if run.id.startswith(name)]
        if len(found) != 1:
            raise UsageError(f"{self._file}: {'no run' if not found else f'{len(found)} runs'} {name!r}; mitl history runs lists them")
        return found[0]

    def cases(self) -> list[KeptCase]:
        """Gives the cases of all runs, oldest run first."""
        runs = {run.id: run for run in self.runs()}
        with self._telling():
            rows = self._open.execute("SELECT run, id, title, outcome, duration_s, reason FROM cases ORDER BY position").fetchall()
        found = [KeptCase(runs[row[0]], row[1], row[2], Outcome(row[3]), row[4], row[5]) for row in rows]
        order = {key: number for number, key in enumerate(runs)}
        return sorted(found, key=lambda case: order[case.run.id])

    def checks(self) -> list[KeptCheck]:
        """Gives the checks of all runs, oldest run first."""
        runs = {run.id: run for run in self.runs()}
        columns = "run, case_id, name, value, unit, bound, uncertainty, outcome, at_least, warning, guard, budget"
        with self._telling():
            rows = self._open.execute(f"SELECT {columns} FROM checks ORDER BY position").fetchall()  # noqa: S608 - our own names
        order = {key: number for number, key in enumerate(runs)}
        return sorted((KeptCheck(runs[row[0]], row[1], _check(row[2:])) for row in rows), key=lambda kept: order[kept.run.id])

    @contextmanager
    def _telling(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            raise UsageError(f"{self._file}: not a store that can be used: {error}") from error


def open_store(file: Path, *, create: bool = False) -> Store:
    """Gives the store in a file. Raises UsageError where there is none and none is to be made."""
    if not create and not file.is_file():
        raise UsageError(f"{file}: there is no history yet; mitl history add RUN makes one")
    try:
        return Store(file)
    except sqlite3.Error as error:
        raise UsageError(f"{file}: cannot be opened: {error}") from error


def run_id(folder: Path) -> str:
    """Gives the id of a folder's run. Raises UsageError where it has no results."""
    try:
        return hashlib.sha256((folder / FILE_NAME).read_bytes()).hexdigest()[:10]
    except OSError as error:
        raise UsageError(f"{folder / FILE_NAME}: {error.strerror}; expected the folder of a run made by mitl verify") from error


def comparable(run: KeptRun | RunRecord, other: KeptRun) -> bool:
    """Gives whether two runs judge the same: rig, robot and injected faults agree."""
    return (run.rig, run.robot, run.faults) == (other.rig, other.robot, other.faults)


def _calibration(folder: Path) -> tuple[float, ...] | None:
    try:
        found = load_calibration(folder / "calibration.toml")
    except UsageError:
        return None
    numbers = [1e3 * found.held_out.position_rms, *(1e3 * found.X_LB[:3]), found.scale.mean()]
    return tuple(float(value) for value in numbers)


def _row(run: str, case: str, number: int, check: CheckRecord) -> tuple[object, ...]:
    budget = json.dumps([[term.name, term.value, term.source] for term in check.budget])
    judged = (check.value, check.unit, check.limit, check.uncertainty, check.outcome.value)
    return (run, case, number, check.name, *judged, int(check.at_least), int(check.warning), check.guard, budget)


def _check(row: tuple[object, ...]) -> CheckRecord:
    name, value, unit, limit, uncertainty, outcome, at_least, warning, guard, budget = row
    return CheckRecord(
        str(name),
        _number(value),
        str(unit),
        _number(limit) or 0.0,
        _number(uncertainty),
        Outcome(outcome),
        bool(at_least),
        bool(warning),
        None,
        tuple(BudgetTerm(str(term[0]), float(term[1]), str(term[2])) for term in json.loads(str(budget))),
        guard=_number(guard) or 0.0,
    )


def _number(value: object) -> float | None:
    return float(value) if isinstance(value, int | float) else None


def _run(row: tuple[object, ...]) -> KeptRun:
    key, started, rig, robot, seed, faults, outcome, wall_s, versions, folder, calibration = row
    known = json.loads(str(calibration))
    return KeptRun(
        str(key),
        str(started),
        str(rig),
        str(robot),
        int(str(seed)),
        tuple(json.loads(str(faults))),
        Outcome(outcome),
        _number(wall_s) or 0.0,
        dict(json.loads(str(versions))),
        str(folder),
        None if known is None else tuple(known),
    )
