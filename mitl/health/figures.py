"""A figure of the health check: judged by its own limit, and by how much worse it is than in the baseline.

Invariant: the baseline is an earlier health record; its own uncertainty counts in the budget of the change.
"""

from __future__ import annotations

from dataclasses import dataclass

from mitl.engine import Check
from mitl.engine.check import PER_SI
from mitl.engine.health import CHANGE, HealthRecord
from mitl.metrics.uncertainty import Budget


@dataclass(frozen=True)
class Figures:
    """Takes the figures of one case. baseline: what the rig showed when it was known to be well, or None where there is none yet."""

    check: Check
    baseline: HealthRecord | None

    def judge(
        self,
        name: str,
        *,
        value: float,
        limit: float,
        unit: str,
        budget: Budget,
        change: float | None = None,
        at_least: bool = False,
        either_way: bool = False,
    ) -> None:
        """Judges a figure in `unit` by its limit, and by `change` how much worse than in the baseline it may be. budget: in SI.

        either_way: being smaller than in the baseline is as bad as being larger.
        """
        self.check(name, value=value, limit=limit, unit=unit, budget=budget, at_least=at_least)
        if self.baseline is None or change is None:
            return
        then = self.baseline.figure(name)
        if then is None or then.value is None or then.uncertainty is None:
            self.check.message("warning", f"{name}: the baseline of {self.baseline.date} has no such figure; set a new one")
            return
        worse = then.value - value if at_least else value - then.value
        self.check(
            f"{name}{CHANGE}",
            value=worse if either_way else max(worse, 0.0),
            limit=change,
            unit=unit,
            budget=budget.with_term("baseline", then.uncertainty / PER_SI[unit], f"the figure of {self.baseline.date}"),
        )
