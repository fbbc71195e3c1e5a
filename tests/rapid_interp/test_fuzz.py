"""Fuzz: whatever the text, there is a program or `RapidErrors`, soon and in bounded memory. A short run of `fuzz.py`."""

from __future__ import annotations

import multiprocessing

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.rapid_interp import fuzz

SHORT_RUN = 1200


def digest(text: str) -> None:
    with fuzz.time_limit():
        fuzz.digest(text)


def test_programs_made_from_the_grammar_and_from_changed_samples_are_programs_or_errors():
    with multiprocessing.get_context("spawn").Pool(2, initializer=fuzz.limit_memory) as pool:
        results = pool.map(fuzz.guarded, range(SHORT_RUN), chunksize=50)
    assert [outcome for _, outcome, _ in results if outcome.startswith("Traceback")] == []
    loaded = [outcome for _, outcome, _ in results if outcome != "refused"]
    assert len(loaded) > SHORT_RUN / 10  # a fuzzer whose programs are all refused finds nothing


@settings(max_examples=150, deadline=None, derandomize=True)
@given(st.lists(st.sampled_from(fuzz.WORDS), max_size=60))
def test_any_row_of_words_in_a_routine_is_a_program_or_errors(words):
    digest("MODULE m\nVAR num x;\nPROC main()\n" + " ".join(words) + "\nENDPROC\nENDMODULE")


@settings(max_examples=100, deadline=None, derandomize=True)
@given(st.text(max_size=80))
def test_any_text_is_a_program_or_errors(text):
    digest(text)


@pytest.mark.parametrize(
    "body",
    [
        "x := " + "(" * 10_000 + "1" + ")" * 10_000 + ";",
        "IF TRUE THEN\n" * 10_000 + "ENDIF\n" * 10_000,
        "IF TRUE " * 10_000 + "x := 1;",
        "x := " + " + ".join(["1"] * 10_000) + ";",
        "x := " + "NOT " * 10_000 + "TRUE;",
        "x := " + "-" * 10_000 + "1;",
        "x := " + "[" * 10_000,
        "x := " + "Abs(" * 10_000,
        "x" + "{x" * 10_000,
        "x" + ".x" * 10_000 + " := 1;",
        "x := " + ("(1 + " * 70 + "1" + ")" * 70 + " + ") * 150 + "1;",
        "FOR i FROM 1 TO 2 DO\n" * 5_000,
        "TEST x CASE " * 5_000,
        '"' * 10_001,
        "x := 1E999; x := 0x" + "F" * 5000 + ";",
        "VAR num huge{1000000,1000000};",
    ],
    ids=lambda body: body[:24],
)
def test_deep_and_long_input_is_a_program_or_errors(body):
    digest(f"MODULE m\nPROC main()\nVAR num x;\n{body}\nENDPROC\nENDMODULE")
