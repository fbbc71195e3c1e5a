"""Tokens to statements, going on after an error at the next place that looks like a beginning.

Invariant: `block` always returns, with its stop word, an END word or a declaration as the current token.
"""

from __future__ import annotations

from collections.abc import Callable

from rapid_interp.reading.expressions import SyntaxProblem
from rapid_interp.reading.lexer import END, NAME, NUMBER, PLACEHOLDER, STRING
from rapid_interp.reading.resync import ResyncParser
from rapid_interp.reading.tree import (
    Argument,
    Assign,
    Branch,
    CallStatement,
    Case,
    Connect,
    Data,
    Expression,
    For,
    Goto,
    If,
    Label,
    LateName,
    Name,
    Placeholder,
    Raise,
    Return,
    Simple,
    Statement,
    Test,
    While,
)
from rapid_interp.reading.words import BEGINNINGS, DATA_WORDS, INNER_WORDS, RESTARTS, STATEMENT_ENDS, STOPS


class StatementParser(ResyncParser):
    """The grammar of statements."""

    def block(self, stops: frozenset[str], late_data: list[Data] | None = None) -> tuple[Statement, ...]:
        """Gives the statements up to a word of `stops` or one that can only end something further out."""
        found: list[Statement] = []
        depth = self.depth
        while (kind := self.kinds[self.at]) not in stops and kind not in STOPS:
            begin = self.at
            try:
                if kind in DATA_WORDS:
                    self.report("RAPID-E008", "data declarations belong before the first statement of the routine")
                    data = self.data("", self.at)
                    if late_data is not None:
                        late_data.append(data)
                elif kind in INNER_WORDS:
                    self.report("RAPID-E004", f"{kind} without the statement that it belongs to")
                    self.at += 1
                    if kind == "CASE":
                        self._list_or_gap(":")
                    self.at += self.kinds[self.at] == ":"
                elif kind == ";":
                    self.at += 1
                else:
                    found.append(self.statement())
            except SyntaxProblem:
                self.synchronise(begin)
                self.depth = depth
        return tuple(found)

    def data(self, scope: str, begin: int) -> Data:
        """Gives the data declaration here (read by the module's grammar)."""
        raise NotImplementedError

    def statement(self) -> Statement:
        """Gives the statement here."""
        handler = _HANDLERS.get(self.kinds[self.at])
        if handler is None:
            raise self.fail("a statement")
        return handler(self)

    def named_statement(self) -> Statement:
        """Gives the assignment, label or call here."""
        kinds = self.kinds
        at = self.at
        following = kinds[at + 1]
        start = self.starts[at]
        if following == ":":
            self.at = at + 2
            return Label(self.texts[at], start, self.end_before())
        if following in (":=", "{", ".", "="):
            target = self.reference()
            if self.kinds[self.at] == "=":
                self.report("RAPID-E001", "expected ':=', found '=': it compares, ':=' assigns")
                self.at += 1
            else:
                self.take(":=", "':='")
            value = self.expression()
            self.semicolon()
            return Assign(target, value, start, self.end_before())
        name = self.take_name()
        return self.call(name, start)

    def call(self, name: Name | LateName, start: int) -> CallStatement:
        """Gives the call of `name`; the arguments may stand in parentheses as a whole."""
        if self._next_statement_begins():
            arguments: tuple[Argument, ...] = ()
        elif self.kinds[self.at] == "(" and self._parenthesis_ends_statement():
            self.at += 1
            arguments = self.arguments(")")
            self.take(")")
        else:
            arguments = self.arguments(";")
        self.semicolon()
        return CallStatement(name, arguments, start, self.end_before())

    def _next_statement_begins(self) -> bool:
        """Gives whether what follows a call's name is a statement of its own on a later line: the `;` was forgotten."""
        at = self.at
        kind = self.kinds[at]
        begins = self.kinds[at + 1] in (":=", NAME, NUMBER, STRING) if kind == NAME else kind in RESTARTS
        return begins and "\n" in self.source.text[self.end_before() : self.starts[at]]

    def _parenthesis_ends_statement(self) -> bool:
        level = 0
        for at in range(self.at, len(self.kinds)):
            kind = self.kinds[at]
            if kind == "(":
                level += 1
            elif kind == ")":
                level -= 1
                if level == 0:
                    return self.kinds[at + 1] == ";"
            elif kind in (";", END):
                break
        return False

    def late_call(self) -> Statement:
        """Gives the call of a procedure by a name that is known only when it runs."""
        start = self.starts[self.at]
        self.at += 1
        value = self.expression()
        self.take("%")
        return self.call(LateName(value, start, self.end_before()), start)

    # ---------------------------------------------------------------- compound statements

    def if_statement(self) -> Statement:
        """Gives the IF here, compact or with a block."""
        begin = self.at
        start = self.starts[begin]
        self.at += 1
        self.deeper()
        condition = self._if_condition()
        if self.kinds[self.at] == "THEN":
            self.at += 1
        elif self.looks_like_then():
            self.fail("THEN")
            self.at += 1
        elif self.lacks_then():
            self.forgotten("THEN")
        elif self.kinds[self.at] == NAME or self.kinds[self.at] in BEGINNINGS or self.kinds[self.at] in ("%", PLACEHOLDER):
            statement = self.statement()
            self.depth -= 1
            return If((Branch(condition, (statement,)),), None, True, start, self.end_before())
        elif not isinstance(condition, Placeholder):
            self.fail("THEN")
        self.block_ifs += 1
        branches = [Branch(condition, self.block(_IF_STOPS))]
        otherwise: tuple[Statement, ...] | None = None
        while self.kinds[self.at] in ("ELSEIF", "ELSE"):
            if self.kinds[self.at] == "ELSEIF":
                self.at += 1
                condition = self.header("THEN")
                branches.append(Branch(condition, self.block(_IF_STOPS)))
            else:
                self.at += 1
                otherwise = self.block(_IF_STOPS)
                if self.kinds[self.at] in ("ELSEIF", "ELSE"):
                    self.report("RAPID-E004", f"{self.kinds[self.at]} after ELSE")
        end = self.close("ENDIF", "IF", begin)
        self.block_ifs -= 1
        self.depth -= 1
        return If(tuple(branches), otherwise, False, start, end)

    def _if_condition(self) -> Expression:
        begin = self.at
        try:
            return self.expression()
        except SyntaxProblem:
            while self.kinds[self.at] not in RESTARTS and self.kinds[self.at] not in (";", "THEN"):
                self.at += 1
            if self.kinds[self.at] != "THEN":
                raise
            return Placeholder("<EXP>", self.starts[begin], self.starts[begin] + 1)

    def while_statement(self) -> Statement:
        """Gives the WHILE here."""
        begin = self.at
        self.at += 1
        self.deeper()
        condition = self.header("DO")
        body = self.block(STATEMENT_ENDS)
        end = self.close("ENDWHILE", "WHILE", begin)
        self.depth -= 1
        return While(condition, body, self.starts[begin], end)

    def for_statement(self) -> Statement:
        """Gives the FOR here."""
        begin = self.at
        self.at += 1
        self.deeper()
        gap = Placeholder("<EXP>", self.starts[begin], self.starts[begin] + 3)
        variable, first, last = Name("", gap.start, gap.end), gap, gap  # type: tuple[Name, Expression, Expression]
        step: Expression | None = None
        try:
            variable = self.take_name("the name of the loop variable")
            self.take("FROM")
            first = self.expression()
            self.take("TO")
            last = self.expression()
        except SyntaxProblem:
            self.skip_line()
        else:
            if self.kinds[self.at] == "STEP":
                self.at += 1
                step = self.header("DO")
            elif self.kinds[self.at] == "DO":
                self.at += 1
            elif not self.forgotten("DO", "STEP or DO"):
                self.fail("STEP or DO")
                self.skip_line()
        body = self.block(STATEMENT_ENDS)
        end = self.close("ENDFOR", "FOR", begin)
        self.depth -= 1
        return For(variable, first, last, step, body, self.starts[begin], end)

    def test_statement(self) -> Statement:
        """Gives the TEST here."""
        begin = self.at
        self.at += 1
        self.deeper()
        subject = self._list_or_gap("CASE")[0]
        if self.kinds[self.at] == ";":
            self.at += 1
        cases: list[Case] = []
        default: tuple[Statement, ...] | None = None
        if (kind := self.kinds[self.at]) not in ("CASE", "DEFAULT", "ENDTEST", PLACEHOLDER):
            self.fail("CASE, DEFAULT or ENDTEST")
            self.block(_TEST_STOPS)
        while (kind := self.kinds[self.at]) in ("CASE", "DEFAULT", PLACEHOLDER):
            self.at += 1
            if kind == PLACEHOLDER:
                continue
            if kind == "CASE":
                if default is not None:
                    self.report("RAPID-E004", "CASE after DEFAULT", self.at - 1)
                values = self._list_or_gap(":")
                self._colon()
                cases.append(Case(values, self.block(_TEST_STOPS)))
            else:
                self._colon()
                default = self.block(_TEST_STOPS)
        end = self.close("ENDTEST", "TEST", begin)
        self.depth -= 1
        return Test(subject, tuple(cases), default, self.starts[begin], end)

    def _colon(self) -> None:
        if self.kinds[self.at] == ":":
            self.at += 1
        else:
            self.report_at("RAPID-E001", f"expected ':' after the values, found {self.shown()}", self.end_before())

    def _list_or_gap(self, closer: str) -> tuple[Expression, ...]:
        begin = self.at
        try:
            return self.expressions()
        except SyntaxProblem:
            line = self.source.line_of(self.starts[begin])
            while (
                self.kinds[self.at] not in RESTARTS
                and self.kinds[self.at] not in (";", closer)
                and self.source.line_of(self.starts[self.at]) == line
            ):
                self.at += 1
            return (Placeholder("<EXP>", self.starts[begin], self.starts[begin] + 1),)

    # ---------------------------------------------------------------- simple statements

    def valued_statement(self) -> Statement:
        """Gives the RETURN or RAISE here."""
        begin = self.at
        self.at += 1
        value = None if self.kinds[self.at] == ";" else self.expression()
        self.semicolon()
        kind = Return if self.kinds[begin] == "RETURN" else Raise
        return kind(value, self.starts[begin], self.end_before())

    def goto_statement(self) -> Statement:
        """Gives the GOTO here."""
        start = self.starts[self.at]
        self.at += 1
        label = self.take_name("the name of a label")
        self.semicolon()
        return Goto(label, start, self.end_before())

    def simple_statement(self) -> Statement:
        """Gives the RETRY, TRYNEXT or EXIT here."""
        begin = self.at
        self.at += 1
        self.semicolon()
        return Simple(self.kinds[begin], self.starts[begin], self.end_before())

    def connect_statement(self) -> Statement:
        """Gives the CONNECT here."""
        start = self.starts[self.at]
        self.at += 1
        if self.kinds[self.at] != NAME:
            raise self.fail("the name of an interrupt")
        interrupt = self.reference()
        self.take("WITH")
        trap = self.take_name("the name of a trap")
        self.semicolon()
        return Connect(interrupt, trap, start, self.end_before())

    def placeholder_statement(self) -> Statement:
        """Gives the placeholder here; a `;` or `:=` expression after it belongs to it."""
        at = self.at
        self.at += 1
        if self.kinds[self.at] == ":=":
            self.at += 1
            self.expression()
        if self.kinds[self.at] == ";":
            self.at += 1
        return Placeholder(self.texts[at], self.starts[at], self.end_before())


_IF_STOPS = STATEMENT_ENDS | {"ELSE", "ELSEIF"}
_TEST_STOPS = STATEMENT_ENDS | {"CASE", "DEFAULT"}
_HANDLERS: dict[str, Callable[[StatementParser], Statement]] = {
    NAME: StatementParser.named_statement,
    "%": StatementParser.late_call,
    "IF": StatementParser.if_statement,
    "WHILE": StatementParser.while_statement,
    "FOR": StatementParser.for_statement,
    "TEST": StatementParser.test_statement,
    "RETURN": StatementParser.valued_statement,
    "RAISE": StatementParser.valued_statement,
    "GOTO": StatementParser.goto_statement,
    "RETRY": StatementParser.simple_statement,
    "TRYNEXT": StatementParser.simple_statement,
    "EXIT": StatementParser.simple_statement,
    "CONNECT": StatementParser.connect_statement,
    PLACEHOLDER: StatementParser.placeholder_statement,
}
