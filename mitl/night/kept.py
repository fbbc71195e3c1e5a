"""night.json, beside the run: what was planned, and what was left out and why. And the same in words."""

from __future__ import annotations

import json
from pathlib import Path

from mitl.errors import UsageError
from mitl.night.plan import Night, Offer
from mitl.recording.atomic import replacing

FILE_NAME = "night.json"


def as_json(night: Night) -> dict[str, object]:
    """Gives the plan as JSON values; times in s of the rig's time."""
    return {
        "budget_s": night.budget,
        "before_s": night.before,
        "planned_s": round(night.seconds, 3),
        "chosen": [_offer(offer) for offer in night.chosen],
        "left_out": [_offer(offer) for offer in night.left_out],
        "found": {fault: round(share, 4) for fault, share in night.found.items()},
    }


def write_night(folder: Path, night: Night) -> None:
    """Writes the plan into the run's folder. Raises UsageError where it cannot be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with replacing(folder / FILE_NAME) as beside:
            beside.write_text(json.dumps(as_json(night), indent=2) + "\n", encoding="utf-8")
    except OSError as error:
        raise UsageError(f"{folder / FILE_NAME}: cannot be written: {error.strerror or error}") from error


def in_words(night: Night) -> str:
    """Gives the plan in lines: what fits, what was left out, which faults nothing that was chosen would find."""
    total = len(night.chosen) + len(night.left_out)
    lines = [
        f"{len(night.chosen)} of {total} cases in {_time(night.seconds)} of {_time(night.budget)}, "
        f"{_time(night.before)} of it for the calibration:",
        *(f"  {offer.case:<32} {_time(offer.seconds):>9}{_last(offer)}" for offer in night.chosen),
    ]
    if night.left_out:
        lines += ["left out:", *(f"  {offer.case:<32} {_time(offer.seconds):>9}{_last(offer)}" for offer in night.left_out)]
    missed = [fault for fault, share in night.found.items() if share < 0.5]  # more likely missed than found
    if missed:
        lines.append(f"faults that these cases would rather miss: {', '.join(missed)}")
    return "\n".join(lines)


def _offer(offer: Offer) -> dict[str, object]:
    last = offer.last.value if offer.last else None
    return {"case": offer.case, "seconds": round(offer.seconds, 3), "urgency": round(offer.urgency, 4), "last": last}


def _last(offer: Offer) -> str:
    return f"  {offer.last.value} the last time" if offer.last is not None and offer.last.value != "pass" else ""


def _time(seconds: float) -> str:
    return f"{seconds / 60.0:.1f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"
