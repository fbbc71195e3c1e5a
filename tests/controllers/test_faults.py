"""Faults: parsed strictly, and each changes the motion by about its size."""

import numpy as np
import pytest

from mitl.controllers.faults import KINDS, effect_filter, joint_offset, orientation_law, parse_fault
from mitl.errors import UsageError
from mitl.motion.bridge import work_object_frame
from rapid_interp import data, effects

AT = effects.SourceLine("M", "main", "m.mod", 1)
COMMON = {
    "at": AT,
    "speed": data.SpeedData(200, 500, 5000, 1000),
    "zone": data.ZoneData(False, 50, 75, 75, 7.5, 75, 7.5),
    "tool": data.ToolData(tframe=data.Pose(data.Pos(0, 0, 100))),
    "wobj": data.WObjData(uframe=data.Pose(data.Pos(500, 0, 400), data.Orient(0.923879533, 0, 0, 0.382683432))),
}
LINE = effects.MoveL(target=data.RobTarget(data.Pos(100, 30, 50)), **COMMON)
ARC = effects.MoveC(via=data.RobTarget(data.Pos(150, 80, 50)), target=data.RobTarget(data.Pos(100, 130, 50)), **COMMON)


def broken(text, *moves):
    filtered = effect_filter([parse_fault(text)])
    return [filtered(move) for move in moves][-1]


def test_a_name_alone_has_the_default_size_and_a_size_can_be_given():
    assert parse_fault("target-offset").size == KINDS["target-offset"].size
    assert parse_fault("target-offset=2.5").size == 2.5


@pytest.mark.parametrize(("text", "said"), [("target-ofset", "target-offset"), ("nonsense", "known are"), ("speed=fast", "per cent")])
def test_an_unknown_name_or_size_is_refused_with_a_hint(text, said):
    with pytest.raises(UsageError, match=said):
        parse_fault(text)


def test_a_target_offset_shifts_every_target_by_its_size():
    assert broken("target-offset=7", LINE).target.trans == data.Pos(107, 30, 50)
    assert broken("target-offset=7", ARC).via.trans == data.Pos(157, 80, 50)


def test_a_wrong_work_object_is_turned_about_its_own_z_axis():
    turned = work_object_frame(broken("wrong-work-object=4", LINE).wobj)
    right = work_object_frame(LINE.wobj)
    between = np.degrees((right.inv() * turned).rotation.as_rotvec())
    assert between == pytest.approx([0, 0, 4], abs=1e-6)
    assert turned.translation == pytest.approx(right.translation)


def test_a_wrong_tool_is_longer():
    assert broken("wrong-tool=5", LINE).tool.tframe.trans.z == 105


def test_a_circle_bulges_by_its_size_in_the_middle():
    via = broken("circle-radius=10", LINE, ARC).via.trans
    assert (via.x, via.y, via.z) == pytest.approx((160, 80, 50))


def test_a_zone_becomes_a_stop_point_or_loses_a_share():
    assert broken("zone-as-fine", LINE).zone.finep
    assert broken("zone-as-fine=0.4", LINE).zone.pzone_tcp == pytest.approx(30)
    assert broken("zone-size=-50", LINE).zone.pzone_tcp == pytest.approx(25)


def test_speed_is_off_by_a_per_cent():
    assert broken("speed=3", LINE).speed.v_tcp == pytest.approx(206)


def test_an_axis_sign_mirrors_y():
    assert broken("axis-sign", LINE).target.trans == data.Pos(100, -30, 50)


def test_joint_targets_have_no_work_object_to_be_wrong():
    move = effects.MoveAbsJ(target=data.JointTarget(), **COMMON)
    for name in ("target-offset", "wrong-work-object", "wrong-tool", "axis-sign", "circle-radius"):
        assert broken(name, move) == move


def test_late_turning_does_nothing_first_and_all_in_the_end():
    law = orientation_law([parse_fault("orientation-not-interpolated=0.8")])
    assert law(np.array([-1.0, 0.0, 0.8, 1.0, 2.0])) == pytest.approx([0, 0, 0, 1, 1])
    assert orientation_law([])(np.array([0.3])) == pytest.approx([0.3])


def test_only_the_servo_fault_moves_the_axes():
    assert np.degrees(joint_offset([parse_fault("joint-offset=2")])) == pytest.approx([0, 0, 2, 0, 0, 0])
    assert not joint_offset([parse_fault(name) for name in KINDS if name != "joint-offset"]).any()


def test_faults_add_up():
    filtered = effect_filter([parse_fault("target-offset=1"), parse_fault("target-offset=2")])
    assert filtered(LINE).target.trans.x == 103
