"""The task: starting, reading and setting data, endless loops, depth, replies."""

from __future__ import annotations

import time

import pytest

from rapid_interp import RapidError, load_text
from rapid_interp import effects as fx
from rapid_interp.data import Orient, Pos, RobTarget

LOOP = """MODULE loop
  PERS num option := 0;
  VAR pose frame;
  VAR string word := "a";
  CONST num LIMIT := 2;
  VAR bool flags{2};
  LOCAL VAR robtarget target := [[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PROC main()
    WHILE option < LIMIT DO
      WaitTime 0.1;
    ENDWHILE
    TPWrite "done";
  ENDPROC
  PROC other(num x)
  ENDPROC
ENDMODULE
"""


def test_data_can_be_set_while_the_program_runs():
    task = load_text(LOOP).start()
    run = task.run()
    assert isinstance(next(run), fx.Wait)
    assert isinstance(run.send(None), fx.Wait)
    task.set("OPTION", "LIMIT + 1")
    effect = run.send(None)
    assert effect == fx.Write(fx.SourceLine("loop", "main", "<text>", 12), "done")
    with pytest.raises(StopIteration):
        run.send(None)


@pytest.mark.parametrize(
    ("name", "text", "value"),
    [
        ("option", "-3", "-3"),
        ("loop:option", "1E3", "1000"),
        ("word", '"say ""x"""', '"say ""x"""'),
        ("flags", "[TRUE, FALSE]", "[TRUE,FALSE]"),
        ("frame", "[[0,0,0.5],[1,0,0,0]]", "[[0,0,0.5],[1,0,0,0]]"),
        ("frame", "PoseInv([[1,0,0],[1,0,0,0]])", "[[-1,0,0],[1,0,0,0]]"),
    ],
)
def test_a_value_set_reads_as_the_same_literal(name, text, value):
    task = load_text(LOOP).start()
    task.set(name, text)
    assert task.literal(name) == value


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("option", '"a"', "expected num, found string"),
        ("option", "1;", "expected the end of the value, found ';'"),
        ("option", "", "expected an expression"),
        ("option", "1 / 0", "division by zero"),
        ("option", "(" * 5000, "nested too deeply"),
        ("option", "nothing", "unknown name 'nothing'"),
        ("frame", "[1,2]", "pos"),
        ("LIMIT", "3", "is a constant and cannot be set"),
        ("optoin", "3", "did you mean 'option'?"),
        ("nowhere:option", "3", "the program has no data 'nowhere:option'"),
    ],
)
def test_a_bad_value_is_refused_and_changes_nothing(name, text, message):
    task = load_text(LOOP).start()
    with pytest.raises(RapidError, match=r"(?s).*") as caught:
        task.set(name, text)
    assert message in str(caught.value)
    assert task.get("option") == 0.0


def test_data_is_read_as_the_records_of_the_data_module():
    task = load_text(LOOP).start()
    assert task.get("target") == RobTarget(Pos(1, 2, 3), Orient(1, 0, 0, 0))
    assert task.get("flags") == (False, False)
    assert task.get("v100").v_tcp == 100
    assert task.literal("loop:target").startswith("[[1,2,3],[1,0,0,0],[0,0,0,0],[9E+09,")


def test_two_tasks_of_a_program_share_nothing():
    program = load_text(LOOP)
    one, two = program.start(), program.start()
    one.set("option", "7")
    assert two.get("option") == 0.0


@pytest.mark.parametrize(
    ("routine", "module", "message"),
    [("mian", None, "did you mean 'main'?"), ("main", "other", "in module other"), ("other", None, "it needs the arguments x")],
)
def test_a_routine_that_cannot_be_started_is_told(routine, module, message):
    with pytest.raises(RapidError) as caught:
        load_text(LOOP).start(routine, module)
    assert message in str(caught.value)


def test_an_endless_loop_without_effect_ends_with_its_line_within_seconds(program):
    begin = time.process_time()
    with pytest.raises(RapidError) as caught:
        list(program("VAR num n;\nWHILE TRUE DO\nn := Sin(n) + 1;\nENDWHILE").start().run())
    assert time.process_time() - begin < 5.0
    assert "endless loop" in str(caught.value)
    assert 5 <= caught.value.line <= 7


@pytest.mark.parametrize("body", ["WaitTime 0;", "SetDO do1, 1;", "IF di1 = 2 Stop;", 'TPWrite "x";'])
def test_effects_that_take_no_time_do_not_hide_an_endless_loop(program, body):
    run = program(f"WHILE TRUE DO {body} ENDWHILE").start(max_steps=1000).run()
    with pytest.raises(RapidError, match="endless loop"):
        exhausted(run)


def exhausted(run):
    """Sends replies until the end."""
    effect = next(run)
    while True:
        effect = run.send(0.0 if isinstance(effect, fx.ReadSignal) else None)


def test_a_loop_with_waits_goes_on(program):
    run = program("WHILE TRUE DO WaitTime 0.1; ENDWHILE").start(max_steps=10).run()
    assert [type(next(run)) for _ in range(100)] == [fx.Wait] * 100


def test_recursion_without_end_is_an_error_of_the_program(program):
    with pytest.raises(RapidError, match="more than 1000 deep"):
        list(program("down;", "PROC down()\ndown;\nENDPROC").start().run())


def test_functions_may_have_effects_and_are_called_in_the_order_of_the_text(run):
    declarations = 'FUNC num f(num n)\nTPWrite "f"\\Num:=n;\nRETURN n;\nENDFUNC'
    assert run('TPWrite "sum"\\Num:=f(1) + f(2) * f(3);', declarations) == ["f1", "f2", "f3", "sum7"]
    assert run('IF f(1) = 2 AND f(2) = 2 TPWrite "no";\nIF f(1) = 1 OR f(3) = 0 TPWrite "yes";', declarations) == ["f1", "f1", "yes"]


def test_a_signal_without_reply_is_an_error(program):
    run = program('IF di1 = 1 TPWrite "x";').start().run()
    next(run)
    with pytest.raises(RapidError, match="the signal 'di1' is not known"):
        run.send(None)


def test_clocks_count_what_the_world_replies(run):
    body = 'ClkStart c; ClkStop c; ClkStart c; TPWrite ""\\Num:=ClkRead(c); ClkReset c; TPWrite ""\\Num:=ClkRead(c);'
    assert run(body, "VAR clock c;", [1.0, 3.5, 10.0, 10.25, 0.0])[-3::2] == ["2.75", "0"]


def test_waiting_for_a_signal_polls_it(run):
    assert run("WaitDI di1, 1;", "", [0, 0, 1]) == ["read di1", "wait 0.01", "read di1", "wait 0.01", "read di1"]


def test_the_value_of_a_group_is_waited_for_by_comparison(run):
    assert run("WaitGI giCode\\GT, 4;", "", [4, 5])[-1] == "read giCode"
    assert run("WaitRob\\InPos;") == ["wait 0 in position"]
    with pytest.raises(RapidError, match=r"did not get the value within 0\.01 s"):
        run("WaitAI aiX, 4\\MaxTime:=0.01;")


def test_an_effect_has_every_argument_of_its_instruction(program):
    body = r"MoveL p, v100\T:=3, z10\Z:=2, tool0\WObj:=w;"
    declarations = (
        "VAR robtarget p := [[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n"
        'PERS wobjdata w := [FALSE,TRUE,"",[[7,0,0],[1,0,0,0]],[[0,8,0],[1,0,0,0]]];'
    )
    (move,) = program(body, declarations).start().run()
    assert isinstance(move, fx.MoveL)
    assert (move.duration, move.zone_mm, move.tcp_speed) == (3.0, 2.0, None)
    assert (move.wobj.uframe.trans, move.wobj.oframe.trans) == (Pos(7, 0, 0), Pos(0, 8, 0))
    assert move.at == fx.SourceLine("m", "main", "<text>", 5)


SAVED = """! before
MODULE kept
  PERS num count := 1; ! a comment
  PERS pos place;
  PERS string same := "as it was";
  LOCAL PERS num list{2} := [1, 2];
  VAR num passing := 3;
  PROC main()
    count := count + 1;
    place := [1, 2.5, 3];
    list{2} := 7;
    passing := 4;
  ENDPROC
ENDMODULE
! after
"""


def test_persistent_data_are_written_back_into_the_text_as_it_was():
    task = load_text(SAVED, "kept.mod").start()
    assert task.saved() == {}
    list(task.run())
    (text,) = task.saved().values()
    expected = SAVED.replace("count := 1;", "count := 2;").replace("PERS pos place;", "PERS pos place := [1,2.5,3];")
    assert text == expected.replace("[1, 2]", "[1,7]")
    assert load_text(text).start().literal("place") == "[1,2.5,3]"


@pytest.mark.parametrize(
    "body",
    ["n := w;", "n := Abs(w);", "Incr w;", "WaitTime w;", "IF w Stop;", "n := list{w};", "RAISE w;", "%w%;", "takes w;", "changes w;"],
)
def test_a_value_of_a_type_that_is_not_known_is_an_error_where_another_is_needed(program, body):
    more = """VAR weavedata w; VAR num n; VAR num list{3};
PROC takes(num x)
ENDPROC
PROC changes(INOUT num x)
ENDPROC"""
    with pytest.raises(RapidError, match="not known"):
        list(program(body, more).start().run())
