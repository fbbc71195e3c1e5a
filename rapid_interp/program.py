"""Programs: reading, checking and starting them. The public face of the package.

Invariant: a `Program` has no errors; everything that is wrong with its texts was raised as `RapidErrors`.
"""

from __future__ import annotations

from collections.abc import Collection, Generator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rapid_interp.causes import not_caused
from rapid_interp.effects import Effect, Reply
from rapid_interp.errors import Diagnostic, RapidError, RapidErrors, Severity
from rapid_interp.meaning.calls import CallCompiler
from rapid_interp.meaning.compiler import Findings
from rapid_interp.meaning.declarations import Declarations
from rapid_interp.meaning.predefined import DATA
from rapid_interp.meaning.resolving import resolve
from rapid_interp.meaning.symbols import DataSymbol, RoutineSymbol, Scope, did_you_mean
from rapid_interp.meaning.types import Array, Atomic, RapidType, Record, Value
from rapid_interp.reading.expressions import ExpressionParser, SyntaxProblem
from rapid_interp.reading.files import read_texts
from rapid_interp.reading.lexer import END
from rapid_interp.reading.modules import Parsed, parse_any
from rapid_interp.reading.tree import Module
from rapid_interp.running.format import literal
from rapid_interp.running.mail import Mail
from rapid_interp.running.modules import ModuleTable
from rapid_interp.running.network import Network
from rapid_interp.running.sandbox import Sandbox
from rapid_interp.running.task import MAX_STEPS, Stepper
from rapid_interp.running.values import Fault, frozen, is_python_record, to_record
from rapid_interp.shared import SharedData, common_values, shared_slots
from rapid_interp.source import SourceText


@dataclass(frozen=True)
class Comment:
    """A comment from the exclamation mark on, its place (1-based), and whether nothing else is on its line."""

    file: str
    line: int
    column: int
    text: str
    alone: bool


@dataclass(frozen=True)
class Program:
    """A program without errors. `warnings` are what its check found beside."""

    modules: tuple[str, ...]
    routines: tuple[RoutineSymbol, ...]
    data: tuple[DataSymbol, ...]
    warnings: tuple[Diagnostic, ...]
    _initial: tuple[Value, ...] = field(repr=False)
    _scopes: dict[str, Scope] = field(repr=False)
    _everywhere: Scope = field(repr=False)
    _parsed: tuple[Parsed, ...] = field(repr=False)

    def start(
        self,
        routine: str = "main",
        module: str | None = None,
        *,
        max_steps: int = MAX_STEPS,
        files: Path | None = None,
        network: Network | None = None,
    ) -> Task:
        """Gives a new task about to run a procedure, with all data at their initial values.

        `max_steps` bounds the steps between effects that take time; a loop beyond it is a `RapidError`. `files` is the folder that
        holds all files of the program, `network` what its sockets reach (`HostNetwork`); without them they are refused.
        """
        named = [found for found in self.routines if found.kind == "PROC" and (module is None or found.module.lower() == module.lower())]
        matches = [found for found in named if found.name.lower() == routine.lower()]
        where = f" in module {module}" if module else ""
        if not matches:
            hint = did_you_mean(routine, [found.name for found in named])
            raise RapidError(f"the program has no procedure {routine!r}{where}{hint}", code="RAPID-R361")
        if len(matches) > 1:
            owners = ", ".join(found.module for found in matches)
            raise RapidError(f"several modules have a procedure {routine!r}: {owners}; name the module", code="RAPID-R361")
        entry = matches[0]
        required = [parameter.name for parameter in entry.parameters if not parameter.optional]
        if required:
            raise RapidError(f"{entry.name} cannot be started: it needs the arguments {', '.join(required)}", code="RAPID-R361")
        return Task(self, entry, max_steps, files, network)

    @property
    def trees(self) -> tuple[Module, ...]:
        """The syntax trees of the modules."""
        return tuple(module for parsed in self._parsed for module in parsed.modules)

    @property
    def comments(self) -> tuple[Comment, ...]:
        """All comments, in the order of the texts."""
        found: list[Comment] = []
        for parsed in self._parsed:
            source = parsed.source
            for start, text in sorted({comment for module in parsed.modules for comment in module.comments}):
                line, column = source.position(start)
                found.append(Comment(source.file, line, column, text, alone=not source.line_text(line)[: column - 1].strip()))
        return tuple(found)

    def find_data(self, name: str, module: str = "") -> DataSymbol:
        """Gives the data of a name or `module:name`; without module, the one seen from `module` or any."""
        owner, colon, plain = name.rpartition(":")
        found = [symbol for symbol in self.data if symbol.name.lower() == plain.strip().lower()]
        if colon:
            found = [symbol for symbol in found if symbol.module.lower() == owner.strip().lower()]
        preferred = [symbol for symbol in found if symbol.module.lower() == module.lower()]
        public = [symbol for symbol in found if symbol.scope != "LOCAL"]
        for choice in (preferred, public, found):
            if choice:
                return choice[0]
        raise RapidError(f"the program has no data {name!r}{did_you_mean(plain, [symbol.name for symbol in self.data])}", code="RAPID-R362")


class Task:
    """A running program. Its data may be read and set at any time, also between two effects."""

    def __init__(
        self, program: Program, entry: RoutineSymbol, max_steps: int, files: Path | None = None, network: Network | None = None
    ) -> None:
        self.program = program
        self.entry = entry
        self._globals: list[Value] = list(program._initial)
        self._modules = ModuleTable(program._scopes, program._everywhere, program.data, program._parsed, self._globals)
        self._stepper = Stepper(self._globals, entry, self._modules, max_steps)
        self._shared: tuple[SharedData, dict[str, int]] | None = None
        self._stepper.files = Sandbox(files) if files is not None else None
        self._stepper.network = network

    @property
    def name(self) -> str:
        """The task's name, `T_ROB1` unless it was started by `start_tasks`."""
        return self._stepper.name

    def run(self) -> Generator[Effect, Reply, None]:
        """Gives the generator of effects; send the reply that the effect asks for, or None. Raises `RapidError`."""
        return self._stepper.run() if self._shared is None else self._run_shared(*self._shared)

    def _run_shared(self, shared: SharedData, slots: dict[str, int]) -> Generator[Effect, Reply, None]:
        inner = self._stepper.run()
        reply: Reply = None
        while True:
            shared.pull(slots, self._globals)
            try:
                effect = inner.send(reply)
            except StopIteration:
                return
            finally:
                shared.push(slots, self._globals)
            reply = yield effect

    def share(self, name: str, shared: SharedData, slots: dict[str, int], mail: Mail) -> None:
        """Names the task and lets it share data and messages with others: see `start_tasks`."""
        self._stepper.name = name
        self._stepper.mail = mail
        mail.slot(f"RMQ_{name}")
        self._shared = shared, slots

    def _pull(self) -> None:
        if self._shared is not None:
            self._shared[0].pull(self._shared[1], self._globals)

    def _value(self, name: str) -> tuple[RapidType, Value]:
        self._pull()
        predefined = DATA.get(name.lower())
        try:
            symbol = self.program.find_data(name, self.entry.module)
        except RapidError:
            if predefined is None:
                raise
            return predefined[1], predefined[2]
        return symbol.type, self._globals[symbol.slot]

    def get(self, name: str) -> Any:  # noqa: ANN401 - float, bool, str, a record of `data`, or a tuple of these
        """Gives the value of module data: float, bool, str, a record of `data`, or a tuple (arrays, own records)."""
        kind, value = self._value(name)
        return as_python(kind, frozen(value))

    def literal(self, name: str) -> str:
        """Gives the value of module data as a RAPID literal that reads as the same value."""
        return literal(frozen(self._value(name)[1]))

    def set(self, name: str, literal_text: str) -> None:
        """Sets module data to a RAPID constant expression such as `3`, `TRUE` or `[[0,0,0],[1,0,0,0]]`."""
        symbol = self.program.find_data(name, self.entry.module)
        if symbol.storage == "CONST":
            raise RapidError(f"{symbol.name} is a constant and cannot be set", code="RAPID-R363")
        self._pull()
        self._globals[symbol.slot] = self._parsed(symbol, literal_text)
        if self._shared is not None:
            self._shared[0].push(self._shared[1], self._globals)

    def saved(self) -> dict[str, str]:
        """Gives the texts of the files whose PERS data have other values than at the start, with these as initial values."""
        self._pull()
        return self._modules.saved_files(self.program._initial)

    def _parsed(self, symbol: DataSymbol, text: str) -> Value:
        source = SourceText(f"value of {symbol.name}", text)
        parser = ExpressionParser(source)
        try:
            node = parser.expression()
            if parser.kinds[parser.at] != END:
                raise parser.fail("the end of the value")
        except (SyntaxProblem, RecursionError):
            node = None
        findings = Findings(diagnostics=parser.diagnostics)
        if node is not None and not findings.diagnostics:
            unit = CallCompiler(source, symbol.module, self.program._scopes[symbol.module.lower()], findings)
            try:
                operand = unit.value(node, symbol.type)
                if unit.here and not findings.finish():
                    unit.error("RAPID-E140", "a value must be constant", 0)
                problems = [found for found in findings.finish() if found.severity is Severity.ERROR]
                if not problems:
                    return operand.run([self._globals, self._stepper, None, None])
            except (Fault, ArithmeticError, ValueError, LookupError, RecursionError) as problem:
                unit.error("RAPID-E140", f"the value cannot be computed: {problem}", 0)
        problems = [found for found in findings.finish() if found.severity is Severity.ERROR]
        reason = problems[0].message if problems else "it cannot be read"
        raise RapidError(f"{text!r} is no value for {symbol.name} ({symbol.type.name}): {reason}", code="RAPID-R363")


def start_tasks(
    programs: Mapping[str, Program], routine: str = "main", *, max_steps: int = MAX_STEPS, files: Path | None = None
) -> dict[str, Task]:
    """Gives a new task for each program by its name; PERS that more than one declares, not LOCAL or TASK, are the same data for all.

    Whoever drives them decides which goes on when, and lets tasks meet at `WaitForTasks`. Raises `RapidError`.
    """
    slots = shared_slots({name: program.data for name, program in programs.items()})
    everything = [symbol for program in programs.values() for symbol in program.data]
    shared = common_values(slots, {name: program._initial for name, program in programs.items()}, everything)
    tasks = {name: program.start(routine, max_steps=max_steps, files=files) for name, program in programs.items()}
    mail = Mail()
    for name, task in tasks.items():
        task.share(name, shared, slots[name], mail)
    return tasks


def as_python(kind: RapidType, value: Value) -> Any:  # noqa: ANN401 - see `Task.get`
    """Gives a value with records of `data` in place of tuples."""
    match kind:
        case Atomic():
            return value
        case Record():
            if is_python_record(kind.name):
                return to_record(kind.name, value)
            return tuple(as_python(part, item) for (_, part), item in zip(kind.components, value, strict=True))
        case Array():
            inner = kind.element if len(kind.dimensions) == 1 else Array(kind.element, kind.dimensions[1:])
            return tuple(as_python(inner, item) for item in value)


def _resolved(parsed: Sequence[Parsed], signals: Collection[str], *, lenient: bool) -> tuple[list[Diagnostic], Declarations]:
    findings = Findings(signals={name.lower() for name in signals}, lenient=lenient)
    declarations = Declarations(findings)
    resolve(parsed, declarations)
    return findings.finish(), declarations


def _load(texts: Sequence[SourceText], signals: Collection[str], *, lenient: bool) -> Program:
    parsed = [parse_any(text) for text in texts]
    problems = [found for text in parsed for found in text.diagnostics]
    found, declarations = _resolved(parsed, signals, lenient=lenient)
    if problems:
        raise RapidErrors(_in_order([*problems, *not_caused(found, problems)], texts))
    if any(finding.severity is Severity.ERROR for finding in found):
        raise RapidErrors(_in_order(found, texts))
    return Program(
        modules=tuple(module.name.text for text in parsed for module in text.modules),
        routines=tuple(symbol for symbol, _, _ in declarations.routines),
        data=tuple(declarations.data),
        warnings=tuple(found),
        _initial=tuple(declarations.globals),
        _scopes=declarations.scopes,
        _everywhere=declarations.everywhere,
        _parsed=tuple(parsed),
    )


def load(sources: Sequence[Path | str], *, signals: Collection[str] = (), lenient: bool = False) -> Program:
    """Gives the program of files and folders. Raises `RapidErrors` with all errors, OSError for an unreadable file.

    `signals` are names that the controller has as signals, beside those that the program's use of them shows.
    With `lenient`, instructions that are not known and can change neither motion nor data are left out, with a warning.
    """
    return _load(read_texts(sources), signals, lenient=lenient)


def load_text(text: str, file: str = "<text>", *, signals: Collection[str] = (), lenient: bool = False) -> Program:
    """Gives the program of a text. Raises `RapidErrors` with all errors."""
    return _load([SourceText(file, text)], signals, lenient=lenient)


def check_texts(
    texts: Sequence[SourceText], *, syntax_only: bool = False, signals: Collection[str] = (), lenient: bool = False
) -> list[Diagnostic]:
    """Gives all findings of texts that make one program, in their order."""
    parsed = [parse_any(text) for text in texts]
    problems = [found for text in parsed for found in text.diagnostics]
    if not syntax_only:
        found, _ = _resolved(parsed, signals, lenient=lenient)
        problems += not_caused(found, problems)
    return _in_order(problems, texts)


def _in_order(findings: Sequence[Diagnostic], texts: Sequence[SourceText]) -> list[Diagnostic]:
    order = {text.file: place for place, text in enumerate(texts)}
    return sorted(findings, key=lambda finding: (order[finding.file], finding.line, finding.column))


def check(
    sources: Sequence[Path | str], *, syntax_only: bool = False, signals: Collection[str] = (), lenient: bool = False
) -> list[Diagnostic]:
    """Gives all findings of files and folders that make one program; OSError for an unreadable file."""
    return check_texts(read_texts(sources), syntax_only=syntax_only, signals=signals, lenient=lenient)
