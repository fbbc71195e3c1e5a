"""The poses that calibration learns from, and whether they suffice. Invariant: a set that passes here determines all unknowns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.calibration.distortion import Distortion
from mitl.errors import MitlError
from mitl.paths import BoolArray, FloatArray

# ASSUMPTION A-61: fewest poses. Three determine the unknowns; with fewer than these, rejection cannot tell an outlier from the rest.
_FEWEST = {Distortion.RIGID: 6, Distortion.SCALE: 6, Distortion.AFFINE: 10}
_SPREAD = np.deg2rad(60.0)  # facts/tracker.md, Calibration: at least 60 deg spread about two axes
# ASSUMPTION A-62: smallest extent of the flange positions. Over .1 m, .2 mm of noise leaves the scale of 20 poses uncertain by
# about .1 %, a fifth of the effect that is looked for.
_EXTENT = 0.1
# ASSUMPTION A-69: a pose with four times the usual jitter, and over 3 mm, holds a glitch or was not still. A glitch of 25 mm for 20 ms
# moves the mean of half a second by 1 mm, which residuals need not show.
_RESTLESS = 4.0
_RESTLESS_FLOOR = 3e-3
_MOST_COMPARED = 200  # poses whose pairs are compared for the spread; more would only cost time


class CalibrationError(MitlError):
    """The poses do not determine the calibration; the message says what is missing. Exit code 4."""


@dataclass(frozen=True, eq=False)
class CalibrationPoses:
    """Pairs of what the robot and the tracker say about the same still pose.

    flange: (N, 7) X_BF as the controller reports it. tracked: (N, 7) X_LM, averaged. jitter: (N,) m, diameter of the cloud that
    was averaged. Poses are `x y z qw qx qy qz`; a lost tracker may have given zeros. Raises ValueError where shapes disagree.
    """

    flange: FloatArray
    tracked: FloatArray
    jitter: FloatArray

    def __post_init__(self) -> None:
        n = len(self.jitter)
        shapes = (self.flange.shape, self.tracked.shape, self.jitter.shape)
        if shapes != ((n, 7), (n, 7), (n,)):
            raise ValueError(f"expected shapes (N, 7), (N, 7), (N,), got {shapes}")

    def __len__(self) -> int:
        return len(self.jitter)

    def select(self, chosen: BoolArray) -> CalibrationPoses:
        """Gives the poses where `chosen` (N,) is true."""
        return CalibrationPoses(self.flange[chosen], self.tracked[chosen], self.jitter[chosen])


def invalid_reasons(poses: CalibrationPoses) -> list[str]:
    """Gives for each pose why it cannot be used at all, or "" where it can."""
    known = poses.jitter[np.isfinite(poses.jitter)]
    usual = float(np.median(known)) if len(known) else 0.0
    restless = max(_RESTLESS * usual, _RESTLESS_FLOOR)
    return [_invalid_reason(*pose, restless) for pose in zip(poses.flange, poses.tracked, poses.jitter, strict=True)]


def _invalid_reason(flange: FloatArray, tracked: FloatArray, jitter: float, restless: float) -> str:
    if not np.all(np.isfinite(flange)) or np.linalg.norm(flange[3:]) < 0.5:
        return "the robot's pose is no pose"
    if not np.all(np.isfinite(tracked)) or np.linalg.norm(tracked[3:]) < 0.5:
        return "the tracker's pose is no pose"
    if not np.any(tracked[:3]):
        return "the tracker was lost (zero position)"
    if jitter > restless:
        return f"the point was not still: jitter {jitter * 1e3:.1f} mm (limit {restless * 1e3:.1f})"
    return ""


def require_enough(poses: CalibrationPoses, distortion: Distortion) -> None:
    """Raises CalibrationError saying what is missing where the poses do not determine the calibration."""
    missing: list[str] = []
    if len(poses) < _FEWEST[distortion]:
        raise CalibrationError(
            f"calibration ({distortion.value}) needs at least {_FEWEST[distortion]} usable poses, got {len(poses)}: measure more"
        )
    first, second = rotation_spread(poses.flange)
    if min(first, second) < _SPREAD:
        missing.append(
            f"the flange must turn by at least 60 deg about two axes; it turns by {np.rad2deg(first):.0f} deg about one"
            f" and {np.rad2deg(second):.0f} deg across it"
        )
    extents = position_extents(poses.flange)
    needed = {Distortion.RIGID: 0, Distortion.SCALE: 1, Distortion.AFFINE: 3}[distortion]
    if needed and extents[needed - 1] < _EXTENT:
        where = "in all three directions" if needed == 3 else "in some direction"
        missing.append(
            f"to find the tracker's scale the flange must move by at least {_EXTENT * 1e3:.0f} mm {where};"
            f" it moves by {', '.join(f'{e * 1e3:.0f}' for e in extents)} mm"
        )
    if missing:
        raise CalibrationError(f"the {len(poses)} usable poses do not determine the calibration: " + "; ".join(missing))


def rotation_spread(flange: FloatArray) -> tuple[float, float]:
    """Gives the largest rotation between two of the poses (N, 7), and the largest part of one across that first axis, in rad."""
    some = flange[np.linspace(0, len(flange) - 1, min(len(flange), _MOST_COMPARED)).astype(int)]
    R_BF = Rotation.from_quat(some[:, 3:], scalar_first=True)
    i, j = np.triu_indices(len(some), 1)
    turns = (R_BF[i] * R_BF[j].inv()).as_rotvec()  # in B, so that axes of different pairs compare
    angles = np.linalg.norm(turns, axis=1)
    widest = int(np.argmax(angles))
    if angles[widest] == 0.0:
        return 0.0, 0.0
    axis = turns[widest] / angles[widest]
    return float(angles[widest]), float(np.max(np.linalg.norm(np.cross(turns, axis), axis=1)))


def position_extents(flange: FloatArray) -> FloatArray:
    """Gives the extent (3,) in m of the positions of poses (N, 7) along their principal directions, widest first."""
    centred = flange[:, :3] - flange[:, :3].mean(axis=0)
    directions = np.linalg.svd(centred, full_matrices=False)[2]
    return np.sort(np.ptp(centred @ directions.T, axis=0))[::-1]
