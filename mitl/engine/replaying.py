"""Plays a tape to a case: a rig whose answers are those of the recorded run, in their order.

Invariant: a case that asks for what the recorded run did not ask for is told so, and never gets the answer to another question.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mitl.calibration.pose_set import CalibrationPoses
from mitl.calibration.result import Calibration
from mitl.calibration.store import load_calibration_and_reference, save_calibration
from mitl.engine.calibration_session import SessionCalibration
from mitl.engine.tape import ROUND, Call, Tape
from mitl.engine.taping import sources_as_text
from mitl.errors import RigError
from mitl.feedback import FeedbackSamples
from mitl.paths import FloatArray, PosePath
from mitl.protocols import AveragedPoint, ExecutionState, LoggedEvent, OracleSource, Rig
from mitl.samples import TrackerSamples

_SESSION, _CALIBRATION = "session", "calibration"


class Player:
    """The tape of the case that is judged again, and where it stands."""

    def __init__(self) -> None:
        self._tape = Tape()
        self._place = 0

    def insert(self, tape: Tape) -> None:
        """Takes another tape and stands at its beginning."""
        self._tape, self._place = tape, 0

    def now(self) -> float:
        """Gives the rig's time in s at the last call that was played, or at the first one."""
        calls = self._tape.calls
        return calls[min(max(self._place - 1, 0), len(calls) - 1)].time if calls else 0.0

    def reach(self, mark: str) -> None:
        """Winds on to a mark; a case that ended sooner than the recorded run leaves out what lies before it."""
        for place in range(self._place, len(self._tape.calls)):
            call = self._tape.calls[place]
            if (call.part, call.method) == ("case", mark):
                self._place = place + 1
                return

    def another_round(self) -> bool:
        """Gives whether the recorded run repeated the case here."""
        call = self._next()
        if call is None or (call.part, call.method) != ("case", ROUND):
            return False
        self._place += 1
        return True

    def stop(self) -> None:
        """Plays a stop where one was; another one changes nothing, as at a rig."""
        call = self._next()
        if call is not None and (call.part, call.method) == ("controller", "stop"):
            self.play("controller", "stop")

    def play(self, part: str, method: str, *arguments: str | float) -> Any:  # noqa: ANN401 - what the rig gave then
        """Gives the next answer. Raises RigError where the recorded run asked something else, or where the rig refused then."""
        asked = Call(part, method, arguments)
        call = self._next()
        if call is None:
            raise RigError(f"the recording ends before {asked.asked}: the case asks for more than was recorded; run it at the rig")
        words = [argument for argument in arguments if isinstance(argument, str)]
        if (part, method) != (call.part, call.method) or words != [known for known in call.arguments if isinstance(known, str)]:
            raise RigError(
                f"the recording has no answer to {asked.asked}: the recorded run asked {call.asked} there; the case or its program "
                "has changed since in what it does at the rig: run it there"
            )
        self._place += 1
        if call.refused is not None:
            raise RigError(call.refused)
        return call.result

    def _next(self) -> Call | None:
        return self._tape.calls[self._place] if self._place < len(self._tape.calls) else None


@dataclass(frozen=True)
class ReplayedRig(Rig):
    """A rig that is played from tapes."""

    player: Player = field(default_factory=Player)


def replayed_rig(
    tape_of: Callable[[str], Tape],
    oracles: OracleSource,
    *,
    facts: Mapping[str, str],
    name: str,
    robot: str,
    seed: int,
    versions: Mapping[str, str],
) -> ReplayedRig:
    """Gives the rig of a recorded run. tape_of: gives a case's tape by the case's id. facts: those of any tape of the run."""
    player = Player()

    def begin_case(case_id: str) -> None:
        player.insert(tape_of(case_id))

    details = " tells details"
    trackers = {
        fact.removesuffix(details): (_PlayedDetails if told == "True" else _PlayedTracker)(player, fact.removesuffix(details))
        for fact, told in facts.items()
        if fact.endswith(details)
    }
    return ReplayedRig(
        name=name,
        robot=robot,
        seed=seed,
        controller=_PlayedController(player),
        tracker=trackers["tracker"],
        clock=_PlayedClock(player),
        oracles=oracles,
        begin_case=begin_case,
        versions=dict(versions),
        devices={part.removeprefix("device "): tracker for part, tracker in trackers.items() if part.startswith("device ")},
        feedback=_PlayedFeedback(player) if "feedback" in facts else None,
        player=player,
    )


def keep_session(tape: Tape | None, session: SessionCalibration) -> None:
    """Puts the calibration in force on the tape, if there is one, with the poses that it was solved from."""
    if tape is None:
        return
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "calibration.toml"
        save_calibration(file, session.calibration, reference=session.reference)
        tape.facts["calibration"] = file.read_text(encoding="utf-8")
    poses = session.poses
    tape.calls.insert(
        0, Call(_SESSION, _CALIBRATION, (), [poses.flange, poses.tracked, poses.jitter, session.measured_at, session.reference])
    )


def session_of(tape: Tape, case_id: str) -> SessionCalibration:
    """Gives the calibration that was in force when the case ran. Raises RigError where the tape has none."""
    calls = [call for call in tape.calls if (call.part, call.method) == (_SESSION, _CALIBRATION)]
    if not calls or "calibration" not in tape.facts:
        raise RigError(f"the recording of {case_id} has no calibration")
    result: Any = calls[0].result
    flange, tracked, jitter, measured_at, reference = result
    return SessionCalibration(_calibration(tape.facts["calibration"]), CalibrationPoses(flange, tracked, jitter), measured_at, reference)


def _calibration(text: str) -> Calibration:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "calibration.toml"
        file.write_text(text, encoding="utf-8")
        return load_calibration_and_reference(file)[0]


class _PlayedController:
    """A recorded controller."""

    def __init__(self, player: Player) -> None:
        self._player = player

    def _play(self, method: str, *arguments: str | float) -> Any:  # noqa: ANN401 - see Player.play
        return self._player.play("controller", method, *arguments)

    def load(self, sources: Sequence[Path]) -> None:
        self._play("load", *sources_as_text(sources))

    def start(self) -> None:
        self._play("start")

    def stop(self) -> None:
        self._player.stop()

    def state(self) -> ExecutionState:
        state: ExecutionState = self._play("state")
        return state

    def read(self, name: str) -> str:
        return str(self._play("read", name))

    def write(self, name: str, literal: str) -> None:
        self._play("write", name, literal)

    def read_signal(self, name: str) -> float:
        return float(self._play("read_signal", name))

    def joints(self) -> FloatArray:
        joints: FloatArray = self._play("joints")
        return joints

    def flange(self) -> FloatArray:
        flange: FloatArray = self._play("flange")
        return flange

    def set_motors(self, on: bool) -> None:
        self._play("set_motors", on)

    def set_speed_ratio(self, per_cent: float) -> None:
        self._play("set_speed_ratio", per_cent)

    def event_log(self) -> list[LoggedEvent]:
        events: list[LoggedEvent] = self._play("event_log")
        return events


class _PlayedTracker:
    """A recorded tracker."""

    def __init__(self, player: Player, part: str) -> None:
        self._player = player
        self._part = part

    def start(self) -> None:
        self._player.play(self._part, "start")

    def stop(self) -> PosePath:
        path: PosePath = self._player.play(self._part, "stop")
        return path

    def path(self) -> PosePath:
        path: PosePath = self._player.play(self._part, "path")
        return path

    def latest(self) -> PosePath:
        path: PosePath = self._player.play(self._part, "latest")
        return path

    def average(self, seconds: float) -> AveragedPoint:
        point: AveragedPoint = self._player.play(self._part, "average", seconds)
        return point


class _PlayedDetails(_PlayedTracker):
    """A recorded tracker that told more than poses."""

    def samples(self) -> TrackerSamples:
        samples: TrackerSamples = self._player.play(self._part, "samples")
        return samples


class _PlayedClock:
    """A recorded clock."""

    def __init__(self, player: Player) -> None:
        self._player = player

    def now(self) -> float:
        return float(self._player.play("clock", "now"))

    def wait(self, seconds: float) -> None:
        self._player.play("clock", "wait", seconds)


class _PlayedFeedback:
    """A controller's recorded stream."""

    def __init__(self, player: Player) -> None:
        self._player = player

    def start(self) -> None:
        self._player.play("feedback", "start")

    def stop(self) -> FeedbackSamples:
        samples: FeedbackSamples = self._player.play("feedback", "stop")
        return samples
