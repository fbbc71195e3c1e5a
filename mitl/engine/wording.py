"""How checks and cases are put into words, the same in JUnit, on the terminal and in the report."""

from __future__ import annotations

from mitl.engine.reach import unseen
from mitl.engine.record import CaseRecord, CheckRecord
from mitl.outcome import Outcome


def sentence(check: CheckRecord) -> str:
    """Gives a check in one line."""
    value = "no number" if check.value is None else f"{check.value:.4g}"
    unit = f" {check.unit}" if check.unit else ""
    relation = "at least" if check.at_least else "limit"
    spread = "unknown" if check.uncertainty is None else f"{check.uncertainty:.2g}{unit}"
    kind = " (warning only)" if check.warning else ""
    beyond = f" ({-check.margin:.3g}{unit} beyond)" if check.margin is not None and check.margin < 0.0 else ""
    return f"{check.name}: {value}{unit}, {relation} {check.limit:.4g}{unit}{beyond}, u = {spread}: {check.outcome.value}{kind}"


def reason(case: CaseRecord) -> str:
    """Gives why a case is what it is, a line for each check or message that made it so; empty for PASS.

    Where the rig could not have told, also what it cannot see (`engine.reach`).
    """
    match case.outcome:
        case Outcome.PASS:
            return ""
        case Outcome.ERROR:
            return "\n".join(message.text for message in case.messages if message.level in {"error", "fatal"})
        case Outcome.SKIPPED:
            return "\n".join(message.text for message in case.messages)
        case Outcome.FAIL | Outcome.INCONCLUSIVE:
            lines = [sentence(check) for check in case.checks if check.outcome is case.outcome and not check.warning]
            blind = unseen(case) if case.outcome is Outcome.INCONCLUSIVE else ""
            return "\n".join([*lines, *([blind] if blind else [])])
