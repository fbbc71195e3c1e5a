"""Which runs a campaign consists of.

Invariant: a trial's key says all that its result depends on, so that a finished one need never be run again.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Trial:
    """One run: a rig, a seed, a fault (NAME=SIZE) or none, and the cases that are run with it."""

    rig: str
    seed: int
    fault: str | None
    cases: tuple[str, ...]

    @property
    def key(self) -> str:
        """Gives the trial in one line."""
        return f"{self.rig} {self.seed} {self.fault or '-'} {','.join(self.cases)}"


def planned(
    catches: Mapping[str, Sequence[str]], sizes: Mapping[str, Sequence[float]], *, rig: str, seeds: Iterable[int], sound: bool
) -> list[Trial]:
    """Gives the trials: every fault at every size with the cases that name it, and all cases on a sound controller, for every seed.

    catches: case id to the faults that it names. sizes: fault to its sizes. In the order of seeds, so that an interrupted campaign has a
    bit of everything. Faults that no case names make no trial.
    """
    trials = []
    for seed in seeds:
        if sound:
            trials.append(Trial(rig, seed, None, tuple(catches)))
        for fault, wanted in sizes.items():
            cases = tuple(case for case, faults in catches.items() if fault in faults)
            if cases:
                trials += [Trial(rig, seed, f"{fault}={size:g}", cases) for size in wanted]
    return trials
