"""ATC-6, other instructions visible in the motion: a velocity override, a largest speed, a program displacement."""

from __future__ import annotations

import numpy as np

from mitl.atc.measuring import TimedRun, timed
from mitl.atc.verdicts import check_position, check_speed
from mitl.engine import Bench, Check, case
from mitl.errors import RigError
from mitl.metrics.acceleration import middle_passages
from mitl.metrics.line import line_deviation
from mitl.metrics.speed import line_speed
from mitl.paths import FloatArray

SPEED_LIMIT = 5e-3
LINE_LIMIT = 5e-3
DISPLACED = np.array([0.0, 0.0, 0.04])
"""Program displacement in m in the work object."""
_EXPECTED = {"override of 50 per cent": 0.2, "largest speed of 150 mm/s": 0.15}
_WINDOW = 0.4


@case(
    "atc-6/override",
    title="VelSet",
    purpose="Lines programmed at 400 mm/s run with an override of 50 per cent, and with a largest speed of 150 mm/s.",
    requirement="VelSet scales and limits the programmed speeds.",
    limit_source="thesis 3.4.4.1: 5 mm/s",
    program="atc_6.mod",
    catches=("override-ignored", "speed"),
    typical_s=12.0,
)
def test_override(bench: Bench, check: Check) -> None:
    """The mean speed about the middle of each line, by the programmed figures and no oracle."""
    run = timed(bench.run(3, variables={"speed": "400"}, name="VelSet"))
    middles = _middles(run)
    for number, (name, expected) in enumerate(_EXPECTED.items()):
        found = [line_speed(run.tool, middle - _WINDOW / 2, middle + _WINDOW / 2) for middle in middles[number::2]]
        faster = float(np.mean([speed.value for speed in found])) - expected
        random = float(np.sqrt(np.mean([speed.random**2 for speed in found]) / len(found)))
        check_speed(bench, check, f"speed, {name}", faster=faster, at=expected, random=random, limit=SPEED_LIMIT)


@case(
    "atc-6/displacement",
    title="Program displacement",
    purpose="A line is 40 mm higher while PDispSet is in force, and where it was after PDispOff.",
    requirement="A program displacement shifts positions until it is taken off.",
    limit_source="thesis 3.4.3.3: 5 mm",
    program="atc_6.mod",
    catches=("displacement-ignored", "target-offset"),
    typical_s=12.0,
)
def test_displacement(bench: Bench, check: Check) -> None:
    """Distance from the programmed line, shifted by the programmed displacement."""
    run = timed(bench.run(4, variables={"speed": "150"}, name="PDispSet"))
    _, there, _, back = run.moves("MoveL")
    for name, move, shift in (("displaced", there, DISPLACED), ("taken off", back, np.zeros(3))):
        start, end = (pose + shift for pose in (back.end[:3], back.start[:3]))
        path = run.during(move)
        across = line_deviation(path.position, start, end).across
        check_position(bench, check, f"distance from the line, {name}", path, across, LINE_LIMIT)


def _middles(run: TimedRun) -> FloatArray:
    """Gives when the lines of a run pass their middle, wherever in time that is: a wrong speed puts off all that follow."""
    moves = run.moves("MoveL")
    line = moves[0].end[:3] - moves[0].start[:3]
    length = float(np.linalg.norm(line))
    piece = run.tool.between(moves[0].begins - 0.3, run.tool.time[-1])
    middles = middle_passages(piece.time, (piece.position - moves[0].start[:3]) @ (line / length), length)[: len(moves)]
    if len(middles) < len(moves):
        raise RigError(f"the line was passed {len(middles)} times, expected {len(moves)}: is the tool on it?")
    return middles
