"""Faults: parsed strictly, and each changes the motion by about its size."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mitl.controllers.faults import KINDS, effect_filter, joint_offset, orientation_law, parse_fault, playback, robot_model
from mitl.errors import UsageError
from mitl.motion.bridge import work_object_frame
from mitl.motion.robot_model import load_robot_model
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


def test_a_turned_target_is_turned_about_its_own_z_axis_and_stays_in_its_place():
    for target, right in ((broken("target-turn=8", LINE).target, LINE.target), (broken("target-turn=8", ARC).via, ARC.via)):
        q, q0 = (np.array([o.rot.q1, o.rot.q2, o.rot.q3, o.rot.q4]) for o in (target, right))
        turn = Rotation.from_quat(q0, scalar_first=True).inv() * Rotation.from_quat(q, scalar_first=True)
        assert np.degrees(turn.as_rotvec()) == pytest.approx([0, 0, 8], abs=1e-9)
        assert target.trans == right.trans


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


def test_only_servo_faults_move_the_axes():
    assert np.degrees(joint_offset([parse_fault("joint-offset=2")])(0.0)) == pytest.approx([0, 0, 2, 0, 0, 0])
    assert np.degrees(joint_offset([parse_fault("joint-drift=3")])(20.0)) == pytest.approx([1, 0, 0, 0, 0, 0])
    others = [parse_fault(name) for name in KINDS if name not in {"joint-offset", "joint-drift"}]
    assert not joint_offset(others)(100.0).any()


def test_faults_add_up():
    filtered = effect_filter([parse_fault("target-offset=1"), parse_fault("target-offset=2")])
    assert filtered(LINE).target.trans.x == 103


SPLIT = data.WObjData(uframe=data.Pose(data.Pos(500, 0, 400)), oframe=data.Pose(data.Pos(), data.Orient(0.923879533, 0, 0, 0.382683432)))


@pytest.mark.parametrize("name", [name for name, kind in KINDS.items() if kind.make_filter is not None and kind.unit != "share"])
def test_a_filter_of_size_0_changes_nothing(name):
    line = replace(LINE, wobj=SPLIT)
    assert effect_filter([parse_fault(f"{name}=0")])(line) == line


def test_work_object_and_tool_are_lost_inverted_or_composed_wrongly():
    line = replace(LINE, wobj=SPLIT)
    right = work_object_frame(SPLIT)
    assert broken("work-object-ignored=0.5", line).wobj.uframe.trans == data.Pos(250, 0, 200)
    assert broken("tool-inverted", line).tool.tframe.trans.z == -100
    assert broken("tool-inverted=0.5", line).tool.tframe.trans.z == 0
    inverted = work_object_frame(broken("object-frame-inverted", line).wobj)
    assert np.degrees((right.inv() * inverted).rotation.as_rotvec()) == pytest.approx([0, 0, -90], abs=1e-6)
    swapped = work_object_frame(broken("frame-order", line).wobj)
    assert swapped.translation == pytest.approx([0.5 * np.sqrt(0.5), 0.5 * np.sqrt(0.5), 0.4])


def test_an_arc_is_run_on_the_other_side():
    via = broken("wrong-arc", LINE, ARC).via.trans
    assert (via.x, via.y) == pytest.approx((50, 80))


def test_a_wait_is_longer():
    assert broken("wait-time=10", effects.Wait(AT, 2.0)).seconds == pytest.approx(2.2)


def test_a_controller_that_ignores_limits_believes_in_wider_ones():
    model = load_robot_model("irb140")
    wider = robot_model(model, [parse_fault("joint-limit-ignored=10")])
    assert np.degrees(wider.upper - model.upper) == pytest.approx([10] * 6)


@dataclass(frozen=True)
class Straight:
    """One axis at 1 rad/s from 0 to 2 s, then at rest; a zone at 1 s."""

    moves: tuple = (
        SimpleNamespace(
            begins=0.0, ends=1.0, move=SimpleNamespace(fine=False, zone=SimpleNamespace(radius=0.02), speed=SimpleNamespace(tcp=0.2))
        ),
        SimpleNamespace(begins=1.0, ends=2.0, move=SimpleNamespace(fine=True)),
    )

    def joints_at(self, time):
        return np.array([min(max(time, 0.0), 2.0), 0, 0, 0, 0, 0])


def angle(text, time):
    return playback([parse_fault(text)])(Straight(), time)[0]


def test_a_hiccup_halts_the_motion_for_its_size_and_makes_it_good():
    assert angle("hiccup=50", 0.5) == pytest.approx(0.5)
    assert angle("hiccup=50", 0.55) == pytest.approx(0.5)
    assert angle("hiccup=50", 0.75) == pytest.approx(0.75)


def test_the_speed_sags_in_a_zone_by_its_size_on_average():
    assert angle("speed-dip=20", 1.1) - angle("speed-dip=20", 0.9) == pytest.approx(0.8 * 0.2)
    assert angle("speed-dip=20", 1.3) == pytest.approx(1.3)


def test_an_overshoot_passes_the_stop_and_comes_back():
    assert angle("overshoot=25", 2.01) == pytest.approx(2.025)
    assert angle("overshoot=25", 2.1) == pytest.approx(2.0)


def test_acceleration_limits_are_looser_or_gone():
    limit = effects.LimitPathAcceleration(AT, 1.0, 2.0)
    gentle = effects.SetAcceleration(AT, 20, 50)
    assert broken("acceleration-limit-ignored", limit) == effects.LimitPathAcceleration(AT, None, None)
    assert broken("acceleration-limit-ignored=.5", limit) == effects.LimitPathAcceleration(AT, 2.0, 4.0)
    assert broken("acceleration-limit-ignored=0", limit) == limit
    assert broken("acceleration-limit-ignored=.5", gentle) == effects.SetAcceleration(AT, 60, 75)


def test_an_analog_output_is_too_large_and_a_digital_one_is_not():
    def actions(*given):
        return tuple(effects.Trigger(action=action) for action in given)

    moved = effects.TriggerMove(
        AT, LINE, actions(effects.SetOutput("ao", 5.0), effects.RampOutput("ao", 5.0, 40.0), effects.SetOutput("do", 1.0))
    )
    assert broken("analog-scale=20", moved).triggers == actions(
        effects.SetOutput("ao", 6.0), effects.RampOutput("ao", 6.0, 40.0), effects.SetOutput("do", 1.0)
    )
    follows = effects.TriggerMove(AT, LINE, actions(effects.FollowSpeed("ao", 0.02, 0.0)))
    assert broken("analog-scale=50", follows).triggers == actions(effects.FollowSpeed("ao", 0.03, 0.0))


@dataclass(frozen=True)
class ToAndFro:
    """A record in which axis 1 goes to 1 rad and back, a second each, twice; a stand-in for a MotionRecord as a playback sees it."""

    moves: tuple = tuple(SimpleNamespace(begins=float(second), ends=second + 1.0) for second in range(4))

    def joints_at(self, time):
        there = time % 2
        return np.array([min(there, 2 - there) if 0 < time < 4 else 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])


def test_play_leaves_an_axis_behind_on_either_side_and_scatter_somewhere_else_each_time():
    record = ToAndFro()
    loose, scattered = playback([parse_fault("backlash=2")]), playback([parse_fault("scatter=1")])
    late = [np.degrees(loose(record, time)[0] - record.joints_at(time)[0]) for time in (0.9, 1.9, 2.9)]
    assert late == pytest.approx([-1.0, 1.0, -1.0])
    off = [np.degrees(scattered(record, time)[0] - record.joints_at(time)[0]) for time in (1.0 - 1e-9, 2.0 - 1e-9, 3.0 - 1e-9)]
    assert len({round(value, 6) for value in off}) == 3
    assert max(np.abs(off)) < 4.0
    assert playback([parse_fault("scatter=0"), parse_fault("backlash=0")])(record, 0.7) == pytest.approx(record.joints_at(0.7))


def test_a_sluggish_arm_has_less_acceleration():
    model = load_robot_model("irb140")
    assert robot_model(model, [parse_fault("sluggish=50")]).tcp_acceleration == pytest.approx(model.tcp_acceleration / 2)


def test_settings_that_are_ignored_keep_nothing_of_what_they_say():
    assert broken("configuration-ignored", effects.SetConfiguration(AT, True, True)) == effects.SetConfiguration(AT, True, False)
    assert broken("override-ignored=.5", effects.SetVelocity(AT, 50.0, 150.0)) == effects.SetVelocity(AT, 75.0, 300.0)
    shift = effects.SetDisplacement(AT, data.Pose(data.Pos(0, 10, 40)))
    assert broken("displacement-ignored", shift).displacement.trans == data.Pos(0, 0, 0)
    turned = broken("wrong-configuration", effects.MoveJ(target=data.RobTarget(data.Pos(100, 30, 50)), **COMMON)).target.robconf
    assert (turned.cf1, turned.cf4, turned.cf6, turned.cfx) == (0, -2, -2, 1)


def test_a_late_turn_begins_and_ends_with_the_move_and_is_behind_by_its_size_in_the_middle():
    law = orientation_law([parse_fault("orientation-late=.2")])
    assert law(np.array([0.0, 0.5, 1.0])) == pytest.approx([0.0, 0.3, 1.0])
    assert (np.diff(law(np.linspace(0, 1, 50))) > 0).all()
