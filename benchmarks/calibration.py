"""Prints how well calibration does on simulated poses: accuracy, outliers, honesty of the covariance, time offset.

Run: python benchmarks/calibration.py [SEEDS]. tests/calibration uses the same experiments with fewer seeds.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation
from scipy.stats import chi2

from mitl.calibration import Calibration, CalibrationError, CalibrationPoses, Distortion, calibrate, time_offset
from mitl.calibration.distortion import distortion_matrix
from mitl.paths import FloatArray, PosePath
from mitl.poses import pose_of, transform_of

POSITION_NOISE = 0.2e-3  # m per axis and averaged pose
ROTATION_NOISE = float(np.deg2rad(0.05))  # rad per axis and averaged pose
SCALE = 1.0055
THESIS_SCALE = np.array([1.0063, 1.0055, 1.0047])  # facts/tracker.md, preset `thesis`
THESIS_SKEW = np.array([0.0, np.tan(np.deg2rad(0.42)), 0.0])


@dataclass(frozen=True, eq=False)
class Scene:
    """A true tracker: X_LB and X_FM, scale (3,) and skew (3,)."""

    X_LB: RigidTransform
    X_FM: RigidTransform
    scale: FloatArray
    skew: FloatArray

    def report(self, flange: RigidTransform) -> RigidTransform:
        """Gives what the tracker reports for flange poses, noise aside."""
        X_LM = self.X_LB * flange * self.X_FM
        return RigidTransform.from_components(X_LM.translation @ distortion_matrix(self.scale, self.skew).T, X_LM.rotation)


def scene(rng: np.random.Generator, scale: FloatArray | float = SCALE, skew: FloatArray | None = None) -> Scene:
    """Gives a tracker some 2 m away, its body some 120 mm from the flange, turned at random."""
    X_LB = RigidTransform.from_components(np.array([1.0, 2.0, -0.5]) + rng.uniform(-0.3, 0.3, 3), Rotation.random(rng=rng))
    X_FM = RigidTransform.from_components(np.array([0.03, 0.02, 0.12]), Rotation.random(rng=rng))
    return Scene(X_LB, X_FM, np.broadcast_to(np.asarray(scale, dtype=np.float64), (3,)), np.zeros(3) if skew is None else skew)


def flange_poses(rng: np.random.Generator, count: int) -> RigidTransform:
    """Gives flange poses in half a metre cubed, turned at random by up to 45 deg; the first four by 45 deg about two axes."""
    vectors = rng.uniform(-1.0, 1.0, (count, 3))
    sure = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
    vectors[:4] = sure[:count]
    turn = Rotation.from_rotvec(vectors * np.deg2rad(45.0))
    return RigidTransform.from_components(np.array([0.5, 0.0, 0.5]) + rng.uniform(-0.25, 0.25, (count, 3)), turn)


def measured(
    rng: np.random.Generator,
    truth: Scene,
    flange: RigidTransform,
    position_noise: float = POSITION_NOISE,
    rotation_noise: float = ROTATION_NOISE,
) -> CalibrationPoses:
    """Gives the poses with white noise per axis on what the tracker reports."""
    n = len(flange)
    X_LM = truth.report(flange)
    position = X_LM.translation + rng.normal(size=(n, 3)) * position_noise
    turn = X_LM.rotation * Rotation.from_rotvec(rng.normal(size=(n, 3)) * rotation_noise)
    return CalibrationPoses(pose_of(flange), pose_of(RigidTransform.from_components(position, turn)), np.full(n, 1e-3))


def prediction_error(calibration: Calibration, truth: Scene, flange: RigidTransform) -> tuple[float, float]:
    """Gives the rms of the norm of position (m) and rotation (rad) errors of predicted tracker poses, against noise-free truth."""
    predicted = transform_of(calibration.tracker_poses(pose_of(flange)))
    expected = truth.report(flange)
    position = predicted.translation - expected.translation
    turn = (predicted.rotation.inv() * expected.rotation).magnitude()
    return float(np.sqrt(np.mean(np.sum(position**2, axis=1)))), float(np.sqrt(np.mean(turn**2)))


@dataclass(frozen=True)
class Accuracy:
    """Medians over seeds, m and rad. truth: fresh poses against noise-free truth. held_out: against noisy poses not fitted to.

    All are rms of norms over three axes; per axis is 1 / sqrt(3) of it.
    """

    truth_position: float
    truth_rotation: float
    held_out_position: float
    held_out_rotation: float
    registration: float


def accuracy(seeds: int, count: int, distortion: Distortion, scale: FloatArray | float = SCALE, skew: FloatArray | None = None) -> Accuracy:
    """Gives the median accuracy of a calibration from `count` poses."""
    rows = []
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        truth = scene(rng, scale, skew)
        try:
            fit = calibrate(measured(rng, truth, flange_poses(rng, count)), distortion=distortion)
        except CalibrationError:  # ten poses through a model without scale may contradict each other
            continue
        rows.append(
            (
                *prediction_error(fit, truth, flange_poses(rng, 200)),
                fit.held_out.position_rms,
                fit.held_out.rotation_rms,
                fit.position_uncertainty(),
            )
        )
    return Accuracy(*(float(value) for value in np.median(np.array(rows), axis=0)))


def outlier_effect(seeds: int) -> tuple[FloatArray, FloatArray]:
    """Gives for each seed (S,), (S,) in m how far two outliers of 20 (35 mm; zero pose) move predicted tracker positions, rms.

    First against the calibration from the 18 other poses, then against that from 20 good ones, which knows a tenth more.
    """
    effect = []
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        truth = scene(rng)
        good = measured(rng, truth, flange_poses(rng, 20))
        tracked = good.tracked.copy()
        tracked[7, :3] += 0.035 * np.array([0.0, 0.6, 0.8])
        tracked[12] = 0.0
        spoilt = calibrate(CalibrationPoses(good.flange, tracked, good.jitter))
        without = np.ones(20, dtype=np.bool_)
        without[[7, 12]] = False
        fresh = pose_of(flange_poses(rng, 200))
        difference = [
            spoilt.tracker_poses(fresh)[:, :3] - clean.tracker_poses(fresh)[:, :3]
            for clean in (calibrate(good.select(without)), calibrate(good))
        ]
        effect.append([float(np.sqrt(np.mean(np.sum(d**2, axis=1)))) for d in difference])
    without_them, all_good = np.array(effect).T
    return without_them, all_good


def coverage(seeds: int, count: int = 20) -> tuple[float, float]:
    """Gives how often the truth lies in the 95 % region of all 13 unknowns, and in the 95 % interval of the scale."""
    region = interval = 0
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        truth = scene(rng)
        fit = calibrate(measured(rng, truth, flange_poses(rng, count)))
        found_LB, found_FM = transform_of(fit.X_LB), transform_of(fit.X_FM)
        error = np.concatenate(
            [
                (found_LB.rotation.inv() * truth.X_LB.rotation).as_rotvec(),
                truth.X_LB.translation - found_LB.translation,
                (found_FM.rotation.inv() * truth.X_FM.rotation).as_rotvec(),
                truth.X_FM.translation - found_FM.translation,
                [truth.scale[0] - fit.scale[0]],
            ]
        )
        region += bool(error @ np.linalg.solve(fit.covariance, error) <= chi2.ppf(0.95, len(error)))
        interval += bool(abs(error[-1]) <= 1.96 * np.sqrt(fit.covariance[-1, -1]))
    return region / seeds, interval / seeds


def motion(rate: float = 250.0, duration: float = 5.0, speed: float = 0.5) -> PosePath:
    """Gives a path around a box at a speed in m/s with rounded corners, half a second of rest at both ends."""
    t = np.arange(round(duration * rate)) / rate
    corners = np.array([[0, 0, 0], [0.4, 0, 0], [0.4, 0.3, 0], [0.4, 0.3, 0.3], [0, 0.3, 0.3], [0, 0, 0], [0.4, 0, 0]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    way = np.clip(t - 0.5, 0.0, duration - 1.0) * speed
    position = np.stack([np.interp(way, along, corners[:, i]) for i in range(3)], axis=1)
    kernel = np.hanning(27)[1:-1] / np.hanning(27).sum()
    position = np.stack([np.convolve(np.pad(position[:, i], 12, mode="edge"), kernel, "valid") for i in range(3)], axis=1)
    return PosePath(t, position, np.tile([1.0, 0.0, 0.0, 0.0], (len(t), 1)), np.ones(len(t), dtype=np.bool_))


def time_offset_errors(seeds: int, noise: float = POSITION_NOISE) -> FloatArray:
    """Gives errors (S,) in s of the time offset of 5 s at .5 m/s, seen in another frame with scale and white noise."""
    reference = motion()
    errors = []
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        offset = rng.uniform(-2.0, 2.0)
        t = reference.time[20:-20] + rng.uniform(0.0, 0.004)
        seen = np.stack([np.interp(t, reference.time, reference.position[:, i]) for i in range(3)], axis=1)
        seen = SCALE * Rotation.random(rng=rng).apply(seen) + rng.normal(size=seen.shape) * noise
        path = PosePath(t - offset, seen, np.tile([1.0, 0.0, 0.0, 0.0], (len(t), 1)), np.ones(len(t), dtype=np.bool_))
        errors.append(time_offset(reference, path).seconds - offset)
    return np.array(errors)


def table(seeds: int) -> list[str]:
    """Gives the lines of the benchmark's table."""
    lines = [
        f"{seeds} seeds, noise per axis and pose {POSITION_NOISE * 1e3:.2f} mm and {np.rad2deg(ROTATION_NOISE):.3f} deg. Medians of rms:",
        "  truth:    prediction of fresh poses against noise-free truth, norm and per axis",
        "  held out: prediction against noisy poses not fitted to, norm (the noise alone has 0.346 mm and 0.087 deg)",
        "  u:        Calibration.position_uncertainty, per axis",
        "tracker         model    poses |  truth mm  per axis  truth deg  per axis | held out mm       deg |   u mm",
    ]
    trackers: list[tuple[str, FloatArray | float, FloatArray | None]] = [
        ("scale 1.0055", SCALE, None),
        ("thesis affine", THESIS_SCALE, THESIS_SKEW),
    ]
    for name, scale, skew in trackers:
        for distortion in Distortion:
            for count in (20, 40) if distortion is Distortion.AFFINE else (10, 20, 40):  # ten may not span all three directions
                a = accuracy(seeds, count, distortion, scale, skew)
                size, deg, axis = a.truth_position * 1e3, np.rad2deg(a.truth_rotation), np.sqrt(3)
                lines.append(
                    f"{name:<16}{distortion.value:<9}{count:>5} | {size:>9.3f} {size / axis:>9.3f} {deg:>10.4f} {deg / axis:>9.4f} |"
                    f" {a.held_out_position * 1e3:>11.3f} {np.rad2deg(a.held_out_rotation):>9.4f} | {a.registration * 1e3:>6.3f}"
                )
    for name, effect in zip(("18 others", "20 good poses"), outlier_effect(seeds), strict=True):
        mm = effect * 1e3
        lines.append(f"two outliers of 20 (35 mm; zero pose) against the {name}: median {np.median(mm):.4f}, largest {mm.max():.4f} mm")
    region, interval = coverage(seeds)
    lines.append(f"95 % region of all unknowns holds the truth in {region:.1%}, 95 % interval of the scale in {interval:.1%}")
    errors = time_offset_errors(seeds) * 1e3
    lines.append(f"time offset from 5 s at .5 m/s: sd {errors.std():.4f}, largest {np.abs(errors).max():.4f} ms")
    return lines


if __name__ == "__main__":
    begun = time.perf_counter()
    lines = table(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
    print("\n".join([*lines, f"{time.perf_counter() - begun:.0f} s"]))  # noqa: T201 - a benchmark prints
