"""Expressions: what ValToStr shows for them, and what cannot be computed."""

from __future__ import annotations

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rapid_interp import RapidError, load_text
from rapid_interp.library.poses import cross, magnitude
from rapid_interp.running.format import literal
from rapid_interp.running.numbers import num

DECLARATIONS = """
VAR num a := 1; VAR num list{3} := [1,2,3]; VAR bool t := TRUE; VAR bool f := FALSE; VAR pos p := [1,2,3]; VAR string s := "Rapid";
VAR robtarget rt := [[1,2,3],[1,0,0,0],[0,0,0,0],[0,0,0,0,0,0]];
"""


@pytest.mark.parametrize(
    ("expression", "shown"),
    [
        ("1 + 2 * 3", "7"),
        ("(1 + 2) * 3", "9"),
        ("-2 + 5", "3"),
        ("-a * 2", "-2"),
        ("2 - 3 - 4", "-5"),
        ("7 DIV 2 * 2 + 7 MOD 2", "7"),
        ("-7 DIV 2", "-3"),
        ("-7 MOD 2", "-1"),
        ("8 / 4 / 2", "1"),
        # NOT binds loosest: NOT (f AND f), (NOT (t AND f)) OR t, NOT (t OR ...) is not how OR goes
        ("NOT f AND f", "TRUE"),
        ("NOT (f) AND f", "TRUE"),
        ("(NOT f) AND f", "FALSE"),
        ("NOT t OR t", "TRUE"),
        ("NOT t AND f OR f", "TRUE"),
        ("t AND NOT f", "TRUE"),
        ("NOT a = 1", "FALSE"),
        ("a = 1 AND 2 > 1", "TRUE"),
        ("t OR f AND f", "TRUE"),
        ("t XOR t OR t", "TRUE"),
        ("1 < 2 AND 2 <= 2 AND 3 > 2 AND 3 >= 3 AND 1 <> 2", "TRUE"),
        ("p + [1,1,1]", "[2,3,4]"),
        ("p - p", "[0,0,0]"),
        ("p * 2", "[2,4,6]"),
        ("2 * p", "[2,4,6]"),
        ("p * [0,0,1]", "[2,-1,0]"),
        ("-p", "[-1,-2,-3]"),
        ("p = [1,2,3]", "TRUE"),
        ("list = [1,2,3]", "TRUE"),
        ("list <> [1,2,4] AND NOT (list = [3,2,1])", "TRUE"),
        ("p.y", "2"),
        ("list{a + 1}", "2"),
        ("rt.trans.z", "3"),
        ("1 / 3", "0.333333"),
        ("10000000", "1E+07"),
        ("9E9", "9E+09"),
        ("123456", "123456"),
        ("0.00001", "1E-05"),
        ("Abs(-3)", "3"),
        ("Sqrt(2)", "1.41421"),
        ("Sin(30)", "0.5"),
        ("Cos(180)", "-1"),
        ("Sin(180)", "0"),
        ("Tan(45)", "1"),
        ("ASin(1)", "90"),
        ("ACos(0)", "90"),
        ("ATan(1)", "45"),
        ("ATan2(1, -1)", "135"),
        ("Pow(2, 10)", "1024"),
        ("Exp(0)", "1"),
        (r"Round(2.345\Dec:=2)", "2.35"),
        ("Round(2.5)", "3"),
        ("Round(-2.5)", "-3"),
        (r"Trunc(2.349\Dec:=2)", "2.34"),
        ("Trunc(-2.9)", "-2"),
        ("NumToStr(1.005, 2)", '"1.00"'),
        ("NumToStr(-0.001, 2)", '"0.00"'),
        (r"NumToStr(1234.5, 2\Exp)", '"1.23E+03"'),
        ("StrLen(s)", "5"),
        ("StrPart(s, 2, 3)", '"api"'),
        ('StrFind(s, 1, "pd")', "3"),
        ('StrMatch(s, 1, "id")', "4"),
        ("StrMap(s, STR_LOWER, STR_UPPER)", '"RAPID"'),
        ('s + "!"', '"Rapid!"'),
        ("Dim(list, 1)", "3"),
        ("Distance([0,0,0], [3,4,0])", "5"),
        ("VectMagn([3,4,0])", "5"),
        ("DotProd(p, p)", "14"),
        ("CrossProd([1,0,0], [0,1,0])", "[0,0,1]"),
        ("OrientZYX(90, 0, 0)", "[0.707107,0,0,0.707107]"),
        (r"EulerZYX(\Z, OrientZYX(30, 20, 10))", "30"),
        (r"EulerZYX(\Y, OrientZYX(30, 20, 10))", "20"),
        (r"EulerZYX(\X, OrientZYX(30, 20, 10))", "10"),
        ("PoseVect([[1,0,0], [0,0,0,1]], [1,0,0])", "[0,0,0]"),
        ("PoseMult([[1,0,0],[1,0,0,0]], [[0,2,0],[1,0,0,0]])", "[[1,2,0],[1,0,0,0]]"),
        ("PoseInv([[1,2,3],[1,0,0,0]])", "[[-1,-2,-3],[1,0,0,0]]"),
        ("DefFrame([1,0,0], [1,5,0], [0,0,0])", "[[1,0,0],[0.707107,0,0,0.707107]]"),
        (r"DefFrame([1,0,0], [1,5,0], [0,2,0]\Origin:=3)", "[[1,2,0],[0.707107,0,0,0.707107]]"),
        ('StrToVal("3", a)', "TRUE"),
        ('StrToVal("[1,2,-3]", p)', "TRUE"),
        ('StrToVal("[1,2]", p)', "FALSE"),
        ('StrToVal("x", a)', "FALSE"),
        ('StrToVal("TRUE", t)', "TRUE"),
        ("NOrient([2,0,0,0])", "[1,0,0,0]"),
        ("Offs(rt, 1, 1, 1)", "[[2,3,4],[1,0,0,0],[0,0,0,0],[0,0,0,0,0,0]]"),
        (r"RelTool(rt, 0, 0, 0\Rz:=180)", "[[1,2,3],[6.12323E-17,0,0,1],[0,0,0,0],[0,0,0,0,0,0]]"),
    ],
)
def test_an_expression_has_the_value_of_the_manual(writes, expression, shown):
    assert writes(expression, DECLARATIONS) == shown


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        ("a := 1 / (a - 1);", "division by zero"),
        ("a := list{4};", "index 4 is outside of 1..3"),
        ("list{0} := 1;", "index 0 is outside of 1..3"),
        ("a := list{1.5};", "index 1.5 is outside of 1..3"),
        ("a := Sqrt(-1);", "square root of the negative number -1"),
        ("a := ACos(2);", "from -1 to 1, found 2"),
        ("a := 1.5 DIV a;", "DIV needs whole numbers, found 1.5 and 1"),
        ("a := Pow(10, 400);", "Pow: math range error"),
        ("s := StrPart(s, 5, 2);", "not inside a string of 5"),
        ("WHILE TRUE DO s := s + s; ENDWHILE", "more than 80"),
        ("WaitTime -1;", "at least 0 s, found -1"),
        ('%"nothing"%;', "unknown procedure 'nothing' in a late-bound call"),
        ("MoveL rt, v100\\V:=0, fine, tool0;", "\\V must be positive, found 0"),
        ("rt.rot.q1 := 0; MoveL rt, v100, fine, tool0;", "the orientation of the target is no unit quaternion: [0,0,0,0]"),
        ("UIShow 1;", "UIShow: it shows something to the operator; --lenient leaves it out"),
        ("SearchL di1, p, rt, v10, tool0;", "SearchL: it is not simulated: there is no sensor"),
        ("SearchL 1;", "SearchL: it is not simulated"),
    ],
)
def test_what_cannot_be_computed_is_an_error_with_its_line(program, statement, message):
    task = program(statement, DECLARATIONS).start()
    with pytest.raises(RapidError) as caught:
        list(task.run())
    assert message in str(caught.value)
    assert caught.value.line == 7
    assert caught.value.module == "m"
    assert statement.split("\n")[0] in caught.value.format()


@given(st.floats(allow_nan=False, allow_infinity=False, width=32).map(num))
def test_a_number_written_as_a_literal_reads_as_the_same_number(value):
    task = load_text("MODULE m\nVAR num n;\nPROC main()\nENDPROC\nENDMODULE").start()
    task.set("n", literal(value))
    assert task.get("n") == value


@given(st.floats(-720, 720), st.floats(-89, 89), st.floats(-179, 179))
def test_euler_angles_come_back_from_the_quaternion(z, y, x):
    task = load_text(
        "MODULE m\nVAR num z; VAR num y; VAR num x; VAR orient o;\nPROC main()\no := OrientZYX(z, y, x);\n"
        "z := EulerZYX(\\Z, o); y := EulerZYX(\\Y, o); x := EulerZYX(\\X, o);\nENDPROC\nENDMODULE"
    ).start()
    # near 90 deg about y a change of 1e-7 in a quaternion of nums is 0.005 deg
    for name, value in (("z", z), ("y", y), ("x", x)):
        task.set(name, repr(value))
    list(task.run())
    assert math.isclose(task.get("y"), y, abs_tol=1e-2)
    assert abs(math.remainder(task.get("z") - z, 360)) < 1e-2
    assert abs(math.remainder(task.get("x") - x, 360)) < 1e-2


@given(*[st.lists(st.floats(-1, 1).map(lambda value: round(value, 2)), min_size=3, max_size=3)] * 3)
def test_a_frame_defined_by_three_points_has_them_where_it_says(first, second, third):
    points = [tuple(float(value) for value in point) for point in (first, second, third)]
    along, aside = ([b - a for a, b in zip(points[0], point, strict=True)] for point in points[1:])
    assume(magnitude(cross(tuple(along), tuple(aside))) > 1e-3)
    task = load_text(
        "MODULE m\nVAR pos a; VAR pos b; VAR pos c; VAR pos p; VAR pos q;\nPROC main()\n"
        "p := PoseVect(PoseInv(DefFrame(a, b, c)), b); q := PoseVect(PoseInv(DefFrame(a, b, c)), c);\nENDPROC\nENDMODULE"
    ).start()
    for name, point in zip("abc", points, strict=True):
        task.set(name, literal(point))
    list(task.run())
    on_x, in_plane = task.get("p"), task.get("q")
    assert on_x.x > 0
    assert math.isclose(on_x.x, magnitude(tuple(along)), rel_tol=1e-6, abs_tol=1e-6)
    assert max(abs(on_x.y), abs(on_x.z), abs(in_plane.z)) < 1e-6
    assert in_plane.y > 0
