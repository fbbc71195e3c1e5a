"""Expressions to code: names, components, elements, aggregates and operators, with their types checked.

Invariant: an expression with a call or a signal in it adds steps that put the results into temporary slots first,
in the order of the text; what remains is a function of the frame without effects.
"""

from __future__ import annotations

from typing import assert_never

from rapid_interp.effects import ReadSignal
from rapid_interp.errors import diagnostic
from rapid_interp.meaning import operators
from rapid_interp.meaning.compiler import Compiler, Operand, conforming, constant, failed, folded
from rapid_interp.meaning.elements import checked, element, single
from rapid_interp.meaning.named_numbers import ERROR_NAMES
from rapid_interp.meaning.predefined import DATA, ERROR_PREFIX
from rapid_interp.meaning.symbols import GLOBALS, DataSymbol, Frame, Run, did_you_mean
from rapid_interp.meaning.types import (
    ANY,
    BOOL,
    DNUM,
    NUM,
    OPAQUE_DEFAULT,
    STRING,
    SYNCIDENT,
    WORLD_ZONES,
    Array,
    Atomic,
    RapidType,
    Record,
    Value,
    fits,
    is_opaque,
    is_signal,
)
from rapid_interp.reading.tree import (
    Aggregate,
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
from rapid_interp.running.values import ABSENT, Fault, FixedReference, PartReference, SlotReference, error_number

SIGNAL_PREFIXES = ("di", "do", "gi", "go", "ai", "ao")
"""ASSUMPTION A-36: an undeclared name that begins so, followed by a digit, `_` or a capital, is a signal of the controller."""
SIGNAL_OR_NAME = "signal or its name"
_CONFIGURED = frozenset({"taskid", "mecunit", "syncident"})


class ExpressionCompiler(Compiler):
    """Compiles expressions. Function calls are added by a subclass."""

    def value(self, node: Expression, wanted: RapidType = ANY) -> Operand:
        """Gives the operand for an expression whose value must be of the wanted type."""
        operand = self.operand(node, wanted)
        if operand.signal or is_signal(operand.type):
            if is_signal(wanted) or wanted.name == SIGNAL_OR_NAME:
                return operand
            operand = self.read_signal(operand, node.start)
        if operand.type is NUM and operand.constant:
            if wanted is DNUM:
                return Operand(DNUM, operand.run, constant=True)
            if wanted is NUM:
                return single(operand)
        if wanted.name == "num or dnum":
            if operand.type not in (NUM, DNUM) and not is_opaque(operand.type):
                self.error("RAPID-E120", f"expected num or dnum, found {operand.type.name}", node.start)
        elif not fits(operand.type, wanted):
            self.error("RAPID-E120", f"expected {wanted.name}, found {operand.type.name}", node.start)
            return failed(wanted)
        if is_opaque(operand.type) and not is_opaque(wanted):
            return conforming(operand, wanted)
        return operand

    def operand(self, node: Expression, wanted: RapidType) -> Operand:
        """Gives the operand for an expression; `wanted` gives aggregates their type and is not checked here."""
        match node:
            case Number():
                return constant(NUM, node.value)
            case Name():
                return self.name(node, wanted)
            case Text():
                return constant(STRING, node.value)
            case Truth():
                return constant(BOOL, node.value)
            case Aggregate():
                return self.aggregate(node, wanted)
            case Binary():
                return self.binary(node)
            case Unary():
                return self.unary(node)
            case Index():
                return self.index(node)
            case Component():
                return self.component(node)
            case Call():
                return self.call(node)
            case Placeholder():
                self.warn("RAPID-W201", f"not executed: the placeholder {node.text}", node.start)
                return failed()
            case _:
                assert_never(node)

    def call(self, node: Call) -> Operand:
        """Gives the operand for a function call."""
        raise NotImplementedError

    # ---------------------------------------------------------------- names

    def name(self, node: Name, wanted: RapidType) -> Operand:
        """Gives the operand for a name."""
        symbol = self.scope.find_data(node.text)
        if symbol is not None:
            return self.data(symbol)
        key = node.text.lower()
        predefined = DATA.get(key)
        if predefined is not None:
            _, kind, value = predefined
            if key in ("errno", "intno"):
                return Operand(NUM, lambda f: f[1].error_number if key == "errno" else f[1].interrupts.current)
            return Operand(kind, lambda _: value, lambda _: FixedReference(value), "CONST", constant=True)
        if key.startswith(ERROR_PREFIX) or key in ERROR_NAMES:
            return constant(NUM, error_number(key))
        if is_signal(wanted) or wanted.name == SIGNAL_OR_NAME:
            self.findings.signals.add(key)
            return self.signal(node.text, wanted)
        if wanted.name in _CONFIGURED:
            return constant(wanted, node.text.lower() if wanted is SYNCIDENT else node.text)
        if wanted not in (ANY, NUM, DNUM) and not is_opaque(wanted) and wanted.name != "num or dnum":
            self.error(self.unknown_code(node.text), self.unknown(node.text), node.start)
            return failed(wanted)
        unknown = diagnostic(self.source, node.start, self.unknown_code(node.text), self.unknown(node.text))
        if not looks_like_signal(node.text):
            self.findings.maybe_signals.append((key, unknown))
        return self.signal(node.text, ANY)

    def unknown_code(self, name: str) -> str:
        """Gives the code for a name that is not known here."""
        return "RAPID-E108" if name.lower() in self.findings.local_names else "RAPID-E101"

    def unknown(self, name: str) -> str:
        """Gives the message for a name that nothing declares."""
        if self.scope.find_routine(name):
            return f"{name!r} is a routine, not data; a function call needs parentheses"
        if (owner := self.findings.local_names.get(name.lower())) is not None:
            return f"{name!r} is LOCAL in module {owner}"
        return f"unknown name {name!r}{self.findings.hint(name, self.scope.data_names() + [entry[0] for entry in DATA.values()])}"

    def signal(self, name: str, kind: RapidType) -> Operand:
        """Gives the operand for a signal known by its name."""
        return Operand(kind, lambda _: name, lambda _: FixedReference(name), "VAR", signal=name)

    def data(self, symbol: DataSymbol) -> Operand:
        """Gives the operand for declared data."""
        slot = symbol.slot
        if symbol.type is SYNCIDENT and symbol.storage != "parameter":
            return constant(SYNCIDENT, symbol.name.lower())
        if symbol.fixed:
            fixed = symbol.fixed[0]
            return Operand(symbol.type, lambda _: fixed, lambda _: FixedReference(fixed), symbol.storage, constant=True)
        run: Run
        refer: Run
        if isinstance(symbol.type, Array):
            return self._array(symbol)
        if symbol.is_global:

            def run(f: Frame) -> Value:
                return f[GLOBALS][slot]

            def refer(f: Frame) -> Value:
                return SlotReference(f[GLOBALS], slot)
        elif symbol.by_reference:
            name = symbol.name

            def refer(f: Frame) -> Value:
                if f[slot] is ABSENT:
                    raise Fault(f"the optional argument {name!r} was not given", "RAPID-R340")
                return f[slot]

            def run(f: Frame) -> Value:
                return refer(f).get()
        elif symbol.optional:
            name = symbol.name

            def run(f: Frame) -> Value:
                value = f[slot]
                if value is ABSENT:
                    raise Fault(f"the optional argument {name!r} was not given", "RAPID-R340")
                return value

            def refer(f: Frame) -> Value:
                return SlotReference(f, slot)
        else:

            def run(f: Frame) -> Value:
                return f[slot]

            def refer(f: Frame) -> Value:
                return SlotReference(f, slot)

        return Operand(symbol.type, run, refer, symbol.storage)

    def _array(self, symbol: DataSymbol) -> Operand:
        slot, name, optional = symbol.slot, symbol.name, symbol.optional

        def refer(f: Frame) -> Value:
            if symbol.is_global:
                return SlotReference(f[GLOBALS], slot)
            if optional and f[slot] is ABSENT:
                raise Fault(f"the optional argument {name!r} was not given", "RAPID-R340")
            return f[slot] if symbol.by_reference else SlotReference(f, slot)

        def raw(f: Frame) -> Value:
            value = f[GLOBALS][slot] if symbol.is_global else f[slot]
            if value.__class__ is tuple or value.__class__ is list:
                return value
            return refer(f).raw()

        return Operand(symbol.type, lambda f: refer(f).get(), refer, symbol.storage, raw=raw)

    def read_signal(self, operand: Operand, at: int) -> Operand:
        """Gives the operand for the value of a signal; adds the steps that ask for it."""
        where = self.source_line(at)
        name = operand.run
        slot = self.new_slot()

        def ask(f: Frame) -> ReadSignal:
            signal = name(f)
            if not signal:
                raise Fault("the signal variable is not connected to a signal", "RAPID-R320")
            f[1].reply_slot = slot
            return ReadSignal(where, signal)

        self.emit(ask)
        return Operand(NUM, lambda f: f[slot])

    # ---------------------------------------------------------------- parts

    def component(self, node: Component) -> Operand:
        """Gives the operand for `base.name`."""
        base = self.operand(node.base, ANY)
        if is_opaque(base.type):
            return failed()
        place = base.type.index(node.name) if isinstance(base.type, Record) else None
        if place is None or not isinstance(base.type, Record):
            names = [name for name, _ in base.type.components] if isinstance(base.type, Record) else []
            hint = did_you_mean(node.name, names) if names else ""
            self.error("RAPID-E104", f"{base.type.name} has no component {node.name!r}{hint}", node.sign)
            return failed()
        whole, refer = base.run, base.refer
        run: Run = lambda f: whole(f)[place]  # noqa: E731 - three variants of one line
        return Operand(
            base.type.components[place][1],
            run,
            (lambda f: PartReference(refer(f), place)) if refer else None,
            base.storage,
            base.constant,
        )

    def index(self, node: Index) -> Operand:
        """Gives the operand for `base{i, j}`."""
        base = self.operand(node.base, ANY)
        places = [self.value(item, NUM) for item in node.indices]
        if is_opaque(base.type):
            return failed()
        if not isinstance(base.type, Array):
            self.error("RAPID-E126", f"{base.type.name} is no array", node.base.start)
            return failed()
        if len(places) != len(base.type.dimensions):
            count = len(base.type.dimensions)
            self.error(
                "RAPID-E124", f"the array has {count} dimension{'s' * (count > 1)}, found {len(places)} indices", node.indices[0].start
            )
            return failed()
        for item, place, size in zip(node.indices, places, base.type.dimensions, strict=True):
            if place.constant and size > 0:
                self._inside(place, size, item.start)
        checks = [checked(place.run, item.start) for item, place in zip(node.indices, places, strict=True)]
        run, refer = element(base.raw or base.run, base.refer, checks)
        return Operand(base.type.element, run, refer, base.storage)

    def _inside(self, place: Operand, size: int, at: int) -> None:
        """Warns of a constant index that can never be right; a program may want the error and handle it."""
        try:
            number = place.run([])
        except (Fault, ArithmeticError, ValueError, LookupError):
            return  # it is told where the value is computed
        if number != int(number) or not 1 <= number <= size:
            self.warn("RAPID-W208", f"index {number:g} is outside of 1..{size}", at)

    # ---------------------------------------------------------------- aggregates and operators

    def aggregate(self, node: Aggregate, wanted: RapidType) -> Operand:
        """Gives the operand for `[a, b, ...]` as the wanted type."""
        parts: list[RapidType]
        match wanted:
            case Record():
                parts = [kind for _, kind in wanted.components]
                if len(parts) != len(node.items):
                    self.error("RAPID-E125", f"{wanted.name} has {len(parts)} components, found {len(node.items)}", node.start)
                    return failed(wanted)
            case Array():
                size = wanted.dimensions[0]
                if size >= 0 and size != len(node.items):
                    self.error("RAPID-E125", f"{wanted.name} needs {size} elements here, found {len(node.items)}", node.start)
                    return failed(wanted)
                inner = wanted.element if len(wanted.dimensions) == 1 else Array(wanted.element, wanted.dimensions[1:])
                parts = [inner] * len(node.items)
            case Atomic() if wanted.name in WORLD_ZONES and len(node.items) == 1:
                self.value(node.items[0], NUM)
                return constant(wanted, wanted.default)  # ASSUMPTION A-244: a zone begins undefined, whatever a saved program says
            case Atomic():
                if not is_opaque(wanted):
                    self.error("RAPID-E120", f"expected {wanted.name}, found an aggregate", node.start)
                    return failed(wanted)
                parts = [ANY] * len(node.items)
        operands = [self.value(item, part) for item, part in zip(node.items, parts, strict=True)]
        runs = [operand.run for operand in operands]
        if all(operand.constant for operand in operands):
            try:
                value = tuple(run([]) for run in runs)
            except (Fault, ArithmeticError, ValueError, LookupError):
                return failed(wanted)
            return constant(wanted, value if wanted is not ANY else value or OPAQUE_DEFAULT)
        return Operand(wanted, lambda f: tuple([run(f) for run in runs]))

    def unary(self, node: Unary) -> Operand:
        """Gives the operand for a sign or NOT."""
        operand = self.value(node.operand)
        found = operators.unary(node.operator, operand.type, operand.run)
        if found is None:
            self.error("RAPID-E121", f"{node.operator} does not apply to {operand.type.name}", node.start)
            return failed(BOOL if node.operator == "NOT" else ANY)
        result = Operand(*found, constant=operand.constant)
        return folded(result) if operand.constant else result

    def binary(self, node: Binary) -> Operand:
        """Gives the operand for two operands and a sign."""
        left = self.value(node.left)
        if node.operator in ("AND", "OR"):
            guard = self.reserve()
            begin = self.here
            right = self.value(node.right)
            if self.here == begin:
                self.code.steps.pop()
                self.code.places.pop()
            else:
                return self._guarded(node, left, right, guard)
        else:
            right = self.value(node.right, left.type if isinstance(node.right, Aggregate) else ANY)
        if left.type is NUM and right.type is NUM:
            left, right = single(left), single(right)
        found = operators.binary(node.operator, left.type, right.type, left.run, right.run)
        if found is None:
            self.error("RAPID-E121", f"{node.operator} does not apply to {left.type.name} and {right.type.name}", node.sign)
            return failed(BOOL if node.operator in ("AND", "OR", "XOR", "=", "<>", "<", ">", "<=", ">=") else ANY)
        result = Operand(*found, constant=left.constant and right.constant)
        return folded(result) if result.constant else result

    def _guarded(self, node: Binary, left: Operand, right: Operand, guard: int) -> Operand:
        """AND or OR whose right side has steps of its own, which must not run when the left side decides."""
        for side in (left, right):
            if side.type is not BOOL and not is_opaque(side.type):
                self.error("RAPID-E121", f"{node.operator} does not apply to {left.type.name} and {right.type.name}", node.sign)
                break
        slot = self.new_slot()
        self.store(slot, right.run)
        end, first, following, decides = self.here, left.run, guard + 1, node.operator == "OR"

        def step(f: Frame) -> int:
            f[slot] = value = first(f)
            return end if value is decides else following

        self.patch(guard, step)
        return Operand(BOOL, lambda f: f[slot])


def looks_like_signal(name: str) -> bool:
    """Gives whether an undeclared name is taken for a signal of the controller."""
    return name[:2].lower() in SIGNAL_PREFIXES and len(name) > 2 and (name[2] == "_" or name[2].isdigit() or name[2].isupper())
