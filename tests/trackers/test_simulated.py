"""What is particular to the simulated tracker: its clock, its sessions, what it does when lost."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.distance import pdist

from mitl.errors import RigError
from mitl.poses import IDENTITY
from mitl.resources import models_folder
from mitl.simulation.tracker_model import TrackerModel
from mitl.simulation.tracker_parameters import load_preset
from mitl.simulation.world import World
from mitl.trackers.simulated import SimulatedTracker, TrackerClock, diameter

THESIS, IDEAL = load_preset("thesis"), load_preset("ideal")
LOSING = replace(THESIS, loss=replace(THESIS.loss, rate_per_s=2.0, duration_s=0.3))


class Still:
    def joints_at(self, _time):
        return np.zeros(6)


def bench(parameters, seed=1, clock=None):
    world = World(models_folder() / "irb140" / "robot.urdf", Still(), TrackerModel(parameters, seed), X_WL=IDENTITY, X_FM=IDENTITY)
    return world, SimulatedTracker(world, clock or TrackerClock.drawn(parameters, seed))


def test_its_clock_has_an_offset_of_some_hundred_seconds_and_a_small_rate_error():
    clocks = [TrackerClock.drawn(THESIS, seed) for seed in range(200)]
    offsets, rates = np.array([clock.offset for clock in clocks]), np.array([clock.rate_error for clock in clocks])
    assert 100 <= offsets.min() < 200 < 800 < offsets.max() <= 900
    assert rates.std() == pytest.approx(5e-6, rel=0.2)
    assert TrackerClock.drawn(THESIS, 3) == TrackerClock.drawn(THESIS, 3)
    assert TrackerClock.drawn(IDEAL, 3) == TrackerClock(0.0, 0.0)


def test_all_its_times_are_on_its_own_clock():
    world, tracker = bench(IDEAL, clock=TrackerClock(500.0, 0.01))
    tracker.start()
    world.wait(1.0)
    assert tracker.stop().time[[0, -1]] == pytest.approx([500.0, 501.01])
    assert tracker.latest().time[0] == pytest.approx(501.01)
    assert tracker.average(1.0).time == pytest.approx(500.0 + 1.01 * 1.5)


def test_the_ideal_tracker_in_the_robots_frame_shows_the_flange():
    _, tracker = bench(IDEAL)
    point = tracker.average(0.5)
    assert point.position == pytest.approx([0.515, 0.0, 0.712], abs=1e-12)
    assert point.quaternion_wxyz == pytest.approx([np.sqrt(0.5), 0, np.sqrt(0.5), 0], abs=1e-12)
    assert point.jitter == pytest.approx(0.0, abs=1e-12)


def test_before_the_first_sample_there_is_no_latest_one():
    _, tracker = bench(THESIS)
    with pytest.raises(RigError, match="no sample yet"):
        tracker.latest()


def test_an_average_uses_valid_samples_only():
    _, tracker = bench(LOSING)
    point = tracker.average(3.0)
    assert point.count < 700
    # Lost samples read zero, .88 m away: one in the mean or the cloud would show.
    assert point.jitter < 0.01
    assert np.linalg.norm(point.position) == pytest.approx(np.linalg.norm([0.515, 0.712]), abs=0.02)


def test_a_lost_tracker_says_so():
    always = replace(THESIS, loss=replace(THESIS.loss, rate_per_s=250.0, duration_s=10.0))
    world, tracker = bench(always)
    tracker.start()
    with pytest.raises(RigError, match=r"the tracker is lost: none of 126 samples in 0\.5 s is valid"):
        tracker.average(0.5)
    with pytest.raises(RigError, match="the tracker is lost"):
        tracker.latest()
    path = tracker.stop()
    assert len(path) == 126
    assert not path.valid.any()
    assert world.now() == 0.5


def test_a_tracker_that_begins_with_another_seed_measures_as_a_new_one_with_it():
    world, tracker = bench(THESIS, seed=1)
    tracker.start()
    world.wait(1.0)
    tracker.begin(TrackerModel(THESIS, seed=2))
    with pytest.raises(RigError, match="not started"):
        tracker.path()
    again = tracker.average(1.0)
    expected = bench(THESIS, seed=2)[1].average(1.0)
    # The new one has one sample more, that at its very beginning.
    assert again.position == pytest.approx(expected.position, abs=2e-4)
    assert not np.allclose(again.position, bench(THESIS, seed=1)[1].average(1.0).position, atol=2e-4)


def test_hours_without_recording_keep_no_samples():
    world, tracker = bench(IDEAL)
    world.wait(30.0)
    tracker.start()
    world.wait(0.1)
    assert len(tracker.stop()) == 25


@given(arrays(float, st.tuples(st.integers(2, 40), st.just(3)), elements=st.floats(-1, 1, width=32)))
@settings(deadline=None, derandomize=True)
def test_the_diameter_is_the_greatest_distance(points):
    assert diameter(points) == pytest.approx(pdist(points).max(), abs=1e-12)


def test_the_diameter_of_many_points_is_found_in_blocks():
    points = np.random.default_rng(1).normal(size=(2500, 3))
    points[[3, 2400]] = [[9.0, 0.0, 0.0], [-9.0, 0.0, 0.0]]
    assert diameter(points) == pytest.approx(18.0)
    assert diameter(points[:1]) == 0.0


def test_samples_are_the_same_however_often_the_world_waits():
    """Chunks are of the world's choice until somebody reads; what is read is all up to now."""
    paths = []
    for steps in (1, 200):
        world, tracker = bench(THESIS)
        world.wait(0.502)  # between two samples
        tracker.start()
        for _ in range(steps):
            world.wait(2.0 / steps)
        assert tracker.latest().time[0] == pytest.approx(tracker.path().time[-1])
        world.wait(0.1)
        path = tracker.stop()
        world.wait(0.1)  # no longer recorded
        assert len(tracker.path()) == len(path) == 525
        paths.append(path)
    assert np.array_equal(paths[0].position, paths[1].position)
    assert np.array_equal(paths[0].time, paths[1].time)


def test_a_button_that_is_wired_later_is_not_in_the_samples_before():
    from mitl.simulation.tracker_button import ButtonInput

    world, tracker = bench(IDEAL)
    tracker.start()
    world.wait(1.0)
    line = ButtonInput(IDEAL.button, 1)
    line.change(0.0, True)
    tracker.wire(0, line)
    world.wait(1.0)
    buttons = tracker.samples().buttons
    assert not buttons[:251].any()
    assert buttons[251:].all()
