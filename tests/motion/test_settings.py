"""What a program says about the moves after it: displacement, payload, configurations; and where in the text a refused move stands."""

import numpy as np
import pytest

from mitl.errors import MotionError
from mitl.motion.offline import Frame

EXACT = 1e-6


def test_a_displacement_shifts_and_turns_targets_but_not_joint_targets(rapid, moved):
    motion = moved(
        rapid.joint(450, 0, 400),
        "PDispSet [[10,-20,30],[0.9961946981,0,0,0.0871557427]];",  # 10 deg about z
        rapid.line(430, 50, 380),
        rapid.joint(430, 60, 380),
        rapid.axes(0, 10, 10, 0, 40, 0),
        "PDispOff;",
        rapid.line(430, 50, 380),
    )
    ends = [1e3 * (motion.run.planner.arm.flange(e.move.leg.q_end) * e.move.leg.X_FT).translation for e in motion.record.moves]
    turn = np.array([[np.cos(np.pi / 18), -np.sin(np.pi / 18), 0], [np.sin(np.pi / 18), np.cos(np.pi / 18), 0], [0, 0, 1]])
    assert ends[1] == pytest.approx(turn @ [430, 50, 380] + [10, -20, 30], abs=1e3 * EXACT)
    assert ends[2] == pytest.approx(turn @ [430, 60, 380] + [10, -20, 30], abs=1e3 * EXACT)
    assert np.degrees(motion.record.moves[3].move.leg.q_end) == pytest.approx([0, 10, 10, 0, 40, 0])
    assert ends[4] == pytest.approx([430, 50, 380], abs=1e3 * EXACT)


def test_a_displacement_acts_within_the_work_object(rapid, moved):
    line = f"MoveL {rapid.target(-30, 40, 50)},v300,fine,tA\\WObj:=wTurned;"
    motion = moved(rapid.joint(450, 0, 400), "PDispSet [[5,6,7],[1,0,0,0]];", line)
    last = motion.samples(frame=Frame.WORK_OBJECT).path.position[-1]
    assert 1e3 * last == pytest.approx([-25, 46, 57], abs=1e3 * EXACT)


def test_a_move_knows_what_the_gripper_holds(rapid, moved):
    held = "GripLoad [2.5,[0,0,40],[1,0,0,0],0,0,0.01];"
    motion = moved(rapid.joint(450, 0, 400), held, rapid.line(450, 50, 400), "GripLoad load0;", rapid.line(450, 0, 400))
    loads = [executed.move.settings.load for executed in motion.record.moves]
    assert loads[0] is None
    assert (loads[1].mass, loads[1].cog.z) == (2.5, 40)
    assert loads[2].mass == pytest.approx(0.001)


def test_a_refusal_names_the_column_of_the_instruction(rapid, moved):
    with pytest.raises(MotionError, match="out of reach") as refused:
        moved(rapid.joint(450, 0, 400) + "  " + rapid.line(900, 0, 400))
    assert refused.value.column == len(rapid.joint(450, 0, 400)) + 3
