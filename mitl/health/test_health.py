"""The health check's cases: the tracker by itself, places come back to, the speed of a line, and the time to react.

Every figure has a limit of its own, and a limit of how much worse than the baseline it may be.
"""

from __future__ import annotations

import numpy as np

from mitl.atc.measuring import DRIFT_SD, DRIFT_TAU, SETTLING, budget_of_speed
from mitl.engine import Bench, TrackedRun, case
from mitl.engine.bench import STILL
from mitl.errors import RigError
from mitl.health.figures import Figures
from mitl.metrics.deviation import window_means
from mitl.metrics.glitch import without_glitches
from mitl.metrics.iso9283.pose_accuracy import pose_accuracy
from mitl.metrics.iso9283.repeatability import rp
from mitl.metrics.line import line_deviation
from mitl.metrics.speed import line_speed
from mitl.metrics.stillness import jitter_diameter
from mitl.metrics.uncertainty import Budget, Term, drift_sigma
from mitl.paths import FloatArray, PosePath

WINDOW = 0.5
"""Seconds of a still window, as in the thesis's table 4.1."""
NEAR = 40e-3
LEAST = 5
"""Valid samples of a still window below which it is none."""
STANDING_TOURS = 3
TOURS = 10
ENDS = 3
"""Tours at either end whose means tell the drift."""
SPEED = 0.2
MIDDLE = 0.4
"""Seconds about the middle of a line over which its mean speed is taken (facts/atc.md)."""
HOPS = 12
# ASSUMPTION A-340: what a health check allows, and how much worse than the baseline.
JITTER_LIMIT, JITTER_CHANGE = 2e-3, 0.7e-3
VALID_LIMIT, VALID_CHANGE = 0.99, 0.01
GAP_LIMIT = 50e-3
GLITCHES_LIMIT = 2
PLACE_LIMIT, PLACE_CHANGE = 5e-3, 3e-3
TURN_LIMIT, TURN_CHANGE = np.radians(2.0), np.radians(1.0)
RP_LIMIT, RP_CHANGE = 4e-3, 1.5e-3
DRIFT_LIMIT = 2.5e-3
SPEED_LIMIT, SPEED_CHANGE = 5e-3, 4e-3
REACTION_LIMIT, REACTION_CHANGE = 0.2, 50e-3
_CROSSING = 2.0
"""Seconds in which the tool passes the middle of the line; slower is no pass."""
_FAR = 1e-3
_SMOOTH = 0.012


@case(
    "health/tracker",
    title="The tracker by itself",
    purpose="Jitter of standing points, glitches, valid samples and gaps over tours of six places.",
    requirement="The tracker sees as well as when the rig was known to be well.",
    limit_source="ours: jitter 2 mm, thesis 4.1.1 has 1.2 mm at its noisiest place; glitches as facts/tracker.md, one in 80 stops",
    program="health.mod",
    typical_s=60.0,
)
def test_tracker(bench: Bench, figures: Figures) -> None:
    """What a worse tracker shows: a base station that is covered, reflections, a weak battery, a loose mount."""
    runs = [bench.run(1, name=f"tour {number}") for number in range(1, STANDING_TOURS + 1)]
    windows = [window for run in runs for window in _windows(run) if len(window) >= LEAST]
    if len(windows) < 2:
        raise RigError(f"the tracker saw {len(windows)} standing points in {len(runs)} tours: is it in view?")
    jitter = np.array([jitter_diameter(window.position) for window in windows])
    random = float(np.std(jitter, ddof=1) / np.sqrt(len(jitter)))
    figures.judge(
        "jitter of a standing point",
        value=1e3 * float(jitter.mean()),
        limit=1e3 * JITTER_LIMIT,
        change=1e3 * JITTER_CHANGE,
        unit="mm",
        budget=Budget((Term("random", random, f"{len(jitter)} windows of {WINDOW:g} s"),)),
    )
    valid = np.concatenate([run.raw.valid for run in runs])
    shares = [run.raw.valid.mean() for run in runs]
    figures.judge(
        "valid samples",
        value=100.0 * float(valid.mean()),
        limit=100.0 * VALID_LIMIT,
        change=100.0 * VALID_CHANGE,
        unit="%",
        at_least=True,
        budget=Budget((Term("random", float(np.std(shares, ddof=1)) / np.sqrt(len(shares)), f"{len(valid)} samples"),)),
    )
    gaps = [float(np.diff(run.raw.time).max()) for run in runs]
    sampled = Budget((Term("sampling", 4e-3 / np.sqrt(12), "one sample of 4 ms"),))
    figures.judge("longest gap between samples", value=1e3 * max(gaps), limit=1e3 * GAP_LIMIT, unit="ms", budget=sampled)
    glitches = sum(_glitches(run.raw) for run in runs)
    figures.judge("glitches", value=float(glitches), limit=float(GLITCHES_LIMIT), unit="", budget=Budget())
    rate = np.mean([(len(run.raw) - 1) / np.ptp(run.raw.time) for run in runs])
    figures.check.message("info", f"{rate:.1f} samples per second, {glitches} glitches at {len(jitter)} stops")


@case(
    "health/places",
    title="Places come back to",
    purpose="Six places are visited ten times: repeatability of robot and tracker, the calibration, and the drift from first to last.",
    requirement="Robot, calibration and tracker are what they were when the rig was known to be well.",
    limit_source="thesis 3.4.2.3: 5 mm from the program; ours: the rest, from the noise floors of facts/tracker.md",
    program="health.mod",
    catches=("target-offset", "wrong-work-object", "joint-drift", "scatter"),
    typical_s=150.0,
)
def test_places(bench: Bench, figures: Figures) -> None:
    """A calibration that no longer holds shows as places and orientations away from the program, all in one way."""
    tours = []
    begun = bench.clock.now()
    for number in range(1, TOURS + 1):
        run = bench.run(1, name=f"tour {number}")
        tours.append([_mean_pose(window) for window in _windows(run)])
    elapsed = bench.clock.now() - begun
    poses = np.array(tours)
    programmed = [move.end for move in bench.last_oracle.moves[1:-1]]
    found = [pose_accuracy(poses[:, place], end) for place, end in enumerate(programmed)]
    repeatability = np.array([rp(poses[:, place, :3]) for place in range(poses.shape[1])])
    spread = float(np.std(repeatability, ddof=1) / np.sqrt(len(repeatability)))
    figures.judge(
        "repeatability",
        value=1e3 * float(repeatability.mean()),
        limit=1e3 * RP_LIMIT,
        change=1e3 * RP_CHANGE,
        unit="mm",
        budget=Budget((Term("random", spread, f"{len(repeatability)} places, {TOURS} times"),)),
    )
    lever = float(np.linalg.norm(bench.last_oracle.tool[:3]))
    known = (
        Term("registration", bench.calibration.position_uncertainty(lever), "calibration"),
        Term("drift", drift_sigma(DRIFT_SD, DRIFT_TAU, bench.since_calibration), "tracker, since the calibration"),
    )
    figures.judge(
        "places away from the program",
        value=1e3 * float(np.mean([each.position for each in found])),
        limit=1e3 * PLACE_LIMIT,
        change=1e3 * PLACE_CHANGE,
        unit="mm",
        budget=Budget((Term("random", float(np.mean([each.random for each in found])), f"{TOURS} visits"), *known)),
    )
    figures.judge(
        "orientations away from the program",
        value=float(np.degrees(np.mean([each.angle for each in found]))),
        limit=float(np.degrees(TURN_LIMIT)),
        change=float(np.degrees(TURN_CHANGE)),
        unit="deg",
        budget=Budget((Term("registration", bench.calibration.rotation_uncertainty(), "calibration"),)),
    )
    moved = poses[-ENDS:, :, :3].mean(axis=(0, 1)) - poses[:ENDS, :, :3].mean(axis=(0, 1))
    scatter = float(np.sqrt(np.mean(np.var(poses[:, :, :3], axis=0, ddof=1))))
    figures.judge(
        "drift from first to last tours",
        value=1e3 * float(np.linalg.norm(moved)),
        limit=1e3 * DRIFT_LIMIT,
        unit="mm",
        budget=Budget(
            (
                Term("random", scatter * np.sqrt(2.0 / (ENDS * poses.shape[1])), f"{ENDS} tours at either end"),
                Term("drift", drift_sigma(DRIFT_SD, DRIFT_TAU, elapsed), "tracker, facts/tracker.md"),
            )
        ),
    )


@case(
    "health/speed",
    title="Speed of a line",
    purpose="A line is run eight times at 200 mm/s.",
    requirement="The robot keeps the speed that it kept when the rig was known to be well.",
    limit_source="thesis 3.4.4.1: 5 mm/s, 400 ms about the middle of the line",
    program="health.mod",
    catches=("speed",),
    typical_s=30.0,
)
def test_speed(bench: Bench, figures: Figures) -> None:
    """The mean of all passes; their scatter tells how well it is known."""
    run = bench.run(2, variables={"speed": f"{1e3 * SPEED:g}"}, name="line")
    lines = [move for move in run.oracle.moves if move.kind == "MoveL"]
    middles = _passings(run.tool, lines[0].start[:3], lines[0].end[:3])
    if len(middles) != len(lines):
        raise RigError(f"the line was passed {len(middles)} times; expected {len(lines)}")
    passes = np.array([line_speed(run.tool, middle - MIDDLE / 2, middle + MIDDLE / 2).value for middle in middles])
    random = float(np.std(passes, ddof=1) / np.sqrt(len(passes)))
    figures.judge(
        "speed of a line, off by",
        value=1e3 * (float(passes.mean()) - SPEED),
        limit=1e3 * SPEED_LIMIT,
        change=1e3 * SPEED_CHANGE,
        unit="mm/s",
        either_way=True,
        budget=budget_of_speed(bench, random=random, speed=SPEED),
    )


@case(
    "health/reaction",
    title="Reaction time",
    purpose="From an order to the first millimetre of motion, 12 times.",
    requirement="Controller, network and tracker are as quick as when the rig was known to be well.",
    limit_source="ATC-6's 200 ms (facts/atc.md)",
    program="health.mod",
    catches=("late-start",),
    typical_s=40.0,
)
def test_reaction(bench: Bench, figures: Figures) -> None:
    """The mean: a single one may be late on a busy network."""
    bench.go(3, settle=SETTLING)
    times = []
    for number in range(1, HOPS + 1):
        run = bench.run(4, variables={"speed": "200"}, name=f"hop {number}")
        rest = run.tool.between(run.given - STILL, run.given)
        smooth = window_means(run.tool.time, run.tool.position, _SMOOTH)
        away = np.linalg.norm(smooth - rest.position.mean(axis=0), axis=1) > _FAR
        moved = run.tool.time[away & (run.tool.time > run.given)]
        times.append(float(moved[0]) - run.given if len(moved) else np.inf)
    random = float(np.std(times, ddof=1) / np.sqrt(len(times))) if np.all(np.isfinite(times)) else 0.0
    figures.judge(
        "mean reaction",
        value=1e3 * float(np.mean(times)),
        limit=1e3 * REACTION_LIMIT,
        change=1e3 * REACTION_CHANGE,
        unit="ms",
        budget=Budget((Term("random", random, f"{HOPS} hops"), Term("noise", 2e-3, "noise at 1 mm of motion"))),
    )


def _windows(run: TrackedRun) -> list[PosePath]:
    """Gives the valid samples of half a second at every place of a tour, the middle of the time for which the tool was near it.

    That needs no clock: a robot that is late is judged by its reaction, not by its places. The arm has settled for .1 s by then. Windows
    may have few samples, or none where the tracker was lost. Raises RigError where the tool never came near a place.
    """
    windows = []
    for number, move in enumerate(run.oracle.moves[1:-1], start=1):
        near = np.flatnonzero(np.linalg.norm(run.tool.position - move.end[:3], axis=1) < NEAR)
        if not len(near):
            raise RigError(f"the tool was not seen within {1e3 * NEAR:.0f} mm of place {number} of the tour")
        visits = np.split(near, np.flatnonzero(np.diff(near) > 1) + 1)
        times = run.tool.time[max(visits, key=lambda visit: float(np.ptp(run.tool.time[visit])))]
        middle = (times[0] + times[-1]) / 2
        windows.append(run.tool.between(middle - WINDOW / 2, middle + WINDOW / 2))
    return windows


def _passings(path: PosePath, start: FloatArray, end: FloatArray) -> list[float]:
    """Gives when the middle of a line is passed, either way: the tool crosses it between two places a tenth of the line away from it."""
    length = float(np.linalg.norm(end - start))
    away = line_deviation(path.position, start, end)
    beyond = away.along - length / 2
    on_line = np.linalg.norm(away.across, axis=1) < NEAR
    far = np.flatnonzero(on_line & (np.abs(beyond) > length / 10))
    turns = np.flatnonzero(np.diff(np.sign(beyond[far])) != 0)
    crossed = [slice(far[turn], far[turn + 1] + 1) for turn in turns if path.time[far[turn + 1]] - path.time[far[turn]] < _CROSSING]
    return [float(path.time[part][np.argmin(np.abs(beyond[part]))]) for part in crossed]


def _mean_pose(window: PosePath) -> FloatArray:
    """Gives the mean pose (7,) of a still window. Raises RigError where the tracker was lost."""
    if len(window) < LEAST:
        raise RigError(f"{len(window)} valid samples at a place of the tour, expected {LEAST} at least: is the tracker in view?")
    quaternion = window.quaternion_wxyz * np.sign(window.quaternion_wxyz @ window.quaternion_wxyz[0])[:, None]
    turn = quaternion.mean(axis=0)
    return np.concatenate([window.position.mean(axis=0), turn / np.linalg.norm(turn)])


def _glitches(path: PosePath) -> int:
    """Gives how many excursions a path has that no robot can make."""
    marked = path.valid & ~without_glitches(path).valid
    return int(np.sum(marked[1:] & ~marked[:-1])) + int(marked[0])
