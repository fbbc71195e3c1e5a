r"""Trees to text: one form for every tree, which reads as the same tree again.

Invariant: `parse(printed(tree))` gives the tree but for offsets. Comments are not part of the tree and are not printed.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import assert_never

from rapid_interp.reading.expressions import PRECEDENCE
from rapid_interp.reading.tree import (
    Aggregate,
    AliasType,
    Argument,
    Assign,
    Binary,
    Call,
    CallStatement,
    Component,
    Connect,
    Data,
    Declaration,
    Expression,
    For,
    Goto,
    If,
    Index,
    Label,
    LateName,
    Module,
    Name,
    Number,
    Parameter,
    Placeholder,
    Raise,
    RecordType,
    Return,
    Routine,
    Simple,
    Statement,
    Test,
    Text,
    Truth,
    Unary,
    While,
)

_SIGN_LEVEL, _NOT_LEVEL = 5, 2


def printed(module: Module) -> str:
    """Gives the text of a module."""
    attributes = f"({', '.join(module.attributes)})" if module.attributes else ""
    lines = [f"MODULE {module.name.text}{attributes}"]
    for declaration in module.declarations:
        lines += _indented(declaration_lines(declaration))
    return "\n".join([*lines, "ENDMODULE", ""])


def _indented(lines: Iterable[str]) -> list[str]:
    return ["  " + line for line in lines]


def expression_text(node: Expression, level: int = 1) -> str:
    """Gives the text of an expression, in parentheses if it binds less tightly than `level`."""
    match node:
        case Name() | Number() | Text() | Placeholder():
            return node.text
        case Truth():
            return "TRUE" if node.value else "FALSE"
        case Aggregate():
            return f"[{_list(node.items)}]"
        case Unary():
            own = _NOT_LEVEL if node.operator == "NOT" else _SIGN_LEVEL
            text = f"{node.operator} {expression_text(node.operand, own)}"
            return f"({text})"
        case Binary():
            own = PRECEDENCE[node.operator]
            text = f"{expression_text(node.left, own)} {node.operator} {expression_text(node.right, own + 1)}"
            return f"({text})" if own < level else text
        case Index():
            return f"{expression_text(node.base)}{{{_list(node.indices)}}}"
        case Component():
            return f"{expression_text(node.base)}.{node.name}"
        case Call():
            return f"{node.name.text}({_arguments(node.arguments)})"
        case _:
            assert_never(node)


def _list(nodes: Iterable[Expression]) -> str:
    return ", ".join(expression_text(node) for node in nodes)


def _arguments(nodes: Iterable[Argument]) -> str:
    return ", ".join(_argument(node) for node in nodes)


def _argument(node: Argument) -> str:
    value = "" if node.value is None else expression_text(node.value)
    if not node.option:
        return f"{node.label}:={value}" if node.label else value
    sign = "?" if node.conditional else ":=" if value else ""
    return f"\\{node.option}{sign}{value}"


def _block(nodes: Iterable[Statement]) -> list[str]:
    return [line for node in nodes for line in _indented(statement_lines(node))]


def statement_lines(node: Statement) -> list[str]:
    """Gives the lines of a statement."""
    match node:
        case Assign():
            return [f"{expression_text(node.target)} := {expression_text(node.value)};"]
        case CallStatement():
            name = f"%{expression_text(node.name.value)}%" if isinstance(node.name, LateName) else node.name.text
            return [f"{name} {_arguments(node.arguments)}".rstrip() + ";"]
        case If(compact=True):
            (branch,) = node.branches
            first, *rest = statement_lines(branch.body[0])
            return [f"IF {expression_text(branch.condition)} {first}", *rest]
        case If():
            lines: list[str] = []
            for word, branch in zip(["IF", *["ELSEIF"] * len(node.branches)], node.branches, strict=False):
                lines += [f"{word} {expression_text(branch.condition)} THEN", *_block(branch.body)]
            if node.otherwise is not None:
                lines += ["ELSE", *_block(node.otherwise)]
            return [*lines, "ENDIF"]
        case While():
            return [f"WHILE {expression_text(node.condition)} DO", *_block(node.body), "ENDWHILE"]
        case For():
            step = f" STEP {expression_text(node.step)}" if node.step is not None else ""
            head = f"FOR {node.variable.text} FROM {expression_text(node.first)} TO {expression_text(node.last)}{step} DO"
            return [head, *_block(node.body), "ENDFOR"]
        case Test():
            lines = [f"TEST {expression_text(node.subject)}"]
            for case in node.cases:
                lines += [f"CASE {_list(case.values)}:", *_block(case.body)]
            if node.default is not None:
                lines += ["DEFAULT:", *_block(node.default)]
            return [*lines, "ENDTEST"]
        case Goto():
            return [f"GOTO {node.label.text};"]
        case Label():
            return [f"{node.name}:"]
        case Return() | Raise():
            word = "RETURN" if isinstance(node, Return) else "RAISE"
            return [f"{word};" if node.value is None else f"{word} {expression_text(node.value)};"]
        case Simple():
            return [f"{node.keyword};"]
        case Connect():
            return [f"CONNECT {expression_text(node.interrupt)} WITH {node.trap.text};"]
        case Placeholder():
            return [node.text]
        case _:
            assert_never(node)


def declaration_lines(node: Declaration) -> list[str]:
    """Gives the lines of a declaration."""
    match node:
        case Data():
            dimensions = f"{{{_list(node.dimensions)}}}" if node.dimensions else ""
            value = f" := {expression_text(node.value)}" if node.value is not None else ""
            return [_scoped(node.scope, f"{node.storage} {node.type_name.text} {node.name.text}{dimensions}{value};")]
        case RecordType():
            fields = [f"{field.type_name.text} {field.name.text};" for field in node.fields]
            return [_scoped(node.scope, f"RECORD {node.name.text}"), *_indented(fields), "ENDRECORD"]
        case AliasType():
            return [_scoped(node.scope, f"ALIAS {node.type_name.text} {node.name.text};")]
        case Routine():
            return _routine(node)
        case Placeholder():
            return [node.text]
        case _:
            assert_never(node)


def _scoped(scope: str, text: str) -> str:
    return f"{scope} {text}" if scope else text


def _routine(node: Routine) -> list[str]:
    result = f"{node.type_name.text} " if node.type_name is not None else ""
    head = _scoped(node.scope, f"{node.kind} {result}{node.name.text}")
    lines = [head if node.kind == "TRAP" else f"{head}({_parameters(node.parameters)})"]
    for data in node.data:
        lines += _indented(declaration_lines(data))
    lines += _block(node.body)
    if node.backward is not None:
        lines += ["BACKWARD", *_block(node.backward)]
    if node.error is not None:
        lines += [f"ERROR ({_list(node.error.numbers)})" if node.error.numbers else "ERROR", *_block(node.error.body)]
    if node.undo is not None:
        lines += ["UNDO", *_block(node.undo)]
    return [*lines, f"END{node.kind}"]


def _parameters(nodes: tuple[Parameter, ...]) -> str:
    text, group = "", 0
    for place, node in enumerate(nodes):
        excludes = node.group and node.group == group
        text += " | " if excludes else ", " if place else ""
        group = node.group
        rank = f"{{{','.join('*' * node.rank)}}}" if node.rank else ""
        mode = f"{node.mode} " if node.mode else ""
        text += f"{chr(92) if node.optional and not excludes else ''}{mode}{node.type_name.text} {node.name.text}{rank}"
    return text
