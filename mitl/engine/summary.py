"""summary.txt: what is read first in the morning. Kept complete after every case, so that it is there however the night ended."""

from __future__ import annotations

from mitl.engine.record import CaseRecord, RunRecord
from mitl.engine.wording import reason
from mitl.outcome import Outcome

FILE_NAME = "summary.txt"
_ORDER = (Outcome.ERROR, Outcome.FAIL, Outcome.INCONCLUSIVE, Outcome.SKIPPED)


def text_of(run: RunRecord) -> str:
    """Gives the summary: the outcome in a line, then what was not passed and why, then the warnings of what was."""
    counts = ", ".join(f"{number} {one.value}" for one in Outcome if (number := sum(case.outcome is one for case in run.cases)))
    lines = [
        f"{run.outcome.value.upper()}: {counts or 'no cases'}",
        f"rig {run.rig or 'unknown'}, seed {run.seed}, began {run.started}, ran {_hours(run.wall_s)}",
    ]
    if run.faults:
        lines.append(f"faults injected: {' '.join(run.faults)}")
    if run.interrupted:
        lines.append("NOT COMPLETE: go on with the same command and --resume")
    for outcome in _ORDER:
        cases = [case for case in run.cases if case.outcome is outcome]
        if cases:
            lines += ["", f"{outcome.value}:", *(f"  {case.id}: {_one_line(reason(case))}" for case in cases)]
    warned = [(case, text) for case in run.cases for text in _warnings(case)]
    if warned:
        lines += ["", "warnings:", *(f"  {case.id}: {_one_line(text)}" for case, text in warned)]
    return "\n".join(lines) + "\n"


def _warnings(case: CaseRecord) -> list[str]:
    return list(dict.fromkeys(message.text for message in case.messages if message.level == "warning"))


def _one_line(text: str) -> str:
    return " ".join(text.split())


def _hours(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {rest} s"
