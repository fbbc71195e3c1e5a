"""The uncertainty budget of a measurement: named terms, combined by root sum of squares, each kept for the report."""

from __future__ import annotations

from dataclasses import dataclass
from math import expm1, sqrt


@dataclass(frozen=True)
class Term:
    """One term: its name, standard uncertainty (1 sigma) in the unit of the value, and where it comes from."""

    name: str
    value: float
    source: str = ""


@dataclass(frozen=True)
class Budget:
    """Terms of one standard uncertainty. Terms are independent; a correlated pair must enter as one term.

    Raises ValueError for a negative term or two terms of one name.
    """

    terms: tuple[Term, ...] = ()

    def __post_init__(self) -> None:
        names = [term.name for term in self.terms]
        if len(set(names)) != len(names):
            raise ValueError(f"expected every term once, got {', '.join(names)}")
        for term in self.terms:
            if not term.value >= 0.0:
                raise ValueError(f"the term {term.name!r} must not be negative, got {term.value}")

    @property
    def combined(self) -> float:
        """Gives the standard uncertainty of the value: root sum of squares of the terms."""
        return sqrt(sum(term.value**2 for term in self.terms))

    def with_term(self, name: str, value: float, source: str = "") -> Budget:
        """Gives the budget with one more term."""
        return Budget((*self.terms, Term(name, value, source)))

    def repeated(self, count: int) -> Budget:
        """Gives the budget of the mean of `count` repeats: only the random term falls, as 1 / sqrt(count)."""
        if count < 1:
            raise ValueError(f"expected at least one measurement, got {count}")
        return Budget(tuple(Term(t.name, t.value / sqrt(count), t.source) if t.name == "random" else t for t in self.terms))

    def explained(self, unit: str = "m", factor: float = 1.0) -> str:
        """Gives one line for the report, values times `factor` in `unit`: `0.31 mm = random 0.20, registration 0.24`."""
        parts = ", ".join(f"{term.name} {term.value * factor:.3g}" for term in self.terms if term.value > 0.0)
        return f"{self.combined * factor:.3g} {unit}" + (f" = {parts}" if parts else "")


def position_budget(
    *,
    random: float,
    registration: float,
    scale: float = 0.0,
    length: float = 0.0,
    field: float = 0.0,
    drift: float = 0.0,
    speed: float = 0.0,
    time_sigma: float = 0.0,
) -> Budget:
    """Gives the budget of a position or distance in m: u^2 = random + registration + (scale L) + field + drift + (v sigma_t).

    random: noise of the value itself, see `metrics.deviation.largest_deviation`. registration: `Calibration.position_uncertainty`.
    scale: relative uncertainty of the tracker's scale, over `length` m (only where registration does not contain it already).
    field: unmodelled distortion of the volume. drift: since calibration. speed: m/s, times time_sigma: s, of the time offset (only
    for deviations at the same time). Source: facts/tracker.md, "What the bench can and cannot judge".
    """
    return Budget(
        (
            Term("random", random, "noise of the recording"),
            Term("registration", registration, "calibration"),
            Term("scale", scale * length, f"{scale:.2g} of {length:.3g} m"),
            Term("field", field, "unmodelled distortion of the tracked volume"),
            Term("drift", drift, "tracker drift since calibration"),
            Term("timing", speed * time_sigma, f"{speed:.3g} m/s times {time_sigma * 1e3:.2g} ms"),
        )
    )


DRIFT_SD, DRIFT_TAU = 0.84e-3, 1200.0
"""The tracker's drift on its worst axis, m, and its correlation time, s (facts/tracker.md, preset thesis, after the thesis's table 4.3)."""


def drift_sigma(sd: float, tau: float, elapsed: float) -> float:
    """Gives what a drift adds in the time since calibration: standard deviation of its change, in the unit of `sd`.

    sd, tau (s): of the drift as an Ornstein-Uhlenbeck process (facts/tracker.md: .36 / .84 / .71 mm, 20 min). elapsed: s.
    """
    return sd * sqrt(-2.0 * expm1(-abs(elapsed) / tau))


def point_budget(*, jitter: float, registration: float, field: float = 0.0, drift: float = 0.0) -> Budget:
    """Gives the budget of a still, averaged point in m from its observed jitter (diameter of the cloud).

    ASSUMPTION A-66: the mean of a window is as uncertain, per axis, as a fifth of its jitter diameter. Slow noise does not average
    out within the window: facts/tracker.md's lighthouse2 fit has .18 mm for means and 1.28 mm of jitter over 500 ms, a seventh.
    """
    return position_budget(random=jitter / 5.0, registration=registration, field=field, drift=drift)
