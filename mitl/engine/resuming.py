"""Going on with a run that ended too early: which of its cases stay, and whether it is the same run at all.

Invariant: what was judged stays as it was judged; numbers of two rigs, seeds, faults or versions never stand in one run.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from mitl.engine.record import CaseRecord, RunRecord
from mitl.engine.results import FILE_NAME, read_run
from mitl.errors import UsageError
from mitl.outcome import Outcome

_JUDGED = (Outcome.PASS, Outcome.FAIL, Outcome.INCONCLUSIVE)


def earlier_run(folder: Path | None) -> RunRecord | None:
    """Gives the run in a folder, None where there is none yet. Raises UsageError without a folder, or for one that cannot be read."""
    if folder is None:
        raise UsageError("a run is resumed in its folder: name it (--out, --mitl-out)")
    return read_run(folder) if (folder / FILE_NAME).is_file() else None


def judged(run: RunRecord) -> tuple[CaseRecord, ...]:
    """Gives the cases that need not be run again: pass, fail and inconclusive. What was skipped or could not be judged is run."""
    return tuple(case for case in run.cases if case.outcome in _JUDGED)


def refuse_another(run: RunRecord, *, rig: str, seed: int, faults: tuple[str, ...], versions: Mapping[str, str]) -> None:
    """Raises UsageError where the run in the folder is another than the one that is to go on. rig: its name, "" where not known yet."""
    asked = {"seed": seed, "faults": " ".join(faults) or "none", **({"rig": rig} if rig else {})}
    found = {"seed": run.seed, "faults": " ".join(run.faults) or "none", "rig": run.rig}
    differ = [f"{what} {found[what]}, now {value}" for what, value in asked.items() if found[what] != value]
    # only packages that the former run knows: a run that never reached its rig knows less
    differ += [f"{name} {old}, now {versions[name]}" for name, old in run.versions.items() if name in versions and versions[name] != old]
    if differ:
        raise UsageError(f"the run in the folder is another one: {'; '.join(differ)}; give another folder")
