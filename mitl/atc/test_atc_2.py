"""ATC-2, speed: along a straight line, through the zone of a corner, and along a path of lines and zones."""

from __future__ import annotations

import numpy as np

from mitl.atc.measuring import timed
from mitl.atc.verdicts import check_speed
from mitl.engine import Bench, Check, case
from mitl.metrics.speed import line_speed, speed_difference

SPEED_LIMIT = 5e-3
WINDOW = 0.4
"""Seconds about the middle of a line over which its mean speed is taken (facts/atc.md)."""
CUT = 0.4
"""Seconds cut off both ends of a path (facts/atc.md)."""
LONG, LONG_LIMIT, ENDS = 500, 2.5e-3, 0.3
"""Speed in mm/s that is judged over the whole line as well, but for so many s at its ends, by half of the thesis's limit."""
LINES = {5: 1, 50: 2, 100: 2, 250: 3, 500: 4, 800: 4, 1000: 4}
"""Programmed speeds in mm/s, and the subOption whose line is long enough for each."""
CORNERS = {1000: (1, 0.150), 800: (2, 0.080), 500: (3, 0.030), 200: (4, 0.005), 100: (5, 0.001), 50: (6, 0.0003)}
"""The thesis's table 3.1: programmed speeds in mm/s, subOption and zone in m."""
_AROUND = 0.4
"""Seconds before and after a zone whose noise is taken for the zone's."""
_SHORTEST = 0.03
"""Half the least time in s over which a speed through a zone is taken; a small zone is passed faster than a speed can be told."""


@case(
    "atc-2/line-speed",
    title="Speed on a straight line",
    purpose="The mean speed in the middle of a line is the programmed one, from 5 to 1000 mm/s.",
    requirement="Straight sections are passed at the programmed speed.",
    limit_source="thesis 3.4.4.1: 5 mm/s, 400 ms about the middle of the line; ours: 2.5 mm/s at 500 mm/s over the whole line",
    program="atc_2.mod",
    catches=("speed",),
    typical_s=90.0,
)
def test_line_speed(bench: Bench, check: Check) -> None:
    """Every line is passed four times, which tells how far a mean speed scatters: slow noise does not show within one recording."""
    passes = {}
    for speed, sub_option in LINES.items():
        run = timed(bench.run(1, sub_option, variables={"speed": str(speed)}, name=f"{speed} mm/s"))
        moves = run.moves("MoveL")
        middles = [(move.begins + move.ends) / 2 for move in moves]
        if speed == LONG:
            whole = np.array([line_speed(run.tool, move.begins + ENDS, move.ends - ENDS).value for move in moves])
        passes[speed] = np.array([line_speed(run.tool, middle - WINDOW / 2, middle + WINDOW / 2).value for middle in middles])
    pooled = float(np.sqrt(np.mean([np.var(found, ddof=1) for found in passes.values()])))
    for speed, found in passes.items():
        random = max(pooled, float(np.std(found, ddof=1))) / np.sqrt(len(found))
        faster = float(found.mean()) - 1e-3 * speed
        check_speed(bench, check, f"speed at {speed} mm/s", faster=faster, at=1e-3 * speed, random=random, limit=SPEED_LIMIT)
    check_speed(
        bench,
        check,
        f"speed at {LONG} mm/s over the whole line",
        faster=float(whole.mean()) - 1e-3 * LONG,
        at=1e-3 * LONG,
        random=float(np.std(whole, ddof=1)) / np.sqrt(len(whole)),
        limit=LONG_LIMIT,
    )


@case(
    "atc-2/zone-speed",
    title="Speed through the zone of a corner",
    purpose="A corner of 90 deg is passed at its speed, with the smallest zone that keeps it.",
    requirement="A zone that is large enough keeps the speed; the executed speed is the oracle's.",
    limit_source="thesis 3.4.4.2 and table 3.1: 5 mm/s",
    program="atc_2.mod",
    catches=("speed-dip", "zone-as-fine"),
    typical_s=40.0,
)
def test_zone_speed(bench: Bench, check: Check) -> None:
    """The thesis's tracker cannot tell: over the tens of ms that a zone lasts, its noise is worth more than the limit."""
    for speed, (sub_option, zone) in CORNERS.items():
        run = timed(bench.run(2, sub_option, variables={"speed": str(speed)}, name=f"{speed} mm/s"))
        corner = run.moves("MoveL")[0].ends
        half = max(zone / (1e-3 * speed), _SHORTEST)
        found = speed_difference(run.run.oracle.tcp, run.tool, corner - half, corner + half, around=_AROUND)
        check_speed(
            bench,
            check,
            f"speed through the zone at {speed} mm/s",
            faster=found.value,
            at=1e-3 * speed,
            random=found.random,
            limit=SPEED_LIMIT,
        )


@case(
    "atc-2/path-speed",
    title="Speed along a path",
    purpose="A rectangle with a different zone in each corner is passed at its speed.",
    requirement="The speed is kept through lines and zones.",
    limit_source="thesis 3.4.4.3: 5 mm/s, 400 ms cut off both ends",
    program="atc_2.mod",
    catches=("speed", "zone-as-fine"),
    typical_s=20.0,
)
def test_path_speed(bench: Bench, check: Check) -> None:
    """The mean speed against that of the oracle by the same estimator."""
    run = timed(bench.run(3, variables={"speed": "200"}, name="rectangle"))
    sides = run.moves("MoveL")
    start, stop = sides[0].begins + CUT, sides[-1].ends - CUT
    found = speed_difference(run.run.oracle.tcp, run.tool, start, stop, around=CUT)
    check_speed(
        bench, check, "mean speed along the rectangle", faster=found.value, at=sides[0].tcp_speed, random=found.random, limit=SPEED_LIMIT
    )
