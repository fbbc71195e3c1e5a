"""Which runs a campaign consists of.

Invariant: a trial's key says all that its result depends on, so that a finished one need never be run again.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Trial:
    """One run: a rig, a seed, a fault (NAME=SIZE) or none, and the cases that are run with it, in their order.

    until_found: no case is run once one has failed.
    """

    rig: str
    seed: int
    fault: str | None
    cases: tuple[str, ...]
    until_found: bool = False

    @property
    def key(self) -> str:
        """Gives the trial in one line."""
        until = " until found" if self.until_found else ""
        return f"{self.rig} {self.seed} {self.fault or '-'} {','.join(self.cases)}{until}"


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


def quickest_first(trials: Iterable[Trial], typical_s: Mapping[str, float]) -> list[Trial]:
    """Gives the trials so that those with a fault run their cases from the quickest on, and no more once one has found it.

    typical_s: how long each case usually takes, in s. Whether at least one case fails is answered all the same.
    """
    return [
        trial if trial.fault is None else replace(trial, cases=tuple(sorted(trial.cases, key=typical_s.__getitem__)), until_found=True)
        for trial in trials
    ]
