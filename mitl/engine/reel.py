"""Reel: what a case's rig is to its recorder, whether the rig is there or is played from a tape.

Invariant: marks are put where they are reached, so that a tape that was made while another was played can be played itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from mitl.engine.recorder import CaseRecorder
from mitl.engine.replaying import Player, ReplayedRig
from mitl.engine.tape import BEGINS, ENDS, MEASURED, ROUND, Tape
from mitl.engine.taping import taped
from mitl.protocols import Rig


@dataclass(frozen=True)
class Reel:
    """The rig as the case gets it, its clock as the recorder reads it, and the player, where the rig is none but a tape."""

    rig: Rig
    recorder: CaseRecorder
    now: Callable[[], float]
    player: Player | None

    def begin(self, *, repeats: int) -> None:
        """Begins the case's time. repeats: how often an inconclusive case may be run, which its verdicts depend on."""
        if self.recorder.tape is not None:
            self.recorder.tape.facts["repeats"] = str(repeats)
        self._reach(BEGINS)
        self.recorder.start_clock(self.now)
        self.recorder.more = self._another_round
        self.recorder.closing.append(lambda: self._reach(MEASURED))

    def end(self) -> None:
        """Ends the case's time."""
        self._reach(ENDS)
        self.recorder.stop_clock()

    def _reach(self, mark: str) -> None:
        if self.player is not None:
            self.player.reach(mark)
        if self.recorder.tape is not None:
            self.recorder.tape.mark(mark)

    def _another_round(self) -> bool:
        if self.player is not None and not self.player.another_round():
            self.recorder.say("info", "it would be run again, but the recording has no more rounds")
            return False
        if self.recorder.tape is not None:
            self.recorder.tape.mark(ROUND)
        return True


def reel_of(rig: Rig, recorder: CaseRecorder, *, keep: bool) -> Reel:
    """Gives the reel of a case that begins. keep: whether what the rig tells is kept for judging again."""
    player = rig.player if isinstance(rig, ReplayedRig) else None
    now = player.now if player is not None else rig.clock.now
    recorder.tape = Tape(now=now) if keep else None
    return Reel(rig if recorder.tape is None else taped(rig, recorder.tape), recorder, now, player)
