"""What is particular to a replayed recording; what it promises as a Tracker is in test_tracker_contract.py."""

import numpy as np
import pytest

from mitl.errors import RigError
from mitl.paths import PosePath
from mitl.samples import TrackerSamples
from mitl.trackers.replay import ReplayClock, ReplayTracker


def recording(count=250, lost=()):
    time = 70.0 + np.arange(count) * 0.004
    valid = np.ones(count, dtype=bool)
    valid[list(lost)] = False
    path = PosePath(time, np.arange(count)[:, None] * [1e-3, 0, 0], np.tile([1.0, 0, 0, 0], (count, 1)), valid)
    return TrackerSamples.plain(path)


def test_it_begins_with_the_recording_and_ends_with_it():
    clock = ReplayClock()
    tracker = ReplayTracker(recording(), clock)
    assert tracker.latest().time[0] == 70.0
    tracker.start()
    clock.wait(0.5)
    assert tracker.latest().time[0] == pytest.approx(70.5)
    clock.wait(0.6)
    assert len(tracker.stop()) == 250
    with pytest.raises(RigError, match=r"the recording has ended: its last sample is at 70\.996 s"):
        tracker.latest()
    with pytest.raises(RigError, match="the recording has ended"):
        tracker.average(0.5)


def test_a_lost_stretch_is_lost_again():
    clock = ReplayClock()
    tracker = ReplayTracker(recording(lost=range(50, 250)), clock)
    assert tracker.average(0.1).count == 26
    clock.wait(0.4)
    with pytest.raises(RigError, match="the tracker is lost"):
        tracker.latest()
    with pytest.raises(RigError, match="the tracker is lost: none of"):
        tracker.average(0.1)


def test_an_empty_recording_is_refused():
    with pytest.raises(RigError, match="no sample"):
        ReplayTracker(TrackerSamples.joined([]), ReplayClock())
