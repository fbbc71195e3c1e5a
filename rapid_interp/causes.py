"""Which errors of meaning are worth telling beside syntax errors, and which are only their consequences.

Invariant: without syntax errors nothing is left out.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from rapid_interp.errors import Diagnostic

_WORD = re.compile(r"\w+")
_HEAD = re.compile(r"\b(?:PROC|TRAP|FUNC\s+\w+)\s+(\w+)", re.IGNORECASE)
_UNREAD = "RAPID-E006"
_NAMES = frozenset({"RAPID-E101", "RAPID-E102", "RAPID-E103", "RAPID-E104"})
_ARGUMENTS = frozenset({"RAPID-E110", "RAPID-E111", "RAPID-E112", "RAPID-E113", "RAPID-E114"})
_MISSING_STATEMENT = frozenset({"RAPID-E106", "RAPID-E130", "RAPID-W205"})


def not_caused(found: Sequence[Diagnostic], problems: Sequence[Diagnostic]) -> list[Diagnostic]:
    """Gives the findings that the syntax errors `problems` cannot have caused.

    A name on a broken line may be a declaration that was lost, a broken head has lost its parameters, and a lost statement may have been
    a label or RETURN. When a text was not read to its end, nothing can be said of it.
    """
    if not problems:
        return list(found)
    if any(problem.code == _UNREAD for problem in problems):
        return []
    broken = {(problem.file, problem.line) for problem in problems}
    lines = [problem.source_line.partition("!")[0] for problem in problems]
    lost_names = {word.lower() for line in lines for word in _WORD.findall(line)}
    lost_heads = {name.lower() for line in lines for name in _HEAD.findall(line)}

    def caused(finding: Diagnostic) -> bool:
        if (finding.file, finding.line) in broken:
            return True
        if finding.code in _NAMES:
            word = _WORD.match(finding.source_line, finding.column - 1)
            return word is None or word[0].lower() in lost_names
        if finding.code in _ARGUMENTS:
            return any(word.lower() in lost_heads for word in _WORD.findall(finding.source_line))
        return finding.code in _MISSING_STATEMENT

    return [finding for finding in found if not caused(finding)]
