"""What a program is meant to be refused: comments such as `! preflight: expect axis-limit`, set against what was found.

Invariant: a comment speaks of the instruction on its own line; alone on its line, of the one below. No finding is lost: each is given as
expected or as not.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from mitl.motion.preflight import Finding, Severity
from rapid_interp import Comment

_NOTE = re.compile(r"!\s*preflight\s*:\s*(?P<words>.*)", re.IGNORECASE)
_WORDS = re.compile(r"(?P<verb>expect|allow)\s+(?P<code>[\w-]+)\s*", re.IGNORECASE)


def set_apart(findings: Sequence[Finding], comments: Sequence[Comment]) -> tuple[tuple[Finding, ...], tuple[Finding, ...]]:
    """Gives the findings that no comment expects, and those that one does.

    `expect` asks for its finding, `allow` takes it where it comes. A finding that is missing, or a comment that cannot be read, is a
    finding of its own: a warning.
    """
    expected: list[Finding] = []
    notes: list[Finding] = []
    for comment in comments:
        if (note := _NOTE.match(comment.text)) is None:
            continue
        if (words := _WORDS.fullmatch(note["words"])) is None:
            message = f"{comment.text.strip()!r} is not understood: expected `! preflight: expect CODE`, or `allow`"
            notes.append(_warning(comment, "note", message))
            continue
        code, line = words["code"].lower(), comment.line + comment.alone
        found = [one for one in findings if (one.file, one.line, one.code.lower()) == (comment.file, line, code)]
        expected += found
        if not found and words["verb"].lower() == "expect":
            notes.append(_warning(comment, "not-found", f"{words['code']} is expected at line {line}, and was not found"))
    return (*(one for one in findings if one not in expected), *notes), tuple(one for one in findings if one in expected)


def _warning(comment: Comment, code: str, message: str) -> Finding:
    return Finding(Severity.WARNING, code, message, comment.file, "", comment.line, comment.column)
