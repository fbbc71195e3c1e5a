"""Prints how a campaign grows faster with a second worker, and that both campaigns give the same outcomes.

Run: python benchmarks/campaign_scaling.py [SEEDS]. Times are those of the clock, start of the workers included: on a machine that does
something else, or that has one core, the ratio tells of that and not of the campaign.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from pathlib import Path

from mitl.campaign.execute import execute
from mitl.campaign.plan import Trial

CASES = ("atc-1/direction", "atc-2/line-speed", "atc-6/stop", "atc-7/place")


def campaign(seeds: int, workers: int) -> tuple[float, dict[str, dict[str, str]]]:
    """Gives the seconds that one sound trial of every case and seed takes, and the outcomes by trial."""
    trials = [Trial("sim", seed, None, (case,)) for seed in range(1, seeds + 1) for case in CASES]
    with tempfile.TemporaryDirectory() as folder:
        begin = time.monotonic()
        results = execute(trials, Path(folder), workers=workers)
        spent = time.monotonic() - begin
    return spent, {key: result.outcomes for key, result in results.items()}


def main() -> int:
    """Prints both times and their ratio; gives 1 where the outcomes differ."""
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 15
    load = os.getloadavg()[0]
    alone, outcomes = campaign(seeds, 1)
    both, again = campaign(seeds, 2)
    print(f"trials:      {len(outcomes)}; cores: {os.cpu_count()}; load before: {load:.1f}")  # noqa: T201 - a benchmark prints
    print(f"one worker:  {alone:.1f} s")  # noqa: T201
    print(f"two workers: {both:.1f} s, {alone / both:.2f} times as fast (asked for: 1.8)")  # noqa: T201
    print("outcomes:    the same" if outcomes == again else "outcomes:    DIFFERENT")  # noqa: T201
    return int(outcomes != again)


if __name__ == "__main__":
    sys.exit(main())
