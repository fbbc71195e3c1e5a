"""Several tasks with common PERS, what a driver may reply, and how fast long arrays are."""

from __future__ import annotations

import time

import pytest

from rapid_interp import RapidError, RapidErrors, load_text, start_tasks
from rapid_interp import effects as fx
from tests.rapid_interp.world import World

ONE = """MODULE one
PERS num level := 5;
PERS bool done;
PERS num mine := 1;
VAR syncident meet;
PERS tasks all{2} := [["ONE"],["TWO"]];
PROC main()
WaitTime 1;
level := level + 1;
TPWrite "one"\\Num:=level;
WaitSyncTask meet, all;
WaitUntil done;
TPWrite GetTaskName() + " sees that two is done";
ENDPROC
ENDMODULE"""
TWO = """MODULE two
PERS num level;
PERS bool done;
TASK PERS num mine := 2;
VAR syncident meet;
PERS tasks all{2} := [["ONE"],["TWO"]];
PROC main()
WaitUntil level = 6\\PollRate:=0.4;
TPWrite "two"\\Num:=level;
WaitSyncTask meet, all;
done := TRUE;
TPWrite "mine"\\Num:=mine;
ENDPROC
ENDMODULE"""


def drive_together(tasks, most=1000):
    """Lets the task go on whose time comes first; tasks meet when all that they name wait."""
    lines, runs = [], {name: task.run() for name, task in tasks.items()}
    times = dict.fromkeys(runs, 0.0)
    meeting = {}
    for _ in range(most):
        ready = [name for name in runs if name not in meeting]
        if not ready:
            break
        name = min(ready, key=times.__getitem__)
        try:
            effect = runs[name].send(None)
        except StopIteration:
            del runs[name]
            continue
        match effect:
            case fx.Wait():
                times[name] += effect.seconds
            case fx.WaitForTasks():
                meeting[name] = effect.meeting
                if all(meeting.get(other) == effect.meeting for other in effect.tasks):
                    late = max(times.values())
                    times |= dict.fromkeys(effect.tasks, late)
                    meeting.clear()
            case fx.Write():
                lines.append(effect.text)
    return lines


def test_tasks_share_pers_and_meet():
    tasks = start_tasks({"ONE": load_text(ONE), "TWO": load_text(TWO)})
    assert drive_together(tasks) == ["one6", "two6", "mine2", "ONE sees that two is done"]
    assert tasks["TWO"].get("level") == 6
    assert (tasks["ONE"].get("mine"), tasks["TWO"].get("mine")) == (1.0, 2.0)


def test_what_is_set_in_one_task_is_seen_in_the_other():
    tasks = start_tasks({"ONE": load_text(ONE), "TWO": load_text(TWO)})
    tasks["ONE"].set("level", "9")
    assert tasks["TWO"].literal("level") == "9"


def test_common_data_of_different_types_is_refused():
    other = TWO.replace("PERS num level", "PERS string level").replace("level = 6", 'level = "6"').replace("\\Num:=level", "")
    with pytest.raises(RapidError, match="level: num in task ONE, but string in task TWO"):
        start_tasks({"ONE": load_text(ONE), "TWO": load_text(other)})


@pytest.mark.parametrize(("error", "expected"), [("ERR_PATH_STOP", ["MoveL 1 2 3 v100 fine", "path stopped", "on"]), ("", "motors off")])
def test_a_driver_may_reply_that_it_failed(program, error, expected):
    task = program(
        'MoveL p, v100, fine, tool0;\nTPWrite "on";\nERROR\nIF ERRNO = ERR_PATH_STOP TPWrite "path stopped";\nTRYNEXT;',
        "VAR robtarget p := [[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];",
    ).start()
    world = World()
    world.refused["MoveL"] = fx.Failed(error, "motors off")
    if error:
        assert world.run(task) == expected
    else:
        with pytest.raises(RapidError, match=expected):
            world.run(task)


def test_interrupts_beyond_the_queue_and_unknown_ones_are_lost(program):
    task = program("CONNECT i WITH t;\nIDisable;\nWaitTime 1;\nIEnable;", 'VAR intnum i;\nTRAP t\nTPWrite "trap";\nENDTRAP').start()
    run = task.run()
    next(run)
    effect = run.send(fx.Interrupted((1,) * 40 + (7,)))
    count = 0
    while True:
        assert isinstance(effect, fx.Write)
        count += 1
        try:
            effect = run.send(None)
        except StopIteration:
            break
    assert count == 30


def test_an_unfinished_effect_is_resumed_and_its_reply_is_the_one_that_comes_then(program):
    task = program('CONNECT i WITH t;\nIF di1 = 1 TPWrite "one";', 'VAR intnum i;\nTRAP t\nTPWrite "trap";\nENDTRAP').start()
    run = task.run()
    next(run)
    assert run.send(fx.Interrupted((1,), finished=False)).text == "trap"
    assert isinstance(run.send(None), fx.Resume)
    assert run.send(1.0).text == "one"


def test_an_error_in_a_trap_ends_the_program_and_exitcycle_in_a_trap_begins_again(program):
    declarations = 'VAR intnum i; VAR num count;\nTRAP t\nTPWrite "trap";\n{}\nENDTRAP'
    body = 'Incr count;\nIDelete i;\nCONNECT i WITH t;\nIF count = 1 WaitTime 1;\nTPWrite "end"\\Num:=count;'
    run = program(body, declarations.format("ExitCycle;")).start().run()
    next(run)
    texts = [run.send(fx.Interrupted((1,))).text]
    effect = run.send(None)
    while True:
        texts.append(type(effect).__name__ if not isinstance(effect, fx.Write) else effect.text)
        try:
            effect = run.send(None)
        except StopIteration:
            break
    assert texts == ["trap", "Unsubscribe", "end2"]
    run = program(body, declarations.format("count := 1 / 0;")).start().run()
    next(run)
    run.send(fx.Interrupted((1,)))
    with pytest.raises(RapidError, match="division by zero"):
        run.send(None)


def test_a_cycle_without_time_is_an_endless_loop(program):
    with pytest.raises(RapidError, match="endless loop"):
        list(program("ExitCycle;").start(max_steps=1000).run())


def test_long_arrays_are_as_fast_as_short_ones(program):
    body = "FOR i FROM 1 TO 100000 DO\nlist{i} := i;\nchange list, i;\nENDFOR\nTPWrite ValToStr(list{100000});"
    declarations = "VAR num list{100000};\nPROC change(INOUT num values{*}, num place)\nvalues{place} := values{place} + 1;\nENDPROC"
    begin = time.process_time()
    (write,) = program(body, declarations).start(max_steps=10_000_000).run()
    assert write.text == "100001"
    assert time.process_time() - begin < 5.0


def test_arrays_on_the_stack_are_bounded(program):
    declarations = "PROC down()\nVAR num list{1000000};\nlist{1} := 1;\ndown;\nENDPROC"
    with pytest.raises(RapidError, match="the arrays of the running routines"):
        list(program("down;", declarations).start().run())


def test_a_record_that_doubles_at_every_level_is_refused():
    parts = ["num", *(f"r{place}" for place in range(39))]
    levels = "\n".join(f"RECORD r{place}\n{part} a;\n{part} b;\nENDRECORD" for place, part in enumerate(parts))
    with pytest.raises(RapidErrors, match="more than 1000 components"):
        load_text(f"MODULE m\n{levels}\nVAR r39 x;\nENDMODULE")
