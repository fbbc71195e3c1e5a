"""Library routines: what ValToStr shows for their values, and that none of them is without a program."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from rapid_interp import RapidError, load, load_text
from rapid_interp.library.catalogue import catalogue
from rapid_interp.library.table import LibraryRoutine
from tests.rapid_interp.conftest import PROGRAM
from tests.rapid_interp.test_network import talk
from tests.rapid_interp.world import World

FOLDER = Path(__file__).parent
DECLARATIONS = """
VAR num n := 3; VAR dnum d := 5; VAR byte b := 6; VAR string s := "Rapid"; VAR num list{3} := [1,2,3];
VAR robtarget rt := [[1,2,3],[1,0,0,0],[0,0,0,0],[0,0,0,0,0,0]]; VAR pos p := [1,2,3];
"""

MORE = """VAR num copy{3}; VAR pos grid{2,2}; VAR clock c;
PROC late2()
TPWrite "late2";
ENDPROC
PROC lateopt(\\num x)
IF Present(x) TPWrite ValToStr(x);
IF NOT Present(x) TPWrite "none";
ENDPROC
PROC passing(\\num y)
%"lateopt"%\\x?y;
ENDPROC
PROC fill(INOUT num values{*})
FOR i FROM 1 TO Dim(values, 1) DO values{i} := 7; ENDFOR
ENDPROC
FUNC num total(num values{*})
VAR num sum;
FOR i FROM 1 TO Dim(values, 1) DO sum := sum + values{i}; ENDFOR
RETURN sum;
ENDFUNC"""

EXPRESSIONS = [
    ("Max(12, 10)", "12"),
    ("Min(A := 2, B := -1)", "-1"),
    ("BitAnd(12, 10)", "8"),
    ("BitOr(12, 10)", "14"),
    ("BitXOr(12, 10)", "6"),
    ("BitNeg(1)", "254"),
    ("BitLSh(129, 1)", "2"),
    ("BitRSh(129, 1)", "64"),
    ("BitCheck(b, 2)", "TRUE"),
    ("BitCheck(b, 1)", "FALSE"),
    ("BitAndDnum(4294967296, 4294967297)", "4294967296"),
    ("BitOrDnum(4294967296, 1)", "4294967297"),
    ("BitXOrDnum(4294967297, 1)", "4294967296"),
    ("BitNegDnum(0)", "4.5035996273705E+15"),
    ("BitLShDnum(1, 40)", "1099511627776"),
    ("BitRShDnum(1099511627776, 40)", "1"),
    ("BitCheckDnum(1099511627776, 41)", "TRUE"),
    ("ByteToStr(65)", '"65"'),
    (r"ByteToStr(65\Hex)", '"41"'),
    (r"ByteToStr(65\Okt)", '"101"'),
    (r"ByteToStr(65\Bin)", '"01000001"'),
    (r"ByteToStr(65\Char)", '"A"'),
    ('StrToByte("65")', "65"),
    (r'StrToByte("41"\Hex)', "65"),
    (r'StrToByte("101"\Okt)', "65"),
    (r'StrToByte("01000001"\Bin)', "65"),
    (r'StrToByte("A"\Char)', "65"),
    ('DecToHex("255")', '"FF"'),
    ('HexToDec("FF")', '"255"'),
    ('StrDigCmp("4294967295", GT, "12")', "TRUE"),
    ('StrDigCmp("12", LTEQ, "11")', "FALSE"),
    ('StrDigCmp("12", EQ, "12")', "TRUE"),
    ('StrDigCmp("12", NOTEQ, "12")', "FALSE"),
    ('StrDigCalc("4000000000", OpAdd, "7")', '"4000000007"'),
    ('StrDigCalc("10", OpSub, "7")', '"3"'),
    ('StrDigCalc("10", OpMult, "7")', '"70"'),
    ('StrDigCalc("10", OpDiv, "7")', '"1"'),
    ('StrDigCalc("10", OpMod, "7")', '"3"'),
    ("AbsDnum(-d)", "5"),
    ("SqrtDnum(16)", "4"),
    ("SinDnum(30)", "0.5"),
    ("CosDnum(60)", "0.5"),
    ("TanDnum(45)", "1"),
    ("ExpDnum(1)", "2.71828182845905"),
    ("ASinDnum(0.5)", "30"),
    ("ACosDnum(0.5)", "60"),
    ("ATanDnum(1)", "45"),
    ("ATan2Dnum(1, 1)", "45"),
    ("PowDnum(2, 40)", "1099511627776"),
    (r"RoundDnum(2.345\Dec:=2)", "2.35"),
    (r"TruncDnum(2.349\Dec:=2)", "2.34"),
    ("NumToDnum(0.1)", "0.100000001490116"),
    ("DnumToNum(d)", "5"),
    ("DnumToStr(4294967295.5, 2)", '"4294967295.50"'),
    ("NumToStr(0.1, 10)", '"0.1000000015"'),
    ('StrOrder("first", "second", STR_LOWER)', "TRUE"),
    ('StrOrder("b", "a", "ba")', "TRUE"),
    ('StrOrder("b", "a", STR_LOWER)', "FALSE"),
    (r'StrFormat("{1} of {2}"\Arg1:="3"\Arg2:="4")', '"3 of 4"'),
    ('StrMemb(s, 1, "QRS")', "TRUE"),
    ('StrMemb(s, 2, "QRS")', "FALSE"),
    (r"StrFind(s, 1, STR_UPPER \NotInSet)", "2"),
    ('StrMatch(s, 1, "x")', "6"),
    ("DefDFrame([0,0,0],[1,0,0],[0,1,0],[5,0,0],[6,0,0],[5,1,0])", "[[5,0,0],[1,0,0,0]]"),
    ("DefDFrame([0,0,0],[1,0,0],[0,1,0],[0,0,0],[0,1,0],[-1,0,0])", "[[0,0,0],[0.707107,0,0,0.707107]]"),
    ("Type(rt)", '"robtarget"'),
    ("Type(d)", '"dnum"'),
    ("Dim(list, 1)", "3"),
    # num is single precision
    ("16777216 + n - 3 + 1", "1.67772E+07"),
    ("16777216 + 1 = 16777216", "TRUE"),
    ("0.1 + 0.2 = 0.3", "TRUE"),
    ("n / 3 * 0.1 = 0.1", "TRUE"),
    ("1 + 1E-8 = 1", "TRUE"),
    ("d + 4294967295", "4294967300"),
    ("d / 3", "1.66666666666667"),
    ("0.1 * 3 - 0.3 = 0", "TRUE"),
]


@pytest.mark.parametrize(("expression", "shown"), EXPRESSIONS)
def test_a_routine_has_the_value_of_the_manual(writes, expression, shown):
    assert writes(expression, DECLARATIONS) == shown


BODIES = [
    ("BitSet b, 1; TPWrite ValToStr(b);", "7"),
    ("BitClear b, 2; TPWrite ValToStr(b);", "4"),
    ("d := 0; BitSet d, 41; TPWrite ValToStr(d);", "1099511627776"),
    ("Incr n; TPWrite ValToStr(n);", "4"),
    ("Decr n; TPWrite ValToStr(n);", "2"),
    ("Add n, 0.5; TPWrite ValToStr(n);", "3.5"),
    ("Add d, 4294967296; TPWrite ValToStr(d);", "4294967301"),
    ("Clear n; TPWrite ValToStr(n);", "0"),
    ("n := 16777216; Incr n; TPWrite NumToStr(n, 0);", "16777216"),
    ("d := 16777216; Incr d; TPWrite ValToStr(d);", "16777217"),
    ("n := 0; FOR i FROM 1 TO 10 DO n := n + 0.1; ENDFOR TPWrite ValToStr(n = 1) + NumToStr(n, 7);", "FALSE1.0000001"),
    ("n := 0; FOR i FROM 0 TO 1 STEP 0.1 DO Incr n; ENDFOR TPWrite ValToStr(n);", "10"),
    ("n := 0.7; IF n = 0.7 TPWrite NumToStr(n, 3);", "0.700"),
    ("p.x := 0.1; n := p.x; IF n = p.x TPWrite ValToStr(p);", "[0.1,2,3]"),
    ("TryInt n; TPWrite \"whole\";", "whole"),
    ("CallByVar \"late\", 2;", "late2"),
    ('%"lateopt"%\\x:=4;', "4"),
    ('%"lateopt"%;', "none"),
    ("passing\\y:=8;", "8"),
    ("passing;", "none"),
    ("list{2} := 9; copy := list; list{2} := 1; TPWrite ValToStr(copy) + ValToStr(list);", "[1,9,3][1,1,3]"),
    ("fill list; TPWrite ValToStr(list);", "[7,7,7]"),
    ("grid{2,1}.y := 4; TPWrite ValToStr(grid);", "[[[0,0,0],[0,0,0]],[[0,4,0],[0,0,0]]]"),
    ("grid{2,1} := p; IF grid{2,1} = p TPWrite ValToStr(total(list));", "6"),
    ("list{1} := 5; list{2} := total(list); TPWrite ValToStr(list);", "[5,10,3]"),
    ("ClkReset c; ClkStart c; WaitTime 0.5; ClkStop c; TPWrite ValToStr(ClkRead(c \\HighRes));", "0.5"),
]  # fmt: skip


@pytest.mark.parametrize(("body", "shown"), BODIES)
def test_instructions_change_data_as_the_manual_says(run, body, shown):
    assert run(body, DECLARATIONS + MORE)[-1] == shown


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        ("b := BitAnd(256, 1);", "from 0 to 255, found 256"),
        ("b := BitAnd(1.5, 1);", "from 0 to 255, found 1.5"),
        ("BitSet b, 9;", "from 1 to 8, found 9"),
        ('b := StrToByte("x");', "'x' is no byte"),
        ('s := HexToDec("xyz");', "needs digits, found 'xyz'"),
        ('s := StrDigCalc("1", OpDiv, "0");', "division by zero"),
        ('s := StrDigCalc("1", OpSub, "2");', "-1 is outside of 0"),
        ("n := 1E38; n := n * n;", "too large for num"),
        ("s := NumToStr(1, 400);", "0 to 15, found 400"),
        ("s := ValToStr(rt) + ValToStr(rt);", "more than 80"),
        ('n := StrFind(s, 0, "a");', "position 0 is not inside"),
        ("TriggL rt, v100, t, fine, tool0;", "has not been defined by TriggIO"),
        ("TriggIO t, 5, 1;", "one of \\DOp, \\GOp and \\AOp"),
        ("TriggIO t, -5\\DOp:=do1, 1;", "cannot be negative"),
        ('MoveLSync rt, v100, z10, tool0, "nothing";', "no procedure 'nothing'"),
        ("ITimer 0, i;", "a positive time, found 0"),
        ("ITimer 1, i;", "not connected to a trap"),
        ("PathAccLim TRUE, FALSE;", "needs a positive \\AccMax"),
        ("VelSet 0, 100;", "needs positive values"),
        ('Open "HOME:/a", f;', "no folder was given"),
        ("ArcL rt, v10, fine, tool0;", "ArcL: an application package"),
        ("SocketCreate link;", "no connection is opened: sockets are refused, unless a Python caller gives the program a network"),
        ('SpyStart "x";', "--lenient leaves it out"),
        ("SyncMoveOn m, all;", "several robots that move together"),
        ("TryInt 1.5;", "1.5 is no integer"),
        ("n := Round(1E30 * 1E10);", "too large for num"),
    ],
)
def test_wrong_use_is_an_error_with_its_line(program, statement, message):
    more = "VAR triggdata t; VAR intnum i; VAR iodev f; VAR tasks all{1}; VAR socketdev link;\n"
    task = program(statement, DECLARATIONS + more).start()
    with pytest.raises(RapidError) as caught:
        list(task.run())
    assert message in str(caught.value)
    assert caught.value.line == 8


COMPILED = {"waituntil", "exitcycle", "callbyvar", "resetretrycount"}
"""Steps of their own, with no Python of the library behind them; `programs/statements.mod` and `errors.mod` have them."""


def counted(routine: LibraryRoutine, used: set[str]) -> LibraryRoutine:
    """Gives the routine with its name noted whenever it is carried out."""
    run = routine.run
    if run is None:
        return routine

    def noting(*arguments):
        used.add(routine.name.lower())
        return run(*arguments)

    return replace(routine, run=noting)


def test_every_routine_that_is_executed_is_carried_out_by_a_program(monkeypatch, tmp_path):
    used: set[str] = set()
    table = {name: counted(routine, used) for name, routine in catalogue().items()}
    monkeypatch.setattr("rapid_interp.meaning.arguments.catalogue", lambda: table)
    for path in sorted(FOLDER.glob("programs/*.mod")):
        text = path.read_text()
        (tmp_path / path.stem).mkdir()
        World(text).run(load([path]).start(files=tmp_path / path.stem))
    for body in [*(f"TPWrite ValToStr({expression});" for expression, _ in EXPRESSIONS), *(body for body, _ in BODIES)]:
        World().run(load_text(PROGRAM.format(declarations=DECLARATIONS + MORE, body=body)).start())
    talk()
    missing = {routine.name for routine in catalogue().values() if routine.run is not None and routine.name.lower() not in used | COMPILED}
    assert " ".join(sorted(missing)) == ""


def test_what_is_not_executed_says_why():
    assert [routine.name for routine in catalogue().values() if routine.run is None and not routine.refused] == []
