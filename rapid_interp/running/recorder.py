"""What the path recorder of a task has noted.

Invariant: `place` counts the moves between the start and where the robot is on the path.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from rapid_interp.data import RobTarget
from rapid_interp.effects import Effect, Motion, MoveAbsJ, MoveC, MoveJ, MoveL, TriggerMove
from rapid_interp.running.values import Fault, error_number


@dataclass(slots=True)
class Recorder:
    """The moves since `start`, and the marks that PathRecStart set between them."""

    start: RobTarget
    records: bool = True
    moves: list[Motion] = field(default_factory=list)
    marks: dict[float, int] = field(default_factory=dict)
    place: int = 0

    def mark(self) -> float:
        """Gives the number of a new mark at this place."""
        number = float(len(self.marks) + 1)
        self.marks[number] = self.place
        return number

    def note(self, effect: Effect) -> None:
        """Notes a move; what lay further on the path is forgotten."""
        move = effect.move if isinstance(effect, TriggerMove) else effect
        if self.records and isinstance(move, MoveAbsJ | MoveJ | MoveL | MoveC):
            del self.moves[self.place :]
            self.moves.append(move)
            self.place += 1

    def _target(self, mark: float | None, otherwise: int) -> int:
        if mark is None:
            return otherwise
        if mark not in self.marks:
            raise Fault("the identity is of no recorded path", "RAPID-R354", number=error_number("ERR_ARGVALERR"))
        return self.marks[mark]

    def goes_back(self, mark: float | None) -> bool:
        """Gives whether the path leads back to a mark, or back at all."""
        return (mark is None or mark in self.marks) and self._target(mark, 0) < self.place

    def goes_on(self, mark: float | None) -> bool:
        """Gives whether the path leads on to a mark, or on at all."""
        return (mark is None or mark in self.marks) and self._target(mark, len(self.moves)) > self.place

    def back_to(self, mark: float | None) -> list[Motion]:
        """Gives the moves back to a mark or to the start; the robot is there afterwards."""
        end = self._target(mark, 0)
        found = [self._back(place) for place in range(self.place - 1, end - 1, -1)]
        self.place = min(self.place, end)
        return found

    def on_to(self, mark: float | None) -> list[Motion]:
        """Gives the moves on to a mark or to the end; the robot is there afterwards."""
        end = self._target(mark, len(self.moves))
        found = self.moves[self.place : end]
        self.place = max(self.place, end)
        return found

    def _back(self, place: int) -> Motion:
        """Gives the move that undoes one: of its kind, to where it began."""
        move = self.moves[place]
        before = self.moves[place - 1] if place else None
        if isinstance(before, MoveAbsJ):
            return replace(before, speed=move.speed, zone=move.zone)
        target = before.target if before is not None else self.start
        if isinstance(move, MoveAbsJ):
            return MoveJ(at=move.at, speed=move.speed, zone=move.zone, tool=move.tool, wobj=move.wobj, target=target)
        return replace(move, target=target)
