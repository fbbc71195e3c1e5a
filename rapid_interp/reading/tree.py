"""The syntax tree of RAPID. `start` and `end` are offsets into the source text.

Invariant: nodes are immutable and hold what was written, not what it means. They are named tuples because a
tree has a node for every other token and frozen dataclasses take four times as long to make.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias


class Name(NamedTuple):
    """An identifier where an expression may stand."""

    text: str
    start: int
    end: int


class Number(NamedTuple):
    """A numeric literal; in aggregates the sign belongs to it."""

    text: str
    value: float
    start: int
    end: int


class Text(NamedTuple):
    """A string literal."""

    text: str
    value: str
    start: int
    end: int


class Truth(NamedTuple):
    """TRUE or FALSE."""

    value: bool
    start: int
    end: int


class Aggregate(NamedTuple):
    """`[a, b, ...]`: a record or an array."""

    items: tuple[Expression, ...]
    start: int
    end: int


class Unary(NamedTuple):
    """A sign or NOT before an operand."""

    operator: str
    operand: Expression
    start: int
    end: int


class Binary(NamedTuple):
    """Two operands; `sign` is the offset of the operator between them."""

    operator: str
    left: Expression
    right: Expression
    sign: int
    start: int
    end: int


class Index(NamedTuple):
    """`base{i, j, k}`."""

    base: Expression
    indices: tuple[Expression, ...]
    start: int
    end: int


class Component(NamedTuple):
    """`base.name`; `sign` is the offset of the name."""

    base: Expression
    name: str
    sign: int
    start: int
    end: int


class Call(NamedTuple):
    """A function call."""

    name: Name
    arguments: tuple[Argument, ...]
    start: int
    end: int


class Placeholder(NamedTuple):
    r"""A gap left by an editor, such as `<EXP>` or `<SMT>`: may be read, not run."""

    text: str
    start: int
    end: int


Expression: TypeAlias = Name | Number | Text | Truth | Aggregate | Unary | Binary | Index | Component | Call | Placeholder


class Argument(NamedTuple):
    r"""An argument. `option` is the name after a backslash; `conditional` is `\x?y`, pass `y` on if present.

    `label` is the parameter that a required argument names: `Dist:=3.5`.
    """

    option: str
    value: Expression | None
    conditional: bool
    start: int
    end: int
    label: str = ""


class Assign(NamedTuple):
    """`target := value;`."""

    target: Expression
    value: Expression
    start: int
    end: int


class CallStatement(NamedTuple):
    """A procedure or instruction with its arguments; `name` is an expression in the late-bound form `%name%`."""

    name: Name | LateName
    arguments: tuple[Argument, ...]
    start: int
    end: int


class LateName(NamedTuple):
    """`%expression%`: the name of a procedure, known only when it is called."""

    value: Expression
    start: int
    end: int


class Branch(NamedTuple):
    """A condition with its statements."""

    condition: Expression
    body: tuple[Statement, ...]


class If(NamedTuple):
    """IF with its ELSEIFs; `otherwise` is None without ELSE; `compact` is `IF condition statement;`."""

    branches: tuple[Branch, ...]
    otherwise: tuple[Statement, ...] | None
    compact: bool
    start: int
    end: int


class While(NamedTuple):
    """WHILE condition DO body."""

    condition: Expression
    body: tuple[Statement, ...]
    start: int
    end: int


class For(NamedTuple):
    """FOR variable FROM first TO last STEP step DO body."""

    variable: Name
    first: Expression
    last: Expression
    step: Expression | None
    body: tuple[Statement, ...]
    start: int
    end: int


class Case(NamedTuple):
    """The values of a CASE and its statements."""

    values: tuple[Expression, ...]
    body: tuple[Statement, ...]


class Test(NamedTuple):
    """TEST subject with its CASEs; `default` is None without DEFAULT."""

    subject: Expression
    cases: tuple[Case, ...]
    default: tuple[Statement, ...] | None
    start: int
    end: int


class Goto(NamedTuple):
    """GOTO label."""

    label: Name
    start: int
    end: int


class Label(NamedTuple):
    """`name:`, the target of a GOTO."""

    name: str
    start: int
    end: int


class Return(NamedTuple):
    """RETURN, with a value in functions."""

    value: Expression | None
    start: int
    end: int


class Raise(NamedTuple):
    """RAISE, with an error number outside of error handlers."""

    value: Expression | None
    start: int
    end: int


class Simple(NamedTuple):
    """RETRY, TRYNEXT or EXIT."""

    keyword: str
    start: int
    end: int


class Connect(NamedTuple):
    """CONNECT interrupt WITH trap."""

    interrupt: Expression
    trap: Name
    start: int
    end: int


Statement: TypeAlias = Assign | CallStatement | If | While | For | Test | Goto | Label | Return | Raise | Simple | Connect | Placeholder


class Data(NamedTuple):
    """A CONST, VAR or PERS. `scope` is LOCAL, TASK or empty."""

    scope: str
    storage: str
    type_name: Name
    name: Name
    dimensions: tuple[Expression, ...]
    value: Expression | None
    start: int
    end: int


class Field(NamedTuple):
    """A component of a RECORD declaration."""

    type_name: Name
    name: Name


class RecordType(NamedTuple):
    """RECORD name with its components."""

    scope: str
    name: Name
    fields: tuple[Field, ...]
    start: int
    end: int


class AliasType(NamedTuple):
    """ALIAS type name."""

    scope: str
    type_name: Name
    name: Name
    start: int
    end: int


class Parameter(NamedTuple):
    """A parameter. `mode` is empty (IN), INOUT, VAR or PERS; `rank` counts the dimensions `{*,*}`; parameters that
    exclude each other share a `group` that is not 0.
    """

    optional: bool
    group: int
    mode: str
    type_name: Name
    name: Name
    rank: int
    start: int
    end: int


class ErrorHandler(NamedTuple):
    """The ERROR section of a routine; without `numbers` it takes every error."""

    numbers: tuple[Expression, ...]
    body: tuple[Statement, ...]


class Routine(NamedTuple):
    """A PROC, FUNC or TRAP with everything in it; `end` is the offset after its END keyword."""

    scope: str
    kind: str
    type_name: Name | None
    name: Name
    parameters: tuple[Parameter, ...]
    data: tuple[Data, ...]
    body: tuple[Statement, ...]
    backward: tuple[Statement, ...] | None
    error: ErrorHandler | None
    undo: tuple[Statement, ...] | None
    start: int
    end: int


Declaration: TypeAlias = Data | RecordType | AliasType | Routine | Placeholder


class Module(NamedTuple):
    """A module; `comments` are (offset, text) of all comments of its file."""

    name: Name
    attributes: tuple[str, ...]
    declarations: tuple[Declaration, ...]
    comments: tuple[tuple[int, str], ...]
    start: int
    end: int
