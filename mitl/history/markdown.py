"""Summaries as Markdown, ready for a comment on a pull request. Invariant: text from outside is escaped and mentions nobody."""

from __future__ import annotations

import re

from mitl.engine.record import CheckRecord, RunRecord
from mitl.history.difference import Difference
from mitl.history.gates import GateResult
from mitl.outcome import Outcome
from mitl.report.since import Since

SIGN = {Outcome.PASS: "✅", Outcome.FAIL: "❌", Outcome.INCONCLUSIVE: "❔", Outcome.ERROR: "⚠️", Outcome.SKIPPED: "⏭️"}
_MOST_ROWS = 40
_MOST_TEXT = 200


def summary(run: RunRecord, since: dict[str, Since], gate: GateResult | None = None) -> str:
    """Gives a run in a few lines: what failed, by how much, since when, and what the gates say."""
    counts = ", ".join(f"{number} {o.value}" for o in Outcome if (number := sum(case.outcome is o for case in run.cases)))
    lines = [f"### {SIGN[run.outcome]} mitl: {counts or 'no cases'}", ""]
    lines.append(f"Rig {_text(run.rig)}, robot {_text(run.robot)}, seed {run.seed}" + _faults(run) + ".")
    if run.interrupted:
        lines.append("**Interrupted:** the run judged only a part of its cases.")
    excused = {} if gate is None else {case.id: known for case, known in gate.expected}
    bad = [case for case in run.cases if case.outcome not in {Outcome.PASS, Outcome.SKIPPED}]
    if bad:
        lines += ["", "| | Case | What | Since |", "|---|---|---|---|"]
        for case in bad[:_MOST_ROWS]:
            found = [check for check in case.checks if check.outcome is case.outcome and not check.warning]
            said = [message.text for message in case.messages if message.level in {"error", "fatal"}]
            what = "<br>".join([_check(check) for check in found[:3]] or [_text(text) for text in said[:2]])
            known = f" *(expected: {_text(excused[case.id].reason)})*" if case.id in excused else ""
            when = since[case.id].words if case.id in since else ""
            lines.append(f"| {SIGN[case.outcome]} | {_text(case.id)} | {what}{known} | {when} |")
        if len(bad) > _MOST_ROWS:
            lines.append(f"\nand {len(bad) - _MOST_ROWS} more")
    if gate is not None:
        lines += ["", "**Gates: open**" if gate.open else "**Gates: closed**"]
        lines += [f"- {_text(reason)}" for reason in gate.broken]
        lines += [f"- fixed, to be taken out of the known issues: {_text(known.case)}" for known in gate.fixed]
    return "\n".join(lines) + "\n"


def difference(found: Difference, names: tuple[str, str]) -> str:
    """Gives the difference of two runs."""
    lines = [f"### mitl: {_text(names[0])} → {_text(names[1])}", ""]
    if found.settings:
        lines += ["| | before | after |", "|---|---|---|", *(f"| {_text(n)} | {_text(a)} | {_text(b)} |" for n, a, b in found.settings), ""]
    if found.cases:
        lines += ["| Case | before | after |", "|---|---|---|"]
        lines += [f"| {_text(c.id)} | {_outcome(c.before)} | {_outcome(c.after)} |" for c in found.cases[:_MOST_ROWS]]
    else:
        lines.append("No case changed its outcome.")
    if found.checks:
        lines += ["", "| Check | before | after | moved | |", "|---|--:|--:|--:|---|"]
        for change in found.checks[:_MOST_ROWS]:
            unit = _text(change.after.unit)
            row = f"| {_text(change.case_id)}: {_text(change.after.name)} | {change.before.value:.4g} | {change.after.value:.4g} {unit} "
            lines.append(row + f"| {change.moved:+.3g} ({change.sigmas:+.1f} σ) | {_outcome(change.after.outcome)} |")
    else:
        lines.append("No value moved by more than its uncertainty explains.")
    return "\n".join(lines) + "\n"


def _check(check: CheckRecord) -> str:
    value = "no number" if check.value is None else f"**{check.value:.4g}** {_text(check.unit)}".strip()
    spread = "unknown" if check.uncertainty is None else f"{check.uncertainty:.2g}"
    return f"{_text(check.name)}: {value}, {'at least' if check.at_least else 'limit'} {check.limit:.4g}, u = {spread}"


def _faults(run: RunRecord) -> str:
    return f", injected: {_text(' '.join(run.faults))}" if run.faults else ""


def _outcome(outcome: Outcome | None) -> str:
    return "—" if outcome is None else f"{SIGN[outcome]} {outcome.value}"


def _text(text: str) -> str:
    """Gives text that Markdown leaves as it is, in one line; an @ is followed by nothing visible, so that it mentions nobody."""
    short = " ".join(text.split())
    short = short if len(short) <= _MOST_TEXT else short[: _MOST_TEXT - 1] + "…"
    escaped = re.sub(r"([\\`*_{}\[\]()#+!|~])", r"\\\1", short.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;"))
    return escaped.replace("@", "@\u200b").replace("://", ":\u200b//")
