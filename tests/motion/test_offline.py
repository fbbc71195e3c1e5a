"""Sampling a run: positions exact, frames consistent, oracles cut to the order they answer."""

import numpy as np
import pytest

from mitl.errors import MitlError
from mitl.motion.offline import Frame, programmed_moves
from mitl.motion.oracles import PlannedOracles
from mitl.motion.record import View
from mitl.motion.robot_model import load_robot_model
from mitl.poses import transforms_of_path

EXACT = 1e-6  # m; the issue's own figure
CASE = r"""MODULE Orders
PERS tooldata tA := [TRUE,[[0,0,100],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];
PERS wobjdata w := [FALSE,TRUE,"",[[400,0,300],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
CONST robtarget p := [[50,0,100],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
VAR num option := 0;
PROC main()
  ConfL \Off; ConfJ \Off;
  MoveJ p,v300,fine,tA\WObj:=w;
  WHILE TRUE DO
    TEST option
    CASE 1:
      SetDO doBusy,1;
      MoveL Offs(p,0,100,0),v100,fine,tA\WObj:=w;
      MoveL p,v100,fine,tA\WObj:=w;
      SetDO doBusy,0;
      option := 0;
    CASE 2:
      WHILE TRUE DO WaitTime 1; ENDWHILE
    ENDTEST
    WaitTime 0.05;
  ENDWHILE
ENDPROC
ENDMODULE
"""


@pytest.fixture(scope="module")
def circle(rapid, moved):
    """A full circle of two arcs about (450, 50, 400), radius 50 mm."""
    return moved(
        rapid.joint(500, 50, 400),
        rapid.arc((450, 100, 400), (400, 50, 400), "z10", "v100"),
        rapid.arc((450, 0, 400), (500, 50, 400), "fine", "v100"),
    )


def test_a_circle_is_exact_also_where_its_two_arcs_meet(circle):
    samples = circle.samples()
    on_circle = samples.path.position[samples.move > 0]
    assert np.linalg.norm(on_circle - [0.45, 0.05, 0.4], axis=1) == pytest.approx(0.05, abs=EXACT)


def test_the_executed_circle_is_smaller_by_the_filters_closed_form(circle):
    """Two moving averages of width w shrink a circle run at angular speed a by (sin(a w / 2) / (a w / 2))^2."""
    samples = circle.samples(view=View.TOOL)
    half_way = circle.record.moves[1].ends
    inside = np.abs(samples.path.time - half_way) < 0.3
    angular, width = 0.1 / 0.05, load_robot_model("irb140").arm_windows[0]
    shrunk = 0.05 * np.sinc(angular * width / 2 / np.pi) ** 2
    radius = np.linalg.norm(samples.path.position[inside] - [0.45, 0.05, 0.4], axis=1)
    # the filters work on joints, not on the TCP: the difference is of the joints' curvature over the widths
    assert radius == pytest.approx(shrunk, abs=0.5 * (0.05 - shrunk))


def test_every_view_and_frame_tells_of_the_same_joints(circle):
    for view in View:
        world, base, wobj = (circle.samples(250.0, view, frame) for frame in Frame if frame is not None)
        np.testing.assert_array_equal(world.joints, base.joints)
        np.testing.assert_array_equal(world.path.position, wobj.path.position)  # wobj0
        X_BF = circle.run.planner.arm.flange(world.joints)
        X_FT = circle.record.moves[0].move.leg.X_FT
        tolerance = 2e-6 if view is View.PLANNED else 1e-9  # planned joints are interpolated between ticks, positions exact
        assert (X_BF * X_FT).translation == pytest.approx(world.path.position, abs=tolerance)


def test_quaternions_do_not_flip(circle):
    quaternion = circle.samples().path.quaternion_wxyz
    assert np.sum(quaternion[1:] * quaternion[:-1], axis=1).min() > 0.99


def test_the_moves_are_told_as_programmed(circle):
    moves = programmed_moves(circle.run, circle.record.moves, 1.0)
    assert [move.kind for move in moves] == ["MoveJ", "MoveC", "MoveC"]
    assert moves[1].via[:3] == pytest.approx([0.45, 0.1, 0.4])
    assert moves[1].start[:3] == pytest.approx([0.5, 0.05, 0.4], abs=EXACT)
    assert moves[1].end[:3] == pytest.approx(moves[2].start[:3], abs=EXACT)
    assert moves[1].zone == pytest.approx(0.01)
    assert moves[1].begins == pytest.approx(circle.record.moves[1].begins - 1)


def test_an_oracle_is_what_follows_its_order(tmp_path):
    (tmp_path / "orders.mod").write_text(CASE)
    oracles = PlannedOracles(load_robot_model("irb140"))
    oracle = oracles.oracle([tmp_path / "orders.mod"], {"option": "1"})
    assert [move.line for move in oracle.moves] == [13, 14]
    assert oracle.tcp.time[0] == 0
    assert oracle.tcp.position[[0, -1]] == pytest.approx(np.array([[0.05, 0, 0.1]] * 2), abs=EXACT)
    assert oracle.tcp.position[:, 1].max() == pytest.approx(0.1, abs=5e-5)  # the pause of a fine point is shorter than filters and lag
    assert oracle.wobj[:3] == pytest.approx([0.4, 0, 0.3])
    times, values = oracle.signals["doBusy"]
    assert list(values) == [0, 1, 0]
    assert np.all(np.diff(times) >= 0)
    assert transforms_of_path(oracle.tcp)[0].rotation.magnitude() == pytest.approx(np.pi)
    assert oracles.oracle([tmp_path / "orders.mod"], {"option": "1"}) is oracle, "the same question is answered from memory"


def test_an_order_that_is_never_done_is_told(tmp_path):
    (tmp_path / "orders.mod").write_text(CASE)
    with pytest.raises(MitlError, match="not done after 600 s"):
        PlannedOracles(load_robot_model("irb140")).oracle([tmp_path / "orders.mod"], {"option": "2"})
