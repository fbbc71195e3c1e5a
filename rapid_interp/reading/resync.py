"""What is missing at the end of a line or a block, and where reading goes on after an error.

Invariant: nothing here takes a token that begins a statement, unless an error was reported before it.
"""

from __future__ import annotations

from difflib import SequenceMatcher

from rapid_interp.reading.expressions import ExpressionParser, SyntaxProblem
from rapid_interp.reading.lexer import NAME, STRING, is_closed
from rapid_interp.reading.tree import Expression, Placeholder
from rapid_interp.reading.words import OUTER_WORDS, RESTARTS, ROUTINE_ENDS, STATEMENT_ENDS, STOPS
from rapid_interp.source import SourceText


class ResyncParser(ExpressionParser):
    """The ends of lines, of headers and of blocks."""

    def __init__(self, source: SourceText) -> None:
        super().__init__(source)
        self.block_ifs = 0
        """IFs with a block that are open here."""
        self._surplus: list[int] | None = None
        """For every token how many ENDIF more than IFs that need one come up to the end of its routine."""

    def synchronise(self, begin: int) -> None:
        """Goes to where reading can go on: after the next `;`, or at a word that begins or ends something."""
        self.depth = 0
        if self.at == begin:
            self.at += self.kinds[self.at] not in STOPS
        while (kind := self.kinds[self.at]) not in RESTARTS:
            self.at += 1
            if kind == ";":
                return

    def semicolon(self) -> None:
        """Takes the `;`. If the next token begins a new line, the `;` was forgotten and reading goes on there."""
        if self.kinds[self.at] == ";":
            self.at += 1
            return
        before = self.end_before()
        if "\n" not in self.source.text[before : self.starts[self.at]]:
            raise self.fail("';'")
        if self.kinds[self.at - 1] != STRING or is_closed(self.texts[self.at - 1]):
            self.report_at("RAPID-E001", f"expected ';' at the end of the line, found {self.shown()} on a later one", before)

    def header(self, closer: str) -> Expression:
        """Gives the expression before THEN or DO. An error in it does not lose the block."""
        begin = self.at
        try:
            value = self.expression()
            if not self.forgotten(closer):
                self.take(closer)
        except SyntaxProblem:
            while self.kinds[self.at] not in RESTARTS and self.kinds[self.at] not in (";", closer):
                line_break = "\n" in self.source.text[self.starts[self.at] : self.starts[self.at + 1]]
                self.at += 1
                if line_break:
                    break
            if self.kinds[self.at] == closer:
                self.at += 1
            return Placeholder("<EXP>", self.starts[begin], self.starts[begin] + 1)
        return value

    def forgotten(self, word: str, shown: str = "") -> bool:
        """Gives whether a word is missing at the end of its line; then that is reported there, and reading goes on at the next line."""
        before = self.end_before()
        if self.kinds[self.at] == word or "\n" not in self.source.text[before : self.starts[self.at]]:
            return False
        self.report_at("RAPID-E001", f"expected {shown or word} at the end of the line, found {self.shown()} on a later one", before)
        return True

    def close(self, word: str, opener: str, begin: int) -> int:
        """Takes the END word of a block and gives the offset after it; another or none is an error."""
        kind = self.kinds[self.at]
        line = self.source.line_of(self.starts[begin])
        if kind == word:
            self.at += 1
        elif kind in STATEMENT_ENDS or (kind in ROUTINE_ENDS and word in ROUTINE_ENDS):
            self.report("RAPID-E004", f"wrong END keyword: expected {word} to close the {opener} of line {line}, found {kind}")
            self.at += 1
        else:
            self.report("RAPID-E005", f"expected {word} to close the {opener} of line {line}, found {self.shown()}")
        return self.end_before()

    def lacks_then(self) -> bool:
        """Gives whether this IF, whose next statement stands on a later line, is no compact IF: more ENDIF come than IFs that need one."""
        if "\n" not in self.source.text[self.end_before() : self.starts[self.at]]:
            return False
        if self._surplus is None:
            self._surplus = [0] * (len(self.kinds) + 1)
            for at in range(len(self.kinds) - 1, -1, -1):
                kind = self.kinds[at]
                if kind not in ROUTINE_ENDS and kind not in OUTER_WORDS:
                    self._surplus[at] = self._surplus[at + 1] + (kind in ("ENDIF", "ELSEIF")) - (kind == "THEN")
        return self._surplus[self.at] > self.block_ifs

    def looks_like_then(self) -> bool:
        """Gives whether the name here, last on its line, is a misspelt THEN and not the instruction of a compact IF."""
        if self.kinds[self.at] != NAME:
            return False
        following = self.kinds[self.at + 1]
        between = self.source.text[self.starts[self.at] : self.starts[self.at + 1]]
        if following == ";" or "\n" not in between:
            return False
        return following in RESTARTS or SequenceMatcher(None, self.texts[self.at].upper(), "THEN").ratio() >= 0.6

    def skip_line(self) -> None:
        """Goes to the next line, or after a DO on this one."""
        line = self.source.line_of(self.starts[self.at])
        while self.kinds[self.at] not in RESTARTS and self.source.line_of(self.starts[self.at]) == line:
            self.at += 1
            if self.kinds[self.at - 1] == "DO":
                break
