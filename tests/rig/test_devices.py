"""Further tracked devices, wired buttons, stored calibrations and presets of one's own come from the rig file."""

from pathlib import Path

import numpy as np
import pytest

import mitl.atc
from mitl.calibration import save_calibration
from mitl.engine.calibration_session import calibrate_rig
from mitl.engine.frame_watch import frame_watch
from mitl.errors import UsageError
from mitl.resources import models_folder
from mitl.rig import load_rig
from mitl.rig.config import read_rig
from mitl.simulation.tracker_button import ButtonInput, WiredButton
from mitl.simulation.tracker_parameters import Button

RIG = '[rig]\nkind = "simulation"\nrobot = "irb140"\ntracker = "thesis"\n'
TRIGGER = """MODULE Trigger
  PROC main()
    MoveAbsJ [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v500, fine, tool0;
    WaitTime 0.5;
    SetDO doTrigger, 1;
    WaitTime 0.5;
    SetDO doTrigger, 0;
    WaitTime 1;
  ENDPROC
ENDMODULE
"""


def rig_of(tmp_path, text="", seed=1, name="cell.toml"):
    file = tmp_path / name
    file.write_text(RIG + text, encoding="utf-8")
    return load_rig(str(file), seed, ())


def preset_of(tmp_path, **changed):
    text = (models_folder() / "trackers" / "thesis.toml").read_text(encoding="utf-8")
    for key, value in changed.items():
        lines = text.splitlines()
        text = "\n".join(f"{key} = {value}" if line.startswith(f"{key} = ") else line for line in lines)
    (tmp_path / "own.toml").write_text(text, encoding="utf-8")


def test_an_output_of_the_robot_presses_the_trackers_button_within_a_fiftieth_of_a_second(tmp_path):
    program = tmp_path / "trigger.mod"
    program.write_text(TRIGGER)
    delays = []
    for seed in range(1, 6):
        rig = load_rig("sim", seed, ())
        rig.begin_case("trigger")
        begun = rig.clock.now()
        rig.tracker.start()
        rig.controller.load([program])
        rig.controller.start()
        rig.clock.wait(4.0)
        rig.tracker.stop()
        samples = rig.tracker.samples()
        (pressed,) = samples.pressed(0)
        changes = rig.controller.output_changes("doTrigger", 0.0, np.inf)
        assert [value for _, value in changes] == [1.0, 0.0]
        since = pressed - samples.path.time[0]
        delays.append(round(since - (changes[0][0] - begun), 6))
        assert np.sum(samples.buttons) == pytest.approx(125, abs=5), "it goes up again"
    assert all(-0.005 <= delay <= 0.0215 for delay in delays), delays
    assert np.ptp(delays) > 1e-3


def test_the_reference_stands_still_and_a_belt_moves_from_the_beginning_of_every_case(tmp_path):
    text = "[devices.reference]\nposition = [0.5, 0.5, 0.5]\n[devices.belt]\nvelocity = [0.1, 0.0, 0.0]\ntracker = 'ideal'\n"
    rig = rig_of(tmp_path, text)
    assert set(rig.devices) == {"reference", "belt"}
    moved = []
    for case in ("a", "b"):
        rig.begin_case(case)
        for device in rig.devices.values():
            device.start()
        rig.clock.wait(2.0)
        still, belt = (rig.devices[name].stop() for name in ("reference", "belt"))
        assert np.ptp(still.position, axis=0).max() < 3e-3
        assert still.time == pytest.approx(belt.time, abs=0.01), "one clock reads all devices"
        assert np.linalg.norm(belt.position[-1] - belt.position[0]) == pytest.approx(0.1 * (belt.time[-1] - belt.time[0]), rel=1e-3)
        moved.append(belt.position[0])
    assert moved[0] == pytest.approx(moved[1], abs=1e-9)


def test_all_devices_share_a_jump_of_the_frame_and_the_hand_wakes_by_motion(tmp_path):
    preset_of(tmp_path, probability_per_reacquisition="1.0")
    rig = load_rig(str(_with_tracker(tmp_path)), 3, ())
    program = tmp_path / "move.mod"
    program.write_text(
        "MODULE Move\n PROC main()\n  MoveAbsJ [[10,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v100, fine, tool0;\n"
        "  WaitTime 12;\n  MoveAbsJ [[40,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v100, fine, tool0;\n ENDPROC\nENDMODULE\n"
    )
    rig.begin_case("wake")
    rig.tracker.start()
    reference = rig.devices["reference"]
    reference.start()
    rig.controller.load([program])
    rig.controller.start()
    rig.clock.wait(25.0)
    hand, still = rig.tracker.stop(), reference.stop()
    frozen = np.all(np.diff(hand.position, axis=0) == 0.0, axis=1)
    assert 2.0 < 0.004 * np.count_nonzero(frozen) < 8.0, "asleep from 10 s of rest on until the motion has woken it"
    jump = np.linalg.norm(still.position[-200:].mean(axis=0) - still.position[:200].mean(axis=0))
    assert jump > 3e-3
    at = hand.time[np.flatnonzero(frozen)[-1]]
    before, after = still.between(at - 0.5, at - 0.02), still.between(at + 0.02, at + 0.5)
    assert np.linalg.norm(after.position.mean(axis=0) - before.position.mean(axis=0)) == pytest.approx(jump, abs=2e-3)


def _with_tracker(tmp_path):
    file = tmp_path / "own-tracker.toml"
    file.write_text(RIG.replace('"thesis"', '"own.toml"'), encoding="utf-8")
    return file


def test_a_stored_calibration_is_verified_and_one_of_another_day_is_refused(tmp_path):
    session = calibrate_rig(rig_of(tmp_path), _program())
    save_calibration(tmp_path / "kept.toml", session.calibration, reference=session.reference)
    again = rig_of(tmp_path, 'calibration = "kept.toml"\n', name="again.toml")
    stored = calibrate_rig(again, _program())
    assert np.array_equal(stored.calibration.X_LB, session.calibration.X_LB)
    again.begin_case("any")
    assert not frame_watch(again, stored, _program()).look().moved
    other = rig_of(tmp_path, 'calibration = "kept.toml"\n', seed=2, name="other.toml")  # another seed puts the tracker elsewhere
    other.begin_case("any")
    assert frame_watch(other, calibrate_rig(other, _program()), _program()).look().moved


def _program():
    return Path(mitl.atc.__file__).parent / "calibration.mod"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[buttons]\ndoA = 15\n", "0 to 14"),
        ("[buttons]\ndoA = 1\ndoB = 1\n", "two outputs"),
        ("[buttons]\naoA = { button = 1, over = 5 }\n", "unknown key 'over'"),
        ("[buttons]\naoA = { button = 1, above = 'much' }\n", "must be a number"),
        ("[buttons]\naoA = { above = 5 }\n", "0 to 14"),
        ("[devices.reference]\nvelocity = [1, 0, 0]\n", "stands still"),
        ("[devices.belt]\nposition = [1, 0]\n", "three numbers"),
        ("[devices.belt]\nspeed = 1\n", "unknown key 'speed'"),
        ("[devices]\nbelt = 1\n", "must be a section"),
        ("buttons = 1\n", "unknown key 'buttons'"),
    ],
)
def test_a_wrong_device_or_button_is_refused_with_file_and_key(tmp_path, text, said):
    file = tmp_path / "cell.toml"
    file.write_text(RIG + text)
    with pytest.raises(UsageError, match=said) as caught:
        read_rig(str(file))
    assert "cell.toml" in str(caught.value)


def test_an_empty_section_of_devices_leaves_the_rig_without_a_reference(tmp_path):
    assert not rig_of(tmp_path, "[devices]\n").devices


def test_an_analog_output_presses_its_button_above_its_threshold(tmp_path):
    rig = tmp_path / "analog.toml"
    rig.write_text(RIG + "[buttons]\naoLevel = { button = 3, above = 2.5 }\n")
    assert (read_rig(str(rig)).buttons, read_rig(str(rig)).thresholds) == ({"aoLevel": 3}, {"aoLevel": 2.5})
    levels = [(0.1, 2.0), (0.3, 2.6), (0.5, 9.0), (0.7, 2.5)]
    line = ButtonInput(Button(-0.6e-3, 16.6e-3), seed=1)
    button = WiredButton(lambda after, until: [change for change in levels if after < change[0] <= until], line, above=2.5)
    times = np.arange(0.0, 1.0, 0.004)
    pressed = times[button.states(times) == 1]
    assert (pressed[0], pressed[-1]) == (pytest.approx(0.31, abs=0.012), pytest.approx(0.71, abs=0.012))
