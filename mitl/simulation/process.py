"""What takes part in the simulation's time besides the plant: something that acts at instants of its own choosing."""

from __future__ import annotations

from typing import Protocol

from mitl.paths import FloatArray


class Process(Protocol):
    """A participant in virtual time, e.g. the simulated controller's program execution."""

    def next_event(self) -> float:
        """Gives the time in s at which it next wants to act; `math.inf` if never."""
        ...

    def run(self, now: float) -> None:
        """Acts at time `now` >= next_event(); afterwards next_event() must be later, or inf."""
        ...


class JointSource(Protocol):
    """Gives the commanded (executed) joint angles of the arm at any time up to the next event of its process."""

    def joints_at(self, time: float) -> FloatArray:
        """Gives the joint angles (6,) in rad at `time` in s of virtual time."""
        ...
