"""The test engine: `@case` declares, `bench` moves and tracks, `check` judges, the run record keeps.

docs/event_order.md says what happens when.
"""

from mitl.engine.bench import Bench, StillPoint, TrackedRun
from mitl.engine.case import CaseInfo, case
from mitl.engine.check import Check

__all__ = ["Bench", "CaseInfo", "Check", "StillPoint", "TrackedRun", "case"]
