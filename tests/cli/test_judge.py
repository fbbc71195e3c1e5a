"""mitl judge: an old run is judged again without its rig."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mitl import atc
from mitl.calibration.store import load_calibration, save_calibration
from mitl.cli import run
from mitl.engine.replaying import Player
from mitl.engine.tape import ATTACHMENT, ROUND, Call, Tape, decoded, encoded
from mitl.errors import RigError, UsageError
from mitl.motion.oracles import PlannedOracles
from mitl.motion.robot_model import load_robot_model
from mitl.paths import PosePath
from mitl.protocols import AveragedPoint, ExecutionState, LoggedEvent
from mitl.recording import read_recording, write_recording
from mitl.rig.environment import folder_fingerprint
from mitl.rig.judged import recorded_rig
from mitl.samples import TrackerSamples

ATC = Path(atc.__file__).resolve().parent
CASE = "atc-0/tool-offset"


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    folder = tmp_path_factory.mktemp("judge") / "old"
    assert run(["verify", CASE, "--seed", "3", "--out", str(folder)]) == 0
    return folder


def results(folder):
    return json.loads((folder / "results.json").read_text())


def test_without_a_change_the_numbers_are_the_same_and_the_record_names_the_old_one(recorded, tmp_path):
    assert run(["judge", str(recorded), "--out", str(tmp_path / "new")]) == 0
    old, new = results(recorded), results(tmp_path / "new")
    assert new["cases"] == old["cases"]
    assert new["judged_from"] == f"old of {old['started']}"
    assert run(["judge", str(tmp_path / "new"), "--out", str(tmp_path / "newer")]) == 0, "what was judged again can be judged again"
    assert results(tmp_path / "newer")["cases"] == old["cases"]


def test_the_record_has_the_versions_of_what_judged_and_of_the_rig_what_is_not_here(recorded, tmp_path):
    told = results(recorded)
    told["versions"] |= {"numpy": "0.1", "RobotWare": "6.13", "robot model": "irb140 sha256 0"}
    old = tmp_path / "old"
    shutil.copytree(recorded, old)
    (old / "results.json").write_text(json.dumps(told))
    made = recorded_rig(old)
    model = load_robot_model("irb140")
    versions = made.rig(PlannedOracles(model), made.first_tape().facts, model).versions
    assert versions["RobotWare"] == "6.13"
    assert "numpy" not in versions
    assert versions["robot model"] == folder_fingerprint(model.folder) != told["versions"]["robot model"]


def test_another_calibration_changes_the_verdict(recorded, tmp_path):
    known = load_calibration(recorded / "calibration.toml")
    moved = known.X_FM + np.array([0.0, 0.05, 0.0, 0.0, 0.0, 0.0, 0.0])
    save_calibration(tmp_path / "other.toml", replace(known, X_FM=moved))
    assert run(["judge", str(recorded), "--calibration", str(tmp_path / "other.toml"), "--out", str(tmp_path / "new")]) == 1
    (check,) = results(tmp_path / "new")["cases"][0]["checks"]
    assert check["value"] == pytest.approx(50.0, abs=1.0), "the tips lie as far apart as the body is wrongly believed to be"
    assert run(["judge", str(recorded), "--recalibrate", "--out", str(tmp_path / "again")]) == 0
    assert results(tmp_path / "again")["cases"][0]["checks"] == results(recorded)["cases"][0]["checks"]


def test_a_changed_case_is_judged_by_its_new_limit_and_one_that_moves_otherwise_is_told(recorded, tmp_path):
    source = (ATC / "test_atc_0.py").read_text(encoding="utf-8")
    for name, old, new, code in (
        ("limit", "limit=1e3 * TOOL_LIMIT", "limit=1e-6 * TOOL_LIMIT", 3),
        ("moves", "still_point(bench, 2, turn)[0]", "(bench.flange(), still_point(bench, 2, turn)[0])[1]", 4),
    ):
        assert old in source
        folder = tmp_path / name
        folder.mkdir()
        for module in ATC.glob("*.mod"):
            (folder / module.name).write_bytes(module.read_bytes())
        (folder / f"test_{name}.py").write_text(source.replace(old, new), encoding="utf-8")
        assert run(["judge", str(recorded), CASE, "--tests", str(folder), "--out", str(tmp_path / f"{name}-out")]) == code


def test_a_run_without_tapes_and_its_own_folder_are_refused(recorded, tmp_path, capsys):
    assert run(["judge", str(recorded), "--out", str(recorded)]) == 2
    assert "must not replace the old one" in capsys.readouterr().err
    bare = tmp_path / "bare"
    bare.mkdir()
    (bare / "results.json").write_bytes((recorded / "results.json").read_bytes())
    name = results(recorded)["cases"][0]["recording"]
    known = read_recording(recorded / name)
    attachments = {key: value for key, value in known.attachments.items() if key != ATTACHMENT}
    write_recording(bare / name, replace(known, attachments=attachments))
    assert run(["judge", str(bare), "--out", str(tmp_path / "new")]) == 2
    assert "no case has a recording that can be judged again" in capsys.readouterr().err


def test_a_tape_comes_back_bit_for_bit_and_a_broken_one_is_refused():
    path = PosePath(np.array([0.0, 0.1 + 1e-13]), np.full((2, 3), 1 / 3), np.tile([1.0, 0.0, 0.0, 0.0], (2, 1)), np.array([True, False]))
    point = AveragedPoint(1 / 7, path.position[0], path.quaternion_wxyz[0], np.float64(1e-5), 40)
    results = [path, TrackerSamples.plain(path), point, ExecutionState.RUNNING, [LoggedEvent(0.5, 10002, "info", "x")], None, 1.5, "TRUE"]
    content = encoded(Tape([Call("part", "method", ("a", 2.0), result, time=0.1) for result in results], {"repeats": "3"}))
    tape = decoded(content, "x.mcap")
    assert tape.facts == {"repeats": "3"}
    back = [call.result for call in tape.calls]
    assert back[3:] == results[3:]
    assert np.array_equal(back[0].time, path.time)
    assert back[0].time is back[1].path.time, "equal arrays are stored once"
    assert (back[2].time, back[2].jitter, back[2].count) == (point.time, point.jitter, point.count)
    with pytest.raises(UsageError, match=r"x\.mcap: its tape cannot be read"):
        decoded(content[:-40], "x.mcap")
    with pytest.raises(TypeError, match="which a tape does not hold"):
        encoded(Tape([Call("part", "method", (), object())]))


def test_a_player_gives_no_answer_to_another_question():
    player = Player()
    player.insert(Tape([Call("controller", "read", ("a",), "1", time=2.0), Call("controller", "start", (), None, "motors are off", 3.0)]))
    with pytest.raises(RigError, match=r"has no answer to controller\.read\('b'\): the recorded run asked controller\.read\('a'\)"):
        player.play("controller", "read", "b")
    assert player.play("controller", "read", "a") == "1"
    assert player.now() == 2.0
    with pytest.raises(RigError, match="motors are off"):
        player.play("controller", "start")
    with pytest.raises(RigError, match="the recording ends before"):
        player.play("clock", "now")


def test_a_player_repeats_where_the_run_repeated_and_leaves_out_rounds_that_are_not_needed():
    player = Player()
    calls = [
        Call("case", "begins"),
        Call("clock", "now", (), 1.0),
        Call("case", ROUND),
        Call("clock", "now", (), 2.0),
        Call("case", "measured"),
    ]
    player.insert(Tape(calls))
    player.reach("begins")
    assert not player.another_round()
    assert player.play("clock", "now") == 1.0
    assert player.another_round()
    player.insert(Tape([*calls, Call("controller", "event_log", (), [])]))
    player.reach("begins")
    player.reach("measured")
    assert player.play("controller", "event_log") == []
