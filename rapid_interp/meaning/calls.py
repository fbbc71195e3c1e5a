"""Calls to code: of the program's own routines, of the library, late-bound, and `Present`.

Invariant: a binder gives the value of one parameter from the caller's frame; the callee's frame is made of binders only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from rapid_interp.library.table import Effects, LibraryRoutine
from rapid_interp.meaning.arguments import (
    ANYDATA,
    ANYTYPE,
    NUMERICDATA,
    find_library,
    library_names,
    library_parameters,
    library_result,
    matched,
)
from rapid_interp.meaning.compiler import Operand, failed
from rapid_interp.meaning.expressions import ExpressionCompiler
from rapid_interp.meaning.symbols import GLOBALS, TASK, Frame, ParameterInfo, RoutineSymbol, Run
from rapid_interp.meaning.types import ANY, BOOL, DNUM, NUM, STRING, SWITCH, RapidType, Value, conforms, fits, is_opaque, is_signal
from rapid_interp.reading.tree import Argument, Call, CallStatement, LateName, Name
from rapid_interp.running.numbers import has_nums, rounded
from rapid_interp.running.values import ABSENT, Fault, FixedReference


@dataclass(frozen=True, slots=True)
class Enter:
    """Tells the task to run a routine of the program in a new frame, and where its value goes."""

    routine: RoutineSymbol
    frame: Frame
    slot: int | None


@dataclass(frozen=True, slots=True)
class Perform:
    """Tells the task to carry out the effects of a library routine, and where its value goes."""

    effects: Effects
    slot: int | None


@dataclass(frozen=True, slots=True)
class LateArgument:
    """An argument of a late-bound call: a reference, with its type, or a switch; ABSENT if it was passed on and is not there."""

    option: str
    type: RapidType | None
    reference: Value


@dataclass(frozen=True, slots=True)
class LateCall:
    """Tells the task to find a procedure by its name and run it with these arguments."""

    name: str
    module: str
    arguments: tuple[LateArgument, ...]


_MISFITS = {"PERS": ("VAR", "parameter", "loop"), "VAR": ("PERS",)}
"""Which data cannot be given for a parameter of a mode."""
_PERSISTENT_TYPES = frozenset({"tooldata", "wobjdata", "loaddata"})
"""Types whose arguments instructions take as PERS. Constants are let pass: programs made offline hold them."""
_OF_MOTION = ("move", "trigg", "search", "sync", "arc", "spot", "paint", "disp", "ind", "egm")
_MOTION_TYPES = frozenset({"robtarget", "jointtarget", "speeddata", "zonedata", "tooldata", "wobjdata", "pose"})


class CallCompiler(ExpressionCompiler):
    """Compiles calls in expressions and statements."""

    def call(self, node: Call) -> Operand:
        """Gives the operand for a function call."""
        name = node.name.text
        routine = self.scope.find_routine(name)
        if routine is not None:
            if routine.result is None:
                self.error("RAPID-E102", f"{name!r} is a {routine.kind}, which gives no value", node.start)
                return failed()
            slot = self.new_slot()
            self._enter(routine, node.arguments, node.end - 1, slot)
            return Operand(routine.result, lambda f: f[slot])
        if name.lower() == "present":
            return self._present(node)
        if name.lower() == "remainingretries" and not node.arguments:
            return Operand(NUM, lambda f: float(f[TASK].retries_left(f)))
        library = find_library(name)
        if library is None or not library.is_function:
            self._unknown_function(node, library)
            return failed()
        result = library_result(library)
        if library.run is None:
            self._pending(library, node.arguments, node.start)
            return failed(result, f"{library.name}: {library.refused}")
        if library.refused:
            self.warn("RAPID-W203", f"{library.name}: {library.refused}", node.start)
        binders = self._library_binders(library, node.arguments, node.end - 1)
        if library.effects:
            slot = self.new_slot()
            self._perform(library, binders, node.start, slot)
            return Operand(result, (lambda f: rounded(result, f[slot])) if has_nums(result) else lambda f: f[slot])
        apply = _applied(library, binders, node.start)
        return Operand(result, (lambda f: rounded(result, apply(f))) if has_nums(result) else apply)

    def _unknown_function(self, node: Call, library: LibraryRoutine | None) -> None:
        name = node.name.text
        if library is not None:
            self.error("RAPID-E102", f"{name!r} is an instruction, which gives no value", node.start)
        elif self.scope.find_data(name):
            self.error("RAPID-E102", f"{name!r} is data, not a function; elements are written with braces: {name}{{...}}", node.start)
        elif (owner := self.findings.local_names.get(name.lower())) is not None:
            self.error("RAPID-E108", f"{name!r} is LOCAL in module {owner}", node.start)
        else:
            known = self.scope.routine_names() + library_names(functions=True)
            self.error("RAPID-E102", f"unknown function {name!r}{self.findings.hint(name, known)}", node.start)
        self._look_at(node.arguments)

    def _look_at(self, arguments: tuple[Argument, ...]) -> None:
        """Compiles arguments only for the errors in them."""
        for argument in arguments:
            if argument.value is not None and not isinstance(argument.value, Name):
                self.operand(argument.value, ANY)

    def _present(self, node: Call) -> Operand:
        value = node.arguments[0].value if len(node.arguments) == 1 else None
        symbol = self.scope.find_data(value.text) if isinstance(value, Name) else None
        if symbol is None or not symbol.optional:
            self.error("RAPID-E127", "Present needs the name of an optional parameter of this routine", node.start)
            return failed(BOOL)
        slot = symbol.slot
        return Operand(BOOL, lambda f: f[slot] is not ABSENT)

    # ---------------------------------------------------------------- statements

    def call_statement(self, node: CallStatement) -> None:
        """Adds the steps of a call that stands alone."""
        if isinstance(node.name, LateName):
            self._late(node.name, node)
            return
        name = node.name.text
        routine = self.scope.find_routine(name)
        if routine is not None:
            if routine.kind != "PROC":
                self.error("RAPID-E102", f"{name!r} is a {routine.kind}; only a PROC can be called as a statement", node.start)
            else:
                self._enter(routine, node.arguments, node.name.end - 1, None)
            return
        library = find_library(name)
        if library is None or library.is_function:
            self._unknown_procedure(node, name, library)
            return
        if library.run is None:
            self._refused(library, node)
            return
        if library.refused:
            self.warn("RAPID-W203", f"{library.name}: {library.refused}", node.start)
        binders = self._library_binders(library, node.arguments, node.name.end - 1)
        if library.effects:
            self._perform(library, binders, node.start, None)
            return
        apply, following = _applied(library, binders, node.start), self.here + 1

        def step(f: Frame) -> int:
            apply(f)
            return following

        self.emit(step)

    def _unknown_procedure(self, node: CallStatement, name: str, library: LibraryRoutine | None) -> None:
        if library is not None:
            self.error("RAPID-E102", f"{name!r} is a function; its value must be used", node.start)
            self._look_at(node.arguments)
            return
        if (owner := self.findings.local_names.get(name.lower())) is not None:
            self.error("RAPID-E108", f"{name!r} is LOCAL in module {owner}", node.start)
            return
        known = self.scope.routine_names() + library_names(functions=False)
        message = f"unknown procedure or instruction {name!r}{self.findings.hint(name, known)}"
        if self.findings.lenient and self._changes_nothing(name, node.arguments):
            self.warn("RAPID-W202", f"left out: {message}", node.start)
        else:
            self.error("RAPID-E102", message, node.start)
            self._look_at(node.arguments)

    def _changes_nothing(self, name: str, arguments: tuple[Argument, ...]) -> bool:
        """Gives whether an unknown instruction cannot change data, and none of its arguments has to do with motion."""
        if name.lower().startswith(_OF_MOTION):
            return False
        for argument in arguments:
            if argument.value is None:
                continue
            operand = self.operand(argument.value, ANY)
            changeable = operand.refer is not None and operand.storage != "CONST" and not operand.signal
            if changeable or operand.type.name in _MOTION_TYPES:
                return False
        return True

    def _refused(self, library: LibraryRoutine, node: CallStatement) -> None:
        if self.findings.lenient and library.harmless:
            self.warn("RAPID-W202", f"left out: {library.name}: {library.refused}", node.start)
            self._look_at(node.arguments)
            return
        self._pending(library, node.arguments, node.start)
        message = f"{library.name}: {library.refused}"
        if library.harmless:
            message += "; --lenient leaves it out"

        def refuse(_: Frame) -> int:
            raise Fault(message, "RAPID-R391")

        self.emit(refuse)

    def _late(self, name: LateName, node: CallStatement) -> None:
        called = self.value(name.value, STRING)
        self.late_call(called.run, node.arguments)

    def late_call(self, called: Run, arguments: tuple[Argument, ...]) -> None:
        """Adds the step of a call whose procedure is found by its name when it runs."""
        parts: list[Callable[[Frame], LateArgument]] = [self._late_argument(argument) for argument in arguments]
        module = self.module
        self.emit(lambda f: LateCall(called(f), module, tuple([part(f) for part in parts])))

    def _late_argument(self, argument: Argument) -> Callable[[Frame], LateArgument]:
        option = argument.option
        if argument.value is None:
            return lambda _: LateArgument(option, SWITCH, True)
        operand = self.operand(argument.value, ANY)
        kind, refer = operand.type, operand.refer or _fixed(operand.run)
        if not argument.conditional:
            return lambda f: LateArgument(option, kind, refer(f))
        assert isinstance(argument.value, Name)  # noqa: S101 - so the grammar has it
        symbol = self.scope.find_data(argument.value.text)
        if symbol is None or not symbol.optional:
            self.error("RAPID-E127", f"{argument.value.text!r} is no optional parameter of this routine", argument.value.start)
            return lambda _: LateArgument(option, kind, ABSENT)
        slot = symbol.slot
        return lambda f: LateArgument(option, kind, ABSENT if f[slot] is ABSENT else refer(f))

    def _pending(self, library: LibraryRoutine, arguments: tuple[Argument, ...], at: int) -> None:
        if library.harmless:
            self.warn("RAPID-W201", f"read but not executed: {library.name}: {library.refused}; --lenient leaves it out", at)
        else:
            self.warn("RAPID-W203", f"not carried out: {library.name}: {library.refused}", at)
        self._look_at(arguments)

    # ---------------------------------------------------------------- binding

    def _enter(self, routine: RoutineSymbol, arguments: tuple[Argument, ...], end: int, slot: int | None) -> None:
        found = matched(routine.parameters, arguments, routine.name, end, self.error)
        binders = [self._binder(parameter, argument) for parameter, argument in zip(routine.parameters, found, strict=True)]
        code = routine.code

        def step(f: Frame) -> Enter:
            frame = [f[GLOBALS], f[TASK], None, None, *[bind(f) for bind in binders]]
            frame += [None] * (code.size - len(frame))
            return Enter(routine, frame, slot)

        self.emit(step)

    def _binder(self, parameter: ParameterInfo, argument: Argument | None) -> Run:
        if argument is None:
            return lambda _: ABSENT
        if argument.conditional:
            return self._passed_on(parameter, argument)
        if parameter.is_switch:
            return lambda _: True
        assert argument.value is not None  # noqa: S101 - `matched` has checked it
        if not parameter.mode:
            return self.value(argument.value, parameter.type).run
        operand = self.operand(argument.value, parameter.type)
        if is_signal(operand.type) and not is_signal(parameter.type) and not is_opaque(parameter.type):
            operand = self.value(argument.value, parameter.type)
        return self._reference(parameter, operand, argument)

    def _reference(self, parameter: ParameterInfo, operand: Operand, argument: Argument) -> Run:
        if not _fits_parameter(operand.type, parameter.type):
            self.error(
                "RAPID-E120",
                f"\\{parameter.name}: " * parameter.optional + f"expected {parameter.type.name}, found {operand.type.name}",
                argument.start,
            )
        elif operand.refer is None and not is_opaque(operand.type):
            mode = parameter.mode or "VAR"
            self.error("RAPID-E123", f"{parameter.name} is a parameter of mode {mode}: it needs data, not a value", argument.start)
        elif operand.storage == "CONST" and parameter.mode in ("VAR", "INOUT") and not is_opaque(operand.type):
            self.error(
                "RAPID-E122", f"{parameter.name} is a parameter of mode {parameter.mode}: a constant cannot be changed", argument.start
            )
        elif operand.storage in _MISFITS.get(parameter.mode, ()) and not operand.signal and not is_signal(operand.type):
            wanted = "persistent" if parameter.mode == "PERS" else "variable"
            self.error("RAPID-E115", f"{parameter.name} is a parameter of mode {parameter.mode}: it needs a {wanted}", argument.start)
        if operand.refer is not None and is_opaque(operand.type) and not is_opaque(parameter.type):
            refer, kind = operand.refer, parameter.type

            def checked(f: Frame) -> Value:
                reference = refer(f)
                if not conforms(reference.get(), kind):
                    raise Fault(f"{parameter.name} needs {kind.name}; the type of what is given is not known", "RAPID-R307")
                return reference

            return checked
        return operand.refer or operand.run

    def _passed_on(self, parameter: ParameterInfo, argument: Argument) -> Run:
        r"""Gives the binder of `\x?y`: what the caller itself was given for y, present or not."""
        assert isinstance(argument.value, Name)  # noqa: S101 - so the grammar has it
        symbol = self.scope.find_data(argument.value.text)
        if symbol is None or not symbol.optional:
            self.error("RAPID-E127", f"{argument.value.text!r} is no optional parameter of this routine", argument.value.start)
            return lambda _: ABSENT
        if not _fits_parameter(symbol.type, parameter.type):
            self.error("RAPID-E120", f"expected {parameter.type.name}, found {symbol.type.name}", argument.value.start)
        slot, operand = symbol.slot, self.data(symbol)
        refer = operand.refer if parameter.mode else None
        give: Run = refer or operand.run
        return lambda f: ABSENT if f[slot] is ABSENT else give(f)

    def _library_binders(self, library: LibraryRoutine, arguments: tuple[Argument, ...], end: int) -> list[Run]:
        parameters = library_parameters(library)
        found = matched(parameters, arguments, library.name, end, self.error)
        return [self._library_binder(parameter, argument) for parameter, argument in zip(parameters, found, strict=True)]

    def _library_binder(self, parameter: ParameterInfo, argument: Argument | None) -> Run:
        if argument is None:
            absent = False if parameter.is_switch else None
            return lambda _: absent
        if argument.conditional:
            bind = self._passed_on(parameter, argument)
            return lambda f: None if (value := bind(f)) is ABSENT else value
        if parameter.is_switch:
            return lambda _: True
        assert argument.value is not None  # noqa: S101 - `matched` has checked it
        if parameter.mode:
            target = self.operand(argument.value, parameter.type)
            refer, target_type = self._reference(parameter, target, argument), target.type
            return refer if not (parameter.type is ANYDATA or parameter.type is NUMERICDATA) else lambda f: (target_type, refer(f))
        operand = self.value(argument.value, parameter.type)
        if operand.storage in _MISFITS["PERS"] and operand.type.name in _PERSISTENT_TYPES:
            # ASSUMPTION A-243
            self.warn("RAPID-W209", f"a controller takes only PERS data for {parameter.name}", argument.start)
        if parameter.type is ANYTYPE:
            kind, run = operand.type, operand.run
            return lambda f: (kind, run(f))
        return operand.run

    def _perform(self, library: LibraryRoutine, binders: list[Run], at: int, slot: int | None) -> None:
        where = self.source_line(at)
        run = library.run
        assert run is not None  # noqa: S101 - callers have checked it
        if library.task:
            self.emit(lambda f: Perform(run(f[TASK], where, *[bind(f) for bind in binders]), slot))
        else:
            self.emit(lambda f: Perform(run(where, *[bind(f) for bind in binders]), slot))


def _fits_parameter(given: RapidType, wanted: RapidType) -> bool:
    if wanted.name == "num or dnum":
        return given in (NUM, DNUM) or is_opaque(given)
    return fits(given, wanted) or (wanted is SWITCH and given is SWITCH)


def _fixed(run: Run) -> Run:
    return lambda f: FixedReference(run(f))


def _applied(library: LibraryRoutine, binders: list[Run], at: int) -> Run:
    run = library.run
    assert run is not None  # noqa: S101 - callers have checked it
    name, task = library.name, library.task

    def apply(f: Frame) -> Value:
        try:
            return run(*[f[TASK]] * task, *[bind(f) for bind in binders])
        except (ArithmeticError, ValueError, LookupError) as problem:
            raise Fault(f"{name}: {problem}", "RAPID-R332", start=at) from problem

    return apply
