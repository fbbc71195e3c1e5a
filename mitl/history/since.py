"""Since when the cases of a run are bad, out of the store."""

from __future__ import annotations

from mitl.history.store import KeptRun, Store, comparable
from mitl.outcome import Outcome
from mitl.report.since import Since


def since_of(store: Store, run: KeptRun) -> dict[str, Since]:
    """Gives for every case of a run that is not PASS since when it is so, by the comparable runs up to this one."""
    order = {kept.id: number for number, kept in enumerate(store.runs())}
    rows: dict[str, list[tuple[KeptRun, Outcome]]] = {}
    for case in store.cases():
        if comparable(case.run, run) and order[case.run.id] <= order[run.id] and case.outcome is not Outcome.SKIPPED:
            rows.setdefault(case.id, []).append((case.run, case.outcome))
    found = {}
    for case_id, row in rows.items():
        if row[-1][0].id != run.id or row[-1][1] is Outcome.PASS:
            continue
        bad = 0
        while bad < len(row) and row[-1 - bad][1] is not Outcome.PASS:
            bad += 1
        found[case_id] = Since(row[-bad][0].started, bad, len(row) - 1)
    return found
