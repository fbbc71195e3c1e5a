"""`mitl verify --budget`: chooses the cases of a night from what is known of them."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mitl.engine.case import CaseInfo
    from mitl.history.store import KeptCase
    from mitl.night.plan import Night

CALIBRATION_S = 300.0
"""Seconds of the rig's time that a run's own calibration takes (rig.load: when the simulated cases begin)."""


def planned_night(infos: Sequence[CaseInfo], budget: float, *, rig: str, store: Path | None, power: Path | None) -> Night:
    """Gives the night. budget: s. rig: as --rig has it. store: mitl history's file; one that is not there yet tells nothing.

    power: campaign.json of a campaign. Raises UsageError for a rig, store or file that cannot be read.
    """
    from mitl.night.known import offers, power_of  # noqa: PLC0415 - heavy imports only when the command runs
    from mitl.night.plan import plan  # noqa: PLC0415 - see above

    name, robot, calibrated = _rig(rig)
    kept = [case for case in _kept(store) if (case.run.rig, case.run.robot, case.run.faults) == (name, robot, ())]
    known = offers(infos, now=datetime.now(UTC), kept=kept, power=power_of(power) if power is not None else None)
    return plan(known, budget, before=0.0 if calibrated else CALIBRATION_S)


def _kept(store: Path | None) -> list[KeptCase]:
    from mitl.history.store import open_store  # noqa: PLC0415 - see above

    if store is None or not store.is_file():
        return []
    with open_store(store) as opened:
        return opened.cases()


def _rig(name_or_file: str) -> tuple[str, str, bool]:
    """Gives the rig's name and robot, and whether it has a stored calibration."""
    from mitl.rig.config import read_rig  # noqa: PLC0415 - see above
    from mitl.rig.physical_config import is_physical, read_physical  # noqa: PLC0415 - see above

    config = read_physical(Path(name_or_file)) if is_physical(name_or_file) else read_rig(name_or_file)
    return config.name, config.robot, bool(config.calibration)
