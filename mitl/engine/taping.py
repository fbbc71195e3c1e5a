"""Puts a tape between a case and its rig: every answer of the rig passes through unchanged and is kept.

Invariant: a taped rig does what the rig itself does, call by call; a part that is not there is not there on the taped rig either.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

from mitl.engine.tape import Tape
from mitl.errors import MitlError
from mitl.feedback import FeedbackSamples
from mitl.paths import FloatArray, PosePath
from mitl.protocols import AveragedPoint, Clock, Controller, DetailedTracker, ExecutionState, Feedback, LoggedEvent, Rig, Tracker
from mitl.samples import TrackerSamples

_T = TypeVar("_T")


def taped(rig: Rig, tape: Tape) -> Rig:
    """Gives the rig with all that crosses its seams kept on the tape."""
    devices = {name: _tracker(device, f"device {name}", tape) for name, device in rig.devices.items()}
    feedback = None if rig.feedback is None else _TapedFeedback(rig.feedback, tape)
    return replace(
        rig,
        controller=_TapedController(rig.controller, tape),
        tracker=_tracker(rig.tracker, "tracker", tape),
        clock=_TapedClock(rig.clock, tape),
        devices=devices,
        feedback=feedback,
    )


def sources_as_text(sources: Sequence[Path]) -> list[str]:
    """Gives what tells programs apart, wherever they lie: their names and hashes."""
    texts = []
    for source in sources:
        content = source.read_bytes() if source.is_file() else b""
        texts.append(f"{source.name} sha256 {hashlib.sha256(content).hexdigest()}")
    return texts


def _kept(tape: Tape, part: str, method: str, arguments: tuple[str | float, ...], call: Callable[[], _T]) -> _T:
    try:
        result = call()
    except MitlError as error:
        tape.keep(part, method, arguments, refused=str(error))
        raise
    tape.keep(part, method, arguments, result)
    return result


class _TapedController:
    """A controller on tape."""

    def __init__(self, inner: Controller, tape: Tape) -> None:
        self._inner = inner
        self._tape = tape

    def _keep(self, method: str, call: Callable[[], _T], *arguments: str | float) -> _T:
        return _kept(self._tape, "controller", method, arguments, call)

    def load(self, sources: Sequence[Path]) -> None:
        self._keep("load", lambda: self._inner.load(sources), *sources_as_text(sources))

    def start(self) -> None:
        self._keep("start", self._inner.start)

    def stop(self) -> None:
        self._keep("stop", self._inner.stop)

    def state(self) -> ExecutionState:
        return self._keep("state", self._inner.state)

    def read(self, name: str) -> str:
        return self._keep("read", lambda: self._inner.read(name), name)

    def write(self, name: str, literal: str) -> None:
        self._keep("write", lambda: self._inner.write(name, literal), name, literal)

    def read_signal(self, name: str) -> float:
        return self._keep("read_signal", lambda: self._inner.read_signal(name), name)

    def joints(self) -> FloatArray:
        return self._keep("joints", self._inner.joints)

    def flange(self) -> FloatArray:
        return self._keep("flange", self._inner.flange)

    def set_motors(self, on: bool) -> None:
        self._keep("set_motors", lambda: self._inner.set_motors(on), on)

    def set_speed_ratio(self, per_cent: float) -> None:
        self._keep("set_speed_ratio", lambda: self._inner.set_speed_ratio(per_cent), per_cent)

    def event_log(self) -> list[LoggedEvent]:
        return self._keep("event_log", self._inner.event_log)


class _TapedTracker:
    """A tracker on tape."""

    def __init__(self, inner: Tracker, part: str, tape: Tape) -> None:
        self._inner = inner
        self._part = part
        self._tape = tape

    def _keep(self, method: str, call: Callable[[], _T], *arguments: str | float) -> _T:
        return _kept(self._tape, self._part, method, arguments, call)

    def start(self) -> None:
        self._keep("start", self._inner.start)

    def stop(self) -> PosePath:
        return self._keep("stop", self._inner.stop)

    def path(self) -> PosePath:
        return self._keep("path", self._inner.path)

    def latest(self) -> PosePath:
        return self._keep("latest", self._inner.latest)

    def average(self, seconds: float) -> AveragedPoint:
        return self._keep("average", lambda: self._inner.average(seconds), seconds)


class _TapedDetails(_TapedTracker):
    """A tracker that tells more than poses, on tape."""

    def __init__(self, inner: Tracker, details: DetailedTracker, part: str, tape: Tape) -> None:
        super().__init__(inner, part, tape)
        self._details = details

    def samples(self) -> TrackerSamples:
        return self._keep("samples", self._details.samples)


def _tracker(inner: Tracker, part: str, tape: Tape) -> Tracker:
    tape.facts[f"{part} tells details"] = str(isinstance(inner, DetailedTracker))
    return _TapedDetails(inner, inner, part, tape) if isinstance(inner, DetailedTracker) else _TapedTracker(inner, part, tape)


class _TapedClock:
    """A clock on tape."""

    def __init__(self, inner: Clock, tape: Tape) -> None:
        self._inner = inner
        self._tape = tape

    def now(self) -> float:
        return _kept(self._tape, "clock", "now", (), self._inner.now)

    def wait(self, seconds: float) -> None:
        _kept(self._tape, "clock", "wait", (seconds,), lambda: self._inner.wait(seconds))


class _TapedFeedback:
    """A controller's stream on tape."""

    def __init__(self, inner: Feedback, tape: Tape) -> None:
        tape.facts["feedback"] = "True"
        self._inner = inner
        self._tape = tape

    def start(self) -> None:
        _kept(self._tape, "feedback", "start", (), self._inner.start)

    def stop(self) -> FeedbackSamples:
        return _kept(self._tape, "feedback", "stop", (), self._inner.stop)
