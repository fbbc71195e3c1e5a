"""What compiling a routine needs at hand: the steps so far, the names, the place to put errors.

Invariant: a step's index never changes once it is emitted; a jump forward is a reserved step that is patched.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from rapid_interp.effects import SourceLine
from rapid_interp.errors import Diagnostic, Severity, diagnostic
from rapid_interp.meaning.symbols import Code, DataSymbol, Frame, RoutineSymbol, Run, Scope, Step, did_you_mean
from rapid_interp.meaning.types import ANY, RapidType, Value, conforms
from rapid_interp.running.values import Fault, Reference
from rapid_interp.source import SourceText


@dataclass(frozen=True, slots=True)
class Operand:
    """A compiled expression. `refer` gives its reference if it denotes data; `constant` means that its value never changes."""

    type: RapidType
    run: Run
    refer: Run | None = None
    storage: str = ""
    constant: bool = False
    signal: str = ""
    raw: Run | None = None
    """Gives an array as it lies in its slot: a list once an element was changed. For reading elements only."""


MAX_HINTS = 50


@dataclass(slots=True)
class Findings:
    """All diagnostics of a program, and what can be judged only when all of it is read."""

    diagnostics: list[Diagnostic] = field(default_factory=list)
    signals: set[str] = field(default_factory=set)
    maybe_signals: list[tuple[str, Diagnostic]] = field(default_factory=list)
    lenient: bool = False
    """Instructions without effect on motion or data that are not known are warnings."""
    local_names: dict[str, str] = field(default_factory=dict)
    """Names that are LOCAL somewhere, with their modules: for messages only."""
    hints: int = 0
    elements: int = 0
    """Elements of all data of the modules."""

    def hint(self, name: str, known: list[str]) -> str:
        """Gives `did_you_mean` for the first unknown names; looking for all of a wrong file would take long."""
        self.hints += 1
        return did_you_mean(name, known) if self.hints <= MAX_HINTS else ""

    def finish(self) -> list[Diagnostic]:
        """Gives all diagnostics; an unknown name is no error if it is used as a signal elsewhere."""
        unknown = [found for name, found in self.maybe_signals if name not in self.signals]
        return sorted({*self.diagnostics, *unknown}, key=lambda found: (found.file, found.line, found.column))


class Compiler:
    """The state while one routine, or the data of one module, is compiled."""

    def __init__(self, source: SourceText, module: str, scope: Scope, findings: Findings, routine: RoutineSymbol | None = None) -> None:
        self.source = source
        self.module = module
        self.scope = scope
        self.findings = findings
        self.routine = routine
        self.code = routine.code if routine else Code()
        self.place = 0
        """Offset of the statement that steps belong to."""

    def error(self, code: str, message: str, at: int) -> None:
        """Records an error at an offset."""
        self.findings.diagnostics.append(diagnostic(self.source, at, code, message))

    def warn(self, code: str, message: str, at: int) -> None:
        """Records a warning at an offset."""
        self.findings.diagnostics.append(diagnostic(self.source, at, code, message, Severity.WARNING))

    def source_line(self, offset: int) -> SourceLine:
        """Gives where an effect comes from."""
        routine = self.routine.name if self.routine else ""
        return SourceLine(self.module, routine, self.source.file, *self.source.position(offset))

    # ---------------------------------------------------------------- steps

    @property
    def here(self) -> int:
        """Index of the next step."""
        return len(self.code.steps)

    def emit(self, step: Step) -> None:
        """Adds a step."""
        self.code.steps.append(step)
        self.code.places.append(self.place)

    def reserve(self) -> int:
        """Adds a step that is patched later, and gives its index."""
        self.emit(_unpatched)
        return self.here - 1

    def patch(self, index: int, step: Step) -> None:
        """Puts a step where one was reserved."""
        self.code.steps[index] = step

    def new_slot(self) -> int:
        """Gives a slot of the frame that nothing else uses."""
        self.code.size += 1
        return self.code.size - 1

    def declare(self, symbol: DataSymbol) -> None:
        """Makes data known in the innermost scope."""
        self.scope.data[symbol.name.lower()] = symbol

    def store(self, slot: int, run: Run) -> None:
        """Adds the step that puts a value into a slot of the frame."""
        following = self.here + 1

        def step(f: Frame) -> int:
            f[slot] = run(f)
            return following

        self.emit(step)

    def jump(self, index: int, target: int) -> None:
        """Patches a reserved step to go to another."""
        self.patch(index, lambda _: target)

    def jump_unless(self, index: int, condition: Run, target: int) -> None:
        """Patches a reserved step to go on if the condition holds and to `target` otherwise."""
        following = index + 1
        self.patch(index, lambda f: following if condition(f) else target)


def _unpatched(_: Frame) -> int:
    raise Fault("internal error: a jump was not completed", "RAPID-R399")


def constant(kind: RapidType, value: Value) -> Operand:
    """Gives an operand that always has this value."""
    return Operand(kind, lambda _: value, constant=True)


def failed(kind: RapidType = ANY, reason: str = "this expression cannot be executed") -> Operand:
    """Gives the operand that stands for an expression with an error; it fits everywhere and never runs."""

    def never(_: Frame) -> Value:
        raise Fault(reason, "RAPID-R390")

    return Operand(kind, never)


def conforming(operand: Operand, kind: RapidType) -> Operand:
    """Gives an operand of a type that is not known as one of this type; a value that cannot be one is an error when it is used."""
    run = operand.run

    def checked(f: Frame) -> Value:
        value = run(f)
        if not conforms(value, kind):
            raise Fault(f"this needs {kind.name}; the value's type is not known and it is none", "RAPID-R307")
        return value

    return Operand(kind, checked)


def folded(operand: Operand) -> Operand:
    """Gives the operand with its value computed now, if that is possible."""
    try:
        value = operand.run([])
    except (Fault, ArithmeticError, ValueError):
        return Operand(operand.type, operand.run, constant=True)
    return constant(operand.type, value)


def reference_of(operand: Operand, frame: Frame) -> Reference:
    """Gives the reference that a data operand denotes."""
    assert operand.refer is not None  # noqa: S101 - callers have checked it
    found: Reference = operand.refer(frame)
    return found
