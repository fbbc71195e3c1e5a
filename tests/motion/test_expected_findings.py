"""Comments that expect findings: each finding is expected or not, and a comment that is not met is told."""

from __future__ import annotations

from mitl.motion.expected_findings import set_apart
from mitl.motion.preflight import Finding, Severity
from rapid_interp import Comment


def finding(line, code="reach", file="a.mod"):
    return Finding(Severity.ERROR, code, "words", file, "A", line, 3)


def comment(line, text, *, alone=True, file="a.mod"):
    return Comment(file, line, 1, text, alone)


def test_without_comments_nothing_is_expected():
    assert set_apart([finding(3)], [comment(2, "! reach")]) == ((finding(3),), ())


def test_a_comment_alone_speaks_of_the_next_line_and_one_beside_of_its_own():
    assert set_apart([finding(3)], [comment(2, "! preflight: expect reach")]) == ((), (finding(3),))
    assert set_apart([finding(3)], [comment(3, "!PREFLIGHT:expect Reach", alone=False)]) == ((), (finding(3),))


def test_other_lines_codes_and_files_stay_findings_and_the_comment_is_told():
    for other in (finding(4), finding(3, "collision"), finding(3, file="b.mod")):
        left, expected = set_apart([other], [comment(2, "! preflight: expect reach")])
        assert expected == ()
        assert [one.code for one in left] == [other.code, "not-found"]
        assert (left[1].severity, left[1].line) == (Severity.WARNING, 2)
        assert "line 3" in left[1].message


def test_what_is_allowed_need_not_come():
    assert set_apart([], [comment(2, "! preflight: allow axis-speed")]) == ((), ())
    assert set_apart([finding(3)], [comment(2, "! preflight: allow reach")]) == ((), (finding(3),))


def test_a_comment_that_cannot_be_read_is_told():
    for text in ("! preflight: ignore reach", "! preflight:", "! preflight: expect", "! preflight: expect reach collision"):
        (told,), expected = set_apart([], [comment(2, text)])
        assert (told.severity, told.code, told.line, expected) == (Severity.WARNING, "note", 2, ())
        assert text.strip() in told.message
