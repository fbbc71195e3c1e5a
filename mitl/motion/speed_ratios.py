"""SpeedRatios: the shares of programmed speeds that hold for all moves, also for the one under way.

Invariant: the operator's share is never 0; the program's may be, and then the arm stands on its path.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class SpeedRatios:
    """Shares 0..1 of programmed speeds: the operator's override and the program's (SpeedRefresh)."""

    operator: float = 1.0
    program: float = 1.0

    @property
    def share(self) -> float:
        """Gives the share that comes of both."""
        return self.operator * self.program
