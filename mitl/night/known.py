"""What is known of the cases before a night: how long each takes, what it finds, and how it went the last times.

Invariant: what was measured at this rig goes before what the cases say of themselves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import datetime
from pathlib import Path
from statistics import fmean

from mitl.engine.case import CaseInfo
from mitl.engine.json_value import read_json
from mitl.history.store import KeptCase
from mitl.night.plan import TO_LOOK_AT, Offer
from mitl.outcome import Outcome

NAMED = 0.95
"""ASSUMPTION A-337: probability that a case finds a fault that it names and for which nothing was measured, as a campaign asks of it."""
_RECENT = 5
"""Runs of a case, the latest, whose mean duration counts."""
FAILED, NEW, WEEK_OLD, SHARE = 3.0, 0.5, 0.5, 0.02
"""What a case is worth beside what it finds, in faults found: it failed, or could not be judged, the last time; it has never run here; its
last run is a week old (less in proportion); and for running at all, so that time that is left is used.

ASSUMPTION A-338: a case that failed is worth three faults, because the morning's first question is whether it still does.
"""


def offers(
    infos: Sequence[CaseInfo],
    *,
    now: datetime,
    kept: Sequence[KeptCase] = (),
    power: Mapping[tuple[str, str], float] | None = None,
) -> list[Offer]:
    """Gives what every case costs and is worth.

    kept: the cases of earlier runs of this rig and robot, oldest first. power: (case, fault) to the probability that the one finds the
    other, from `power_of`. now: with time zone.
    """
    made = []
    for info in infos:
        past = [case for case in kept if case.id == info.id and case.outcome is not Outcome.SKIPPED]
        took = [case.duration_s for case in past[-_RECENT:] if case.duration_s > 0.0]
        measured = {fault: rate for (case, fault), rate in (power or {}).items() if case == info.id}
        finds = {**dict.fromkeys(info.catches, NAMED), **measured}
        last = past[-1].outcome if past else None
        made.append(Offer(info.id, fmean(took) if took else info.typical_s, finds, _urgency(past, now), last))
    return made


def power_of(file: Path) -> dict[tuple[str, str], float]:
    """Gives the rates of detection in a campaign's campaign.json, of the largest size that was run. Raises UsageError for another file."""
    found: dict[tuple[str, str], tuple[float, float]] = {}
    for one in read_json(file, "expected the campaign.json of mitl campaign").at("detections").items():
        case = one.at("case").text_or_none()
        if case is None:
            continue
        key, size = (case, one.at("fault").text()), abs(one.at("size").number())
        if key not in found or size >= found[key][0]:
            found[key] = (size, one.at("rate").number())
    return {key: rate for key, (_, rate) in found.items()}


def _urgency(past: Sequence[KeptCase], now: datetime) -> float:
    if not past:
        return SHARE + NEW
    days = (now - datetime.fromisoformat(past[-1].run.started)).total_seconds() / 86400.0
    bad = FAILED if past[-1].outcome in TO_LOOK_AT else 0.0
    return SHARE + bad + WEEK_OLD * min(max(days / 7.0, 0.0), 1.0)
