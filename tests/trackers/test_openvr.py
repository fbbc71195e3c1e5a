"""The OpenVR tracker through the real package on a stand-in for SteamVR: what it tells of occlusion, loss, restarts and devices."""

import subprocess
import sys
import time

import numpy as np
import pytest

from mitl.errors import RigError
from mitl.paths import PosePath
from mitl.rig.monotonic_clock import MonotonicClock
from mitl.samples import TrackerSamples, TrackingResult
from mitl.trackers.openvr_runtime import OpenVrRuntime, PoseSource, RuntimeGoneError
from mitl.trackers.openvr_tracker import OpenVrTracker
from mitl.trackers.pose_feed import TRACKER, FedDevice, PoseFeed

from . import steamvr


def samples(count, *, x=1.0, result=TrackingResult.RUNNING_OK, valid=True, buttons=0):
    time_s = np.arange(count) * 0.004
    position = np.tile([x, 2.0, 3.0], (count, 1)) + 0.001 * time_s[:, None]
    path = PosePath(time_s, position, np.tile([0.5, 0.5, 0.5, 0.5], (count, 1)), np.full(count, valid))
    codes = np.full(count, result, dtype=np.int16)
    return TrackerSamples(path, codes, np.full(count, buttons, dtype=np.int16), np.tile([0.1, 0.2, 0.3], (count, 1)))


class Bench:
    """A stand-in with its feed, and trackers on it."""

    def __init__(self, folder):
        self.file = folder / "feed"
        steamvr.use(self.file)
        self.clock = MonotonicClock()
        self.feed = None
        self.trackers = []

    def devices(self, *devices):
        self.feed = PoseFeed(self.file, devices or (FedDevice("LHR-1"),), latency=0.0)

    def tell(self, told, device=0, ahead=0.0):
        self.feed.write(device, told.path.time + time.monotonic() + ahead, told)

    def tracker(self, **options):
        source = options.pop("source", PoseSource.PREDICTED)
        made = OpenVrTracker(lambda: OpenVrRuntime(source=source), self.clock, settle=0.0, **options)
        self.trackers.append(made)
        return made

    def close(self):
        for tracker in self.trackers:
            tracker.close()
        if self.feed is not None:
            self.feed.close()


@pytest.fixture
def bench(tmp_path):
    made = Bench(tmp_path)
    yield made
    made.close()


@pytest.mark.parametrize("source", PoseSource)
def test_pose_velocity_and_result_arrive_as_they_were_told(bench, source):
    bench.devices()
    bench.tell(samples(500), ahead=-0.2)
    tracker = bench.tracker(source=source)
    tracker.start()
    bench.clock.wait(0.1)
    tracker.stop()
    seen = tracker.samples()
    assert len(seen) > 10
    assert seen.path.valid.all()
    assert seen.path.position[-1] == pytest.approx([1.0, 2.0, 3.0], abs=0.002)
    assert seen.path.quaternion_wxyz[-1] == pytest.approx([0.5, 0.5, 0.5, 0.5])
    assert seen.velocity[-1] == pytest.approx([0.1, 0.2, 0.3])
    assert set(seen.result) == {TrackingResult.RUNNING_OK}


def test_an_occluded_device_says_that_it_is_out_of_range_and_its_pose_is_not_trusted_though_it_calls_it_valid(bench):
    bench.devices()
    bench.tell(samples(500, result=TrackingResult.RUNNING_OUT_OF_RANGE), ahead=-0.1)
    tracker = bench.tracker()
    tracker.start()
    bench.clock.wait(0.05)
    tracker.stop()
    assert set(tracker.samples().result) == {TrackingResult.RUNNING_OUT_OF_RANGE}
    assert tracker.samples().path.valid.all()
    assert not tracker.path().valid.any()
    with pytest.raises(RigError, match="lost"):
        tracker.average(0.05)


@pytest.mark.parametrize("told", [samples(500, valid=False), samples(500, x=np.nan)])
def test_a_lost_device_is_told_and_none_of_its_samples_is_valid(bench, told):
    bench.devices()
    bench.tell(told, ahead=-0.1)
    tracker = bench.tracker()
    tracker.start()
    bench.clock.wait(0.05)
    assert not tracker.path().valid.any()
    with pytest.raises(RigError, match="lost"):
        tracker.latest()
    with pytest.raises(RigError, match="lost"):
        tracker.average(0.05)


def test_buttons_are_seen_in_the_samples(bench):
    bench.devices()
    bench.tell(samples(30))
    bench.tell(samples(300, buttons=0b10), ahead=0.12)
    tracker = bench.tracker()
    tracker.start()
    bench.clock.wait(0.25)
    tracker.stop()
    assert len(tracker.samples().pressed(1)) == 1


def test_a_device_is_chosen_by_its_serial_and_several_must_be_told_apart(bench):
    bench.devices(FedDevice("LHR-1"), FedDevice("LHR-2", kind=TRACKER, role=2), FedDevice("LHB-9", kind=4))
    bench.tell(samples(500), ahead=-0.1)
    bench.tell(samples(500, x=7.0), device=1, ahead=-0.1)
    with pytest.raises(RigError, match=r"several devices.*LHR-1.*LHR-2"):
        bench.tracker()
    with pytest.raises(RigError, match=r"no device LHR-3.*LHR-1.*LHR-2"):
        bench.tracker(serial="LHR-3")
    tracker = bench.tracker(serial="LHR-2")
    bench.clock.wait(0.05)
    assert (tracker.device.kind, tracker.device.role) == ("tracker", "right hand")
    assert tracker.latest().position[0, 0] == pytest.approx(7.0, abs=0.01)


def test_after_steamvr_quit_and_came_back_nothing_counts_until_it_is_calibrated_again(bench):
    bench.devices()
    bench.tell(samples(900), ahead=-0.1)
    tracker = bench.tracker()
    tracker.start()
    bench.clock.wait(0.1)
    bench.feed.quit()
    until = time.monotonic() + 5.0
    while not tracker.restarted and time.monotonic() < until:
        time.sleep(0.02)
    bench.feed.restart()
    bench.clock.wait(1.3)
    path = tracker.stop()
    assert path.valid[:10].all()
    assert not path.valid[-50:].any(), "the frame of another session may have moved"
    assert tracker.samples().result[-1] == TrackingResult.RUNNING_OK, "it was connected again"
    for call in (tracker.start, tracker.latest, lambda: tracker.average(0.1)):
        with pytest.raises(RigError, match="calibrate again"):
            call()
    frame = tracker.frame
    tracker.accept_frame()
    bench.tell(samples(200))
    bench.clock.wait(0.1)
    tracker.start()
    bench.clock.wait(0.1)
    assert tracker.stop().valid.all(), "who takes on the new frame goes on in it"
    assert frame == tracker.frame == 1, "and calibrates, because the number is another one"


def test_without_steamvr_it_is_told_what_to_do(bench):
    with pytest.raises(RuntimeGoneError, match="start it"):
        bench.tracker()


def test_without_the_package_the_extra_is_named():
    script = (
        "import sys; sys.modules['openvr'] = None\n"
        "from mitl.trackers.openvr_runtime import OpenVrRuntime\n"
        "from mitl.errors import UsageError\n"
        "try:\n    OpenVrRuntime()\nexcept UsageError as error:\n    print(error)\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert "mitl[vive]" in done.stdout
