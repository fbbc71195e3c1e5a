"""Text to tokens, in three parallel lists.

Invariant: the pieces of a text, trivia included, joined give the text again; only then are offsets right.
The loop runs inside `re` and `map`, because reading speed is decided here.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from itertools import accumulate, compress

from rapid_interp.errors import Diagnostic, diagnostic
from rapid_interp.source import SourceText

KEYWORDS = frozenset(
    [
        "ALIAS",
        "AND",
        "BACKWARD",
        "CASE",
        "CONNECT",
        "CONST",
        "DEFAULT",
        "DIV",
        "DO",
        "ELSE",
        "ELSEIF",
        "ENDFOR",
        "ENDFUNC",
        "ENDIF",
        "ENDMODULE",
        "ENDPROC",
        "ENDRECORD",
        "ENDTEST",
        "ENDTRAP",
        "ENDWHILE",
        "ERROR",
        "EXIT",
        "FALSE",
        "FOR",
        "FROM",
        "FUNC",
        "GOTO",
        "IF",
        "INOUT",
        "LOCAL",
        "MOD",
        "MODULE",
        "NOSTEPIN",
        "NOT",
        "NOVIEW",
        "OR",
        "PERS",
        "PROC",
        "RAISE",
        "READONLY",
        "RECORD",
        "RETRY",
        "RETURN",
        "STEP",
        "SYSMODULE",
        "TASK",
        "TEST",
        "THEN",
        "TO",
        "TRAP",
        "TRUE",
        "TRYNEXT",
        "UNDO",
        "VAR",
        "VIEWONLY",
        "WHILE",
        "WITH",
        "XOR",
    ]
)

NAME, NUMBER, STRING, PLACEHOLDER, END = "name", "number", "string", "placeholder", "end of file"
_TRIVIA, _BAD = "", "bad"

_PIECE = re.compile(
    r"""
    \s+
    |[A-Za-z_\u00c0-\u00d6\u00d8-\u00f6\u00f8-\u024f]\w*
    |0[xX][0-9a-fA-F]+|0[bB][01]+|0[oO][0-7]+|(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?
    |:=|<=|>=|<>
    |<(?:ALT|ARG|CAS|CSE|DDN|DIM|EIT|ELF|ERR|EXP|ID|INIT|LBL|NAM|PAR|RDN|SMT|TDN|VAL|VAR)>
    |(?://|/\*|\#)[^\n]*
    |[-+*/=<>()\[\]{},;:.\\?|%]
    |"[^"\n]*(?:""[^"\n]*)*"?
    |![^\n]*
    |.
    """,
    re.VERBOSE,
)
_NAME_START = re.compile(r"[A-Za-z_\u00c0-\u00d6\u00d8-\u00f6\u00f8-\u024f]")
_HEADER = re.compile(r"\s*%%%.*?%%%", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Tokens:
    """The tokens of a text: kind (a keyword in capitals, a sign, or one of the constants above), text, and offset of each."""

    kinds: list[str]
    texts: list[str]
    starts: list[int]
    comments: tuple[tuple[int, str], ...]
    problems: tuple[Diagnostic, ...]


class _Kinds(dict[str, str]):
    """Kind of a piece, found once for every different piece."""

    def __missing__(self, piece: str) -> str:
        kind = self[piece] = _classify(piece)
        return kind


def _classify(piece: str) -> str:
    first = piece[0]
    if _NAME_START.match(first):
        upper = piece.upper()
        return upper if upper in KEYWORDS else NAME
    if first in "0123456789" or (first == "." and len(piece) > 1):
        return NUMBER
    if first.isspace() or first == "!":
        return _TRIVIA
    if first == '"':
        return STRING
    if piece[0] == "<" and piece[-1] == ">" and len(piece) > 2:
        return PLACEHOLDER
    return piece if first in "-+*/=<>()[]{},;:.\\?|%" and not piece.startswith(("//", "/*")) else _BAD


def tokenize(source: SourceText) -> Tokens:
    """Gives the tokens of a text, the last of them END, with its comments and lexical errors."""
    text = source.text
    header = _HEADER.match(text)
    begin = header.end() if header else 0
    pieces = _PIECE.findall(text, begin)
    all_kinds = list(map(_Kinds().__getitem__, pieces))
    all_starts = list(accumulate(map(len, pieces), initial=begin))
    kinds = list(filter(None, all_kinds))
    texts = list(compress(pieces, all_kinds))
    starts = list(compress(all_starts, all_kinds))
    comments = tuple((start, piece) for start, piece in zip(all_starts, pieces, strict=False) if piece[0] == "!")
    problems = _problems(source, kinds, texts, starts)
    if _BAD in kinds:
        keep = [kind != _BAD for kind in kinds]
        kinds, texts, starts = list(compress(kinds, keep)), list(compress(texts, keep)), list(compress(starts, keep))
    kinds.append(END)
    texts.append("")
    starts.append(max(0, len(text.rstrip()) - 1))
    return Tokens(kinds, texts, starts, comments, tuple(problems))


def _problems(source: SourceText, kinds: list[str], texts: list[str], starts: list[int]) -> list[Diagnostic]:
    found: list[Diagnostic] = []
    if _BAD in kinds:
        previous = -2
        for kind, text, start in zip(kinds, texts, starts, strict=True):
            if kind == _BAD:
                if text.startswith(("//", "/*", "#")):
                    sign = text[:2] if text[0] == "/" else "#"
                    found.append(diagnostic(source, start, "RAPID-E002", f"a comment begins with '!' in RAPID, not with {sign!r}"))
                elif start != previous + 1:  # one message for a run of them
                    found.append(diagnostic(source, start, "RAPID-E002", f"the character {text!r} has no place in RAPID"))
                previous = start
    for index, kind in enumerate(kinds):
        if kind == STRING and not is_closed(texts[index]):
            found.append(diagnostic(source, starts[index], "RAPID-E003", "the string is not closed on its line"))
    return found


def is_closed(text: str) -> bool:
    """Gives whether a string token has its closing quote."""
    return len(text) > 1 and text[-1] == '"' and text.count('"') % 2 == 0


def string_value(text: str) -> str:
    r"""Gives the characters of a string token: `""` is a quote, `\\` a backslash, `\hh` the character of that code."""
    body = text[1:-1] if len(text) > 1 and text[-1] == '"' else text[1:]
    if '"' not in body and "\\" not in body:
        return body
    return _ESCAPE.sub(_unescape, body.replace('""', '"'))


_ESCAPE = re.compile(r"\\(\\|[0-9a-fA-F]{2})")


def _unescape(match: re.Match[str]) -> str:
    code = match[1]
    return "\\" if code == "\\" else chr(int(code, 16))


def number_value(text: str) -> float:
    """Gives the value of a number token; one beyond all numbers is infinite."""
    if len(text) > 1 and text[1] in "xXbBoO":
        whole = int(text, 0)
        return float(whole) if whole.bit_length() < 1024 else math.inf
    return float(text)
