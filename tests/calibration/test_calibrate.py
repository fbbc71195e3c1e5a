import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import RigidTransform, Rotation

from mitl.calibration import CalibrationError, CalibrationPoses, Distortion, calibrate, choose_distortion
from mitl.calibration.pose_set import rotation_spread
from mitl.calibration.unknowns import Unknowns, right_jacobian
from mitl.paths import PosePath
from mitl.poses import IDENTITY, pose_of, transform_of, transforms_of_path


def exact(experiments, seed, count=12, scale=1.0055, skew=None):
    rng = np.random.default_rng(seed)
    truth = experiments.scene(rng, scale, skew)
    return truth, experiments.measured(rng, truth, experiments.flange_poses(rng, count), 0.0, 0.0)


@pytest.mark.parametrize(
    ("distortion", "scale", "skew"),
    [
        (Distortion.RIGID, 1.0, None),
        (Distortion.SCALE, 1.0055, None),
        (Distortion.SCALE, 0.5, None),
        (Distortion.AFFINE, np.array([1.0063, 1.0055, 1.0047]), np.array([0.001, 0.0073, -0.002])),
    ],
)
def test_exact_poses_give_the_exact_transforms(experiments, distortion, scale, skew):
    truth, poses = exact(experiments, 1, 20, scale, skew)
    found = calibrate(poses, distortion=distortion)
    np.testing.assert_allclose(found.X_LB, pose_of(truth.X_LB), atol=1e-9)
    np.testing.assert_allclose(found.X_FM, pose_of(truth.X_FM), atol=1e-9)
    np.testing.assert_allclose(found.scale, truth.scale, atol=1e-9)
    np.testing.assert_allclose(found.skew, truth.skew, atol=1e-9)
    assert found.rejected == ()
    assert found.held_out.position_max < 1e-8


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_any_mounting_of_base_and_body_is_found(experiments, seed):
    truth, poses = exact(experiments, seed)
    found = calibrate(poses)
    error = transform_of(found.X_LB).inv() * truth.X_LB
    assert error.rotation.magnitude() < 1e-8
    assert np.linalg.norm(error.translation) < 1e-8


def test_the_same_poses_give_the_same_calibration(experiments):
    rng = np.random.default_rng(5)
    truth = experiments.scene(rng)
    poses = experiments.measured(rng, truth, experiments.flange_poses(rng, 20))
    first, second = calibrate(poses), calibrate(poses)
    np.testing.assert_array_equal(first.X_LB, second.X_LB)
    np.testing.assert_array_equal(first.covariance, second.covariance)


def test_a_third_of_the_poses_may_be_wrong(experiments):
    rng = np.random.default_rng(6)
    truth = experiments.scene(rng)
    good = experiments.measured(rng, truth, experiments.flange_poses(rng, 24))
    tracked = good.tracked.copy()
    bad = np.array([0, 3, 9, 10, 15, 20, 23])
    tracked[bad, :3] += rng.normal(size=(7, 3)) * 0.05
    found = calibrate(CalibrationPoses(good.flange, tracked, good.jitter))
    assert [rejection.index for rejection in found.rejected] == bad.tolist()
    assert experiments.prediction_error(found, truth, experiments.flange_poses(rng, 100))[0] < 0.4e-3


def test_rejected_poses_are_named_with_their_reason(experiments):
    _, good = exact(experiments, 7, 20)
    tracked, flange = good.tracked.copy(), good.flange.copy()
    tracked[2, :3] = 0.0
    tracked[4] = 0.0
    tracked[6, 0] = np.nan
    tracked[8, :3] += 0.035
    flange[10] = np.inf
    jitter = good.jitter.copy()
    jitter[12] = 0.025
    found = calibrate(CalibrationPoses(flange, tracked, jitter))
    assert [rejection.index for rejection in found.rejected] == [2, 4, 6, 8, 10, 12]
    reasons = [rejection.reason for rejection in found.rejected]
    assert "lost" in reasons[0]
    assert "tracker's pose is no pose" in reasons[1]
    assert "tracker's pose is no pose" in reasons[2]
    assert reasons[3].startswith("outlier: 60.")
    assert "robot's pose is no pose" in reasons[4]
    assert reasons[5] == "the point was not still: jitter 25.0 mm (limit 4.0)"
    assert found.pose_count == 14


def test_too_few_poses_are_refused(experiments):
    _, poses = exact(experiments, 1, 5)
    with pytest.raises(CalibrationError, match="at least 6 usable poses, got 5: measure more"):
        calibrate(poses)
    _, poses = exact(experiments, 1, 9)
    with pytest.raises(CalibrationError, match="at least 10 usable poses, got 9"):
        calibrate(poses, distortion=Distortion.AFFINE)


def turned_about_z(experiments, count=20):
    rng = np.random.default_rng(2)
    truth = experiments.scene(rng)
    turn = Rotation.from_rotvec(np.array([0.0, 0.0, 1.0]) * np.linspace(-1.5, 1.5, count)[:, None])
    flange = RigidTransform.from_components(rng.uniform(-0.3, 0.3, (count, 3)), turn)
    return experiments.measured(rng, truth, flange)


def test_turns_about_one_axis_only_are_refused(experiments):
    with pytest.raises(CalibrationError, match="at least 60 deg about two axes; it turns by 172 deg about one and 0 deg across it"):
        calibrate(turned_about_z(experiments))
    with pytest.raises(CalibrationError, match="two axes"):
        choose_distortion(turned_about_z(experiments))


def test_positions_that_do_not_span_are_refused_for_scales_only(experiments):
    rng = np.random.default_rng(2)
    truth = experiments.scene(rng, 1.0)
    spread = experiments.flange_poses(rng, 20)
    at_one_place = RigidTransform.from_components(np.array([0.5, 0, 0.5]) + rng.uniform(-0.02, 0.02, (20, 3)), spread.rotation)
    poses = experiments.measured(rng, truth, at_one_place)
    with pytest.raises(CalibrationError, match="at least 100 mm in some direction"):
        calibrate(poses, distortion=Distortion.SCALE)
    assert calibrate(poses, distortion=Distortion.RIGID).held_out.position_rms < 1e-3
    on_a_plane = RigidTransform.from_components(spread.translation * np.array([1.0, 1.0, 0.0]), spread.rotation)
    with pytest.raises(CalibrationError, match="in all three directions"):
        calibrate(experiments.measured(rng, truth, on_a_plane), distortion=Distortion.AFFINE)


def test_poses_that_do_not_belong_together_are_refused(experiments):
    _, poses = exact(experiments, 1, 20)
    shuffled = CalibrationPoses(poses.flange, np.roll(poses.tracked, 1, axis=0), poses.jitter)
    with pytest.raises(CalibrationError, match="poses do not agree with each other: 0 of 20 do"):
        calibrate(shuffled)


def test_a_base_that_moved_half_way_is_refused(experiments):
    _, poses = exact(experiments, 1, 20)
    tracked = poses.tracked.copy()
    tracked[10:, :3] += 0.05
    with pytest.raises(CalibrationError, match="do not agree with each other"):
        calibrate(CalibrationPoses(poses.flange, tracked, poses.jitter))


def test_shapes_are_checked():
    with pytest.raises(ValueError, match=r"expected shapes \(N, 7\), \(N, 7\), \(N,\)"):
        CalibrationPoses(np.zeros((3, 7)), np.zeros((4, 7)), np.zeros(3))


def test_rotation_spread_sees_axes_not_single_poses():
    quaternions = Rotation.from_euler("xyz", [[-30, 0, 0], [40, 0, 0], [0, 35, 0], [0, -35, 0]], degrees=True).as_quat(scalar_first=True)
    first, second = rotation_spread(np.concatenate([np.zeros((4, 3)), quaternions], axis=1))
    assert np.rad2deg(first) == pytest.approx(70, abs=1)
    assert np.rad2deg(second) == pytest.approx(70, abs=1)
    assert rotation_spread(np.tile(IDENTITY, (5, 1))) == (0.0, 0.0)


@pytest.mark.parametrize("distortion", list(Distortion))
def test_the_derivative_is_that_of_the_residuals(distortion):
    rng = np.random.default_rng(1)
    size = 12 + distortion.unknowns
    R_BF, R_LM = Rotation.random(4, rng=rng).as_matrix(), Rotation.random(4, rng=rng).as_matrix()
    p_BF = rng.normal(size=(4, 3))
    start = Unknowns(
        Rotation.random(rng=rng).as_matrix(),
        rng.normal(size=3),
        Rotation.random(rng=rng).as_matrix(),
        rng.normal(size=3),
        np.ones(3),
        np.zeros(3),
    )
    step = rng.normal(size=size) * 0.3

    def residuals(at):
        predicted, position = start.stepped(at, distortion).predict(R_BF, p_BF)
        return -position, Rotation.from_matrix(np.swapaxes(predicted, 1, 2) @ R_LM).as_rotvec()

    position, turn = start.stepped(step, distortion).derivative(R_BF, p_BF, R_LM, step, distortion)
    for i in range(size):
        offset = np.eye(size)[i] * 1e-6
        ahead, behind = residuals(step + offset), residuals(step - offset)
        np.testing.assert_allclose(position[:, :, i], (ahead[0] - behind[0]) / 2e-6, atol=1e-7)
        np.testing.assert_allclose(turn[:, :, i], (ahead[1] - behind[1]) / 2e-6, atol=1e-6)


def test_the_right_jacobian_of_a_tiny_rotation_is_the_limit_of_larger_ones():
    direction = np.array([0.6, -0.48, 0.64])
    np.testing.assert_allclose(right_jacobian(0.99e-4 * direction), right_jacobian(1.01e-4 * direction), atol=2e-6)
    np.testing.assert_allclose(right_jacobian(np.zeros(3)), np.eye(3))


def path_of(X, valid=None):
    pose = pose_of(X)
    n = len(pose)
    return PosePath(np.arange(n) * 0.004, pose[:, :3], pose[:, 3:], np.ones(n, dtype=bool) if valid is None else valid)


@pytest.mark.parametrize(("scale", "skew"), [(1.0055, None), (np.array([1.0063, 1.0055, 1.0047]), np.array([0.0, 0.0073, 0.0]))])
def test_flange_and_tool_paths_come_back(experiments, scale, skew):
    truth, poses = exact(experiments, 4, 30, scale, skew)
    found = calibrate(poses, distortion=Distortion.AFFINE)
    rng = np.random.default_rng(9)
    flange = experiments.flange_poses(rng, 50)
    seen = path_of(truth.report(flange), rng.random(50) > 0.2)
    back = found.flange_path(seen)
    np.testing.assert_allclose(pose_of(transforms_of_path(back)), pose_of(flange), atol=1e-8)
    np.testing.assert_array_equal(back.time, seen.time)
    np.testing.assert_array_equal(back.valid, seen.valid)
    X_FT = np.array([0.0, 0.02, 0.15, 0.0, 1.0, 0.0, 0.0])
    X_BO = np.concatenate([[0.5, 0.0, 0.4], Rotation.from_euler("z", 45, degrees=True).as_quat(scalar_first=True)])
    tool = found.tool_path(seen, X_FT, X_BO)
    expected = transform_of(X_BO).inv() * flange * transform_of(X_FT)
    np.testing.assert_allclose(pose_of(transforms_of_path(tool)), pose_of(expected), atol=1e-8)
    np.testing.assert_allclose(found.tracker_poses(pose_of(flange)), pose_of(truth.report(flange)), atol=1e-8)


def test_a_lost_sample_without_orientation_becomes_invalid_and_hurts_no_other(experiments):
    truth, poses = exact(experiments, 4, 30)
    found = calibrate(poses)
    seen = path_of(truth.report(experiments.flange_poses(np.random.default_rng(1), 5)))
    quaternion, position = seen.quaternion_wxyz.copy(), seen.position.copy()
    quaternion[2], position[2] = 0.0, 0.0
    lossy = PosePath(seen.time, position, quaternion, seen.valid)
    whole, back = found.flange_path(seen), found.flange_path(lossy)
    assert back.valid.tolist() == [True, True, False, True, True]
    np.testing.assert_allclose(back.position[back.valid], whole.position[back.valid], atol=1e-12)
    assert found.tool_path(lossy, IDENTITY, IDENTITY).valid.tolist() == [True, True, False, True, True]
    assert np.all(np.isfinite(back.position))


def test_uncertainty_grows_with_the_lever_and_with_unexplained_residuals(experiments):
    rng = np.random.default_rng(3)
    truth = experiments.scene(rng)
    poses = experiments.measured(rng, truth, experiments.flange_poses(rng, 20))
    scale, rigid = calibrate(poses), calibrate(poses, distortion=Distortion.RIGID)
    assert scale.position_uncertainty(0.5) > scale.position_uncertainty()
    assert rigid.position_uncertainty() > 0.5e-3 > scale.position_uncertainty()
    assert scale.rotation_uncertainty() > 0.0


def test_held_out_every_below_two_is_refused(experiments):
    _, poses = exact(experiments, 1)
    with pytest.raises(ValueError, match="held_out_every must be at least 2, got 1"):
        calibrate(poses, held_out_every=1)
