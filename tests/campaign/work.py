"""Trials that take no time; workers import them."""

import os
from pathlib import Path

from mitl.campaign.trial import TrialResult


def quick(trial):
    return TrialResult(trial.key, trial.seed, trial.fault, dict.fromkeys(trial.cases, "fail" if trial.fault else "pass"))


def deadly(trial):
    """The first to get here takes its worker with it."""
    mark = Path(trial.rig)
    if not mark.exists():
        mark.touch()
        os._exit(1)
    return quick(trial)
