"""Solves robot-world and hand-eye with scale: robust start, joint least squares, rejection, refit, covariance, held-out residuals.

Recipe: facts/tracker.md, Calibration. Invariant: the same poses give the same calibration.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from mitl.calibration.closed_form import robust_start
from mitl.calibration.distortion import Distortion
from mitl.calibration.pose_set import CalibrationError, CalibrationPoses, invalid_reasons, require_enough
from mitl.calibration.result import Calibration, Rejection, Residuals
from mitl.calibration.unknowns import Unknowns
from mitl.paths import BoolArray, FloatArray

POSITION_SIGMA = 0.2e-3  # facts/tracker.md: .2 mm and .05 deg per averaged pose
ROTATION_SIGMA = float(np.deg2rad(0.05))
# ASSUMPTION A-63: a pose is an outlier past 5 robust standard deviations (norm over three axes: 1 in 10^5 by chance), and never
# within 2 expected standard deviations, so that noise-free poses are not rejected for rounding.
_REJECT = 5.0
_FLOOR = 0.4
_CHI3_MEDIAN = 1.5382  # median of the norm of three standard normal numbers
_SOFT = 2.0  # whitened residual at which soft-L1 turns from square to linear
_ROUNDS = 10
_MOST_REJECTED = 0.4  # share beyond which the poses contradict each other rather than contain outliers
# ASSUMPTION A-67: no tracker is so bad that half the poses miss by this much; then robot and tracker poses do not belong together.
_ABSURD = 20e-3  # m; a scale of 1 % that the model lacks leaves some 3 mm
_ABSURD_TURN = float(np.deg2rad(3.0))


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Poses as matrices, (N, 3, 3) and (N, 3), and the noise by which residuals are weighted."""

    R_BF: FloatArray
    p_BF: FloatArray
    R_LM: FloatArray
    p_LM: FloatArray
    position_sigma: float
    rotation_sigma: float

    def select(self, chosen: BoolArray) -> _Pairs:
        return _Pairs(self.R_BF[chosen], self.p_BF[chosen], self.R_LM[chosen], self.p_LM[chosen], self.position_sigma, self.rotation_sigma)

    def weighted(self, position_sigma: float, rotation_sigma: float) -> _Pairs:
        return _Pairs(self.R_BF, self.p_BF, self.R_LM, self.p_LM, position_sigma, rotation_sigma)

    def residuals(self, unknowns: Unknowns) -> tuple[FloatArray, FloatArray]:
        """Gives measured from predicted, positions (N, 3) in m and rotation vectors (N, 3) in rad, not weighted."""
        R_LM, p_LM = unknowns.predict(self.R_BF, self.p_BF)
        turn = Rotation.from_matrix(np.swapaxes(R_LM, 1, 2) @ self.R_LM, assume_valid=True).as_rotvec()
        return self.p_LM - p_LM, turn

    def whitened(self, unknowns: Unknowns) -> FloatArray:
        """Gives the residuals (6 N,) in standard deviations: all positions, then all rotations."""
        position, turn = self.residuals(unknowns)
        return np.concatenate([(position / self.position_sigma).ravel(), (turn / self.rotation_sigma).ravel()])


def calibrate(
    poses: CalibrationPoses,
    *,
    distortion: Distortion = Distortion.SCALE,
    held_out_every: int = 5,
    position_sigma: float = POSITION_SIGMA,
    rotation_sigma: float = ROTATION_SIGMA,
    provenance: Mapping[str, str] | None = None,
) -> Calibration:
    """Gives the calibration that all usable poses agree on.

    held_out_every: every so manyeth pose is held out from a fit and predicted by it, in as many turns, so that each pose is
    predicted once by a fit that has not seen it; the calibration itself then uses all. position_sigma (m), rotation_sigma (rad):
    expected noise of one averaged tracker pose per axis; the robot's pose counts as exact. They weigh positions against rotations
    at first; the final weights and the covariance come from the residuals.
    Raises CalibrationError where the poses do not determine the unknowns, ValueError for a held_out_every below 2.
    """
    if held_out_every < 2:
        raise ValueError(f"held_out_every must be at least 2, got {held_out_every}")
    reasons = invalid_reasons(poses)
    usable = np.array([not reason for reason in reasons], dtype=np.bool_)
    require_enough(poses.select(usable), distortion)
    pairs = _pairs(poses.select(usable), position_sigma, rotation_sigma)

    unknowns, inlier, why = _robust_fit(pairs, distortion)
    indices = np.flatnonzero(usable)
    for index, reason in why.items():
        reasons[indices[index]] = reason
    used = np.zeros(len(poses), dtype=np.bool_)
    used[indices[inlier]] = True
    require_enough(poses.select(used), distortion)

    kept = pairs.select(inlier)
    fit = _refit(kept, unknowns, distortion)
    held_out = _held_out(kept, fit.unknowns, distortion, held_out_every)
    flange_sigma, flange_turn_sigma = _flange_sigma(kept, fit, distortion)
    return Calibration(
        X_LB=_pose(fit.unknowns.R_LB, fit.unknowns.p_LB),
        X_FM=_pose(fit.unknowns.R_FM, fit.unknowns.p_FM),
        distortion=distortion,
        scale=fit.unknowns.scale,
        skew=fit.unknowns.skew,
        covariance=fit.covariance,
        training=_summary(*kept.residuals(fit.unknowns)),
        held_out=_summary(*held_out),
        position_sigma=position_sigma,
        rotation_sigma=rotation_sigma,
        position_noise=fit.position_noise,
        rotation_noise=fit.rotation_noise,
        flange_sigma=flange_sigma,
        flange_turn_sigma=flange_turn_sigma,
        pose_count=int(inlier.sum()),
        rejected=tuple(Rejection(i, reason) for i, reason in enumerate(reasons) if reason),
        provenance=dict(provenance or {}),
    )


def held_out_score(poses: CalibrationPoses, distortion: Distortion, every: int, position_sigma: float, rotation_sigma: float) -> FloatArray:
    """Gives for each pose (N,) the squared prediction error in expected standard deviations by a fit that had not seen it.

    `poses` must be usable and free of outliers.
    """
    pairs = _pairs(poses, position_sigma, rotation_sigma)
    start = robust_start(pairs.R_BF, pairs.p_BF, pairs.R_LM, pairs.p_LM, distortion)
    position, turn = _held_out(pairs, _minimise(pairs, start, distortion, "linear"), distortion, every)
    return np.asarray(np.sum((position / position_sigma) ** 2, axis=1) + np.sum((turn / rotation_sigma) ** 2, axis=1))


@dataclass(frozen=True, eq=False)
class _Fit:
    unknowns: Unknowns
    covariance: FloatArray
    position_noise: float
    rotation_noise: float


def _pairs(poses: CalibrationPoses, position_sigma: float, rotation_sigma: float) -> _Pairs:
    R_BF = Rotation.from_quat(poses.flange[:, 3:], scalar_first=True).as_matrix()
    R_LM = Rotation.from_quat(poses.tracked[:, 3:], scalar_first=True).as_matrix()
    return _Pairs(R_BF, poses.flange[:, :3], R_LM, poses.tracked[:, :3], position_sigma, rotation_sigma)


def _pose(R: FloatArray, p: FloatArray) -> FloatArray:
    return np.concatenate([p, Rotation.from_matrix(R).as_quat(canonical=True, scalar_first=True)])


def _minimise(pairs: _Pairs, start: Unknowns, distortion: Distortion, loss: Literal["linear", "soft_l1"]) -> Unknowns:
    """Gives the joint least-squares solution from a start."""

    def residuals(step: FloatArray) -> FloatArray:
        return pairs.whitened(start.stepped(step, distortion))

    def jacobian(step: FloatArray) -> FloatArray:
        return _jacobian(pairs, start, step, distortion)

    solution = least_squares(
        residuals,
        np.zeros(12 + distortion.unknowns),
        jac=jacobian,
        loss=loss,
        f_scale=_SOFT,
        x_scale="jac",
        method="trf",
        xtol=1e-12,
        ftol=1e-12,
        gtol=1e-12,
        max_nfev=200,
    )
    return start.stepped(solution.x, distortion)


def _jacobian(pairs: _Pairs, start: Unknowns, step: FloatArray, distortion: Distortion) -> FloatArray:
    """Gives the derivative (6 N, 12 + k) of the whitened residuals."""
    position, turn = start.stepped(step, distortion).derivative(pairs.R_BF, pairs.p_BF, pairs.R_LM, step, distortion)
    size = position.shape[2]
    return np.concatenate([position.reshape(-1, size) / pairs.position_sigma, turn.reshape(-1, size) / pairs.rotation_sigma])


def _robust_fit(pairs: _Pairs, distortion: Distortion) -> tuple[Unknowns, BoolArray, dict[int, str]]:
    """Gives the soft-L1 solution, which poses (N,) it keeps, and why it drops the others."""
    unknowns = robust_start(pairs.R_BF, pairs.p_BF, pairs.R_LM, pairs.p_LM, distortion)
    inlier = np.ones(len(pairs.p_BF), dtype=np.bool_)
    why: dict[int, str] = {}
    for _ in range(_ROUNDS):
        unknowns = _minimise(pairs.select(inlier), unknowns, distortion, "soft_l1")
        position, turn = (np.linalg.norm(r, axis=1) for r in pairs.residuals(unknowns))
        position_limit = _REJECT * max(_FLOOR * pairs.position_sigma, float(np.median(position[inlier])) / _CHI3_MEDIAN)
        turn_limit = _REJECT * max(_FLOOR * pairs.rotation_sigma, float(np.median(turn[inlier])) / _CHI3_MEDIAN)
        now = (position <= position_limit) & (turn <= turn_limit)
        absurd = float(np.median(position)) > _ABSURD or float(np.median(turn)) > _ABSURD_TURN
        if absurd or now.mean() < 1.0 - _MOST_REJECTED:
            raise CalibrationError(
                f"the poses do not agree with each other: {0 if absurd else int(now.sum())} of {len(now)} do, the median difference is"
                f" {np.median(position) * 1e3:.1f} mm and {np.rad2deg(np.median(turn)):.2f} deg; check that robot and tracker poses"
                " belong together and that the tracker's base stood still"
            )
        why = {
            int(i): f"outlier: {position[i] * 1e3:.2f} mm (limit {position_limit * 1e3:.2f}),"
            f" {np.rad2deg(turn[i]):.3f} deg (limit {np.rad2deg(turn_limit):.3f}) from what the others predict"
            for i in np.flatnonzero(~now)
        }
        if np.array_equal(now, inlier):
            break
        inlier = now
    return unknowns, inlier, why


def _refit(pairs: _Pairs, start: Unknowns, distortion: Distortion) -> _Fit:
    """Gives the plain least-squares solution of poses without outliers, weights and covariance from its own residuals.

    Position and rotation noise are variance components, estimated in turn with the solution (Förstner): each residual sum of
    squares over its share of the redundancy.
    """
    size = 12 + distortion.unknowns
    rows = 3 * len(pairs.p_BF)
    unknowns = start
    covariance: FloatArray = np.eye(size)
    for _ in range(3):
        unknowns = _minimise(pairs, unknowns, distortion, "linear")
        jacobian = _jacobian(pairs, unknowns, np.zeros(size), distortion)
        covariance = _inverse(jacobian.T @ jacobian)
        taken = np.einsum("ij,jk,ik->i", jacobian, covariance, jacobian)  # share of each residual that the unknowns take up
        squares = pairs.whitened(unknowns) ** 2
        # never below 1e-3 of the expected noise: exact poses must not give infinite weights
        position_factor = max(1e-3, float(np.sqrt(squares[:rows].sum() / (rows - taken[:rows].sum()))))
        rotation_factor = max(1e-3, float(np.sqrt(squares[rows:].sum() / (rows - taken[rows:].sum()))))
        pairs = pairs.weighted(pairs.position_sigma * position_factor, pairs.rotation_sigma * rotation_factor)
    jacobian = _jacobian(pairs, unknowns, np.zeros(size), distortion)
    # the noise is estimated too, so that errors follow Student's t: its variance is wider by nu / (nu - 2), with half the redundancy
    # for each of the two noises
    nu = (2 * rows - size) / 2.0
    covariance = _inverse(jacobian.T @ jacobian) * (nu / (nu - 2.0))
    return _Fit(unknowns, covariance, pairs.position_sigma, pairs.rotation_sigma)


def _inverse(matrix: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.inv(matrix), dtype=np.float64)


def _held_out(pairs: _Pairs, start: Unknowns, distortion: Distortion, every: int) -> tuple[FloatArray, FloatArray]:
    """Gives the residuals (N, 3), (N, 3) of each pose against a fit to the turns that leave it out."""
    n = len(pairs.p_BF)
    position, turn = np.empty((n, 3)), np.empty((n, 3))
    turns = min(every, n)
    for first in range(turns):
        out = np.arange(n) % turns == first
        position[out], turn[out] = pairs.select(out).residuals(_minimise(pairs.select(~out), start, distortion, "linear"))
    return position, turn


def _flange_sigma(pairs: _Pairs, fit: _Fit, distortion: Distortion) -> tuple[float, float]:
    """Gives what the covariance means for flange poses in B, per axis, rms over the poses: m and rad."""
    R_LM, p_LM = fit.unknowns.predict(pairs.R_BF, pairs.p_BF)
    size, n = 1e-5, len(p_LM)
    position, turn = [], []
    for i in range(12 + distortion.unknowns):
        step = np.zeros(12 + distortion.unknowns)
        step[i] = size
        R_BF, p_BF = fit.unknowns.stepped(step, distortion).flange(R_LM, p_LM)
        position.append(((p_BF - pairs.p_BF) / size).ravel())
        relative = np.swapaxes(pairs.R_BF, 1, 2) @ R_BF
        turn.append((Rotation.from_matrix(relative, assume_valid=True).as_rotvec() / size).ravel())

    def rms(columns: list[FloatArray]) -> float:
        by_unknown = np.stack(columns, axis=1)
        return float(np.sqrt(np.einsum("ij,jk,ik->", by_unknown, fit.covariance, by_unknown) / (3 * n)))

    return rms(position), rms(turn)


def _summary(position: FloatArray, turn: FloatArray) -> Residuals:
    distance, angle = np.linalg.norm(position, axis=1), np.linalg.norm(turn, axis=1)
    return Residuals(
        position_rms=float(np.sqrt(np.mean(distance**2))),
        position_max=float(distance.max()),
        rotation_rms=float(np.sqrt(np.mean(angle**2))),
        rotation_max=float(angle.max()),
        count=len(distance),
    )
