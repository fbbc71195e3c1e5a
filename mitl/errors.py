"""The errors that mitl raises on purpose. Out of tolerance is an outcome, never one of these."""

from __future__ import annotations


class MitlError(Exception):
    """Base of all errors with a message for the user."""


class UsageError(MitlError):
    """The user asked for something that cannot be done: bad file, bad option, bad value. Exit code 2."""


class RigError(MitlError):
    """The rig could not do its part: controller unreachable, tracker lost, refused command. Exit code 4."""


class MotionError(MitlError):
    """A program cannot move as told: unreachable, axis limit, wrong configuration. Exit code 1 for `oracle`.

    `module`, `line` and `column` (1-based, 0 where it is not known) name the RAPID instruction.
    """

    def __init__(self, message: str, *, module: str, line: int, file: str = "", column: int = 0) -> None:
        super().__init__(message)
        self.module = module
        self.line = line
        self.file = file
        self.column = column

    def __str__(self) -> str:
        return f"{self.module}:{self.line}: {self.args[0]}"
