import dataclasses
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from mitl.calibration import Distortion, calibrate, load_calibration, save_calibration
from mitl.calibration.store import age, load_calibration_and_reference
from mitl.errors import UsageError
from mitl.protocols import AveragedPoint


@pytest.fixture(scope="module", params=list(Distortion))
def calibration(request, experiments):
    rng = np.random.default_rng(1)
    truth = experiments.scene(rng)
    poses = experiments.measured(rng, truth, experiments.flange_poses(rng, 20))
    poses.tracked[3] = 0.0
    poses.tracked[5, 0] += 0.035
    return calibrate(poses, distortion=request.param, provenance={"robot": "irb140", "note": 'quotes " and \\ and\nlines, µ'})


def test_a_calibration_survives_its_file_bit_for_bit(calibration, tmp_path):
    file = tmp_path / "calibration.toml"
    save_calibration(file, calibration, {"date": "2026-01-01"})
    loaded = load_calibration(file)
    stored = loaded.provenance["stored"]
    assert loaded.provenance == {"stored": stored, **calibration.provenance, "date": "2026-01-01"}
    assert timedelta(0) <= age(loaded, datetime.now(UTC)) < timedelta(minutes=5)
    for field in dataclasses.fields(calibration):
        before, after = getattr(calibration, field.name), getattr(loaded, field.name)
        if isinstance(before, np.ndarray):
            np.testing.assert_array_equal(after, before)
        elif field.name != "provenance":
            assert after == before, field.name
    assert loaded.position_uncertainty(0.2) == calibration.position_uncertainty(0.2)
    assert [file.name for file in tmp_path.iterdir()] == ["calibration.toml"]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("X_LB = [", "X_LX = [", r"key `X_LB` is missing: expected 7 numbers"),
        ("pose_count = 18", 'pose_count = "many"', r"key `pose_count`: expected a whole number, got 'many'"),
        ('distortion = "scale"', 'distortion = "bent"', r"key `distortion`: expected one of rigid, scale, affine, got 'bent'"),
        ('distortion = "scale"', 'distortion = "affine"', r"key `covariance`: expected 18 x 18 numbers"),
        ("position_rms = ", "position_rms = nan #", r"key `training.position_rms`: expected a number, got nan"),
        ("schema = 1", "schema = 2", r"key `schema`: expected 1, got 2"),
        ("[held_out]", "[held_up]", r"key `held_out` is missing: expected a table"),
        ("index = 3", "indices = 3", r"key `rejected\[0\].index` is missing"),
        ("schema = 1", "schema =", r"not a TOML file"),
    ],
)
def test_a_broken_file_is_refused_with_file_and_key(experiments, tmp_path, old, new, message):
    rng = np.random.default_rng(1)
    poses = experiments.measured(rng, experiments.scene(rng), experiments.flange_poses(rng, 20))
    poses.tracked[[3, 5]] = 0.0
    file = tmp_path / "calibration.toml"
    save_calibration(file, calibrate(poses))
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(UsageError, match=message) as caught:
        load_calibration(file)
    assert str(caught.value).startswith(str(file))


def test_a_pose_that_is_no_rotation_is_refused(experiments, tmp_path):
    rng = np.random.default_rng(1)
    poses = experiments.measured(rng, experiments.scene(rng), experiments.flange_poses(rng, 20))
    file = tmp_path / "calibration.toml"
    save_calibration(file, calibrate(poses))
    lines = ["X_FM = [0, 0, 0, 2, 0, 0, 0]" if line.startswith("X_FM") else line for line in file.read_text(encoding="utf-8").splitlines()]
    file.write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(UsageError, match="key `X_FM`: expected x y z and a unit quaternion"):
        load_calibration(file)


def test_a_missing_file_and_an_impossible_place_are_usage_errors(experiments, tmp_path):
    with pytest.raises(UsageError, match=r"nowhere\.toml: cannot be read: No such file"):
        load_calibration(tmp_path / "nowhere.toml")
    rng = np.random.default_rng(1)
    poses = experiments.measured(rng, experiments.scene(rng), experiments.flange_poses(rng, 20))
    with pytest.raises(UsageError, match="cannot be written"):
        save_calibration(tmp_path / "no" / "folder.toml", calibrate(poses))


def test_what_the_reference_showed_is_kept_with_the_calibration(calibration, tmp_path):
    file = tmp_path / "calibration.toml"
    point = AveragedPoint(5.0, np.array([0.1, 0.2, 0.3]), np.array([0.5, 0.5, 0.5, 0.5]), 1e-3, 125)
    save_calibration(file, calibration, reference=point)
    _, reference = load_calibration_and_reference(file)
    np.testing.assert_array_equal(reference.position, point.position)
    np.testing.assert_array_equal(reference.quaternion_wxyz, point.quaternion_wxyz)
    assert (reference.jitter, reference.count) == (1e-3, 125)
    save_calibration(file, calibration)
    assert load_calibration_and_reference(file)[1] is None


def test_a_file_that_does_not_tell_when_it_was_stored_has_no_age(calibration):
    assert age(replace(calibration, provenance={}), datetime.now(UTC)) is None
    assert age(replace(calibration, provenance={"stored": "yesterday"}), datetime.now(UTC)) is None
