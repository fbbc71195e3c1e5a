"""What every Tracker promises, run on every implementation. To add one, add a bench: a still body that the tracker can see."""

import shutil
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from mitl.errors import RigError
from mitl.protocols import Clock, Tracker
from mitl.resources import models_folder
from mitl.rig.monotonic_clock import MonotonicClock
from mitl.simulation.tracker_model import TrackerModel
from mitl.simulation.tracker_parameters import load_preset
from mitl.simulation.world import World
from mitl.trackers.openvr_runtime import OpenVrRuntime
from mitl.trackers.openvr_tracker import OpenVrTracker
from mitl.trackers.pose_feed import FedDevice, PoseFeed
from mitl.trackers.replay import ReplayClock, ReplayTracker
from mitl.trackers.simulated import SimulatedTracker, TrackerClock

from . import steamvr


@dataclass
class Bench:
    """A tracker that has just been switched on, and the rig's clock."""

    tracker: Tracker
    clock: Clock
    close: Callable[[], None] = lambda: None


class Still:
    def joints_at(self, _time):
        return np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])


def simulated_bench(preset):
    parameters = load_preset(preset)
    X_WL = np.array([2.0, 0.5, 2.0, 0.0, 0.0, 1.0, 0.0])
    X_FM = np.array([0.0, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0])
    world = World(models_folder() / "irb140" / "robot.urdf", Still(), TrackerModel(parameters, 1), X_WL=X_WL, X_FM=X_FM)
    return Bench(SimulatedTracker(world, TrackerClock.drawn(parameters, 1)), world)


def replay_bench():
    """What the simulated tracker saw in three seconds, played again."""
    recorded = simulated_bench("thesis")
    recorded.tracker.start()
    recorded.clock.wait(3.0)
    clock = ReplayClock()
    recorded.tracker.stop()
    return Bench(ReplayTracker(recorded.tracker.samples(), clock), clock)


def openvr_bench():
    """What the simulated tracker saw, told by a stand-in for SteamVR through the package openvr, in real time."""
    folder = Path(tempfile.mkdtemp(prefix="mitl-feed-"))
    steamvr.use(folder / "feed")
    recorded = simulated_bench("thesis")
    recorded.tracker.start()
    recorded.clock.wait(4.0)
    recorded.tracker.stop()
    feed = PoseFeed(folder / "feed", (FedDevice("LHR-1"),), latency=0.0)
    samples = recorded.tracker.samples()
    feed.write(0, samples.path.time - samples.path.time[0] + time.monotonic() - 0.5, samples)
    clock = MonotonicClock()
    tracker = OpenVrTracker(OpenVrRuntime, clock, settle=0.0)
    clock.wait(0.05)

    def close():
        tracker.close()
        feed.close()
        shutil.rmtree(folder)

    return Bench(tracker, clock, close)


BENCHES = {
    "simulated, thesis": lambda: simulated_bench("thesis"),
    "simulated, ideal": lambda: simulated_bench("ideal"),
    "simulated, lighthouse2": lambda: simulated_bench("lighthouse2"),
    "replay": replay_bench,
    "openvr": openvr_bench,
}


@pytest.fixture(params=BENCHES)
def bench(request):
    made = BENCHES[request.param]()
    yield made
    made.close()


def test_it_is_a_tracker(bench):
    assert isinstance(bench.tracker, Tracker)


def test_a_path_can_only_be_asked_for_after_the_start(bench):
    with pytest.raises(RigError, match="not started"):
        bench.tracker.path()
    with pytest.raises(RigError, match="not started"):
        bench.tracker.stop()


def test_the_path_grows_while_recording_and_stays_after_the_stop(bench):
    bench.tracker.start()
    bench.clock.wait(0.2)
    early = bench.tracker.path()
    bench.clock.wait(0.2)
    whole = bench.tracker.stop()
    bench.clock.wait(0.2)
    assert 0 < len(early) < len(whole) == len(bench.tracker.path())
    np.testing.assert_array_equal(whole.position[: len(early)], early.position)


def test_times_are_seconds_of_the_trackers_clock_and_increase(bench):
    bench.clock.wait(0.1)
    bench.tracker.start()
    begin = bench.clock.now()
    bench.clock.wait(1.0)
    waited = bench.clock.now() - begin
    path = bench.tracker.stop()
    assert np.all(np.diff(path.time) > 0)
    assert path.time[-1] - path.time[0] == pytest.approx(waited, abs=0.05)


def test_a_new_start_begins_a_new_path(bench):
    bench.tracker.start()
    bench.clock.wait(0.5)
    first = bench.tracker.stop()
    bench.clock.wait(0.5)
    bench.tracker.start()
    bench.clock.wait(0.5)
    second = bench.tracker.stop()
    assert second.time[0] > first.time[-1] + 0.4


def test_orientations_are_unit_quaternions(bench):
    bench.tracker.start()
    bench.clock.wait(0.5)
    path = bench.tracker.stop()
    assert np.linalg.norm(path.quaternion_wxyz, axis=1) == pytest.approx(1.0, abs=1e-9)


def test_latest_is_the_last_sample_of_the_path(bench):
    bench.tracker.start()
    bench.clock.wait(0.3)
    before, latest, path = bench.tracker.path(), bench.tracker.latest(), bench.tracker.path()
    assert len(latest) == 1
    assert before.time[-1] <= latest.time[0] <= path.time[-1]  # a real one goes on sampling between two calls
    (at,) = np.flatnonzero(path.time == latest.time[0])
    np.testing.assert_array_equal(latest.position[0], path.position[at])


def test_an_average_takes_its_time_and_the_recording_goes_on(bench):
    bench.clock.wait(0.1)
    bench.tracker.start()
    begin = bench.clock.now()
    point = bench.tracker.average(0.5)
    assert bench.clock.now() - begin + 1e-9 >= 0.5
    path = bench.tracker.stop()
    assert len(path) == pytest.approx(point.count, abs=5)
    assert path.time[0] < point.time < path.time[-1]
    assert point.position == pytest.approx(path.position.mean(axis=0), abs=1e-4)
    assert abs(point.quaternion_wxyz @ path.quaternion_wxyz[0]) == pytest.approx(1.0, abs=1e-4)
    spread = np.linalg.norm(path.position - point.position, axis=1).max()
    assert spread <= point.jitter + 1e-12 <= 2 * spread + 1e-4


def test_an_average_works_without_a_recording_and_leaves_none(bench):
    assert bench.tracker.average(0.2).count > 10
    with pytest.raises(RigError, match="not started"):
        bench.tracker.path()
