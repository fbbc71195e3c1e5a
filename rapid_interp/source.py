r"""A RAPID text with its name, and what an error needs from it: line, column, source line, caret.

Invariant: line ends are `\n`, so an offset into `text` is all the position that a syntax tree keeps.
"""

from __future__ import annotations

from bisect import bisect_right
from functools import cached_property
from itertools import accumulate

MAX_SHOWN = 160
"""Characters of a source line that a message shows; generated files have lines of many thousand."""


class SourceText:
    """A text and the file that it came from. `file` is as the caller gave it."""

    def __init__(self, file: str, text: str) -> None:
        self.file = file
        self.text = text.replace("\r\n", "\n").replace("\r", "\n")

    @cached_property
    def _line_starts(self) -> list[int]:
        return [0, *accumulate(len(line) + 1 for line in self.text.split("\n"))]

    def line_of(self, offset: int) -> int:
        """Gives the 1-based line of an offset."""
        return bisect_right(self._line_starts, offset)

    def position(self, offset: int) -> tuple[int, int]:
        """Gives the 1-based line and column of an offset."""
        line = self.line_of(offset)
        return line, offset - self._line_starts[line - 1] + 1

    def line_text(self, line: int) -> str:
        """Gives the text of a 1-based line without its end."""
        start = self._line_starts[line - 1]
        end = self.text.find("\n", start)
        return self.text[start:] if end < 0 else self.text[start:end]


def caret_lines(source_line: str, column: int) -> str:
    """Gives the source line and below it a caret under the 1-based column; tabs stay tabs in both."""
    start = max(0, column - 1 - MAX_SHOWN // 2) if len(source_line) > MAX_SHOWN else 0
    shown = source_line[start : start + MAX_SHOWN].rstrip()
    before = source_line[start : column - 1]
    return f"    {shown}\n    {''.join(chr(9) if char == chr(9) else ' ' for char in before)}^"
