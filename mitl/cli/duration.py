"""Durations as people write them: 45min, 8h, 1h30min, 90s."""

from __future__ import annotations

import re

import click

_FORM = re.compile(r"(?:(\d+(?:\.\d+)?)\s*h)?\s*(?:(\d+(?:\.\d+)?)\s*min)?\s*(?:(\d+(?:\.\d+)?)\s*s)?", re.IGNORECASE)


def duration(_context: click.Context, _parameter: click.Parameter, value: str | None) -> float | None:
    """Gives an option's value in s; a callback of click. Raises BadParameter for what is no time above 0."""
    if value is None:
        return None
    match = _FORM.fullmatch(value.strip())
    seconds = sum(float(part or 0.0) * size for part, size in zip(match.groups(), (3600.0, 60.0, 1.0), strict=True)) if match else 0.0
    if seconds <= 0.0:
        raise click.BadParameter(f"expected a time such as 45min, 8h, 1h30min or 90s, found {value!r}")
    return seconds
