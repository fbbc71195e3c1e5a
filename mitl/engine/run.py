"""RunKeeper: collects the cases of a run and keeps its folder complete after every case, so that nothing finished is ever lost."""

from __future__ import annotations

import platform
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from mitl.calibration.store import save_calibration
from mitl.engine import case_recording, junit, results, resuming, summary
from mitl.engine.bench import calibration_tracks
from mitl.engine.calibration_session import SessionCalibration
from mitl.engine.case import CaseInfo
from mitl.engine.health import ask
from mitl.engine.record import CaseRecord, Message, RunRecord
from mitl.engine.recorder import CaseRecorder, file_name
from mitl.errors import MitlError, RigError, UsageError
from mitl.outcome import Outcome
from mitl.protocols import Rig
from mitl.recording.atomic import replacing
from mitl.recording.records import Recording

REPORT, REPLAY = "report.html", "replay.html"
_PACKAGES = ("mitl", "numpy", "scipy", "drake", "ruckig", "mcap", "pytest")


@dataclass(frozen=True)
class RigDescription:
    """What the record says of the rig."""

    name: str
    robot: str
    versions: dict[str, str]


@dataclass
class RunKeeper:
    """The run so far. folder: where it is kept, or None to keep nothing. rig_name: what was asked for. problem: why there is no report.
    opened: whether the folder is ready; set from the start where another process makes it ready. resume: go on with the run in it.
    unwritten: why the folder is not up to date, or "". judged_from: the run whose recordings are judged again, if so.
    health: why the rig's latest health check does not vouch for it, or "".
    """

    seed: int
    faults: tuple[str, ...]
    folder: Path | None
    rig_name: str = ""
    planned: list[CaseInfo] = field(default_factory=list)
    rig: RigDescription | None = None
    cases: list[CaseRecord] = field(default_factory=list)
    problem: str | None = None
    opened: bool = False
    resume: bool = False
    unwritten: str = ""
    judged_from: str | None = None
    health: str = ""
    started: str = field(default_factory=lambda: datetime.now(UTC).isoformat(timespec="seconds"))
    _before_s: float = 0.0
    _began: float = field(default_factory=time.monotonic)

    def open_folder(self) -> None:
        """Makes the folder and removes the files of the run that it held before. Raises UsageError where that cannot be."""
        if self.folder is None or self.opened:
            return
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            kept = self._take_up()
            for name in set(_files_of_old_run(self.folder)) - kept:
                (self.folder / name).unlink(missing_ok=True)
        except OSError as error:
            raise UsageError(f"{self.folder}: cannot keep a run here: {error.strerror}") from error
        self.opened = True

    def known(self) -> frozenset[str]:
        """Gives the ids of the cases that a run that is resumed has judged already. Raises UsageError where it is another run."""
        run = resuming.earlier_run(self.folder) if self.resume else None
        if run is None:
            return frozenset()
        resuming.refuse_another(run, rig="", seed=self.seed, faults=self.faults, versions=installed_versions())
        return frozenset(case.id for case in resuming.judged(run))

    def _take_up(self) -> set[str]:
        """Takes over what a run that is resumed has judged; gives the files that stay."""
        run = resuming.earlier_run(self.folder) if self.resume else None
        if run is None:
            return set()
        rig = self.rig.name if self.rig else ""
        now = {**installed_versions(), **(self.rig.versions if self.rig else {})}
        resuming.refuse_another(run, rig=rig, seed=self.seed, faults=self.faults, versions=now)
        kept = resuming.judged(run)
        self.cases = [*kept, *self.cases]
        self.started, self._before_s = run.started, run.wall_s
        # a run's last look stays until this one has made its own: a resumed run may end before its first case
        return {results.FILE_NAME, junit.FILE_NAME, *(name for case in kept for name in (case.recording, case.log) if name is not None)}

    def add(self, case: CaseRecord) -> None:
        """Takes a finished case; one of the same id replaces the former (a test run again)."""
        self.cases = [done for done in self.cases if done.id != case.id] + [case]

    def describe(self, rig: Rig) -> None:
        """Remembers what rig it is."""
        self.rig = RigDescription(rig.name, rig.robot, dict(rig.versions))

    def ask_health(self, rig: Rig, wanted: str | None) -> RigError | None:
        """Remembers why the rig's health check does not vouch for it; gives the error where the run is refused for it (`health.ask`)."""
        self.health, refusal = ask(rig, wanted)
        return refusal

    def rig_as_json(self) -> dict[str, Any] | None:
        """Gives the rig's description for another process."""
        return asdict(self.rig) if self.rig else None

    def take(self, finished: dict[str, Any]) -> None:
        """Takes a finished case with its rig as the JSON values that came from another process, or from this one."""
        self.add(results.case_of_json(finished["case"]))
        if self.rig is None and finished["rig"] is not None:
            self.rig = RigDescription(**finished["rig"])

    def keep_recording(self, recorder: CaseRecorder) -> None:
        """Writes the recording of a case that had the rig or kept anything; that it cannot be written is the case's error."""
        kept = recorder.began is not None or recorder.runs or recorder.paths or recorder.series
        if self.folder is None or recorder.recording is not None or not kept:
            return
        self.open_folder()
        name = file_name(recorder.info.id, ".mcap")
        try:
            case_recording.write(self.folder / name, recorder.recorded(self.provenance()))
        except (OSError, MitlError, ValueError) as error:
            recorder.error(f"the recording {name} could not be written: {error}")
        else:
            recorder.recording = name

    def keep_calibration(self, found: SessionCalibration) -> None:
        """Writes the session's calibration, and the poses that it was solved from, so that it can be solved again."""
        if self.folder is None:
            return
        self.open_folder()
        try:
            save_calibration(self.folder / "calibration.toml", found.calibration, reference=found.reference)
            case_recording.write(self.folder / "calibration.mcap", Recording(calibration_tracks(found.poses), metadata=self.provenance()))
        except (OSError, UsageError) as error:
            self.unwritten = f"the calibration could not be kept: {error}"

    def finish(self, recorder: CaseRecorder, captured: str) -> CaseRecord:
        """Gives the finished case; tracebacks and captured output go into a log file beside the recording."""
        text = "\n".join([*recorder.log, *([captured] if captured else [])])
        if self.folder is None or not text:
            return recorder.finish()
        self.open_folder()
        name = file_name(recorder.info.id, ".log")
        try:
            write_text(self.folder / name, text)
        except (OSError, UsageError) as error:
            recorder.say("warning", f"the log {name} could not be written: {error}")
            return recorder.finish()
        return recorder.finish(name)

    def provenance(self) -> dict[str, str]:
        """Gives what a recording should say about where it came from."""
        rig = self.rig or RigDescription("", "", {})
        faults = {"faults": " ".join(self.faults)} if self.faults else {}
        return {"rig": rig.name, "robot": rig.robot, "seed": str(self.seed), **faults, **installed_versions(), **rig.versions}

    def record(self) -> RunRecord:
        """Gives the record as it is now; planned cases that did not run are SKIPPED, and the run is interrupted."""
        done = {case.id for case in self.cases}
        missing = [_not_run(info) for info in self.planned if info.id not in done]
        rig = self.rig or RigDescription(self.rig_name, "", {})
        return RunRecord(
            rig=rig.name,
            robot=rig.robot,
            seed=self.seed,
            cases=(*self.cases, *missing),
            versions={**installed_versions(), **rig.versions},
            faults=self.faults,
            started=self.started,
            wall_s=round(self._before_s + time.monotonic() - self._began, 3),
            interrupted=bool(missing),
            judged_from=self.judged_from,
            health=self.health,
        )

    def save(self) -> RunRecord:
        """Writes results.json, junit.xml and summary.txt and gives the record. A full disk costs no case: the next time may succeed."""
        run = self.record()
        if self.folder is None or not run.cases or not self.opened:
            return run
        unwritten = ""
        texts = {results.FILE_NAME: results.text_of(run), junit.FILE_NAME: junit.text_of(run), summary.FILE_NAME: summary.text_of(run)}
        for name, text in texts.items():
            try:
                write_text(self.folder / name, text)
            except (OSError, UsageError) as error:
                unwritten = f"the run's folder is not up to date: {error}"
        self.unwritten = unwritten
        return run


def write_text(path: Path, text: str) -> None:
    """Writes a file as a whole or not at all."""
    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8")


def installed_versions() -> dict[str, str]:
    """Gives the versions of Python, the platform and the packages that numbers depend on."""
    found = {"python": platform.python_version(), "platform": f"{platform.system()} {platform.machine()}"}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found


def _files_of_old_run(folder: Path) -> Sequence[str]:
    own = [
        results.FILE_NAME,
        junit.FILE_NAME,
        summary.FILE_NAME,
        REPORT,
        REPLAY,
        "calibration.toml",
        "calibration.mcap",
        "history.json",
        "night.json",
    ]
    try:
        old = results.read_run(folder)
    except UsageError:
        return own
    return [*own, *(name for case in old.cases for name in (case.recording, case.log) if name is not None)]


def _not_run(info: CaseInfo) -> CaseRecord:
    return CaseRecord(
        id=info.id,
        title=info.title,
        outcome=Outcome.SKIPPED,
        messages=(Message("info", "not run, because the run ended before it"),),
        purpose=info.purpose,
        requirement=info.requirement,
        limit_source=info.limit_source,
        catches=info.catches,
        program=info.program.name if info.program else None,
    )
