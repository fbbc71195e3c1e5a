"""ATC-6, stop, restart and waiting: what instructions and calls do to the time of the motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mitl.atc.measuring import timed
from mitl.atc.verdicts import check_position
from mitl.calibration.known_offset import refine_offset
from mitl.calibration.time_offset import TimeOffset
from mitl.engine import Bench, Check, case
from mitl.engine.bench import StoppedRun
from mitl.errors import RigError
from mitl.metrics.line import line_deviation
from mitl.metrics.stillness import overrun, standstill_after
from mitl.metrics.uncertainty import Budget, Term
from mitl.protocols import ProgrammedMove

WAIT_LIMIT = 25e-3
STOP_LIMIT = 0.2
OVERRUN_LIMIT = 70e-3
"""Seconds at its former speed that the tool may go on after a stop was called. ASSUMPTION A-335: our model of the arm takes 56 to 60 ms."""
STOPS = 10
PATH_LIMIT = 5e-3
RESTARTS = 3
_NOISE = 4e-3
"""Standard uncertainty in s of a moment of standstill: the noise of two positions over a deceleration of 15 m/s^2, and one sample."""
_OVERRUN_NOISE = 2.5e-3
"""Standard uncertainty in s of an overrun at 200 mm/s: .4 mm of noise of two averaged positions, and the moment of the call."""
_INSIDE = 35e-3
"""Meters from either end of a line within which a stop tells no overrun: the tool turns round there anyway."""
_FEWEST = 4
"""Stops of which the second shortest overrun is judged; further ones are made until there are so many well within a line."""
_WAITS = (0.3, 1.0, 2.0)
_MARGIN = 0.12
"""Seconds of rest on either side of a motion that help to tell when it was."""


@case(
    "atc-6/wait-time",
    title="WaitTime",
    purpose="Waits of .3, 1 and 2 s between motions last as long as programmed.",
    requirement="WaitTime waits for the programmed time.",
    limit_source="ATC-7's 25 ms (facts/atc.md), ours",
    program="atc_6.mod",
    catches=("wait-time",),
    typical_s=15.0,
)
def test_wait_time(bench: Bench, check: Check) -> None:
    """How much later a motion comes after the wait than before it, both against the oracle."""
    run = timed(bench.run(1, variables={"speed": "200"}, name="waits"))
    reference = run.run.oracle.tcp
    times: list[TimeOffset] = []
    for move in run.moves("MoveL"):
        start, stop = move.begins - _MARGIN, move.ends + _MARGIN
        known = sum(offset.seconds for offset in times)
        times.append(refine_offset(reference.between(start, stop), run.tool.between(start - known, stop - known), known, within=0.8))
    for wait, before, after in zip(_WAITS, times, times[1:], strict=False):
        sigma = float(np.hypot(before.sigma, after.sigma))
        budget = Budget((Term("random", sigma, "when two motions were"), Term("oracle", bench.last_oracle.accuracy.time, "robot model")))
        longer = before.seconds - after.seconds
        check(f"wait of {wait:g} s, longer by", value=1e3 * longer, limit=1e3 * WAIT_LIMIT, unit="ms", budget=budget)


@case(
    "atc-6/stop",
    title="Stop",
    purpose="Ten times, 2 to 8 s into a motion at 200 mm/s, from the call of stop to standstill.",
    requirement="The tool stands still, under 2 mm in 25 ms, soon after stop was called.",
    limit_source="facts/atc.md: 200 ms; ours: an overrun of 70 ms, where the arm's model takes 57",
    program="atc_6.mod",
    catches=("stop-late",),
    typical_s=110.0,
)
def test_stop(bench: Bench, check: Check) -> None:
    """The longest of the ten; and the second shortest overrun, to which what a network takes for a call adds little."""
    moments = np.random.default_rng([bench.rig.seed, 6]).uniform(2.0, 8.0, 2 * STOPS)
    times, ways = [], []
    for number, after in enumerate(moments, start=1):
        run = bench.run_stopped(2, after=float(after), variables={"speed": "200"}, name=f"stop {number}")
        times.append(standstill_after(run.tool, run.called))
        if _within_a_line(bench.last_oracle.moves, run):
            ways.append(overrun(run.tool, run.called))
        if number >= STOPS and len(ways) >= _FEWEST:
            break
    else:
        raise RigError(f"only {len(ways)} of {len(moments)} stops were well within a line, too few to judge the overrun")
    check("longest time to standstill", value=1e3 * max(times), limit=1e3 * STOP_LIMIT, unit="ms", uncertainty=1e3 * _NOISE)
    check(
        "overrun, second shortest",
        value=1e3 * float(np.partition(ways, 1)[1]),
        limit=1e3 * OVERRUN_LIMIT,
        unit="ms",
        uncertainty=1e3 * _OVERRUN_NOISE,
    )
    check.message("info", f"standstill after {1e3 * float(np.mean(times)):.0f} ms on average, {1e3 * min(times):.0f} ms at least")


@case(
    "atc-6/restart",
    title="Restart",
    purpose="Three times a motion along a line is stopped and started again.",
    requirement="The motion continues on its path.",
    limit_source="thesis 3.4.3.3: 5 mm",
    program="atc_6.mod",
    catches=("resume-offset",),
    typical_s=40.0,
)
def test_restart(bench: Bench, check: Check) -> None:
    """The distance from the line after the restart, and the way that the tool has gone by then."""
    moments = np.random.default_rng([bench.rig.seed, 66]).uniform(2.0, 5.0, RESTARTS)
    for number, after in enumerate(moments, start=1):
        with check.subtest(f"restart {number}"):
            run = bench.run_stopped(2, after=float(after), variables={"speed": "200"}, name=f"restart {number}", resume_for=2.5)
            assert run.restarted is not None
            line = next(move for move in bench.last_oracle.moves if move.kind == "MoveL")
            path = run.tool.between(run.restarted + 0.3, run.restarted + 2.3)
            across = line_deviation(path.position, line.start[:3], line.end[:3])
            check_position(bench, check, "distance from the line", path, across.across, PATH_LIMIT)
            gone = float(np.ptp(across.along))
            noise = Budget((Term("random", 1e-3, "noise of two positions"),))
            check("way gone on", value=1e3 * gone, limit=150.0, unit="mm", at_least=True, budget=noise)


def _within_a_line(moves: Sequence[ProgrammedMove], run: StoppedRun) -> bool:
    """Gives whether stop was called while the tool was well within a line of the program."""
    at = run.tool.only_valid().between(run.called - 0.05, run.called)
    for line in (move for move in moves if move.kind == "MoveL" and len(at)):
        length = float(np.linalg.norm(line.end[:3] - line.start[:3]))
        deviation = line_deviation(at.position, line.start[:3], line.end[:3])
        near = np.linalg.norm(deviation.across, axis=1).max() < PATH_LIMIT
        if near and deviation.along.min() > _INSIDE and deviation.along.max() < length - _INSIDE:
            return True
    return False
