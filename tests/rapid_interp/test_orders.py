"""The orders that a program takes, found in its text: what a loop tests, with what is tested or indexed below each case."""

from __future__ import annotations

import rapid_interp


def program(*body, data=(), procedures=()):
    lines = ["MODULE M", "VAR num option := 0;", "VAR num sub := 0;", *data, "PROC main()", *body, "ENDPROC", *procedures, "ENDMODULE"]
    return rapid_interp.load_text("\n".join(lines) + "\n", "m.mod")


def found(*body, data=(), procedures=(), routine="main"):
    return [dict(order.values) for order in rapid_interp.orders(program(*body, data=data, procedures=procedures), routine)]


def waiting(*cases):
    return ("WHILE TRUE DO", "TEST option", *cases, "DEFAULT:", "WaitTime 0.1;", "ENDTEST", "ENDWHILE")


def test_a_program_without_a_loop_or_without_data_takes_none():
    assert found("WaitTime 1;") == []
    assert found("TEST option", "CASE 1:", "WaitTime 1;", "ENDTEST") == []
    assert found("WHILE TRUE DO", "TEST 3", "CASE 3:", "WaitTime 1;", "ENDTEST", "ENDWHILE") == []


def test_values_of_a_case_are_orders_in_the_order_of_the_text():
    assert found(*waiting("CASE 3:", "WaitTime 1;", "CASE 1, -2:", "WaitTime 2;")) == [{"option": 3}, {"option": 1}, {"option": -2}]


def test_constants_are_values_too():
    assert found(*waiting("CASE go:", "WaitTime 1;"), data=("CONST num go := 7;",)) == [{"option": 7}]


def test_what_is_tested_below_a_case_is_combined_with_it_also_in_procedures():
    draw = ("PROC draw()", "TEST sub", "CASE 1:", "WaitTime 1;", "CASE 2:", "WaitTime 2;", "ENDTEST", "ENDPROC")
    assert found(*waiting("CASE 1:", "draw;", "CASE 2:", "WaitTime 1;"), procedures=draw) == [
        {"sub": 1, "option": 1},
        {"sub": 2, "option": 1},
        {"option": 2},
    ]


def test_the_bounds_of_an_array_are_values_of_its_index():
    data = ("CONST num waits{3} := [1,2,3];",)
    assert found(*waiting("CASE 1:", "WaitTime waits{sub};"), data=data) == [{"sub": sub, "option": 1} for sub in (1, 2, 3)]


def test_an_array_of_two_dimensions_gives_all_pairs():
    data = ("VAR num row := 0;", "CONST num waits{2,3} := [[1,2,3],[4,5,6]];")
    pairs = found(*waiting("CASE 1:", "WaitTime waits{row,sub};"), data=data)
    assert len(pairs) == 6
    assert {(pair["row"], pair["sub"]) for pair in pairs} == {(row, sub) for row in (1, 2) for sub in (1, 2, 3)}


def test_a_loop_in_a_called_procedure_counts_and_one_that_calls_itself_ends():
    serve = ("PROC serve()", *waiting("CASE 4:", "serve;"), "ENDPROC")
    assert found("serve;", procedures=serve) == [{"option": 4}]


def test_the_routine_that_is_started_decides():
    other = ("PROC other()", *waiting("CASE 5:", "WaitTime 1;"), "ENDPROC")
    assert found("WaitTime 1;", procedures=other) == []
    assert found("WaitTime 1;", procedures=other, routine="OTHER") == [{"option": 5}]
    assert found("WaitTime 1;", procedures=other, routine="absent") == []


def test_local_data_and_constants_cannot_be_set_and_are_no_orders():
    local = ("VAR num mine := 0;", "WHILE TRUE DO", "TEST mine", "CASE 1:", "WaitTime 1;", "ENDTEST", "ENDWHILE")
    assert found(*local) == []
    assert found("WHILE TRUE DO", "TEST fixed", "CASE 1:", "WaitTime 1;", "ENDTEST", "ENDWHILE", data=("CONST num fixed := 1;",)) == []


def test_an_order_says_what_it_sets_the_tested_data_first():
    (order,) = rapid_interp.orders(program(*waiting("CASE 1:", "TEST sub", "CASE 2:", "WaitTime 1;", "ENDTEST")))
    assert str(order) == "option = 1, sub = 2"
    assert (order.name, order.value) == ("option", 1)


def test_comments_know_their_place_and_whether_they_stand_alone():
    loaded = program("! alone", "WaitTime 1; ! beside", "\t! indented")
    assert [(comment.line, comment.column, comment.text, comment.alone) for comment in loaded.comments] == [
        (5, 1, "! alone", True),
        (6, 13, "! beside", False),
        (7, 2, "! indented", True),
    ]
