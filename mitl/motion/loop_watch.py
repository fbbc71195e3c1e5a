"""LoopWatch: notices a program that makes the very same moves again and again, long before its time is over.

Invariant: a program that makes every move fewer than MOST times is never taken for endless.
"""

from __future__ import annotations

from collections import Counter

from mitl.motion.program_run import ProgramRun
from rapid_interp import effects

MOST = 100
"""As often the same instruction may move to the same place at the same speed without being told how long to go on."""


class LoopWatch:
    """Looks at the moves of one run. `endless` is the move that was made too often, None so far."""

    def __init__(self, run: ProgramRun) -> None:
        self.endless: effects.Motion | None = None
        self._run = run
        self._seen = 0
        self._times: Counter[effects.Motion] = Counter()

    def __call__(self, _following: float) -> bool:
        """Gives whether a move has been made too often."""
        moves = self._run.record.moves
        for executed in moves[self._seen :]:
            effect = executed.move.effect
            self._times[effect] += 1
            if self._times[effect] > MOST and self.endless is None:
                self.endless = effect
        self._seen = len(moves)
        return self.endless is not None
