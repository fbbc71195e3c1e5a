"""What `mitl verify` prints: the list of cases, and the table of a run."""

from __future__ import annotations

import json
from collections.abc import Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from mitl.engine.case import CaseInfo
from mitl.engine.record import CaseRecord, RunRecord
from mitl.engine.wording import reason
from mitl.outcome import Outcome

_STYLE = {
    Outcome.PASS: "green",
    Outcome.FAIL: "bold red",
    Outcome.INCONCLUSIVE: "yellow",
    Outcome.ERROR: "magenta",
    Outcome.SKIPPED: "dim",
}
_PIPE_WIDTH = 160
"""Columns where the output is no terminal."""


def listed(cases: Sequence[CaseInfo], form: str) -> str:
    """Gives the list of cases: id, title, usual time at the rig, faults that it must catch."""
    if form == "json":
        keys = ("id", "title", "purpose", "requirement", "limit_source", "typical_s")
        return json.dumps([{**{key: getattr(info, key) for key in keys}, "catches": list(info.catches)} for info in cases], indent=2)
    if form == "markdown":
        return _page(cases)
    width = max((len(info.id) for info in cases), default=0)
    titles = max((len(info.title) for info in cases), default=0)
    return "\n".join(
        f"{info.id:<{width}}  {info.title:<{titles}}  {info.typical_s:>5.0f} s  {', '.join(info.catches)}".rstrip() for info in cases
    )


def _page(cases: Sequence[CaseInfo]) -> str:
    """Gives docs/test_cases.md: a table, then each case with what it says about itself."""
    rows = [
        f"| [{info.id}](#{info.id.replace('/', '')}) | {info.title} | {info.typical_s:.0f} s | {', '.join(info.catches)} |"
        for info in cases
    ]
    parts = [
        "# Test cases",
        "Made by `mitl verify --list --format markdown` from the cases themselves; a test compares. Times are those at a rig. "
        "A fault is what must make the case FAIL (`mitl faults`).",
        "\n".join(["| Case | Title | Takes | Must catch |", "|---|---|---|---|", *rows]),
    ]
    for info in cases:
        program = f" Program: `mitl/atc/{info.program.name}`." if info.program is not None else ""
        hours = " It takes hours, and is run only where it is asked for by its id or with `--long`." if info.long else ""
        parts += [
            f"## {info.id}",
            f"**{info.title}.** {info.purpose}{hours}",
            f"- Requirement: {info.requirement}\n- Limit: {info.limit_source}.{program}",
        ]
    return "\n\n".join(parts)


def print_table(run: RunRecord, console: Console | None = None) -> None:
    """Prints the cases of a run with what is worth knowing of each, and the outcome of the whole."""
    console = console or Console(highlight=False, markup=False)
    if not console.is_terminal:
        console.width = _PIPE_WIDTH
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in ("outcome", "case", "checks", "what"):
        table.add_column(name, justify="right" if name == "checks" else "left", overflow="fold")
    for case in run.cases:
        table.add_row(Text(case.outcome.value, _STYLE[case.outcome]), Text(case.id), str(len(case.checks)), Text(_what(case)))
    console.print(table)
    counts = ", ".join(f"{number} {outcome.value}" for outcome in Outcome if (number := sum(case.outcome is outcome for case in run.cases)))
    console.print(
        Text.assemble("\n", (run.outcome.value, _STYLE[run.outcome]), f": {counts or 'no cases'}; rig {run.rig}, seed {run.seed}")
    )
    if run.interrupted:
        console.print("interrupted: the run ended before all cases were run")


def _what(case: CaseRecord) -> str:
    """Gives why a case is not PASS, or else the check that came nearest to its limit."""
    if case.outcome is not Outcome.PASS:
        return reason(case)
    near = [
        (abs(check.value) / check.limit, check)
        for check in case.checks
        if check.value is not None and check.limit > 0.0 and not (check.at_least or check.warning)
    ]
    if not near:
        return case.title
    share, check = max(near, key=lambda pair: pair[0])
    return f"{check.name}: {check.value:.3g} of {check.limit:.3g} {check.unit}".strip() + f" ({100.0 * share:.0f} %)"
