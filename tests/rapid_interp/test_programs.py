"""Programs in RAPID: each file in `programs` ends with `! => line` comments, what it must ask for in order."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import pytest

from rapid_interp import Severity, SourceText, check, load
from rapid_interp.reading import tree
from rapid_interp.reading.expressions import PRECEDENCE
from rapid_interp.reading.modules import parse

PROGRAMS = sorted((Path(__file__).parent / "programs").glob("*.mod"))


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_a_program_asks_for_what_its_comments_say(path, run_program, tmp_path):
    text = path.read_text()
    expected = [line.partition("! => ")[2] for line in text.splitlines() if "! => " in line]
    assert expected
    assert run_program(load([path]).start(files=tmp_path), script=text) == expected


@pytest.mark.parametrize("path", sorted((Path(__file__).parent / "accepted").glob("*.mod")), ids=lambda path: path.stem)
def test_a_valid_file_has_no_error(path):
    errors = [found.format() for found in check([path]) if found.severity is Severity.ERROR]
    assert errors == []


def kinds(node):
    """Gives the names of all kinds of nodes in a tree; those of keywords and operators with them."""
    found = set()
    if hasattr(node, "_fields"):
        found.add(type(node).__name__)
        found |= {
            f"{type(node).__name__} {getattr(node, name)}" for name in ("keyword", "operator", "storage", "kind") if hasattr(node, name)
        }
        if isinstance(node, tree.If):
            found.add("compact If" if node.compact else "If with ELSEIF" if len(node.branches) > 1 else "If")
        if isinstance(node, tree.For) and node.step is not None:
            found.add("For with STEP")
    if isinstance(node, tuple):
        found = found.union(*(kinds(part) for part in node))
    return found


def test_every_kind_of_statement_and_declaration_and_operator_is_in_a_program_that_is_run():
    found = kinds(tuple(parse(SourceText(path.name, path.read_text())).modules for path in PROGRAMS))
    wanted = {node.__name__ for node in get_args(tree.Statement) + get_args(tree.Expression) + get_args(tree.Declaration)} - {"Placeholder"}
    wanted |= {f"Simple {word}" for word in ("RETRY", "TRYNEXT", "EXIT")} | {f"Data {word}" for word in ("VAR", "PERS", "CONST")}
    wanted |= {f"Binary {sign}" for sign in PRECEDENCE} | {f"Unary {sign}" for sign in ("NOT", "-", "+")}
    wanted |= {f"Routine {word}" for word in ("PROC", "FUNC", "TRAP")} | {
        "compact If",
        "If with ELSEIF",
        "For with STEP",
        "LateName",
        "ErrorHandler",
    }
    assert sorted(wanted - found) == []
