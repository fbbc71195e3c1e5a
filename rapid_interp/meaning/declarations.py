"""Declarations of a whole program: types, data and routines of all modules, with initial values computed.

Invariant: an initial value is computed when it is first asked for, so that the order of declarations does not matter.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from rapid_interp.errors import Severity
from rapid_interp.meaning.calls import CallCompiler
from rapid_interp.meaning.compiler import Findings
from rapid_interp.meaning.predefined import USER_DATA
from rapid_interp.meaning.statements import StatementCompiler
from rapid_interp.meaning.symbols import Code, DataSymbol, Frame, ParameterInfo, RoutineSymbol, Scope
from rapid_interp.meaning.types import ANY, NUM, PREDEFINED, Array, RapidType, Record, Value, default_value, leaves
from rapid_interp.reading.modules import Parsed
from rapid_interp.reading.tree import AliasType, Data, Expression, Module, Name, Placeholder, RecordType, Routine
from rapid_interp.running.values import Fault
from rapid_interp.source import SourceText

USER = "user"
_BUILT_IN = frozenset({"num", "dnum", "bool", "string", "switch", "pos", "orient", "pose", "clock"})
"""Types that operators and statements know by name; a program cannot give their names another meaning."""
MAX_ELEMENTS = 1_000_000
"""Elements of an array; more is taken for a mistake before it fills the memory."""
MAX_COMPONENTS = 1000
"""Components of a record, those of its components included."""
MAX_DATA = 4_000_000
"""Atomic values of all data of a program."""
_UNSET = object()


class _Globals(list[Value]):
    """The initial values of all module data; one that is not there yet is computed when it is read."""

    def __init__(self) -> None:
        super().__init__()
        self.pending: dict[int, Callable[[], Value]] = {}

    def __getitem__(self, slot: int) -> Value:  # type: ignore[override]
        compute = self.pending.pop(slot, None)
        if compute is not None:
            self[slot] = compute()
        value = super().__getitem__(slot)
        if value is _UNSET:
            raise Fault("the initial value depends on itself")
        return value


class _NoTask:
    """Stands where the running task would be: what asks it for something is no constant."""

    def __getattr__(self, name: str) -> Value:
        raise Fault("it is known only while the program runs")


class Declarations:
    """The names of a program. After `declare_all`, `globals` holds the initial values and `routines` what to compile."""

    def __init__(self, findings: Findings, everywhere: Scope | None = None, values: Sequence[Value] = ()) -> None:
        """With `everywhere`, what is declared joins the names and values of a program that runs."""
        self.findings = findings
        self._joins = everywhere is not None
        self.everywhere = everywhere or Scope()
        if not self._joins:
            self.everywhere.types.update(PREDEFINED)
        self.scopes: dict[str, Scope] = {}
        self.globals = _Globals()
        self.globals.extend(values)
        self.data: list[DataSymbol] = []
        self.routines: list[tuple[RoutineSymbol, Routine, CallCompiler]] = []
        self._frame: Frame = [self.globals, _NoTask(), None, None]
        self._in_work: set[tuple[str, str]] = set()
        self._taken: dict[str, set[str]] = {}
        self._public: dict[str, str] = {}
        self._type_nodes: dict[tuple[str, str], tuple[RecordType | AliasType, CallCompiler]] = {}

    def declare_all(self, parsed: Sequence[Parsed]) -> None:
        """Declares everything in these texts."""
        units: list[tuple[Module, CallCompiler]] = []
        for text in parsed:
            for module in text.modules:
                units.append((module, self._module(module, text.source)))
        for module, unit in units:
            for node in module.declarations:
                if isinstance(node, RecordType | AliasType):
                    if node.name.text.lower() in _BUILT_IN:
                        unit.error("RAPID-E105", f"{node.name.text!r} is a type of the language and cannot be declared", node.name.start)
                        continue
                    self._claim(unit, node.name, node.scope)
                    self._not_task(unit, node)
                    self._type_nodes[unit.module.lower(), node.name.text.lower()] = node, unit
        for key in list(self._type_nodes):
            self._declare_type(key)
        arrays: list[tuple[Data, CallCompiler]] = []
        for module, unit in units:
            for node in module.declarations:
                if isinstance(node, Data):
                    self._claim(unit, node.name, node.scope)
                    self._not_task(unit, node)
                    if node.dimensions:
                        arrays.append((node, unit))
                    else:
                        self._declare_data(unit, node)
                elif isinstance(node, Routine):
                    self._declare_routine(unit, node)
                elif isinstance(node, Placeholder):
                    unit.warn("RAPID-W201", f"not executed: the placeholder {node.text}", node.start)
        for node, unit in arrays:
            self._declare_data(unit, node)
        if not self._joins:
            self._user_data()
        self._compute()

    def _module(self, module: Module, source: SourceText) -> CallCompiler:
        scope = Scope(self.everywhere)
        unit = CallCompiler(source, module.name.text, scope, self.findings)
        if module.name.text.lower() in self.scopes:
            unit.error("RAPID-E105", f"a second module {module.name.text!r} in the same program", module.name.start)
        else:
            self.scopes[module.name.text.lower()] = scope
        return unit

    def _claim(self, unit: CallCompiler, name: Name, scope: str) -> None:
        """Reports a name that is declared twice in a module, or by two modules for the whole program."""
        key = name.text.lower()
        taken = self._taken.setdefault(unit.module.lower(), set())
        if key in taken:
            unit.error("RAPID-E105", f"{name.text!r} is declared twice in module {unit.module}", name.start)
            return
        taken.add(key)
        if scope == "LOCAL":
            self.findings.local_names[key] = unit.module
        else:
            known = (self.everywhere.find_data(name.text) or self.everywhere.find_routine(name.text)) if self._joins else None
            owner = self._public.setdefault(key, known.module if known else unit.module)
            if owner != unit.module:
                unit.error("RAPID-E105", f"{name.text!r} is declared by module {owner} too; one of them must be LOCAL", name.start)

    def _not_task(self, unit: CallCompiler, node: Data | RecordType | AliasType | Routine) -> None:
        if isinstance(node, Data) and node.storage == "CONST" and node.value is None:
            unit.error("RAPID-E141", f"the constant {node.name.text!r} has no value", node.name.start)
        if node.scope == "TASK" and not (isinstance(node, Data) and node.storage in ("VAR", "PERS")):
            unit.error("RAPID-E109", "TASK belongs before VAR or PERS: only data can be a task's own", node.start)

    # ---------------------------------------------------------------- types

    def _declare_type(self, key: tuple[str, str]) -> RapidType:
        node, unit = self._type_nodes[key]
        known = unit.scope.types.get(key[1])
        if known is not None:
            return known
        if key in self._in_work:
            unit.error("RAPID-E107", f"the type {node.name.text!r} contains itself", node.name.start)
            return ANY
        self._in_work.add(key)
        made: RapidType
        if isinstance(node, AliasType):
            made = self.find_type(unit, node.type_name)
        else:
            made = Record(node.name.text, tuple((part.name.text, self.find_type(unit, part.type_name)) for part in node.fields))
            if leaves(made) > MAX_COMPONENTS:  # checked at every record, so that counting stays cheap
                unit.error("RAPID-E128", f"the record would have more than {MAX_COMPONENTS} components in all", node.name.start)
                made = ANY
        self._in_work.discard(key)
        unit.scope.types[key[1]] = made
        if node.scope != "LOCAL":
            self.everywhere.types.setdefault(key[1], made)
        return made

    def find_type(self, unit: CallCompiler, name: Name) -> RapidType:
        """Gives the type of this name, declaring it if its turn has not come."""
        key = name.text.lower()
        found = unit.scope.find_type(name.text)
        if found is not None and (unit.module.lower(), key) not in self._type_nodes:
            return found
        for candidate in self._type_nodes:
            if candidate == (unit.module.lower(), key) or (candidate[1] == key and self._type_nodes[candidate][0].scope != "LOCAL"):
                return self._declare_type(candidate)
        if found is not None:
            return found
        known = [*unit.scope.types, *self.everywhere.types, *(node.name.text for node, _ in self._type_nodes.values())]
        unit.error("RAPID-E103", f"unknown type {name.text!r}{self.findings.hint(name.text, known)}", name.start)
        return ANY

    def _shaped(self, unit: CallCompiler, element: RapidType, dimensions: tuple[Expression, ...]) -> RapidType:
        """Gives the array type with these dimensions, whose sizes must be constant."""
        if not dimensions:
            return element
        sizes: list[int] = []
        total = 1
        if len(dimensions) > 3:
            unit.error("RAPID-E124", f"an array has at most 3 dimensions, found {len(dimensions)}", dimensions[3].start)
        for node in dimensions:
            size = self.constant(unit, node, NUM)
            if isinstance(size, float) and (size < 0 or size != size // 1):
                unit.error("RAPID-E128", f"the size of an array is a whole number, found {size:g}", node.start)
            elif isinstance(size, float) and total * size * leaves(element) > MAX_ELEMENTS:
                unit.error("RAPID-E128", f"the array would have more than {MAX_ELEMENTS} elements", node.start)
            elif isinstance(size, float):
                sizes.append(int(size))
                total *= max(1, int(size))
        return Array(element, tuple(sizes)) if len(sizes) == len(dimensions) <= 3 else ANY

    # ---------------------------------------------------------------- data

    def constant(self, unit: CallCompiler, node: Expression, wanted: RapidType) -> Value | None:
        """Gives the value of a constant expression, or None after reporting why there is none."""
        begin, known = unit.here, len(self.findings.diagnostics)
        operand = unit.value(node, wanted)
        if unit.here != begin:
            unit.error("RAPID-E140", "an initial value must be constant: no calls of the program's functions, no signals", node.start)
            return None
        if self._wrong(known):
            return None
        try:
            return operand.run(self._frame)
        except (Fault, ArithmeticError, ValueError, LookupError) as problem:
            if len(self.findings.diagnostics) == known:
                unit.error("RAPID-E140", f"the constant cannot be computed: {problem}", node.start)
            return None

    def _wrong(self, known: int) -> bool:
        """Gives whether there are errors beyond the first `known` findings: what has one is not computed."""
        return any(found.severity is Severity.ERROR for found in self.findings.diagnostics[known:])

    def _declare_data(self, unit: CallCompiler, node: Data) -> None:
        kind = self._shaped(unit, self.find_type(unit, node.type_name), node.dimensions)
        self.findings.elements += leaves(kind)
        if self.findings.elements > MAX_DATA:
            unit.error("RAPID-E128", f"the program's data would have more than {MAX_DATA} values", node.name.start)
            kind = ANY
            self.findings.elements = 0
        slot = len(self.globals)
        symbol = DataSymbol(node.name.text, kind, node.storage, slot, is_global=True, module=unit.module, scope=node.scope)
        self.globals.append(_UNSET)
        self.data.append(symbol)
        self._publish(unit, symbol)

        def compute() -> Value:
            value = self.constant(unit, node.value, kind) if node.value is not None else None
            return default_value(kind) if value is None else value

        self.globals.pending[slot] = compute

    def _user_data(self) -> None:
        scope = self.scopes.setdefault(USER, Scope(self.everywhere))
        for name, type_name in USER_DATA.items():
            if name not in self.everywhere.data:
                kind = PREDEFINED[type_name]
                symbol = DataSymbol(name, kind, "VAR", len(self.globals), is_global=True, module=USER)
                self.globals.append(default_value(kind))
                self.data.append(symbol)
                self.everywhere.data[name] = scope.data[name] = symbol

    def _publish(self, unit: CallCompiler, symbol: DataSymbol) -> None:
        unit.scope.data.setdefault(symbol.name.lower(), symbol)
        if symbol.scope != "LOCAL":
            self.everywhere.data.setdefault(symbol.name.lower(), symbol)

    def _compute(self) -> None:
        for place, symbol in enumerate(self.data):
            value = self.globals[symbol.slot]
            if symbol.storage == "CONST":
                fixed = self.data[place] = replace(symbol, fixed=(value,))
                for scope in (self.scopes[symbol.module.lower()], self.everywhere):
                    if scope.data.get(symbol.name.lower()) is symbol:
                        scope.data[symbol.name.lower()] = fixed

    def local_data(self, unit: StatementCompiler, node: Data) -> DataSymbol | None:
        """Gives the symbol of data declared in a routine."""
        kind = self._shaped(unit, self.find_type(unit, node.type_name), node.dimensions)
        fixed: tuple[Value, ...] = ()
        if node.storage == "CONST" and node.value is not None:
            begin, known = unit.here, len(self.findings.diagnostics)
            operand = unit.value(node.value, kind)
            try:
                fixed = (operand.run(self._frame),) if unit.here == begin and not self._wrong(known) else ()
            except (Fault, ArithmeticError, ValueError, LookupError):
                del self.findings.diagnostics[known:]  # they come again when the value is compiled as a step
        return DataSymbol(node.name.text, kind, node.storage, unit.new_slot(), fixed=fixed)

    # ---------------------------------------------------------------- routines

    def _declare_routine(self, unit: CallCompiler, node: Routine) -> None:
        self._claim(unit, node.name, node.scope)
        self._not_task(unit, node)
        parameters: list[ParameterInfo] = []
        for parameter in node.parameters:
            kind = self.find_type(unit, parameter.type_name)
            if parameter.rank:
                kind = Array(kind, (-1,) * parameter.rank)
            parameters.append(ParameterInfo(parameter.name.text, kind, parameter.mode, parameter.optional, parameter.group))
        result = self.find_type(unit, node.type_name) if node.type_name is not None else None
        symbol = RoutineSymbol(node.name.text, node.kind, tuple(parameters), result, unit.module, node.scope, unit.source, Code())
        unit.scope.routines.setdefault(symbol.name.lower(), symbol)
        if node.scope != "LOCAL":
            self.everywhere.routines.setdefault(symbol.name.lower(), symbol)
        self.routines.append((symbol, node, unit))
