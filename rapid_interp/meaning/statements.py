"""Statements to steps.

Invariant: every statement begins at a step of its own with its place, so that an error in it is told where it stands.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias, assert_never

from rapid_interp.effects import StopProgram
from rapid_interp.meaning.compiler import Operand
from rapid_interp.meaning.flow import Jumps, always_leaves, is_left_behind
from rapid_interp.meaning.recovery import RecoveryCompiler
from rapid_interp.meaning.symbols import FIRST_LOCAL, GLOBALS, RESULT, TASK, DataSymbol, Frame, RoutineSymbol, Scope, did_you_mean
from rapid_interp.meaning.types import ANY, BOOL, NUM, Array, Value, default_value, is_opaque, leaves
from rapid_interp.reading.tree import (
    Assign,
    CallStatement,
    Component,
    Connect,
    Data,
    Expression,
    For,
    Goto,
    If,
    Index,
    Label,
    Name,
    Placeholder,
    Raise,
    Return,
    Routine,
    Simple,
    Statement,
    Test,
    While,
)
from rapid_interp.running.numbers import add
from rapid_interp.running.values import Fault, error_number

_COMPILED = frozenset({"waituntil", "exitcycle", "callbyvar", "resetretrycount"})
"""Instructions that are steps of their own: they go elsewhere or evaluate an argument more than once."""


class StatementCompiler(RecoveryCompiler):
    """Compiles the body of a routine."""

    def body(self, node: Routine, symbol: RoutineSymbol, local_data: LocalData) -> None:
        """Adds the steps of a whole routine. `local_data` gives the symbol of a local declaration."""
        self.jumps = Jumps(self)
        self.returns = 0
        self.scope = Scope(self.scope)
        for slot, parameter in enumerate(symbol.parameters, start=FIRST_LOCAL):
            by_reference = bool(parameter.mode)
            declared = DataSymbol(
                parameter.name, parameter.type, parameter.mode or "parameter", slot, by_reference=by_reference, optional=parameter.optional
            )
            if parameter.name.lower() in self.scope.data:
                self.error("RAPID-E105", f"{parameter.name!r} is declared twice", node.parameters[slot - FIRST_LOCAL].name.start)
            self.declare(declared)
        self.code.size = FIRST_LOCAL + len(symbol.parameters)
        for data in node.data:
            self.place = data.start
            local = local_data(self, data)
            if local is None:
                continue
            if data.storage == "PERS":
                self.error("RAPID-E134", "PERS data belongs to a module: a routine has VAR and CONST", data.start)
            if data.name.text.lower() in self.scope.data:
                self.error("RAPID-E105", f"{data.name.text!r} is declared twice", data.name.start)
            if isinstance(local.type, Array):
                self.code.elements += leaves(local.type)
            if not local.fixed:
                self._initial(data, local)
            self.declare(local)
        self.statements(node.body)
        self._end(node)
        self.code.body_end = self.here
        if node.error is not None or node.undo is not None or node.backward is not None:
            self._sections(node)
        self.jumps.finish()

    def _initial(self, data: Data, symbol: DataSymbol) -> None:
        if data.value is None:
            value = default_value(symbol.type)
            self.store(symbol.slot, lambda _: value)
            return
        operand = self.value(data.value, symbol.type)
        self.store(symbol.slot, operand.run)

    def _end(self, node: Routine) -> None:
        if node.kind == "FUNC":
            self.place = node.end - len("ENDFUNC")
            name = node.name.text
            if not always_leaves(node.body):
                if self.returns:
                    self.warn("RAPID-W205", f"FUNC {name} can end without RETURN", node.name.start)
                else:
                    self.error("RAPID-E130", f"FUNC {name} has no RETURN", node.name.start)

            def step(_: Frame) -> None:
                raise Fault(f"FUNC {name} ended without RETURN", "RAPID-R350")

            self.emit(step)
        else:
            self.emit(lambda _: None)

    def _sections(self, node: Routine) -> None:
        """Adds the steps of UNDO and ERROR; BACKWARD comes before them only for the errors in it: programs never run backwards here."""
        self.statements(node.backward or ())
        self.emit(lambda _: None)
        if node.undo is not None:
            self.code.undo = self.here
            self.statements(node.undo)
            self.emit(lambda _: None)
        if node.error is not None:
            self.in_handler = True
            self.handler_numbers(node.error)
            self.statements(node.error.body)
            self.emit(lambda _: None)

    def statements(self, nodes: tuple[Statement, ...]) -> None:
        """Adds the steps of statements in a row."""
        self.jumps.enter()
        for place, node in enumerate(nodes):
            self.place = node.start
            begin = self.here
            if place and is_left_behind(nodes[place - 1]) and not isinstance(node, Label):
                self.warn("RAPID-W207", "nothing comes here: the statement before goes elsewhere", node.start)
            self.statement(node)
            end = self.here
            for step in range(begin, end):
                self.code.statements.setdefault(step, (begin, end))
        self.jumps.leave()

    def statement(self, node: Statement) -> None:
        """Adds the steps of a statement."""
        match node:
            case Assign():
                self._assign(node)
            case CallStatement():
                self._call(node)
            case If():
                self._if(node)
            case While():
                self._while(node)
            case For():
                self._for(node)
            case Test():
                self._test(node)
            case Return():
                self._return(node)
            case Goto():
                self.jumps.jump(node)
            case Label():
                self.jumps.label(node)
            case Simple(keyword="EXIT"):
                where = self.source_line(node.start)
                self.emit(lambda _: StopProgram(where, exits=True))
            case Raise():
                self.raise_(node)
            case Connect():
                self._connect(node)
            case Simple():
                self.retry(node)
            case Placeholder():
                self._refuse(f"the placeholder {node.text}", node.start)
            case _:
                assert_never(node)

    def _call(self, node: CallStatement) -> None:
        name = node.name.text.lower() if isinstance(node.name, Name) else ""
        if name not in _COMPILED or self.scope.find_routine(name):
            self.call_statement(node)
        elif name == "waituntil":
            self.wait_until(node)
        elif name == "callbyvar":
            self.call_by_var(node)
        elif name == "resetretrycount":
            self.reset_retries()
        else:
            self.exit_cycle()

    def _refuse(self, what: str, at: int) -> None:
        self.warn("RAPID-W201", f"not executed yet: {what}", at)

        def step(_: Frame) -> None:
            raise Fault(f"not executed yet: {what}", "RAPID-R390")

        self.emit(step)

    def _connect(self, node: Connect) -> None:
        interrupt = self.operand(node.interrupt, ANY)
        trap = self.scope.find_routine(node.trap.text)
        if trap is None or trap.kind != "TRAP":
            traps = [name for name in self.scope.routine_names() if (found := self.scope.find_routine(name)) and found.kind == "TRAP"]
            self.error("RAPID-E102", f"unknown trap {node.trap.text!r}{did_you_mean(node.trap.text, traps)}", node.trap.start)
            return
        if interrupt.signal:
            self.error("RAPID-E101", self.unknown(interrupt.signal), node.interrupt.start)
        elif interrupt.type is not NUM:
            self.error("RAPID-E120", f"expected intnum, found {interrupt.type.name}", node.interrupt.start)
        elif interrupt.refer is None or interrupt.storage == "CONST":
            self.error("RAPID-E123", "CONNECT needs a variable of type intnum", node.interrupt.start)
        if interrupt.type is not NUM or interrupt.refer is None:
            return
        refer, following = interrupt.refer, self.here + 1

        def step(f: Frame) -> int:
            reference, interrupts = refer(f), f[TASK].interrupts
            if reference.get() in interrupts.traps:
                raise Fault("the interrupt is connected to a trap already", "RAPID-R341", number=error_number("ERR_ALRDYCNT"))
            reference.put(float(interrupts.connect(trap)))
            return following

        self.emit(step)

    # ---------------------------------------------------------------- assignment and return

    def _assign(self, node: Assign) -> None:
        target = self.operand(node.target, ANY)
        value = self.value(node.value, target.type)
        if target.signal:
            self.error("RAPID-E101", self.unknown(target.signal), node.target.start)
            return
        if target.storage == "CONST":
            self.error(
                "RAPID-E122",
                f"{self.source.text[node.target.start : node.target.end]} is a constant and cannot be changed",
                node.target.start,
            )
            return
        if target.storage == "loop":
            self.warn("RAPID-W204", "the loop variable is read-only on a controller", node.target.start)
        if target.refer is None:
            if not is_opaque(target.type):
                self.error("RAPID-E123", "this cannot be assigned to", node.target.start)
            else:
                self._refuse("data of a type that is not known", node.start)
            return
        self._store_into(node.target, target, value)

    def _store_into(self, node: Expression, target: Operand, value: Operand) -> None:
        run, following = value.run, self.here + 1
        symbol = self.scope.find_data(node.text) if isinstance(node, Name) else None
        if symbol is not None and symbol.is_global:
            slot = symbol.slot

            def step(f: Frame) -> int:
                f[GLOBALS][slot] = run(f)
                return following
        elif symbol is not None and not symbol.by_reference:
            slot = symbol.slot

            def step(f: Frame) -> int:
                f[slot] = run(f)
                return following
        else:
            refer = target.refer
            assert refer is not None  # noqa: S101 - the caller has checked it
            assert isinstance(node, Name | Index | Component)  # noqa: S101 - nothing else has a reference

            def step(f: Frame) -> int:
                new = run(f)
                refer(f).put(new)
                return following

        self.emit(step)

    def _return(self, node: Return) -> None:
        self.returns += 1
        result = self.routine.result if self.routine else None
        if node.value is None:
            if result is not None:
                self.error("RAPID-E131", "RETURN in a FUNC needs a value", node.start)
            self.emit(lambda _: None)
            return
        if result is None:
            kind = self.routine.kind if self.routine else "PROC"
            self.error("RAPID-E131", f"RETURN in a {kind} takes no value", node.value.start)
            return
        run = self.value(node.value, result).run

        def step(f: Frame) -> None:
            f[RESULT] = run(f)

        self.emit(step)

    # ---------------------------------------------------------------- branches and loops

    def _condition(self, node: Expression) -> Operand:
        return self.value(node, BOOL)

    def _if(self, node: If) -> None:
        ends: list[int] = []
        for branch in node.branches:
            self.place = branch.condition.start
            condition = self._condition(branch.condition)
            guard = self.reserve()
            self.statements(branch.body)
            ends.append(self.reserve())
            self.jump_unless(guard, condition.run, self.here)
        if node.otherwise is not None:
            self.statements(node.otherwise)
        for end in ends:
            self.jump(end, self.here)

    def _while(self, node: While) -> None:
        begin = self.here
        condition = self._condition(node.condition)
        guard = self.reserve()
        self.statements(node.body)
        self.place = node.start
        self.jump(self.reserve(), begin)
        self.jump_unless(guard, condition.run, self.here)

    def _for(self, node: For) -> None:
        first = self.value(node.first, NUM)
        last = self.value(node.last, NUM)
        step = self.value(node.step, NUM) if node.step is not None else None
        variable, limit, width = self.new_slot(), self.new_slot(), self.new_slot()
        begin, end, by = first.run, last.run, step.run if step else None
        following = self.here + 1

        def start(f: Frame) -> int:
            f[variable], f[limit] = begin(f), end(f)
            f[width] = by(f) if by else (1.0 if f[limit] >= f[variable] else -1.0)
            return following

        self.emit(start)
        guard = self.reserve()
        self.scope = Scope(self.scope)
        self.declare(DataSymbol(node.variable.text, NUM, "loop", variable))
        self.statements(node.body)
        assert self.scope.outer is not None  # noqa: S101 - set two lines above
        self.scope = self.scope.outer
        self.place = node.start
        body, after = guard + 1, self.here + 1

        def inside(f: Frame) -> bool:
            return bool(f[variable] <= f[limit] if f[width] >= 0 else f[variable] >= f[limit])

        def advance(f: Frame) -> int:
            f[variable] = add(f[variable], f[width])
            return body if inside(f) else after

        self.emit(advance)
        self.patch(guard, lambda f: body if inside(f) else after)

    def _test(self, node: Test) -> None:
        subject = self.value(node.subject)
        slot = self.new_slot()
        self.store(slot, subject.run)
        ends: list[int] = []
        for case in node.cases:
            self.place = case.values[0].start
            values = [self.value(value, ANY if is_opaque(subject.type) else subject.type) for value in case.values]
            runs = [value.run for value in values]
            guard = self.reserve()
            self.statements(case.body)
            ends.append(self.reserve())
            self.jump_unless(guard, _any_equal(slot, runs), self.here)
        if node.default is not None:
            self.statements(node.default)
        for end in ends:
            self.jump(end, self.here)


def _any_equal(slot: int, runs: list[Callable[[Frame], Value]]) -> Callable[[Frame], Value]:
    return lambda f: any(run(f) == f[slot] for run in runs)


LocalData: TypeAlias = Callable[[StatementCompiler, Data], DataSymbol | None]
