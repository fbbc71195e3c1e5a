"""A campaign's summary as files: CSV, JSON, a page in Markdown and a picture.

Invariant: all are functions of the finished trials; nothing else is told.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from mitl.campaign.summary import Detection, FalseAlarm, Rate, smallest_found
from mitl.recording.atomic import replacing


def write_tables(folder: Path, found: Sequence[Detection], alarms: Sequence[FalseAlarm], units: Mapping[str, str]) -> list[Path]:
    """Writes campaign.csv, campaign.json, detection_power.md and detection_power.png; gives their paths. units: by fault."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / name for name in ("campaign.csv", "campaign.json", "detection_power.md", "detection_power.png")]
    with replacing(paths[0]) as beside, beside.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(("kind", "fault", "size", "unit", "case", "hits", "count", "rate", "low", "high"))
        for one in found:
            rows.writerow(("detection", one.fault, one.size, units.get(one.fault, ""), one.case or "any", *_numbers(one.rate)))
        for alarm in alarms:
            rows.writerow(("false alarm", "", "", "", alarm.case, *_numbers(alarm.rate)))
            rows.writerow(("inconclusive", "", "", "", alarm.case, *_numbers(alarm.open)))
    with replacing(paths[1]) as beside:
        beside.write_text(json.dumps(as_json(found, alarms, units), indent=2) + "\n", encoding="utf-8")
    with replacing(paths[2]) as beside:
        beside.write_text(page(found, alarms, units), encoding="utf-8")
    with replacing(paths[3]) as beside:
        _picture(beside, found, units)
    return paths


def as_json(found: Sequence[Detection], alarms: Sequence[FalseAlarm], units: Mapping[str, str]) -> dict[str, object]:
    """Gives the summary as JSON values."""
    return {
        "detections": [
            {"fault": one.fault, "size": one.size, "unit": units.get(one.fault, ""), "case": one.case, **_rate(one.rate)} for one in found
        ],
        "false_alarms": [{"case": alarm.case, **_rate(alarm.rate), "inconclusive": _rate(alarm.open)} for alarm in alarms],
        "smallest_found": smallest_found(found),
    }


def page(found: Sequence[Detection], alarms: Sequence[FalseAlarm], units: Mapping[str, str]) -> str:
    """Gives the page for docs/."""
    lines = [
        "# Detection power",
        "",
        "Made by `mitl campaign` from seeded runs of the simulated rig. Rates with two-sided 95 % bounds after Clopper and Pearson.",
        "A case that is ERROR counts as not detected, and as a false alarm. With `--until-found` cases ran from the quickest on, and no",
        "more once one had failed: then a case that is not listed was not needed, and only the rate of **any** is of all runs.",
        "",
        "## Smallest fault found in at least 95 % of the runs",
        "",
        "Of the sizes that were run; what lies between two of them was not tried.",
        "",
        "| Fault | Size | Unit |",
        "|---|---|---|",
        *(
            f"| {fault} | {'none of these' if size is None else f'{size:g}'} | {units.get(fault, '')} |"
            for fault, size in smallest_found(found).items()
        ),
        "",
        "## Rate of detection",
        "",
        "| Fault | Size | Unit | Case | Found |",
        "|---|---|---|---|---|",
        *(f"| {one.fault} | {one.size:g} | {units.get(one.fault, '')} | {one.case or '**any**'} | {_words(one.rate)} |" for one in found),
        "",
        *_of_sound(alarms),
        "![rate of detection against size](images/detection_power.png)",
        "",
    ]
    return "\n".join(lines)


def _of_sound(alarms: Sequence[FalseAlarm]) -> list[str]:
    if not alarms:
        return ["The sound controller was not run: nothing is told of false alarms here.", ""]
    rows = [f"| {alarm.case} | {_words(alarm.rate)} | {_words(alarm.open)} |" for alarm in alarms]
    return ["## Sound controller", "", "| Case | False alarms | Inconclusive |", "|---|---|---|", *rows, ""]


def _picture(path: Path, found: Sequence[Detection], units: Mapping[str, str]) -> None:
    import matplotlib.pyplot as plt  # noqa: PLC0415 - heavy

    faults = list(dict.fromkeys(one.fault for one in found))
    columns = 4
    rows = max(1, -(-len(faults) // columns))
    figure, axes = plt.subplots(rows, columns, figsize=(12, 2.2 * rows), sharey=True, squeeze=False)
    for place, axis in enumerate(axes.flat):
        if place >= len(faults):
            axis.set_visible(False)
            continue
        fault = faults[place]
        points = sorted((abs(one.size), one.rate) for one in found if one.fault == fault and one.case is None)
        sizes = [size for size, _ in points]
        rates = [rate for _, rate in points]
        below = [max(rate.value - rate.low, 0.0) for rate in rates]
        above = [max(rate.high - rate.value, 0.0) for rate in rates]
        axis.errorbar(sizes, [rate.value for rate in rates], yerr=[below, above], marker="o", markersize=3, capsize=2, linewidth=1)
        axis.axhline(0.95, color="0.7", linewidth=0.8)
        axis.set_title(fault, fontsize=8)
        axis.set_xlabel(units.get(fault, ""), fontsize=7)
        axis.set_ylim(-0.05, 1.05)
        axis.tick_params(labelsize=7)
    figure.tight_layout()
    figure.savefig(path, format="png", dpi=110)
    plt.close(figure)


def _words(rate: Rate) -> str:
    return f"{rate.hits} of {rate.count}, {100 * rate.value:.1f} % ({100 * rate.low:.1f} to {100 * rate.high:.1f})"


def _numbers(rate: Rate) -> tuple[int, int, float, float, float]:
    return rate.hits, rate.count, rate.value, rate.low, rate.high


def _rate(rate: Rate) -> dict[str, float]:
    return {"hits": rate.hits, "count": rate.count, "rate": rate.value, "low": rate.low, "high": rate.high}
