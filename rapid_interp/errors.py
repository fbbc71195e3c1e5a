"""What is wrong with a program: diagnostics found by reading it, errors raised by running it.

Invariant: every one of them names file, line and column, and can show the source line with a caret.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from rapid_interp.source import SourceText, caret_lines


class Severity(Enum):
    """Whether a program with this finding can run."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding in a source text. `line` and `column` are 1-based."""

    file: str
    line: int
    column: int
    severity: Severity
    code: str
    message: str
    source_line: str

    def format(self) -> str:
        """Gives `FILE:LINE:COL: error: MESSAGE [code]` with the source line and a caret below it."""
        head = f"{self.file}:{self.line}:{self.column}: {self.severity.value}: {self.message} [{self.code}]"
        return f"{head}\n{caret_lines(self.source_line, self.column)}"


def diagnostic(source: SourceText, offset: int, code: str, message: str, severity: Severity = Severity.ERROR) -> Diagnostic:
    """Gives the diagnostic for an offset of a source text."""
    line, column = source.position(offset)
    return Diagnostic(source.file, line, column, severity, code, message, source.line_text(line))


class RapidErrors(Exception):  # noqa: N818 - the name says that it holds all errors of a program
    """A program that cannot be loaded; `diagnostics` holds all findings, errors and warnings."""

    def __init__(self, diagnostics: Sequence[Diagnostic]) -> None:
        super().__init__(diagnostics)
        self.diagnostics = tuple(diagnostics)

    def __str__(self) -> str:
        return "\n".join(finding.format() for finding in self.diagnostics)


class RapidError(Exception):
    """An error while a program runs, or in a value given from outside; `number` is RAPID's ERRNO where it has one."""

    def __init__(
        self,
        message: str,
        *,
        code: str,
        file: str = "",
        module: str = "",
        line: int = 0,
        column: int = 0,
        source_line: str = "",
        number: float | None = None,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.code = code
        self.file = file
        self.module = module
        self.line = line
        self.column = column
        self.source_line = source_line
        self.number = number

    def __str__(self) -> str:
        return f"{self.module}:{self.line}: {self.message}" if self.module else self.message

    def format(self) -> str:
        """Gives the message with its place in the style of `Diagnostic.format`; only the message if it has no place."""
        if not self.line:
            return f"error: {self.message} [{self.code}]"
        where = f" (module {self.module})" if self.module else ""
        head = f"{self.file}:{self.line}:{self.column}: error: {self.message}{where} [{self.code}]"
        return f"{head}\n{caret_lines(self.source_line, self.column)}"
