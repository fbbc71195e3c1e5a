"""ATC-0, preliminary: the registration of tracker and robot, the tool's tip on the tracked body, and the verification of both.

A failure here compromises every other case.
"""

from __future__ import annotations

import numpy as np

from mitl.atc.measuring import budget_of_point, still_point, undistorted
from mitl.calibration.pivot import pivot_point
from mitl.engine import Bench, Check, case
from mitl.metrics.uncertainty import Budget, Term
from mitl.poses import transform_of

JITTER_LIMIT = 1.2e-3
POSITION_LIMIT = 5e-3
TOOL_LIMIT = 0.5e-3
PROBE = np.array([0.0, 0.0, 0.05])
"""p_FT of the 50 mm tool tProbe50 in atc_0.mod, m."""
_POINTS = {1: "origin", 2: "300 mm along X", 3: "300 mm along Y", 4: "300 mm along Z"}
_TURNS = 32
_ROUNDS = 2
"""With preset thesis every other run is repeated, because one round of turns leaves the verdict open."""


@case(
    "atc-0/calibrate",
    title="Registration of tracker and robot",
    purpose="Solve where the tracker's base stands and how the tracked body sits on the flange, with scale and skew, and verify it.",
    requirement="Poses held out from the solution are predicted as well as the following cases need.",
    limit_source="thesis 3.4.2.1 (jitter 1.2 mm warns) and 3.4.2.3 (5 mm), facts/atc.md",
    program="calibration.mod",
    catches=("joint-offset",),
    typical_s=90.0,
)
def test_calibrate(bench: Bench, check: Check) -> None:
    """The session's calibration is what every case uses; here it is judged."""
    calibration = bench.calibration
    of_rms = np.sqrt(2 * calibration.pose_count)
    position = Budget((Term("random", calibration.position_noise / of_rms, "spread of an rms over the poses"),))
    turn = Budget((Term("random", calibration.rotation_noise / of_rms, "spread of an rms over the poses"),))
    residual = calibration.held_out
    check("held-out position residual", value=1e3 * residual.position_rms, limit=1e3 * POSITION_LIMIT, unit="mm", budget=position)
    check("held-out orientation residual", value=float(np.degrees(residual.rotation_rms)), limit=1.0, unit="deg", budget=turn)
    poses = bench.calibration_poses
    if len(poses):  # a stored calibration comes without them
        jitter = float(np.max(poses.jitter))
        check("largest jitter of a pose", value=1e3 * jitter, limit=1e3 * JITTER_LIMIT, uncertainty=0.0, unit="mm", warning=True)
    scale = ", ".join(f"{value:.5f}" for value in calibration.scale)
    skew = ", ".join(f"{value:.3f}" for value in np.degrees(calibration.skew))
    check.message("info", f"model {calibration.distortion.value}: scale {scale}, skew {skew} deg, {calibration.pose_count} poses used")
    for rejection in calibration.rejected:
        check.message("warning", f"pose {rejection.index + 1} was not used: {rejection.reason}")


@case(
    "atc-0/tool-offset",
    title="Tip of a 50 mm tool",
    purpose="Find a tool's tip on the tracked body from turns about the tip alone; compare it with the one that the registration gives.",
    requirement="The position of the tracked body on the flange is right: the tip of a 50 mm tool comes back.",
    limit_source="facts/atc.md: within .5 mm",
    program="atc_0.mod",
    catches=("wrong-tool",),
    typical_s=100.0,
)
def test_tool_offset(bench: Bench, check: Check) -> None:
    """The robot's pose takes no part in the tip that the turns give."""
    turns = [*range(1, _TURNS + 1)] * _ROUNDS
    poses = np.array([undistorted(bench, still_point(bench, 2, turn)[0]) for turn in turns])
    pivot = pivot_point(poses)
    calibration = bench.calibration
    expected = transform_of(calibration.X_FM).inv().apply(PROBE)
    body_sigma = float(np.sqrt(np.linalg.eigvalsh(calibration.covariance[9:12, 9:12]).max()))
    budget = Budget(
        (
            Term("random", pivot.sigma, f"{len(turns)} turns, tip scattered by {1e3 * pivot.residual:.2f} mm"),
            Term("registration", body_sigma, "covariance of X_FM"),
        )
    )
    check(
        "distance of the two tips",
        value=1e3 * float(np.linalg.norm(pivot.p_MT - expected)),
        limit=1e3 * TOOL_LIMIT,
        unit="mm",
        budget=budget,
    )


@case(
    "atc-0/verify",
    title="Four points of the work object",
    purpose="Verify the registration at the work object's origin and 300 mm along each of its axes.",
    requirement="Programmed points are reached: tool, work object and target are combined rightly.",
    limit_source="thesis 3.4.2.3: 5 mm, jitter 1.2 mm",
    program="atc_0.mod",
    catches=("wrong-work-object", "wrong-tool", "target-offset", "axis-sign"),
    typical_s=30.0,
)
def test_verify(bench: Bench, check: Check) -> None:
    """The distance of every averaged point from its programmed place."""
    for number, name in _POINTS.items():
        point, programmed = still_point(bench, 1, number)
        distance = float(np.linalg.norm(point.tool[:3] - programmed[:3]))
        check(f"distance at {name}", value=1e3 * distance, limit=1e3 * POSITION_LIMIT, unit="mm", budget=budget_of_point(bench, point))
        check(f"jitter at {name}", value=1e3 * point.raw.jitter, limit=1e3 * JITTER_LIMIT, uncertainty=0.0, unit="mm", warning=True)
