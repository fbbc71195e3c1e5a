"""A tracker that is out of sight and says that its pose is valid: nothing is judged by that."""

import json

import numpy as np
import pytest

from mitl.cli import run
from mitl.recording import Recording, read_recording, write_recording
from mitl.recording.read import read_tracker_recordings
from mitl.recording.records import TRACKER, PoseTrack, Series
from mitl.resources import models_folder
from mitl.rig.load import load_rig
from mitl.samples import TrackingResult


@pytest.fixture
def rig_file(tmp_path):
    """A rig whose tracker is hidden every quarter of a minute, for up to three seconds."""
    head, _, tail = (models_folder() / "trackers" / "thesis.toml").read_text(encoding="utf-8").partition("[occlusion]")
    hidden = tail.replace("rate_per_s = 0.0 ", "rate_per_s = 0.06 ", 1)
    assert hidden != tail
    head = head.replace("after_s = 10.0 ", "after_s = 0.0 ")  # it never sleeps
    (tmp_path / "hidden.toml").write_text(head + "[occlusion]" + hidden, encoding="utf-8")
    file = tmp_path / "rig.toml"
    file.write_text('[rig]\nkind = "simulation"\nrobot = "irb140"\ntracker = "hidden.toml"\n', encoding="utf-8")
    return file


def test_it_tells_of_the_pose_and_its_path_is_not_valid_there(rig_file):
    rig = load_rig(str(rig_file), 1, ())
    rig.tracker.start()
    rig.clock.wait(60.0)
    path, samples = rig.tracker.stop(), rig.tracker.samples()
    coasting = samples.path.valid & (samples.result == TrackingResult.RUNNING_OUT_OF_RANGE)
    assert coasting.any()
    assert not path.valid[coasting].any()
    middle = np.median(path.only_valid().position, axis=0)
    assert np.linalg.norm(samples.path.position[coasting] - middle, axis=1).max() > 0.03
    assert np.quantile(np.linalg.norm(path.only_valid().position - middle, axis=1), 0.99) < 0.005


def test_a_sound_robot_does_not_fail_by_what_the_tracker_did_not_see(rig_file, tmp_path):
    code = run(["verify", "atc-1/direction", "atc-1/linear", "--rig", str(rig_file), "--seed", "1", "--out", str(tmp_path / "run")])
    told = json.loads((tmp_path / "run" / "results.json").read_text(encoding="utf-8"))
    outcomes = {case["id"]: case["outcome"] for case in told["cases"]}
    assert outcomes == {"atc-1/direction": "error", "atc-1/linear": "pass"}  # the first would fail by 48 mm
    assert code == 4
    said = [message["text"] for case in told["cases"] for message in case["messages"]]
    assert any("out of sight" in text for text in said), said


def test_recordings_keep_what_the_device_said_and_are_read_by_what_it_saw(rig_file, tmp_path):
    rig = load_rig(str(rig_file), 1, ())
    rig.tracker.start()
    rig.clock.wait(60.0)
    rig.tracker.stop()
    samples = rig.tracker.samples()
    state = Series(
        samples.path.time, np.column_stack([samples.result, samples.buttons, samples.velocity]), ("result", "buttons", "vx", "vy", "vz")
    )
    file = tmp_path / "hidden.mcap"
    write_recording(file, Recording(paths={TRACKER: PoseTrack(samples.path, "tracker", "body")}, series={"/tracker/state": state}))
    np.testing.assert_array_equal(read_recording(file).paths[TRACKER].path.valid, samples.path.valid)
    (found,) = read_tracker_recordings(file)
    np.testing.assert_array_equal(found.path.valid, samples.trusted().valid)
    assert found.path.valid.sum() < samples.path.valid.sum()
