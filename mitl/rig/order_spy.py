"""OrderSpy: a controller that also writes down what it was told, so that the same can be rehearsed elsewhere. Implements Controller."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from mitl.paths import FloatArray
from mitl.protocols import Controller, ExecutionState, LoggedEvent


@dataclass
class Told:
    """A program that was loaded and started, and what was written to its variables after its start: (name, literal), in order."""

    sources: tuple[Path, ...]
    writes: list[tuple[str, str]] = field(default_factory=list)
    started: bool = False


class OrderSpy:
    """controller: who does it. told: what it was told, a record each time a program was loaded."""

    def __init__(self, controller: Controller) -> None:
        self._controller = controller
        self.told: list[Told] = []

    def load(self, sources: Sequence[Path]) -> None:
        """Replaces the program."""
        self._controller.load(sources)
        self.told.append(Told(tuple(sources)))

    def start(self) -> None:
        """Starts or resumes execution."""
        self._controller.start()
        if self.told:
            self.told[-1].started = True

    def stop(self) -> None:
        """Stops execution."""
        self._controller.stop()

    def state(self) -> ExecutionState:
        """Gives whether RAPID is executing."""
        return self._controller.state()

    def read(self, name: str) -> str:
        """Gives a RAPID variable."""
        return self._controller.read(name)

    def write(self, name: str, literal: str) -> None:
        """Sets a RAPID variable."""
        self._controller.write(name, literal)
        if self.told:
            self.told[-1].writes.append((name, literal))

    def read_signal(self, name: str) -> float:
        """Gives a signal."""
        return self._controller.read_signal(name)

    def joints(self) -> FloatArray:
        """Gives the axis positions (6,) in rad."""
        return self._controller.joints()

    def flange(self) -> FloatArray:
        """Gives X_BF (7,)."""
        return self._controller.flange()

    def set_motors(self, on: bool) -> None:
        """Switches the motors."""
        self._controller.set_motors(on)

    def set_speed_ratio(self, per_cent: float) -> None:
        """Sets the speed override."""
        self._controller.set_speed_ratio(per_cent)

    def event_log(self) -> list[LoggedEvent]:
        """Gives the events."""
        return self._controller.event_log()
