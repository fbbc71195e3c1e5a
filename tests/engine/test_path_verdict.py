"""A recording of any tracker is judged against an oracle's file: from tables with columns of their own to a verdict with its budget."""

import json
from dataclasses import replace

import numpy as np
import pytest

from mitl.cli import run
from mitl.recording import read_recording, write_recording
from mitl.recording.records import BOUNDS, Recording
from mitl.rig import load_rig
from mitl.trackers.recorder import FLANGE, RigRecorder

SEAM = """MODULE Seam
  PERS tooldata torch := [TRUE,[[40,0,150],[0.9238795,0,0.3826834,0]],[1,[0,0,80],[1,0,0,0],0,0,0]];
  CONST robtarget start := [[450,-100,350],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];

  PROC main()
    ConfL \\Off;
    ConfJ \\Off;
    MoveJ start, v200, fine, torch;
    WaitTime 0.5;
    MoveL Offs(start,0,200,0), v100, z10, torch;
    MoveC Offs(start,50,250,0), Offs(start,100,200,0), v100, z10, torch;
    MoveL Offs(start,100,0,50), v100, fine, torch;
    WaitTime 0.5;
  ENDPROC
ENDMODULE
"""
COLUMNS = "t=Stamp,x=Pos X,y=Pos Y,z=Pos Z,qw=W,qx=X,qy=Y,qz=Z,time=ms,length=mm"


def table(recording, topic, file, *, clock=0.0, keep=lambda _: True):
    """A tracker's export: another delimiter, other names and units, a clock of its own, no rows for what was not seen."""
    path = recording.paths[topic].path.only_valid()
    path = path.select(np.array([keep(t) for t in path.time - path.time[0]]))
    rows = np.column_stack([1e3 * (path.time + clock), 1e3 * path.position, path.quaternion_wxyz])
    np.savetxt(file, rows, delimiter=";", header="made by somebody\nStamp;Pos X;Pos Y;Pos Z;W;X;Y;Z", comments="", fmt="%.7f")


def recorded(folder, name, seconds, faults=()):
    rig = load_rig("sim", 3, faults)
    rig.controller.load([folder / "seam.mod"])
    with RigRecorder(rig, folder / f"{name}.mcap", {}) as recorder:
        rig.controller.start()
        recorder.run(seconds)
    return read_recording(folder / f"{name}.mcap")


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    """A folder as a laboratory has it: oracle, calibration and takes as tables."""
    folder = tmp_path_factory.mktemp("lab")
    (folder / "seam.mod").write_text(SEAM)
    assert run(["oracle", str(folder / "seam.mod"), "--output", str(folder / "seam.mcap")]) == 0
    assert run(["record", "--seed", "3", "--calibration", "--output", str(folder / "poses.mcap")]) == 0
    poses = read_recording(folder / "poses.mcap")
    table(poses, "/tracker/pose", folder / "poses.csv", clock=77.0)
    table(poses, FLANGE, folder / "robot.csv")
    command = ["calibrate", folder / "poses.csv", "--columns", COLUMNS, "--flange", folder / "robot.csv", "--flange-columns", COLUMNS]
    assert run([str(word) for word in [*command, "--output", folder / "calibration.toml"]]) == 0
    good = recorded(folder, "good", 9.0)
    table(good, "/tracker/pose", folder / "good.csv", clock=-500.0)
    table(good, "/tracker/pose", folder / "hidden.csv", keep=lambda t: not 3.5 < t < 4.5)
    table(good, "/tracker/pose", folder / "short.csv", keep=lambda t: t < 6.0)
    table(recorded(folder, "wrong", 9.0, ("target-offset=15",)), "/tracker/pose", folder / "wrong.csv")
    return folder


def judged(lab, take, *options, capsys):
    words = ["compare", lab / "seam.mcap", lab / take, "--columns", COLUMNS, "--calibration", lab / "calibration.toml", *options]
    capsys.readouterr()
    code = run([str(word) for word in words])
    told = capsys.readouterr()
    return code, told.out, told.err


def test_a_sound_robot_passes_with_its_budget(lab, capsys):
    code, out, err = judged(lab, "good.csv", "--format", "json", capsys=capsys)
    assert code == 0, err
    told = json.loads(out)
    assert told["outcome"] == "pass"
    in_time, shape, turn = told["checks"]
    assert in_time["value"] < 3.0
    assert shape["value"] < 2.0
    assert turn["value"] < 0.5
    assert [term["name"] for term in in_time["budget"] if term["value"] > 0] == ["random", "registration", "drift", "timing", "oracle"]
    assert in_time["uncertainty"] == pytest.approx(np.sqrt(sum(term["value"] ** 2 for term in in_time["budget"])))
    assert told["position_rmse_m"] < 2e-3, "the numbers of a comparison are there as well"
    assert "taken as a Vive's" in err


def test_a_wrong_target_fails_by_what_it_is_off(lab, capsys):
    code, out, err = judged(lab, "wrong.csv", "--drift", "0.3", "--format", "json", capsys=capsys)
    assert code == 1
    assert "Vive" not in err
    in_time = json.loads(out)["checks"][0]
    assert in_time["outcome"] == "fail"
    assert in_time["value"] == pytest.approx(15.0, abs=2.0)


def test_near_a_limit_nobody_can_tell(lab, capsys):
    code, out, _ = judged(lab, "good.csv", "--drift", "0.2", "--path-limit", "1.5", capsys=capsys)
    assert code == 3
    assert "limit 1.5 mm: inconclusive" in out
    assert out.rstrip().endswith("verdict        inconclusive")


@pytest.mark.parametrize(("take", "said"), [("hidden.csv", "no valid pose from 3."), ("short.csv", "no valid pose from 6.")])
def test_what_was_not_seen_is_no_pass(lab, capsys, take, said):
    code, _, err = judged(lab, take, capsys=capsys)
    assert code == 4
    assert said in err


def test_a_part_that_was_seen_can_be_judged_alone_and_another_programs_take_cannot(lab, capsys):
    code, out, _ = judged(lab, "hidden.csv", "--moves", "3", capsys=capsys)
    assert code == 0
    assert "moves 3 to 3" in out
    code, _, err = judged(lab, "poses.csv", capsys=capsys)
    assert code == 4
    assert "does not show the motion of the oracle" in err


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--moves", "2:9"], "expected moves between 0 and 3"),
        (["--moves", "x"], "expected FIRST:LAST"),
        (["--limit", "-1"], "expected a number of 0 or more"),
        (["--align", "rigid"], "exclude each other"),
    ],
)
def test_what_cannot_be_is_refused(lab, capsys, options, said):
    code, _, err = judged(lab, "good.csv", *options, capsys=capsys)
    assert code == 2
    assert said in err


def test_an_oracle_that_cannot_judge_is_refused_with_the_command_that_makes_one_that_can(lab, tmp_path, capsys):
    known = read_recording(lab / "seam.mcap")
    others = {
        "bare": Recording(paths=known.paths, metadata=known.metadata),
        "wobj": replace(known, metadata={**known.metadata, "frame": "wobj"}),
        "nameless": replace(known, metadata={key: value for key, value in known.metadata.items() if key != "robot"}),
    }
    said = {"bare": f"lacks /robot/joints, {BOUNDS}", "wobj": "this is in wobj", "nameless": "give --robot"}
    for name, recording in others.items():
        file = tmp_path / f"{name}.mcap"
        write_recording(file, recording)
        capsys.readouterr()
        assert run(["compare", str(file), str(lab / "good.csv"), "--columns", COLUMNS, "--calibration", str(lab / "calibration.toml")]) == 2
        assert said[name] in capsys.readouterr().err
    assert run(["compare", str(lab / "seam.mod"), str(lab / "good.csv"), "--calibration", str(lab / "calibration.toml")]) == 2
    assert run(["compare", str(lab / "seam.mcap"), str(lab / "good.csv"), "--columns", COLUMNS, "--drift", "1"]) == 2
    assert "only to judge" in capsys.readouterr().err


POSITIONS = "t=Stamp,x=Pos X,y=Pos Y,z=Pos Z,time=ms,length=mm"


@pytest.fixture(scope="module")
def reflector(lab):
    words = ["calibrate", lab / "poses.csv", "--columns", POSITIONS, "--flange", lab / "robot.csv", "--flange-columns", COLUMNS]
    assert run([str(word) for word in [*words, "--output", lab / "reflector.toml"]]) == 0
    return lab


@pytest.mark.parametrize(("take", "code", "about"), [("good.csv", 0, 1.0), ("wrong.csv", 1, 15.0)])
def test_a_tracker_of_positions_alone_judges_places_and_no_orientation(reflector, capsys, take, code, about):
    files = [str(reflector / name) for name in ("seam.mcap", take)]
    options = ["--columns", POSITIONS, "--calibration", str(reflector / "reflector.toml"), "--drift", "0.2", "--format", "json"]
    capsys.readouterr()
    assert run(["compare", *files, *options]) == code
    checks = json.loads(capsys.readouterr().out)["checks"]
    assert [check["name"] for check in checks] == ["path deviation at the same time", "distance from the path"]
    assert checks[0]["value"] == pytest.approx(about, abs=1.5)
