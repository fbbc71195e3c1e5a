"""The heartbeat comes into a program without changing its lines or its motions."""

import numpy as np
import pytest

import rapid_interp
from mitl.errors import RigError
from mitl.motion.oracles import PlannedOracles
from mitl.motion.robot_model import load_robot_model
from mitl.rig.heartbeat import HeartBeat, guard_module, with_heartbeat

PROGRAM = """MODULE Orders
  ! main is not the first routine
  PROC other()
    TPWrite "x";
  ENDPROC
  PROC Main()
    VAR num i:=3;
    IF i = 3 THEN
      MoveAbsJ [[20,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v500, fine, tool0;
      WaitTime 4;
      MoveAbsJ [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v500, fine, tool0;
    ENDIF
  ENDPROC
ENDMODULE
"""


@pytest.fixture
def program(tmp_path):
    file = tmp_path / "orders.mod"
    file.write_text(PROGRAM, encoding="utf-8")
    (tmp_path / "made").mkdir()
    return file


def test_only_a_call_before_the_first_instruction_of_main_comes_in(program, tmp_path):
    made, guard = with_heartbeat([program], tmp_path / "made", 3.0)
    before, after = PROGRAM.splitlines(), made.read_text(encoding="utf-8").splitlines()
    assert len(before) == len(after)
    assert [(a, b) for a, b in zip(before, after, strict=True) if a != b] == [("    IF i = 3 THEN", "    mitlWatch; IF i = 3 THEN")]
    assert "ITimer 0.5,tick;" in guard.read_text(encoding="utf-8")


def test_what_it_moves_is_the_same(program, tmp_path):
    oracles = PlannedOracles(load_robot_model("irb140"))
    plain = oracles.oracle([program], {})
    guarded = oracles.oracle(with_heartbeat([program], tmp_path / "made", 30.0), {})
    np.testing.assert_allclose(guarded.tcp.position, plain.tcp.position, atol=1e-9)
    assert [move.line for move in guarded.moves] == [move.line for move in plain.moves]


def test_the_stream_is_started_by_the_same_call_and_all_of_it_is_rapid(program, tmp_path):
    files = with_heartbeat([program], tmp_path / "made", 3.0, egm_device="UCdevice")
    assert rapid_interp.load(files).data
    text = guard_module(3.0, egm_device="UCdevice")
    assert text.index("mitlStream;") < text.index("EGMStreamStart")
    assert text.index("egmident") < text.index("PROC"), "a module's data stand before its routines"


@pytest.mark.parametrize(
    "text", ["MODULE A\n  PROC other()\n    Stop;\n  ENDPROC\nENDMODULE\n", "MODULE A\n  PROC main()\n  ENDPROC\nENDMODULE\n"]
)
def test_a_program_without_a_main_to_guard_is_refused(tmp_path, text):
    (tmp_path / "a.mod").write_text(text, encoding="utf-8")
    (tmp_path / "made").mkdir()
    with pytest.raises(RigError, match="expected one main"):
        with_heartbeat([tmp_path / "a.mod"], tmp_path / "made", 3.0)


def test_a_beat_that_fails_is_told_and_the_next_is_tried():
    beats = []

    def write(beat):
        beats.append(beat)
        if len(beats) == 2:
            raise RigError("the network is gone")

    heart = HeartBeat(write, 0.01, lambda: True)
    heart.go()
    while len(beats) < 4:
        pass
    heart.close()
    assert beats[:4] == ["1", "2", "3", "4"]
    assert heart.problem == ""


def test_nothing_beats_where_nothing_watches():
    beats = []
    heart = HeartBeat(beats.append, 0.01, lambda: False)
    heart.go()
    heart.close()
    assert beats == ["1"]


def test_the_stream_moves_nothing(program, tmp_path):
    oracles = PlannedOracles(load_robot_model("irb140"))
    streamed = oracles.oracle(with_heartbeat([program], tmp_path / "made", 30.0, egm_device="UCdevice"), {})
    np.testing.assert_allclose(streamed.tcp.position, oracles.oracle([program], {}).tcp.position, atol=1e-9)
