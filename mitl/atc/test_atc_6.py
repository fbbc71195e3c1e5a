"""ATC-6, stop, restart and waiting: what instructions and calls do to the time of the motion."""

from __future__ import annotations

import numpy as np

from mitl.atc.measuring import timed
from mitl.calibration.known_offset import refine_offset
from mitl.calibration.time_offset import TimeOffset
from mitl.engine import Bench, Check, case
from mitl.metrics.uncertainty import Budget, Term

WAIT_LIMIT = 25e-3
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
