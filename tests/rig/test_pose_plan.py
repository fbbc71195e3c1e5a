"""The pose plan of a calibration: telling poses, reachable, clear of everything on the way, as a program that any controller can run."""

import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import mitl.atc
from mitl.calibration.distortion import Distortion
from mitl.calibration.pose_choice import _rows, most_telling
from mitl.calibration.pose_set import CalibrationPoses, require_enough
from mitl.cli import main
from mitl.errors import UsageError
from mitl.motion.kinematics import Arm
from mitl.motion.program_run import joints_home
from mitl.motion.robot_model import load_robot_model, robot_names
from mitl.motion.spread_poses import spread_poses
from mitl.poses import pose_of
from mitl.resources import models_folder
from mitl.rig.pose_plan import plan_poses
from mitl.simulation.arm_gaps import ArmGaps
from mitl.simulation.cell import load_cell

IRB140 = load_robot_model("irb140")


def run(arguments):
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    return ended.value.code


def program_of(robot):
    file = models_folder() / robot / "calibration.mod"
    return file if file.is_file() else Path(mitl.atc.__file__).parent / "calibration.mod"


def targets(file):
    text = file.read_text(encoding="utf-8")
    rows = re.findall(r"\[\[([-\d.,]+)\],\[9E9", text)
    return np.radians(np.array([[float(angle) for angle in row.split(",")] for row in rows]))


def test_the_chosen_poses_tell_more_than_as_many_at_random():
    flange = spread_poses(Arm(IRB140), joints_home(), 120).flange
    rows = _rows(flange)

    def information(numbers):
        chosen = rows[numbers].reshape(-1, rows.shape[2])
        return np.linalg.slogdet(chosen.T @ chosen)[1]

    chosen = most_telling(flange, 20)
    assert len(set(chosen)) == 20
    random = np.random.default_rng(1)
    best = max(information(random.permutation(len(flange))[:20]) for _ in range(200))
    assert information(chosen) > best


def test_fewer_candidates_than_poses_are_refused():
    with pytest.raises(ValueError, match="at least 5 candidates, got 4"):
        most_telling(np.tile([0.0, 0, 0, 1, 0, 0, 0], (4, 1)), 5)


def test_candidates_keep_a_margin_to_the_limits_and_the_wrists_singularity():
    spread = spread_poses(Arm(IRB140), joints_home(), 100)
    assert len(spread.joints) == 100
    assert np.all(spread.joints > IRB140.lower + np.radians(9.9))
    assert np.all(spread.joints < IRB140.upper - np.radians(9.9))
    assert np.abs(spread.joints[:, 4]).min() > np.radians(14.9)
    assert pose_of(Arm(IRB140).flange(spread.joints)) == pytest.approx(spread.flange, abs=1e-9)


def test_no_pose_and_no_move_between_them_enters_what_is_not_clear():
    def clear(q):
        return q[0] <= 0.2  # a wall on one side

    plan = plan_poses(IRB140, clear, count=15)
    way = np.concatenate([[plan.home], plan.joints])
    assert way[:, 0].max() <= 0.2
    require_enough(CalibrationPoses(plan.flange, plan.flange, np.zeros(15)), Distortion.AFFINE)


def test_a_cell_without_room_is_refused_with_numbers():
    with pytest.raises(UsageError, match=r"only 0 of 400 reachable poses keep their distance, expected 30"):
        plan_poses(IRB140, lambda _: False)


@pytest.mark.parametrize("robot", robot_names())
def test_the_shipped_programs_keep_limits_and_distance_and_determine_the_calibration(robot):
    model = load_robot_model(robot)
    joints = targets(program_of(robot))
    assert joints[0] == pytest.approx(joints_home())
    assert len(joints) == 31
    assert np.all((joints > model.lower) & (joints < model.upper))
    flange = pose_of(Arm(model).flange(joints[1:]))
    require_enough(CalibrationPoses(flange, flange, np.zeros(30)), Distortion.AFFINE)
    gaps = ArmGaps(model.urdf)
    for start, end in zip(joints[:-1], joints[1:], strict=True):
        for share in np.linspace(0.0, 1.0, 5):
            assert gaps.smallest(model.between_links(start + share * (end - start)), 0.1) > 0.035


def test_a_folded_arm_and_one_at_the_floor_have_no_gap():
    gaps = ArmGaps(IRB140.urdf)
    assert gaps.smallest(np.radians([0.0, 100.0, 45.0, 0.0, 0.0, 0.0]), 0.1) < 0.0, "through the floor"
    assert gaps.smallest(np.radians([0.0, 0.0, 0.0, 0.0, 30.0, 0.0]), 0.01) == np.inf


def test_the_command_writes_a_program_that_mitl_check_accepts_and_says_how_far_it_spreads(tmp_path, capsys):
    file = tmp_path / "poses.mod"
    assert run(["calibrate", "--plan", "--robot", "irb120", "--poses", "12", "--output", str(file)]) == 0
    assert "12 poses over" in capsys.readouterr().err
    assert len(targets(file)) == 13
    assert run(["check", str(file)]) == 0
    assert run(["calibrate", "--plan", "--robot", "irb9000"]) == 2
    assert run(["calibrate", "--plan", "--rig", "sim"]) == 2
    assert "expected one of: recordings, --rig, --plan" in capsys.readouterr().err


def test_a_plan_for_a_cell_keeps_away_from_it_on_every_way_and_the_shipped_one_does_not(tmp_path, capsys):
    """The belt of the cell `line` lies across the front at 300 mm, where the poses for a free arm go through it."""
    file = tmp_path / "poses.mod"
    assert run(["calibrate", "--plan", "--cell", "line", "--poses", "15", "--output", str(file)]) == 0
    assert "away from itself and the cell line" in file.read_text()
    gaps = ArmGaps(IRB140.urdf, load_cell("line"))

    def least(joints):
        ways = [start + share * (end - start) for start, end in pairwise(joints) for share in np.linspace(0.0, 1.0, 9)]
        return min(gaps.smallest(IRB140.between_links(q), 0.1) for q in ways)

    assert least(targets(file)) > 0.035
    assert least(targets(program_of("irb140"))) < -0.05
    assert run(["check", str(file)]) == 0
    assert run(["calibrate", "--rig", "sim", "--cell", "line"]) == 2
    assert "--cell needs --plan" in capsys.readouterr().err
    assert run(["calibrate", "--plan", "--cell", "nowhere"]) == 2
    assert "no cell 'nowhere'" in capsys.readouterr().err


def test_a_cell_that_is_in_the_way_at_home_is_told():
    with pytest.raises(UsageError, match="where it begins, at its home"):
        plan_poses(IRB140, lambda q: q[4] < 0.5, count=12)


def test_another_robot_is_calibrated_by_its_own_program(tmp_path, capsys):
    rig = tmp_path / "small.toml"
    rig.write_text('[rig]\nkind = "simulation"\nrobot = "irb120"\ntracker = "ideal"\n')
    assert run(["calibrate", "--rig", str(rig), "--output", str(tmp_path / "c.toml")]) == 0
    assert "30 of 30 poses used" in capsys.readouterr().out
    assert "[reference]" in (tmp_path / "c.toml").read_text()
