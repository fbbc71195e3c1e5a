r"""Wrong programs in RAPID: `! ### "text"` on a line means that this line has a finding with this text, and no other line has one."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest

from rapid_interp import RapidErrors, SourceText, check, check_texts, load_text

FILES = sorted((Path(__file__).parent / "diagnostics").glob("*.mod"))
EXPECTED = re.compile(r'### "([^"]*)"')


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_marked_line_and_no_other_has_its_finding(path):
    expected = [(number, text) for number, line in enumerate(path.read_text().splitlines(), 1) for text in EXPECTED.findall(line)]
    found = check([path])
    assert Counter(finding.line for finding in found) == Counter(number for number, _ in expected), "\n".join(f.format() for f in found)
    for number, text in expected:
        assert any(f.line == number and text in f"{f.severity.value}: {f.message} [{f.code}]" for f in found), (number, text)


def test_the_caret_stands_under_the_place_also_after_tabs(tmp_path):
    path = tmp_path / "tab.mod"
    path.write_text('MODULE t\n\tPROC main()\n\t\tVAR num x := "a";\n\tENDPROC\nENDMODULE\n')
    (found,) = check([path])
    assert (
        found.format() == f'{path}:3:16: error: expected num, found string [RAPID-E120]\n    \t\tVAR num x := "a";\n    \t\t             ^'
    )


def test_errors_of_meaning_are_told_beside_syntax_errors_unless_these_caused_them():
    text = """MODULE m
      VAR num lost = 1;
      PROC helper(num)
      ENDPROC
      PROC main()
        lost := 1;
        helper 1;
        MovL p10;
        unknown := 2;
        lost := (1;
        GOTO there;
      ENDPROC
    ENDMODULE"""
    found = check_texts([SourceText("x", text)])
    assert [(f.line, f.code) for f in found] == [
        (2, "RAPID-E001"),
        (3, "RAPID-E001"),
        (8, "RAPID-E102"),
        (9, "RAPID-E101"),
        (10, "RAPID-E001"),
    ]


def test_errors_are_told_in_the_order_of_their_lines_also_when_a_program_is_loaded():
    with pytest.raises(RapidErrors) as caught:
        load_text("MODULE m\nPROC main()\nMovL 1;\nx = 1;\nMovJ 2;\nENDPROC\nENDMODULE")
    assert [found.line for found in caught.value.diagnostics] == [3, 4, 5]


def test_a_string_that_is_not_closed_is_one_error():
    found = check_texts([SourceText("x", 'MODULE m\nVAR string s := "open;\nVAR num n;\nENDMODULE')])
    assert [(f.line, f.column, f.code) for f in found] == [(2, 17, "RAPID-E003")]


def test_errors_beyond_a_thousand_are_counted():
    found = check_texts([SourceText("x", "MODULE m\nPROC p()\n" + "x := ;\n" * 3000 + "ENDPROC\nENDMODULE")])
    assert len(found) == 1001
    assert (found[-1].code, found[-1].message) == ("RAPID-E009", "2000 more syntax errors in this file: only the first 1000 are shown")


def test_every_code_of_the_resolver_has_a_program_that_shows_it():
    source = "".join(path.read_text() for path in (Path(__file__).parents[2] / "rapid_interp").rglob("*.py"))
    codes = set(re.findall(r"RAPID-[EW]\d{3}", source))
    shown = {finding.code for path in FILES for finding in [*check([path]), *check([path], lenient=True)]}
    assert codes - shown - {"RAPID-E003", "RAPID-E009"} == set()


def test_a_lenient_caller_is_warned_of_unknown_instructions_that_can_change_nothing():
    body = 'Blink 3, "a"; SpyStart "x"; Blink n; MoveFast 1; Blink p;'
    text = f'MODULE m\nPROC main()\nVAR num n;\nVAR robtarget p;\n{body}\nTPWrite "on";\nENDPROC\nENDMODULE'
    found = check_texts([SourceText("x", text)], lenient=True)
    assert [(f.column, f.code, f.severity.value) for f in found] == [
        (1, "RAPID-W202", "warning"),
        (15, "RAPID-W202", "warning"),
        (29, "RAPID-E102", "error"),
        (38, "RAPID-E102", "error"),
        (50, "RAPID-E102", "error"),
    ]
    assert "left out: unknown procedure or instruction 'Blink'" in found[0].message
    task = load_text(text.replace("Blink n; MoveFast 1; Blink p;", ""), lenient=True).start()
    assert [type(effect).__name__ for effect in task.run()] == ["Write"]
