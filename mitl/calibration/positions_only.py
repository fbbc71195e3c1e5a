"""Calibration of a tracker that tells positions alone, such as a laser tracker with one reflector: X_LB, p_FM and the distortion.

p_LM = A(p_LB + R_LB (p_BF + R_BF p_FM)). The turns of the flange tell where the reflector sits on it. Invariant: R_FM is the identity by
definition and certain; orientations of the tracker are never looked at, and orientations of the flange are the robot's word.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from mitl.calibration.distortion import Distortion
from mitl.calibration.pose_set import CalibrationError, CalibrationPoses, invalid_reasons, require_enough
from mitl.calibration.result import Calibration, Rejection, Residuals
from mitl.calibration.unknowns import Unknowns
from mitl.paths import BoolArray, FloatArray

# ASSUMPTION A-332: a reflector's mean is good to .1 mm per axis; it only sets where residuals begin to count less, and what is left over
# after it counts as registration.
SIGMA = 0.1e-3
_STEPS = (*range(6), *range(9, 12))
"""Of Unknowns' steps: all but the rotation of the body on the flange."""
_SOFT, _REJECT, _FLOOR = 2.0, 5.0, 0.4
_CHI3_MEDIAN = 1.5382
_MOST_REJECTED = 0.4
_ABSURD = 20e-3
_NEAR = 5e-3
"""Median in m of residuals below which a start is near enough: a scale of 1 % that the model lacks leaves some 3 mm."""
_ROUNDS = 10
_EVERY = 5
_SIGNIFICANT = 2.0


def calibrate_positions(poses: CalibrationPoses, distortion: Distortion | None = None) -> Calibration:
    """Gives the calibration from positions; distortion: None for the richest that poses held out justify.

    Raises CalibrationError where the poses do not determine it, or contradict each other.
    """
    if distortion is not None:
        return _Fit(poses, distortion).calibration()
    fits: list[_Fit] = []
    failure: CalibrationError | None = None
    for model in (Distortion.RIGID, Distortion.SCALE, Distortion.AFFINE):
        try:
            fits.append(_Fit(poses, model))
        except CalibrationError as error:
            failure = error
    if not fits:
        raise failure if failure is not None else CalibrationError("no distortion was tried")
    kept = fits[-1].used  # what the richest model keeps is good
    chosen = fits[0]
    score = chosen.unseen(kept)
    for richer in fits[1:]:
        other = richer.unseen(kept)
        gain = score - other
        if np.mean(gain) > _SIGNIFICANT * np.std(gain, ddof=1) / np.sqrt(len(gain)):
            chosen, score = richer, other
    return chosen.calibration()


class _Fit:
    """A robust fit of one model."""

    def __init__(self, poses: CalibrationPoses, distortion: Distortion) -> None:
        self._distortion = distortion
        self._columns = [*_STEPS, *range(12, 12 + distortion.unknowns)]
        self._reasons = invalid_reasons(poses)
        usable = np.array([not reason for reason in self._reasons], dtype=np.bool_)
        require_enough(poses.select(usable), distortion)
        self._R_BF = Rotation.from_quat(np.where(usable[:, None], poses.flange[:, 3:], [1.0, 0, 0, 0]), scalar_first=True).as_matrix()
        self._p_BF, self._p_LM = poses.flange[:, :3], poses.tracked[:, :3]
        self.used = usable
        self.unknowns = self._robust(usable)
        require_enough(poses.select(self.used), distortion)
        self.unknowns = self._minimise(self.used, self.unknowns, robust=False)

    def unseen(self, kept: BoolArray) -> FloatArray:
        """Gives the squared distance in m^2 of each kept pose from what a fit to the others, in five turns, predicts."""
        return np.asarray(np.sum(self._held_out(kept) ** 2, axis=1))

    def calibration(self) -> Calibration:
        """Gives the result, with a covariance of which the rotation of the body is no part."""
        used, unknowns = self.used, self.unknowns
        residual, held_out = self._residual(used, unknowns), self._held_out(used)
        jacobian = self._jacobian(used, unknowns, np.zeros(12 + self._distortion.unknowns))
        rows, size = jacobian.shape
        noise = max(1e-3 * SIGMA, float(np.sqrt(np.sum(residual**2) / (rows - size))))
        own = np.linalg.inv(jacobian.T @ jacobian) * noise**2 * (rows - size) / (rows - size - 2.0)  # Student's t, as in `solve`
        covariance = np.zeros((12 + self._distortion.unknowns,) * 2)
        covariance[np.ix_(self._columns, self._columns)] = own
        return Calibration(
            X_LB=np.concatenate([unknowns.p_LB, Rotation.from_matrix(unknowns.R_LB).as_quat(canonical=True, scalar_first=True)]),
            X_FM=np.concatenate([unknowns.p_FM, [1.0, 0.0, 0.0, 0.0]]),
            distortion=self._distortion,
            scale=unknowns.scale,
            skew=unknowns.skew,
            covariance=covariance,
            training=_summary(residual),
            held_out=_summary(held_out),
            position_sigma=SIGMA,
            rotation_sigma=0.0,
            position_noise=noise,
            rotation_noise=0.0,
            # the predicted place of the reflector is as uncertain as that of the flange, whose orientation is taken from the robot
            flange_sigma=float(np.sqrt(np.einsum("ij,jk,ik->", jacobian, own, jacobian) / rows)),
            flange_turn_sigma=0.0,
            pose_count=int(used.sum()),
            rejected=tuple(Rejection(i, reason) for i, reason in enumerate(self._reasons) if reason),
            positions_only=True,
        )

    def _robust(self, usable: BoolArray) -> Unknowns:
        """Gives a solution that outliers do not move; learns which poses it keeps and why it drops the others."""
        starts: list[Unknowns] = []
        while len(starts) < _ROUNDS and not (starts and self._middle(usable, starts[-1]) < _NEAR):
            starts.append(self._start(usable, len(starts)))
        start = min(starts, key=lambda unknowns: self._middle(usable, unknowns))
        why: dict[int, str] = {}
        for _ in range(_ROUNDS):
            start = self._minimise(self.used, start, robust=True)
            distance = np.linalg.norm(self._residual(np.ones_like(usable), start), axis=1)
            limit = _REJECT * max(_FLOOR * SIGMA, float(np.median(distance[self.used])) / _CHI3_MEDIAN)
            now = usable & (distance <= limit)
            if float(np.median(distance[usable])) > _ABSURD or now.sum() < (1.0 - _MOST_REJECTED) * usable.sum():
                typical = 1e3 * float(np.median(distance[usable]))
                raise CalibrationError(
                    f"the positions do not agree with the robot's poses: the median difference is {typical:.1f} mm;"
                    " check that they belong together and that the tracker's base stood still"
                )
            why = {
                int(i): f"outlier: {1e3 * distance[i]:.2f} mm (limit {1e3 * limit:.2f}) from what the others predict"
                for i in np.flatnonzero(usable & ~now)
            }
            if np.array_equal(now, self.used):
                break
            self.used = now
        for index, reason in why.items():
            self._reasons[index] = reason
        return start

    def _start(self, usable: BoolArray, seed: int) -> Unknowns:
        """Gives a start from some of the poses (all for seed 0): the flange's own positions, fitted rigidly, then all unknowns."""
        index = np.flatnonzero(usable)
        chosen = index if seed == 0 else np.random.default_rng([len(index), seed]).permutation(index)[: max(6, len(index) // 2)]
        some = np.zeros_like(usable)
        some[chosen] = True
        p, q = self._p_BF[some], self._p_LM[some]
        left, _, right = np.linalg.svd((q - q.mean(axis=0)).T @ (p - p.mean(axis=0)))
        R_LB = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
        start = Unknowns(R_LB, q.mean(axis=0) - R_LB @ p.mean(axis=0), np.eye(3), np.zeros(3), np.ones(3), np.zeros(3))
        return self._minimise(some, start, robust=True)

    def _middle(self, usable: BoolArray, unknowns: Unknowns) -> float:
        return float(np.median(np.linalg.norm(self._residual(usable, unknowns), axis=1)))

    def _residual(self, chosen: BoolArray, unknowns: Unknowns) -> FloatArray:
        """Gives measured minus predicted positions (N, 3) in m."""
        return np.asarray(self._p_LM[chosen] - unknowns.predict(self._R_BF[chosen], self._p_BF[chosen])[1])

    def _jacobian(self, chosen: BoolArray, unknowns: Unknowns, step: FloatArray) -> FloatArray:
        """Gives the derivative (3 N, 9 + k) of the residuals at unknowns that `step` led to."""
        R_BF = self._R_BF[chosen]
        position, _ = unknowns.derivative(R_BF, self._p_BF[chosen], unknowns.R_LB @ R_BF, step, self._distortion)
        return np.asarray(position[:, :, self._columns].reshape(-1, len(self._columns)))

    def _minimise(self, chosen: BoolArray, start: Unknowns, *, robust: bool) -> Unknowns:
        def whole(step: FloatArray) -> FloatArray:
            full = np.zeros(12 + self._distortion.unknowns)
            full[self._columns] = step
            return full

        def residuals(step: FloatArray) -> FloatArray:
            return self._residual(chosen, start.stepped(whole(step), self._distortion)).ravel() / SIGMA

        def jacobian(step: FloatArray) -> FloatArray:
            return self._jacobian(chosen, start.stepped(whole(step), self._distortion), whole(step)) / SIGMA

        solution = least_squares(
            residuals,
            np.zeros(len(self._columns)),
            jac=jacobian,
            loss="soft_l1" if robust else "linear",
            f_scale=_SOFT,
            x_scale="jac",
            xtol=1e-12,
            ftol=1e-12,
            gtol=1e-12,
            max_nfev=200,
        )
        return start.stepped(whole(solution.x), self._distortion)

    def _held_out(self, kept: BoolArray) -> FloatArray:
        """Gives the residuals (N, 3) in m of the kept poses, each by a fit that did not see it."""
        index = np.flatnonzero(kept)
        found = np.empty((len(index), 3))
        turns = min(_EVERY, len(index))
        for first in range(turns):
            out = np.arange(len(index)) % turns == first
            others, these = np.zeros_like(kept), np.zeros_like(kept)
            others[index[~out]], these[index[out]] = True, True
            found[out] = self._residual(these, self._minimise(others, self.unknowns, robust=False))
        return found


def _summary(position: FloatArray) -> Residuals:
    distance = np.linalg.norm(position, axis=1)
    return Residuals(float(np.sqrt(np.mean(distance**2))), float(distance.max()), 0.0, 0.0, len(distance))
