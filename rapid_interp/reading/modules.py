"""Tokens to modules: declarations, routines and their sections. The way in is `parse`.

Invariant: `parse` gives a tree and a list of diagnostics for any text whatever, and raises nothing.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from rapid_interp.errors import Diagnostic, diagnostic
from rapid_interp.reading.expressions import MAX_DIAGNOSTICS, SyntaxProblem
from rapid_interp.reading.lexer import END, NAME, PLACEHOLDER
from rapid_interp.reading.statements import StatementParser
from rapid_interp.reading.tree import (
    AliasType,
    Data,
    Declaration,
    ErrorHandler,
    Expression,
    Field,
    Module,
    Name,
    Parameter,
    Placeholder,
    RecordType,
    Routine,
    Statement,
)
from rapid_interp.reading.words import DATA_WORDS, OUTER_WORDS, ROUTINE_ENDS, SECTION_WORDS, STATEMENT_ENDS
from rapid_interp.source import SourceText

ATTRIBUTES = frozenset({"SYSMODULE", "NOSTEPIN", "VIEWONLY", "NOVIEW", "READONLY"})
_ROUTINE_WORDS = frozenset({"PROC", "FUNC", "TRAP"})
_DECLARATION_WORDS = DATA_WORDS | _ROUTINE_WORDS | {"RECORD", "ALIAS", "LOCAL", "TASK"}
_MODULE_STOPS = frozenset({"ENDMODULE", "MODULE", END})


class Parsed(NamedTuple):
    """What a text holds: its modules and its syntax errors."""

    source: SourceText
    modules: tuple[Module, ...]
    diagnostics: tuple[Diagnostic, ...]


def parse(source: SourceText) -> Parsed:
    """Gives the modules of a text and all its syntax errors, in the order of the text."""
    parser = ModuleParser(source)
    modules = parser.modules()
    found = sorted(parser.diagnostics, key=lambda finding: (finding.line, finding.column))
    if (dropped := parser.dropped + len(found) - MAX_DIAGNOSTICS) > 0:
        found = found[:MAX_DIAGNOSTICS]
        message = f"{dropped} more syntax error{'s' * (dropped > 1)} in this file: only the first {MAX_DIAGNOSTICS} are shown"
        found.append(replace(found[-1], code="RAPID-E009", message=message))
    return Parsed(source, modules, tuple(found))


def parse_any(source: SourceText) -> Parsed:
    """Gives what `parse` gives, also where the bounds of nesting together are too much for Python's stack."""
    try:
        return parse(source)
    except RecursionError:
        return Parsed(source, (), (diagnostic(source, 0, "RAPID-E006", "nested too deeply"),))


class ModuleParser(StatementParser):
    """The grammar of modules and declarations."""

    def modules(self) -> tuple[Module, ...]:
        """Gives all modules of the text."""
        found: list[Module] = []
        while self.kinds[self.at] != END or not found:
            if self.kinds[self.at] == "MODULE":
                found.append(self.module())
                continue
            self.report("RAPID-E001", f"expected MODULE, found {self.shown()}")
            while self.kinds[self.at] not in ("MODULE", END):
                self.at += 1
            if self.kinds[self.at] == END:
                break
        return tuple(found)

    def module(self) -> Module:
        """Gives the module here."""
        begin = self.at
        self.at += 1
        name = Name("", self.starts[begin], self.starts[begin] + 6)
        attributes: tuple[str, ...] = ()
        try:
            name = self.take_name("the name of the module")
            attributes = self._attributes()
        except SyntaxProblem:
            self._to_declaration()
        declarations: list[Declaration] = []
        while self.kinds[self.at] not in _MODULE_STOPS:
            at = self.at
            try:
                declarations.append(self.declaration())
            except SyntaxProblem:
                self.depth = 0
                self._skip_declaration(at)
        end = self.close("ENDMODULE", "MODULE", begin)
        return Module(name, attributes, tuple(declarations), self.comments, self.starts[begin], end)

    def _attributes(self) -> tuple[str, ...]:
        if self.kinds[self.at] != "(":
            return ()
        self.at += 1
        found: list[str] = []
        while True:
            if self.kinds[self.at] not in ATTRIBUTES:
                raise self.fail(f"a module attribute ({', '.join(sorted(ATTRIBUTES))})")
            found.append(self.kinds[self.at])
            self.at += 1
            if self.kinds[self.at] != ",":
                break
            self.at += 1
        self.take(")")
        return tuple(found)

    def _to_declaration(self) -> None:
        while self.kinds[self.at] not in _DECLARATION_WORDS and self.kinds[self.at] not in _MODULE_STOPS:
            self.at += 1

    def _skip_declaration(self, begin: int) -> None:
        if self.at == begin:
            self.at += 1
        while self.kinds[self.at] not in _DECLARATION_WORDS and self.kinds[self.at] not in _MODULE_STOPS:
            self.at += 1
            if self.kinds[self.at - 1] == ";" and self.kinds[self.at] in _DECLARATION_WORDS:
                return

    def declaration(self) -> Declaration:
        """Gives the declaration here."""
        begin = self.at
        scope = ""
        if self.kinds[begin] in ("LOCAL", "TASK"):
            scope = self.kinds[begin]
            self.at += 1
        kind = self.kinds[self.at]
        if kind in DATA_WORDS:
            return self.data(scope, begin)
        if kind in _ROUTINE_WORDS:
            return self.routine(scope, begin)
        if kind == "RECORD":
            return self.record(scope, begin)
        if kind == "ALIAS":
            self.at += 1
            type_name = self.take_name("the name of a type")
            name = self.take_name()
            self.semicolon()
            return AliasType(scope, type_name, name, self.starts[begin], self.end_before())
        if kind == PLACEHOLDER:
            self.at += 1
            if self.kinds[self.at] == ";":
                self.at += 1
            return Placeholder(self.texts[begin], self.starts[begin], self.end_before())
        raise self.fail("a declaration (VAR, CONST, PERS, PROC, FUNC, TRAP, RECORD, ALIAS) or ENDMODULE")

    def data(self, scope: str, begin: int) -> Data:
        """Gives the data declaration here, from its storage class on."""
        storage = self.kinds[self.at]
        self.at += 1
        type_name = self.take_name("the name of a type")
        name = self._name_or_gap()
        dimensions: tuple[Expression, ...] = ()
        if self.kinds[self.at] == "{":
            self.at += 1
            dimensions = self.expressions()
            self.take("}")
        value: Expression | None = None
        if self.kinds[self.at] == ":=":
            self.at += 1
            value = self.expression()
        self.semicolon()
        return Data(scope, storage, type_name, name, dimensions, value, self.starts[begin], self.end_before())

    def _name_or_gap(self) -> Name:
        if self.kinds[self.at] == PLACEHOLDER:
            self.at += 1
            return Name(self.texts[self.at - 1], self.starts[self.at - 1], self.end_before())
        return self.take_name()

    def record(self, scope: str, begin: int) -> RecordType:
        """Gives the RECORD declaration here."""
        opener = self.at
        self.at += 1
        name = self.take_name("the name of the record")
        fields: list[Field] = []
        while self.kinds[self.at] in (NAME, PLACEHOLDER):
            if self.kinds[self.at] == PLACEHOLDER:
                self.at += 1
                continue
            type_name = self.take_name()
            fields.append(Field(type_name, self.take_name("the name of a component")))
            self.semicolon()
        end = self.close("ENDRECORD", "RECORD", opener)
        return RecordType(scope, name, tuple(fields), self.starts[begin], end)

    # ---------------------------------------------------------------- routines

    def routine(self, scope: str, begin: int) -> Routine:
        """Gives the PROC, FUNC or TRAP here. An error in its head does not lose its body."""
        opener = self.at
        kind = self.kinds[opener]
        self.at += 1
        type_name: Name | None = None
        name = Name("", self.starts[opener], self.starts[opener] + len(kind))
        parameters: tuple[Parameter, ...] = ()
        try:
            if kind == "FUNC":
                type_name = self.take_name("the type of the function")
            name = self._name_or_gap()
            if kind != "TRAP":
                parameters = self.parameters()
        except SyntaxProblem:
            self.synchronise_head()
        data: list[Data] = []
        self.block_ifs = 0
        self._local_data(data)
        body = self._section(data)
        backward: tuple[Statement, ...] | None = None
        undo: tuple[Statement, ...] | None = None
        error: ErrorHandler | None = None
        while (word := self.kinds[self.at]) in SECTION_WORDS:
            at = self.at
            self.at += 1
            numbers = self._error_numbers() if word == "ERROR" else ()
            section = self._section(data)
            if (word == "ERROR" and error) or (word == "UNDO" and undo is not None) or (word == "BACKWARD" and backward is not None):
                self.report("RAPID-E004", f"a second {word} section in the same routine", at)
            if word == "ERROR":
                error = ErrorHandler(numbers, section)
            elif word == "UNDO":
                undo = section
            else:
                backward = section
        end = self.close("END" + kind, kind, opener)
        return Routine(scope, kind, type_name, name, parameters, tuple(data), body, backward, error, undo, self.starts[begin], end)

    def synchronise_head(self) -> None:
        """Goes to the line after the broken head of a routine."""
        line = self.source.line_of(self.starts[self.at])
        while (
            self.kinds[self.at] not in ROUTINE_ENDS
            and self.kinds[self.at] not in OUTER_WORDS
            and self.source.line_of(self.starts[self.at]) == line
        ):
            self.at += 1

    def _local_data(self, data: list[Data]) -> None:
        while self.kinds[self.at] in DATA_WORDS or self.texts[self.at] in ("<DDN>", "<VAR>", ";"):
            begin = self.at
            if self.kinds[begin] in (PLACEHOLDER, ";"):
                self.at += 1
                continue
            try:
                data.append(self.data("", begin))
            except SyntaxProblem:
                self.synchronise(begin)

    def _section(self, data: list[Data]) -> tuple[Statement, ...]:
        """Gives the statements of a section; END words of statements have no place at this level."""
        found: list[Statement] = []
        while True:
            found += self.block(frozenset(), data)
            kind = self.kinds[self.at]
            if kind in STATEMENT_ENDS:
                article = "an" if kind == "ENDIF" else "a"
                self.report("RAPID-E004", f"{kind} without {article} {kind[3:]} before it")
                self.at += 1
            elif kind in ("ALIAS", "RECORD", "ENDRECORD"):
                self.report("RAPID-E001", f"expected a statement, found {kind}: types are declared outside of routines")
                self.synchronise(self.at - (kind == "ALIAS"))
                self.at += self.kinds[self.at] == kind
            else:
                return tuple(found)

    def _error_numbers(self) -> tuple[Expression, ...]:
        if self.kinds[self.at] != "(":
            return ()
        begin = self.at
        try:
            self.at += 1
            numbers = self.expressions()
            self.take(")")
        except SyntaxProblem:
            self.synchronise(begin)
            return ()
        return numbers

    def parameters(self) -> tuple[Parameter, ...]:
        """Gives the parameter list here, parentheses included."""
        self.take("(", "'(' and the parameters")
        found: list[Parameter] = []
        group = 0
        while self.kinds[self.at] != ")":
            alternatives: list[Parameter] = []
            while True:
                if not self._parameter_gap():
                    alternatives.append(self.parameter(optional=bool(alternatives) and alternatives[-1].optional))
                if self.kinds[self.at] != "|":
                    break
                self.at += 1
            if len(alternatives) > 1:
                group += 1
                alternatives = [parameter._replace(group=group) for parameter in alternatives]
            found += alternatives
            if self.kinds[self.at] == ",":
                self.at += 1
            elif self.kinds[self.at] not in ("\\", ")"):
                raise self.fail("',' or ')' in the parameter list")
        self.at += 1
        return tuple(found)

    def _parameter_gap(self) -> bool:
        r"""Goes over a placeholder for a parameter, `<PAR>` or `\<ALT>`, and gives whether one was here."""
        at = self.at + (self.kinds[self.at] == "\\")
        if self.kinds[at] != PLACEHOLDER:
            return False
        self.at = at + 1
        return True

    def parameter(self, *, optional: bool) -> Parameter:
        """Gives the parameter here, which is in no group yet."""
        start = self.starts[self.at]
        if self.kinds[self.at] == "\\":
            self.at += 1
            optional = True
        mode = ""
        if self.kinds[self.at] in ("VAR", "PERS", "INOUT"):
            mode = self.kinds[self.at]
            self.at += 1
        type_name = self.take_name("the type of a parameter")
        name = self.take_name("the name of a parameter")
        rank = 0
        if self.kinds[self.at] == "{":
            while self.kinds[self.at] == "," or not rank:
                self.at += 1
                rank += 1
                if self.texts[self.at] != "<DIM>":
                    self.take("*", "'*' for a dimension of the parameter")
                else:
                    self.at += 1
            self.take("}")
        return Parameter(optional, 0, mode, type_name, name, rank, start, self.end_before())
