"""Programs in RAPID: each file in `programs` ends with `! => line` comments, what it must ask for in order."""

from __future__ import annotations

from pathlib import Path

import pytest

from rapid_interp import Severity, check, load

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
