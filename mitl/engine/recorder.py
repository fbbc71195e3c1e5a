"""CaseRecorder: what a case says and measures while it runs. It is appended to only; `finish` makes the frozen record."""

from __future__ import annotations

import hashlib
import re
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from mitl.engine.case import CaseInfo
from mitl.engine.case_recording import RecordedRun, fresh, recording_of, slug
from mitl.engine.judging import Look, Question, judged, promising
from mitl.engine.record import CaseRecord, CheckRecord, Message, SubtestRecord
from mitl.engine.tape import ATTACHMENT, Tape, encoded
from mitl.errors import MitlError
from mitl.outcome import Outcome, worst
from mitl.protocols import LoggedEvent
from mitl.recording.records import LogMessage, PoseTrack, Recording, Series


@dataclass
class CaseRecorder:
    """Collects checks, messages, paths and series of one case.

    stop_robot and now are replaced by the fixture `rig`; a case without a rig has nothing to stop and runs on the computer's clock.
    voided: nothing that was measured counts. closing: what is done when the case has measured all, before its verdict.
    round: which run of the case this is, from 1; made: the checks made in it. most_looks: how many runs an inconclusive case may have.
    more: whether the rig can do one more. tape: what the rig told the case, if it is kept.
    """

    info: CaseInfo
    stop_robot: Callable[[], None] = lambda: None
    now: Callable[[], float] = time.monotonic
    checks: list[CheckRecord] = field(default_factory=list)
    messages: list[Message] = field(default_factory=list)
    runs: list[RecordedRun] = field(default_factory=list)
    paths: dict[str, PoseTrack] = field(default_factory=dict)
    series: dict[str, Series] = field(default_factory=dict)
    events: list[LogMessage] = field(default_factory=list)
    log: list[str] = field(default_factory=list)
    broken: bool = False
    voided: bool = False
    skipped: bool = False
    fatal: bool = False
    recording: str | None = None
    began: float | None = None
    ended: float | None = None
    attachments: dict[str, bytes] = field(default_factory=dict)
    subtests: list[SubtestRecord] = field(default_factory=list)
    subtest: str | None = None
    most_looks: int = 1
    round: int = 1
    made: set[str] = field(default_factory=set)
    closing: list[Callable[[], None]] = field(default_factory=list)
    more: Callable[[], bool] = lambda: True
    tape: Tape | None = None
    _asked: dict[str, tuple[Question, list[Look]]] = field(default_factory=dict)
    _subtest_broken: bool = False

    def look(self, question: Question, look: Look) -> CheckRecord:
        """Takes one look at a value and gives the verdict on all looks at it so far."""
        _, looks = self._asked.get(question.name, (question, []))
        self._asked[question.name] = (question, [*looks, look])
        record = judged(question, self._asked[question.name][1])
        places = {check.name: place for place, check in enumerate(self.checks)}
        if question.name in places:
            self.checks[places[question.name]] = record
        else:
            self.checks.append(record)
        self.made.add(question.name)
        return record

    def next_round(self) -> bool:
        """Gives whether the case is to be run once more: it is inconclusive, and what is open may still be decided by averaging.

        Then checks may be made again by their names.
        """
        if self.outcome() is not Outcome.INCONCLUSIVE:
            return False
        asked = [self._asked[check.name] for check in self.checks if check.outcome is Outcome.INCONCLUSIVE and not check.warning]
        if not all(promising(question, looks) for question, looks in asked):
            return False
        if not self.more():
            return False
        self.round += 1
        self.made.clear()
        return True

    def begin_subtest(self, name: str) -> None:
        """Begins a part that is judged by itself."""
        self.subtest, self._subtest_broken = name, False

    def subtest_error(self, text: str, log: str) -> None:
        """Records that the part could not be judged, and why."""
        self._subtest_broken = True
        self.error(text)
        self.log.append(log)

    def end_subtest(self) -> None:
        """Ends the part; its outcome is the worst of its checks."""
        assert self.subtest is not None  # noqa: S101 - check.subtest began it
        found = [check.outcome for check in self.checks if check.subtest == self.subtest and counts(check)]
        broken = self._subtest_broken or not found
        outcome = worst([*found, *([Outcome.ERROR] if broken else [])])
        if not found and not self._subtest_broken:
            self.error(f"{self.subtest}: it made no check, so it judged nothing")
        self.subtests = [done for done in self.subtests if done.name != self.subtest] + [SubtestRecord(self.subtest, outcome)]
        self.subtest = None

    def say(self, level: str, text: str) -> None:
        """Records a message."""
        self.messages.append(Message(level, text))
        self.events.append(LogMessage(max(0.0, self.now() - (self.began or 0.0)), level, text, self.info.id))

    def keep_events(self, events: Sequence[LoggedEvent]) -> None:
        """Keeps the controller's own log entries beside the case's messages."""
        began = self.began or 0.0
        self.events += [
            LogMessage(max(0.0, event.time - began), event.level, f"{event.number} {event.text}", "controller") for event in events
        ]

    def error(self, text: str) -> None:
        """Records that the case could not be judged, and why."""
        self.broken = True
        self.say("error", text)

    def void(self, text: str) -> None:
        """Records that nothing that the case measured counts, and why: it is ERROR whatever its checks say."""
        self.voided = True
        self.error(text)

    def end_measuring(self) -> None:
        """Does what is left to do before the verdict, once."""
        while self.closing:
            self.closing.pop(0)()

    def outcome(self) -> Outcome:
        """Gives the outcome so far: the worst of the checks that count; a case that judged nothing is ERROR."""
        if self.voided:
            return Outcome.ERROR
        found = [check.outcome for check in self.checks if counts(check)]
        if self.broken or not (self.checks or self.skipped):
            found.append(Outcome.ERROR)
        if self.skipped:
            found.append(Outcome.SKIPPED)
        return worst(found) if found else Outcome.PASS

    def add_series(self, name: str, series: Series) -> str:
        """Keeps a series under a topic of its own and gives the topic."""
        topic = fresh(f"/check/{slug(name)}", self.series)
        self.series[topic] = series
        return topic

    def add_path(self, name: str, track: PoseTrack) -> str:
        """Keeps a path under a topic of its own and gives the topic."""
        topic = fresh(f"/path/{slug(name)}", self.paths)
        self.paths[topic] = track
        return topic

    def recorded(self, provenance: dict[str, str]) -> Recording:
        """Gives all that was recorded, with the program's text attached; without paths and series there is nothing worth a file."""
        program = self.info.program
        attachments = {**self.attachments, **({program.name: program.read_bytes()} if program is not None else {})}
        if self.tape is not None:
            attachments[ATTACHMENT] = encoded(self.tape)
        metadata = {"case": self.info.id, **provenance}
        return recording_of(self.runs, paths=self.paths, series=self.series, log=self.events, metadata=metadata, attachments=attachments)

    def start_clock(self, now: Callable[[], float]) -> None:
        """Counts the case's duration from now on the given clock."""
        self.now = now
        self.began = now()
        self.ended = None

    def stop_clock(self) -> None:
        """Ends the duration; the first call counts."""
        if self.began is not None and self.ended is None:
            self.ended = self.now()

    def stop_now(self) -> None:
        """Stops the robot on a way out, where a robot that cannot be reached is one more message."""
        try:
            self.stop_robot()
        except MitlError as error:
            self.error(f"the robot could not be told to stop: {error}")

    def finish(self, log: str | None = None) -> CaseRecord:
        """Gives the frozen record; `log` is the file name of the case's log, if there is one."""
        self.stop_clock()
        return self.preview(log)

    def preview(self, log: str | None = None) -> CaseRecord:
        """Gives the record as it would be if the case ended now."""
        info = self.info
        messages = tuple(self.messages)
        if not (self.checks or self.broken or self.skipped):
            messages += (Message("error", "the case made no check, so it judged nothing"),)
        return CaseRecord(
            id=info.id,
            title=info.title,
            outcome=self.outcome(),
            duration_s=round((self.ended or 0.0) - (self.began or 0.0), 6),
            checks=tuple(replace(check, outcome=Outcome.ERROR) if self.voided else check for check in self.checks),
            messages=messages,
            recording=self.recording,
            purpose=info.purpose,
            requirement=info.requirement,
            limit_source=info.limit_source,
            catches=info.catches,
            program=info.program.name if info.program else None,
            source=_text(info) if info.program else None,
            log=log,
            subtests=tuple(replace(part, outcome=Outcome.ERROR) if self.voided else part for part in self.subtests),
        )


def counts(check: CheckRecord) -> bool:
    """Gives whether a check counts towards the outcome: a warning does only where its value is no number."""
    return not check.warning or check.outcome is Outcome.ERROR


def file_name(case_id: str, suffix: str) -> str:
    """Gives the name of a case's file in the run's folder: / becomes _, other odd characters become - and a hash keeps the name unique."""
    plain = case_id.replace("/", "_")
    safe = re.sub(r"[^A-Za-z0-9_.\-]", "-", plain).strip(".-")[:100] or "case"
    return (safe if safe == plain else f"{safe}-{hashlib.sha256(case_id.encode()).hexdigest()[:8]}") + suffix


def _text(info: CaseInfo) -> str:
    assert info.program is not None  # noqa: S101 - the caller asked
    return info.program.read_text(encoding="utf-8", errors="replace")
