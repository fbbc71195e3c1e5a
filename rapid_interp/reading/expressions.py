"""Tokens to expressions, by precedence climbing.

Invariant: every loop and every recursion takes a token or raises, and nesting is counted, so any input ends.
"""

from __future__ import annotations

from rapid_interp.errors import Diagnostic, diagnostic
from rapid_interp.reading.lexer import END, NAME, NUMBER, PLACEHOLDER, STRING, number_value, string_value, tokenize
from rapid_interp.reading.tree import (
    Aggregate,
    Argument,
    Binary,
    Call,
    Component,
    Expression,
    Index,
    Name,
    Number,
    Placeholder,
    Text,
    Truth,
    Unary,
)
from rapid_interp.source import SourceText

MAX_NESTING = 80
"""Brackets and blocks inside each other, and signs before an operand."""
MAX_CHAIN = 200
"""Operators, or component and index steps, in one row: they make the tree as deep."""
MAX_DIAGNOSTICS = 1000

PRECEDENCE = {
    "OR": 1,
    "XOR": 1,
    "AND": 2,
    "<": 3,
    ">": 3,
    "<=": 3,
    ">=": 3,
    "=": 3,
    "<>": 3,
    "+": 4,
    "-": 4,
    "*": 5,
    "/": 5,
    "DIV": 5,
    "MOD": 5,
}


class SyntaxProblem(Exception):  # noqa: N818 - control flow inside the parser, never seen outside
    """The statement at hand cannot be read on; the diagnostic is recorded already."""


class ExpressionParser:
    """The cursor over the tokens of a text, and the grammar of expressions and argument lists."""

    def __init__(self, source: SourceText) -> None:
        tokens = tokenize(source)
        self.source = source
        self.kinds = tokens.kinds
        self.texts = tokens.texts
        self.starts = tokens.starts
        self.comments = tokens.comments
        self.diagnostics: list[Diagnostic] = list(tokens.problems)
        self.at = 0
        self.depth = 0
        self.gave_up = False
        self.dropped = 0
        """Errors that were not recorded because there are too many."""

    # ---------------------------------------------------------------- cursor and errors

    def report(self, code: str, message: str, at: int | None = None) -> None:
        """Records an error at a token, by default the current one; only one for a place, and a bounded number."""
        self.report_at(code, message, self.starts[self.at if at is None else at])

    def report_at(self, code: str, message: str, offset: int) -> None:
        """Records an error at an offset of the text."""
        if self.gave_up:
            return
        finding = diagnostic(self.source, offset, code, message)
        known = self.diagnostics[-1] if self.diagnostics else None
        if known is not None and (known.line, known.column) == (finding.line, finding.column):
            return
        if len(self.diagnostics) < MAX_DIAGNOSTICS:
            self.diagnostics.append(finding)
        else:
            self.dropped += 1

    def fail(self, expected: str) -> SyntaxProblem:
        """Records that something else was expected here, and gives the exception to raise."""
        self.report("RAPID-E001", f"expected {expected}, found {self.shown()}")
        return SyntaxProblem()

    def shown(self) -> str:
        """Gives the current token as a message shows it."""
        kind, text = self.kinds[self.at], self.texts[self.at]
        if kind == END:
            return kind
        if kind in (NAME, NUMBER, STRING):
            return f"{kind} {text[:40]!r}"
        return f"the reserved word {text!r}" if kind.isalpha() and text != kind else repr(text)

    def take(self, kind: str, expected: str = "") -> str:
        """Gives the text of the current token, which must be of this kind, and goes on."""
        at = self.at
        if self.kinds[at] != kind:
            raise self.fail(expected or (repr(kind) if kind != NAME else "a name"))
        self.at = at + 1
        return self.texts[at]

    def take_name(self, expected: str = "a name") -> Name:
        """Gives the identifier here and goes on."""
        at = self.at
        text = self.take(NAME, expected)
        start = self.starts[at]
        return Name(text, start, start + len(text))

    def end_before(self) -> int:
        """Gives the offset after the token before the current one."""
        at = self.at - 1
        return self.starts[at] + len(self.texts[at])

    def deeper(self) -> None:
        """Counts one level of nesting and refuses too many."""
        self.depth += 1
        if self.depth > MAX_NESTING:
            raise self.give_up(f"nested too deeply: more than {MAX_NESTING} levels")

    def give_up(self, reason: str) -> SyntaxProblem:
        """Records that the text is beyond what a program can be, and leaves the rest of it unread."""
        self.report("RAPID-E006", reason)
        self.gave_up = True
        self.at = len(self.kinds) - 1
        return SyntaxProblem()

    # ---------------------------------------------------------------- grammar

    def expression(self, level: int = 1) -> Expression:
        """Gives the expression here, made of operators that bind at least as tightly as `level`.

        NOT binds loosest: it takes the whole AND term after it.
        ASSUMPTION A-20: so it does too after AND or a relation (`a AND NOT b AND c` is `a AND NOT (b AND c)`).
        """
        kinds = self.kinds
        kind = kinds[self.at]
        start = self.starts[self.at]
        left: Expression
        if kind in ("NOT", "-", "+"):
            self.deeper()
            self.at += 1
            operand = self.expression(2 if kind == "NOT" else 5)
            self.depth -= 1
            left = Unary(kind, operand, start, operand.end)
        else:
            left = self.primary()
        chain = 0
        while True:
            operator = kinds[self.at]
            precedence = PRECEDENCE.get(operator, 0)
            if precedence < level:
                return left
            chain += 1
            if chain > MAX_CHAIN:
                raise self.give_up(f"more than {MAX_CHAIN} operators in a row")
            sign = self.starts[self.at]
            self.at += 1
            right = self.expression(precedence + 1)
            left = Binary(operator, left, right, sign, start, right.end)

    def primary(self) -> Expression:
        """Gives the operand here."""
        at = self.at
        kind = self.kinds[at]
        start = self.starts[at]
        if kind == NUMBER:
            self.at = at + 1
            text = self.texts[at]
            return Number(text, number_value(text), start, start + len(text))
        if kind == NAME:
            return self.reference()
        if kind == "[":
            return self.aggregate()
        self.at = at + 1
        text = self.texts[at]
        if kind == STRING:
            return Text(text, string_value(text), start, start + len(text))
        if kind in ("TRUE", "FALSE"):
            return Truth(kind == "TRUE", start, start + len(text))
        if kind == "(":
            self.deeper()
            inner = self.expression()
            self.depth -= 1
            self.take(")")
            return inner
        if kind == PLACEHOLDER:
            return Placeholder(text, start, start + len(text))
        self.at = at
        raise self.fail("an expression")

    def aggregate(self) -> Expression:
        """Gives the aggregate here. Numbers, which most aggregates are full of, are read without a call."""
        kinds, texts, starts = self.kinds, self.texts, self.starts
        start = starts[self.at]
        self.deeper()
        items: list[Expression] = []
        while True:
            at = self.at = self.at + 1  # over the bracket or comma
            kind = kinds[at]
            if kind == NUMBER and kinds[at + 1] in ",]":
                text = texts[at]
                items.append(Number(text, number_value(text), starts[at], starts[at] + len(text)))
                self.at = at + 1
            elif kind == "-" and kinds[at + 1] == NUMBER and kinds[at + 2] in ",]":
                text = texts[at + 1]
                items.append(Number("-" + text, -number_value(text), starts[at], starts[at + 1] + len(text)))
                self.at = at + 2
            elif kind == "]" and not items:
                pass
            else:
                items.append(self.expression())
            kind = kinds[self.at]
            if kind == "]":
                break
            if kind != ",":
                raise self.fail("',' or ']' in the aggregate")
        self.depth -= 1
        self.at += 1
        return Aggregate(tuple(items), start, self.end_before())

    def reference(self) -> Expression:
        """Gives the data reference or function call here."""
        kinds = self.kinds
        at = self.at
        text, start = self.texts[at], self.starts[at]
        self.at = at + 1
        name = Name(text, start, start + len(text))
        node: Expression = name
        if kinds[self.at] == "(":
            self.deeper()
            self.at += 1
            arguments = self.arguments(")")
            self.take(")", "',' or ')' in the argument list")
            self.depth -= 1
            node = Call(name, arguments, start, self.end_before())
        chain = 0
        while (kind := kinds[self.at]) in ("{", "."):
            chain += 1
            if chain > MAX_CHAIN:
                raise self.give_up(f"more than {MAX_CHAIN} components in a row")
            self.at += 1
            if kind == "{":
                self.deeper()
                indices = self.expressions()
                self.depth -= 1
                self.take("}", "',' or '}' in the index")
                node = Index(node, indices, start, self.end_before())
            else:
                if not self.texts[self.at][:1].isalpha():  # a component may be called like a keyword
                    raise self.fail("a component name")
                self.at += 1
                node = Component(node, self.texts[self.at - 1], self.starts[self.at - 1], start, self.end_before())
        return node

    def expressions(self) -> tuple[Expression, ...]:
        """Gives a list of one or more expressions between commas."""
        found = [self.expression()]
        while self.kinds[self.at] == ",":
            self.at += 1
            found.append(self.expression())
        return tuple(found)

    def arguments(self, closer: str) -> tuple[Argument, ...]:
        r"""Gives the arguments up to `closer`, which is not taken. A comma before a backslash is optional.

        ASSUMPTION A-241: a required argument may name its parameter, `Offs(Point:=p, ...)`.
        """
        kinds = self.kinds
        found: list[Argument] = []
        if kinds[self.at] == closer:
            return ()
        while True:
            start = self.starts[self.at]
            if kinds[self.at] == "\\":
                self.at += 1
                found.append(self.option(start))
            else:
                value = self.expression()
                label = ""
                if kinds[self.at] == ":=" and value.__class__ is Name:
                    label = value.text
                    self.at += 1
                    value = self.expression()
                found.append(Argument("", value, False, start, value.end, label))
            kind = kinds[self.at]
            if kind == ",":
                self.at += 1
            elif kind != "\\":
                return tuple(found)

    def option(self, start: int) -> Argument:
        r"""Gives the optional argument here, after its backslash: `\Switch`, `\Name:=value` or `\Name?parameter`."""
        name = self.texts[self.at]
        if not name[:1].isalpha():
            raise self.fail("the name of an optional argument after '\\'")
        self.at += 1
        kind = self.kinds[self.at]
        value: Expression | None = None
        if kind == ":=":
            self.at += 1
            value = self.expression()
        elif kind == "?":
            self.at += 1
            value = self.take_name("the name of an optional parameter after '?'")
        return Argument(name, value, kind == "?", start, self.end_before())
