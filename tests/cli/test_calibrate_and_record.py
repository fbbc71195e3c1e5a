"""`mitl record` and `mitl calibrate` from the outside, on the simulated rig and on recordings."""

import json

import numpy as np
import pytest

from mitl.calibration import load_calibration
from mitl.cli import run
from mitl.paths import PosePath
from mitl.recording import PoseTrack, Recording, read_recording, write_recording
from mitl.rig import load_rig
from mitl.trackers.recorder import FLANGE, STATE, RigRecorder


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    file = tmp_path_factory.mktemp("record") / "calibration.mcap"
    assert run(["record", "--rig", "sim", "--calibration", "--output", str(file)]) == 0
    return file


def test_a_recording_has_tracker_and_robot(recorded):
    found = read_recording(recorded)
    assert found.damage == ""
    tracker, flange = found.paths["/tracker/pose"].path, found.paths[FLANGE].path
    assert len(tracker) == pytest.approx(250 * (flange.time[-1] - flange.time[0]), rel=0.01)
    assert found.series["/robot/joints"].values.shape == (len(flange), 6)
    assert found.series[STATE].columns == ("result", "buttons", "vx", "vy", "vz")
    assert set(found.series[STATE].column("result")) == {200.0}
    assert found.metadata["rig"] == "sim"


def test_calibrate_prints_what_the_contract_says_and_keeps_the_calibration(recorded, tmp_path, capsys):
    output = tmp_path / "calibration.toml"
    assert run(["calibrate", str(recorded), "--output", str(output), "--format", "json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["used"] >= 20
    assert told["held_out"]["position_rms_m"] < 2e-3
    assert told["scale"] == pytest.approx([1.0063, 1.0055, 1.0047], abs=4e-3)
    assert np.array(told["covariance"]).shape[0] >= 12
    assert told["time_offset_sd_s"] < 1e-3
    assert -900 < told["time_offset_s"] < -100
    assert load_calibration(output).pose_count == told["used"]
    assert run(["calibrate", str(recorded)]) == 0
    text = capsys.readouterr().out
    for word in ("residuals", "held out", "registration", "time offset", "rejected", "sd"):
        assert word in text


def poses(tmp_path, name, count, turn):
    random = np.random.default_rng(1)
    quaternion = np.tile([1.0, 0, 0, 0], (count, 1)) if not turn else random.normal(size=(count, 4))
    quaternion /= np.linalg.norm(quaternion, axis=1)[:, None]
    path = PosePath(np.arange(count, dtype=float), random.uniform(-0.5, 0.5, (count, 3)), quaternion, np.ones(count, dtype=bool))
    tracks = {"/calibration/flange": PoseTrack(path, "base", "flange"), "/calibration/tracker": PoseTrack(path, "tracker", "body")}
    write_recording(tmp_path / name, Recording(tracks))
    return str(tmp_path / name)


def test_recordings_of_poses_are_taken_together_and_a_degenerate_set_is_refused(tmp_path, capsys):
    good = poses(tmp_path, "good.mcap", 12, turn=True)
    assert run(["calibrate", good, good, "--model", "scale", "--format", "json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["poses"] == 24
    assert told["time_offset_s"] is None
    assert run(["calibrate", poses(tmp_path, "flat.mcap", 12, turn=False)]) == 4
    assert "must turn by at least 60 deg about two axes" in capsys.readouterr().err
    assert run(["calibrate", poses(tmp_path, "few.mcap", 3, turn=True)]) == 4
    assert "needs at least" in capsys.readouterr().err


def test_wrong_usage_is_told(tmp_path, capsys, recorded):
    assert run(["calibrate"]) == 2
    assert "expected one of: recordings, --rig, --plan" in capsys.readouterr().err
    assert run(["record", "--output", str(tmp_path / "x.mcap"), "--columns", "vicon"]) == 2
    assert "--columns needs --from" in capsys.readouterr().err
    for name, said in (("x.txt", "written as .mcap, not .txt"), ("x", "not without an ending"), ("none/x.mcap", "there is no folder")):
        assert run(["record", "--seconds", "1", "--output", str(tmp_path / name)]) == 2
        assert said in capsys.readouterr().err
        assert not (tmp_path / name).exists()
    other = tmp_path / "other.mcap"
    track = read_recording(recorded).paths["/tracker/pose"]
    write_recording(other, Recording({"/tracker/pose": track}))
    assert run(["calibrate", str(other)]) == 2
    assert "expected the topics /calibration/flange" in capsys.readouterr().err


def test_a_still_rig_and_a_table_of_another_tracker_are_recorded_too(tmp_path, capsys):
    output = tmp_path / "still.mcap"
    assert run(["record", "--seconds", "1", "--output", str(output)]) == 0
    assert len(read_recording(output).paths["/tracker/pose"].path) == pytest.approx(250, abs=2)
    table = tmp_path / "laser.csv"
    table.write_text("time_s,x_mm,y_mm,z_mm\n-0.5,1,2,3\n0.5,1000,2,3\n")
    assert run(["record", "--from", str(table), "--columns", "laser", "--output", str(output)]) == 0
    path = read_recording(output).paths["/tracker/pose"].path
    assert path.time == pytest.approx([0.0, 1.0])
    assert path.position[1] == pytest.approx([1.0, 0.002, 0.003])


@pytest.mark.parametrize("content", [None, "MODULE M\n  PROC main()\n    MoveL nowhere,v100,fine,tool0;\n  ENDPROC\nENDMODULE\n"])
def test_a_program_that_cannot_be_loaded_leaves_no_recording(tmp_path, capsys, content):
    program, output = tmp_path / "program.mod", tmp_path / "recording.mcap"
    if content is not None:
        program.write_text(content)
    assert run(["record", "--program", str(program), "--output", str(output)]) == (2 if content is None else 4)
    assert "program.mod" in capsys.readouterr().err
    assert not output.exists()


def test_what_is_older_than_a_second_of_the_rigs_time_is_in_the_file_while_it_grows(tmp_path):
    rig, file = load_rig("sim", 1, ()), tmp_path / "recording.mcap"
    with RigRecorder(rig, file, {}) as recorder:
        begin = rig.clock.now()
        for seconds in (1.3, 0.9, 0.49):
            recorder.run(seconds)
            found = read_recording(file)  # as a killed process would leave it
            lasts = rig.clock.now() - begin
            for topic in ("/tracker/pose", FLANGE):
                time = found.paths[topic].path.time
                assert lasts - 1.0 < time[-1] - time[0] <= lasts + 0.01


def test_tables_of_another_tracker_and_of_the_robot_calibrate_as_the_recording_does(recorded, tmp_path, capsys):
    found = read_recording(recorded)
    flange, tracker = tmp_path / "robot.csv", tmp_path / "take.csv"
    for file, topic, header, order in (
        (flange, FLANGE, "time_s,x_mm,y_mm,z_mm,u0,u1,u2,u3", [0, 1, 2, 3]),
        (tracker, "/tracker/pose", "Time (Seconds),X,Y,Z,QX,QY,QZ,QW", [1, 2, 3, 0]),
    ):
        path = found.paths[topic].path
        length = 1e3 if topic == FLANGE else 1.0
        rows = np.column_stack([path.time, path.position * length, path.quaternion_wxyz[:, order]])
        np.savetxt(file, rows, delimiter=",", header=header, comments="", fmt="%.9f")
    command = ["calibrate", str(tracker), "--columns", "optitrack", "--format", "json"]
    capsys.readouterr()
    assert run([*command, "--flange", str(flange), "--flange-columns", "egm"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert run(["calibrate", str(recorded), "--format", "json"]) == 0
    direct = json.loads(capsys.readouterr().out)
    assert told["used"] == direct["used"]
    assert told["scale"] == pytest.approx(direct["scale"], abs=1e-5)
    assert told["time_offset_s"] == pytest.approx(direct["time_offset_s"], abs=1e-5)
    assert run(command) == 2
    assert "need --flange" in capsys.readouterr().err
    assert run(["calibrate", "--rig", "sim", "--flange", str(flange)]) == 2
    assert "expected one RECORDING" in capsys.readouterr().err
