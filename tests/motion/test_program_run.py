"""A RAPID task in time: when outputs fire, what waits do, and how a program that never stops goes on."""

import numpy as np
import pytest

from mitl.errors import MotionError
from mitl.motion import task_run
from mitl.motion.record import View
from mitl.motion.signals import InputChange
from mitl.motion.trigger_times import PREFETCH
from rapid_interp import RapidError

ROUNDING = 1e-9


def signal(motion, name="doDone"):
    return motion.run.signals[name]


def test_after_a_zone_an_output_fires_before_the_zone_begins(rapid, moved):
    motion = moved(
        rapid.joint(450, 0, 400), rapid.line(450, 200, 400, "z50", "v200"), "SetDO doDone,1;", rapid.line(250, 200, 400, speed="v200")
    )
    chain = motion.record.chains[-1]
    entry = chain.start + chain.chain.timing.times_at(np.array([0.150]))[0]
    assert signal(motion) == [(pytest.approx(entry - PREFETCH), 1)]


def test_after_a_stop_point_an_output_waits_for_the_stop(rapid, moved):
    motion = moved(rapid.joint(450, 0, 400), rapid.line(450, 200, 400), "SetDO doDone,1;", rapid.line(250, 200, 400))
    assert signal(motion)[0][0] >= motion.record.moves[1].ends - ROUNDING
    assert signal(motion)[0][0] <= motion.record.moves[2].begins + ROUNDING


def test_outputs_keep_their_order_and_a_delay_is_added(rapid, moved):
    motion = moved(
        rapid.joint(450, 0, 400),
        rapid.line(450, 100, 400, "z10"),
        "SetDO doDone,1;",
        rapid.line(450, 100, 300, "z10"),
        "SetDO doDone,0;",
        "SetDO \\SDelay:=0.5, doLater, 1;",
        rapid.line(450, 0, 300),
    )
    (up, one), (down, zero) = signal(motion)
    assert (one, zero) == (1, 0)
    assert up < down
    assert signal(motion, "doLater")[0][0] == pytest.approx(down + 0.5)
    assert motion.run.value_of("doDone", up - 1e-6) == 0
    assert motion.run.value_of("doDone", 0.5 * (up + down)) == 1


def test_a_wait_in_a_fly_by_point_makes_a_stop_of_it_and_says_so(rapid, moved):
    motion = moved(rapid.joint(450, 0, 400), rapid.line(450, 200, 400, "z50"), "WaitTime 0.5;", rapid.line(250, 200, 400))
    assert ["50024" in event.text for event in motion.run.events] == [True]
    assert "M:" in motion.run.events[0].text
    samples = motion.samples()
    assert np.linalg.norm(samples.path.position - [0.45, 0.2, 0.4], axis=1).min() < 1e-6, "the corner is reached"


def test_a_short_wait_in_a_fly_by_point_stops_nothing(rapid, moved):
    motion = moved(rapid.joint(450, 0, 400), rapid.line(450, 200, 400, "z50"), "WaitTime 0.01;", rapid.line(250, 200, 400))
    assert motion.run.events == []
    corner = motion.record.moves[1].ends
    assert motion.record.planned_tcp(np.linspace(corner - 0.2, corner + 0.2, 200))[2].min() > 0.05


def test_a_wait_after_a_stop_takes_its_time(rapid, moved):
    plain, waiting = (
        moved(rapid.joint(450, 0, 400), rapid.line(450, 100, 400), *wait, rapid.line(350, 100, 400)) for wait in ([], ["WaitTime 1.5;"])
    )
    assert waiting.record.moves[2].begins - plain.record.moves[2].begins == pytest.approx(1.5, abs=0.06)  # the pause of the stop ends in it


def test_tpwrite_and_clocks_know_the_time(rapid, moved):
    motion = moved("ClkStart c;", "WaitTime 2;", 'TPWrite "t=" \\Num:=ClkRead(c);', rapid.joint(450, 0, 400), 'TPWrite "there";')
    first, second = motion.run.written
    assert (first.text, first.time) == ("t=2", pytest.approx(2))
    assert second.time >= motion.record.moves[0].ends - ROUNDING


def test_inputs_are_read_when_the_program_asks(rapid, moved):
    inputs = (InputChange("diGo", 1, 1.0), InputChange("diGo", 0, 2.0))
    motion = moved("WHILE diGo = 0 DO WaitTime 0.05; ENDWHILE", rapid.joint(450, 0, 400), inputs=inputs)
    assert 1.0 <= motion.record.moves[0].begins <= 1.15


def test_an_output_is_read_back_as_it_was_set(rapid, moved):
    motion = moved("SetDO doDone,1;", 'IF doDone = 1 TPWrite "set";')
    assert [line.text for line in motion.run.written] == ["set"]


def test_an_endless_loop_without_time_is_told_with_its_line(moved):
    with pytest.raises((MotionError, RapidError), match=r"endless|steps") as refused:
        moved("WHILE TRUE DO", "SetDO doDone,1;", "ENDWHILE")
    assert refused.value.line in range(10, 13)


def square(rapid, y0=0.0):
    corners = [(450, y0 + 0), (450, y0 + 100), (350, y0 + 100), (350, y0)]
    return [rapid.line(x, y, 400, "z20", "v300") for x, y in corners]


def test_an_endless_fly_by_loop_is_carried_on_without_a_dip_in_speed(rapid, moved):
    """300 sides, planned 200 at a time: no plan's seam is seen in speed, joints, or the order of moves."""
    motion = moved(rapid.joint(350, 0, 400), "WHILE TRUE DO", *square(rapid), "ENDWHILE", until=80.0)
    assert not motion.run.finished
    chains = motion.record.chains
    assert len(chains) >= 3
    assert motion.run.events == []
    for before, after in zip(chains[1:-1], chains[2:], strict=True):
        assert after.start == pytest.approx(before.end, abs=ROUNDING)
        leaving = before.chain.timing.at(np.array([before.chain.timing.duration]))[1][0]
        entering = after.chain.timing.at(np.zeros(1))[1][0]
        assert entering == pytest.approx(leaving, rel=1e-9)
        assert entering > 0.05
        seam = motion.planned_joints(np.array([after.start - 1e-7, after.start + 1e-7]))
        assert np.abs(np.diff(seam, axis=0)).max() < 1e-6
    times = np.linspace(chains[1].start + 1, chains[-1].start + 1, 20000)
    speed = motion.record.planned_tcp(times)[2]
    one_round = speed[:2000].min()
    assert speed.min() >= 0.99 * one_round, "every corner is passed as fast as the first ones"
    begins = [executed.begins for executed in motion.record.moves]
    assert begins == sorted(begins)
    lines = [executed.move.effect.at.line for executed in motion.record.moves[1:9]]
    assert lines[:4] == lines[4:]


@pytest.mark.parametrize("look_ahead", [3, 5, 20])
def test_however_far_it_looks_ahead_limits_hold_and_the_path_is_the_same(rapid, moved, monkeypatch, look_ahead):
    lines = [rapid.joint(450, 0, 400), *(square(rapid) * 8), rapid.line(450, 0, 400)]
    whole = moved(*lines)
    monkeypatch.setattr(task_run, "LOOK_AHEAD", look_ahead)
    motion = moved(*lines)
    for view in View:
        assert motion.holds(view)
    assert len(motion.record.moves) == len(whole.record.moves)
    far = motion.samples(rate=100).path.position
    path = whole.samples(rate=2000).path.position
    assert max(np.linalg.norm(path - place, axis=1).min() for place in far) < 2e-4  # the reference's samples are .15 mm apart


def test_holding_stops_along_the_path_and_the_program_does_not_go_on(rapid, moved):
    motion = moved(rapid.joint(350, 0, 400), "WHILE TRUE DO", *square(rapid), "ENDWHILE", until=3.0)
    moves = len(motion.record.moves)
    now = motion.run.next_event()
    held_at = motion.record.joints_at(now)
    motion.run.hold(now)
    assert motion.run.next_event() == np.inf
    assert motion.record.joints_at(now) == pytest.approx(held_at, abs=1e-7), "the past stays, to within the end of a spline"
    assert motion.record.end < now + 0.5
    position, _, speed = motion.record.planned_tcp(np.linspace(now, motion.record.end, 50))
    assert speed[-1] == pytest.approx(0, abs=1e-9)
    assert np.abs(position[:, 2] - 0.4).max() < 1e-9, "on the plane of the square"
    assert len(motion.record.moves) <= moves


def test_a_fine_point_pauses_as_long_as_the_model_says(rapid, moved):
    motion = moved(rapid.joint(450, 0, 400), rapid.line(450, 100, 400), rapid.line(350, 100, 400))
    first, second = motion.record.chains[1:]
    model = motion.model
    assert second.start - first.end == pytest.approx(max(model.pause_after(0.3), model.start_latency), abs=1e-6)


def test_stop_ends_the_program_after_its_motion(rapid, moved):
    motion = moved(rapid.joint(450, 0, 400), rapid.line(450, 100, 400, "z10"), "Stop;", rapid.line(350, 100, 400))
    assert len(motion.record.moves) == 2
    assert motion.run.finished
