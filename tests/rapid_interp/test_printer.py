"""The printer: parse, print, parse is the identity but for offsets."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rapid_interp import SourceText
from rapid_interp.reading.modules import parse
from rapid_interp.reading.printer import printed

FOLDER = Path(__file__).parent
FILES = sorted([*(FOLDER / "accepted").glob("*.mod"), *(FOLDER / "programs").glob("*.mod")])


def bare(node):
    """Gives a tree without offsets."""
    if hasattr(node, "_fields"):
        kept = [name for name in node._fields if name not in ("start", "end", "sign", "comments")]
        return (type(node).__name__, *(bare(getattr(node, name)) for name in kept))
    return tuple(bare(item) for item in node) if isinstance(node, tuple) else node


def round_trip(text):
    first = parse(SourceText("x", text))
    assert first.diagnostics == ()
    again = parse(SourceText("x", "".join(printed(module) for module in first.modules)))
    assert again.diagnostics == ()
    assert bare(again.modules) == bare(first.modules)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_file_printed_reads_as_the_same_tree(path):
    round_trip(path.read_text())


OPERANDS = st.sampled_from(["a", "1", '"s"', "TRUE", "x{1, 2}", "p.trans.x", "f(1, \\b, \\c:=2)", "[1, -2, - 3]", "<EXP>"])
SIGNS = ["*", "/", "DIV", "MOD", "+", "-", "<", ">=", "=", "<>", "AND", "OR", "XOR"]
EXPRESSIONS = st.recursive(
    OPERANDS,
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from(SIGNS), inner).map(" ".join),
        st.tuples(st.sampled_from(["NOT", "-", "+"]), inner).map(" ".join),
        inner.map("({})".format),
    ),
    max_leaves=12,
)


@settings(max_examples=300, deadline=None)
@given(EXPRESSIONS)
def test_any_expression_printed_reads_as_the_same_tree(text):
    round_trip(f"MODULE m\nVAR num x := {text};\nENDMODULE")
