"""Two grammars written apart agree on what is a program: ours and one for lark. And what reading costs in memory."""

from __future__ import annotations

import random
import tracemalloc
from pathlib import Path

import pytest

from rapid_interp import SourceText, check_texts
from rapid_interp.reading.modules import parse
from tests.rapid_interp import fuzz

lark = pytest.importorskip("lark")

FOLDER = Path(__file__).parent
SAMPLES = [path for name in ("programs", "accepted", "diagnostics") for path in sorted((FOLDER / name).glob("*.mod"))]
MEMORY = 60
"""Bytes of memory a byte of text: issue 3."""


@pytest.fixture(scope="module")
def second():
    return lark.Lark((FOLDER / "second_grammar.lark").read_text(), parser="lalr", lexer="basic")


def accepts(grammar, text):
    try:
        grammar.parse(text)
    except lark.exceptions.LarkError:
        return False
    return True


def is_read(text):
    return check_texts([SourceText("x", text)], syntax_only=True) == []


@pytest.mark.parametrize("path", SAMPLES, ids=lambda path: path.stem)
def test_both_grammars_agree_on_a_sample(second, path):
    assert accepts(second, path.read_text()) is is_read(path.read_text()) is (path.stem not in ("syntax", "deep", "keywords", "recovery"))


def test_both_grammars_agree_on_programs_made_from_the_grammar(second):
    texts = [fuzz.Writer(random.Random(seed)).program() for seed in range(100)]  # noqa: S311 - repeatable, not secret
    assert [text for text in texts if accepts(second, text) is not is_read(text)] == []


def comparable(text):
    """What an editor leaves behind, and how often a section may stand, are no matters of the second grammar."""
    findings = check_texts([SourceText("x", text)], syntax_only=True)
    beyond = any(finding.message.startswith("a second ") for finding in findings)
    return not beyond and not any(piece in text for piece in ("%%%", "VERSION", "<EXP>", "<SMT>", "<DDN>"))


def test_both_grammars_agree_on_samples_with_tokens_taken_away_or_exchanged(second):
    samples = [path.read_text() for path in SAMPLES if path.stem not in ("deep", "keywords")]
    rngs = [random.Random(seed) for seed in range(300)]  # noqa: S311 - repeatable, not secret
    texts = [text for rng in rngs if comparable(text := fuzz.tokens_changed(rng, rng.choice(samples)))]
    assert len(texts) > 200
    assert {is_read(text) for text in texts} == {True, False}
    assert [text for text in texts if accepts(second, text) is not is_read(text)] == []


def test_a_tree_takes_less_memory_than_allowed():
    text = "\n".join(path.read_text().replace("%%%", "!") for path in SAMPLES if path.stem != "deep")
    tracemalloc.start()
    kept = parse(SourceText("x", text))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < MEMORY * len(text.encode())
    assert kept.modules
