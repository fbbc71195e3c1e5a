"""Plots as SVG text for the page. Colours are the page's CSS variables, so that one picture serves light and dark.

Invariant: no text from outside gets into a picture; names and units stand in the page around it, where they are escaped.
"""

from __future__ import annotations

import io
import re
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mitl.paths import FloatArray
from mitl.report.decimation import keep_extremes, with_gaps

_MOST_POINTS = 450
_COLOURS = {
    "ink": "#000101",
    "muted": "#000102",
    "grid": "#000103",
    "oracle": "#000104",
    "measured": "#000105",
    "limit": "#000106",
}
"""Colours by which matplotlib draws, replaced by var(--NAME) in the text."""

_AXES = "xyz"
_SETTINGS: dict[Any, Any] = {
    "svg.fonttype": "none",
    "text.parse_math": False,
    "font.family": "sans-serif",
    "font.size": 9,
    "axes.edgecolor": _COLOURS["muted"],
    "axes.labelcolor": _COLOURS["muted"],
    "axes.titlecolor": _COLOURS["ink"],
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.7,
    "xtick.color": _COLOURS["muted"],
    "ytick.color": _COLOURS["muted"],
    "axes.grid": True,
    "grid.color": _COLOURS["grid"],
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "path.simplify": False,
}


@dataclass(frozen=True)
class Limit:
    """A limit drawn in a deviation plot: its value and half the guard band's width; at_least says which side is good."""

    value: float
    guard: float
    at_least: bool = False


def path_plot(oracle: FloatArray | None, measured: FloatArray | None, *, salt: str) -> str:
    """Gives two planes of a path: oracle and measured positions, (N, 3) in mm. The planes are those in which most is to be seen."""
    given = [curve for curve in (oracle, measured) if curve is not None and len(curve)]
    extent = np.ptp(np.concatenate(given), axis=0)
    first, second, third = (int(axis) for axis in np.argsort(-extent, kind="stable"))
    planes = [tuple(sorted((first, second))), tuple(sorted((first, third)))]
    with mpl.rc_context({**_SETTINGS, "svg.hashsalt": salt}):
        figure = Figure(figsize=(8.4, 3.3))  # margins are given, because finding them takes longer than drawing
        figure.subplots_adjust(left=0.085, right=0.995, top=0.98, bottom=0.145, wspace=0.22)
        for axes, (across, up) in zip(figure.subplots(1, 2), planes, strict=True):
            for curve, colour, width in ((oracle, "oracle", 4.0), (measured, "measured", 1.2)):
                if curve is not None and len(curve):
                    points = curve[keep_extremes(curve, _MOST_POINTS)]
                    axes.plot(points[:, across], points[:, up], color=_COLOURS[colour], linewidth=width, solid_capstyle="round")
            start = given[0][0]
            axes.plot(start[across], start[up], marker="o", markersize=5, color=_COLOURS["ink"], fillstyle="none")
            axes.set_xlabel(f"{_AXES[across]} in mm")
            axes.set_ylabel(f"{_AXES[up]} in mm")
            _equal(axes)
        return _svg(figure)


def deviation_plot(time: FloatArray, value: FloatArray, limits: list[Limit], *, salt: str) -> str:
    """Gives values (N,) over time (N,) in s, with limits and their guard bands."""
    time, rows = with_gaps(time - time[0] if len(time) else time, value[:, None])
    chosen = keep_extremes(rows, _MOST_POINTS)
    signed = bool(np.nanmin(rows, initial=0.0) < 0.0)
    with mpl.rc_context({**_SETTINGS, "svg.hashsalt": salt}):
        figure = Figure(figsize=(5.2, 2.2))
        figure.subplots_adjust(left=0.085, right=0.97, top=0.96, bottom=0.21)
        axes = figure.subplots()
        axes.plot(time[chosen], rows[chosen, 0], color=_COLOURS["measured"], linewidth=1.0)
        for limit in limits:
            sides = (1.0, -1.0) if signed and not limit.at_least else (1.0,)
            for level in (side * limit.value for side in sides):
                if limit.guard > 0.0:
                    axes.axhspan(level - limit.guard, level + limit.guard, color=_COLOURS["limit"], alpha=0.14, linewidth=0.0)
                axes.axhline(level, color=_COLOURS["limit"], linewidth=1.2, linestyle=(0, (5, 3)))
        if not signed:
            axes.set_ylim(bottom=0.0)
        axes.margins(x=0.01)
        axes.set_xlabel("time since the first sample, s")
        return _svg(figure)


def _equal(axes: Axes) -> None:
    """Gives both axes the same scale; a path smaller than a centimetre is not blown up beyond it."""
    figure, box = axes.figure, axes.get_position()
    ratio = box.width * figure.get_figwidth() / (box.height * figure.get_figheight())  # type: ignore[union-attr]
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    height = max(high - low, (right - left) / ratio, 10.0)
    across, up = (left + right) / 2.0, (low + high) / 2.0
    axes.set_xlim(across - height * ratio / 2.0, across + height * ratio / 2.0)
    axes.set_ylim(up - height / 2.0, up + height / 2.0)


def _svg(figure: Figure) -> str:
    out = io.StringIO()
    figure.savefig(out, format="svg", transparent=True, metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    text = out.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r'<svg ([^>]*?)width="[^"]*" height="[^"]*"', r'<svg aria-hidden="true" focusable="false" \1', text, count=1)
    text = re.sub(r"<defs>\s*<style.*?</style>\s*</defs>", "", text, count=1, flags=re.DOTALL)  # would style the whole page
    text = re.sub(r' d="[^"]*"', _one_decimal, text)
    text = re.sub(r" font-family: [^;]*;", "", text)
    text = re.sub(r' id="[a-z0-9.]+_\d+"| transform="rotate\(-0 [^)]*\)"', "", text)  # ids of groups repeat from plot to plot
    text = re.sub(r"\n\s*", "\n", text)
    for name, colour in _COLOURS.items():
        text = text.replace(colour, f"var(--{name})")
    return text


def _one_decimal(found: re.Match[str]) -> str:
    """Gives path data with one decimal, a tenth of a point, and without line breaks."""
    return " ".join(re.sub(r"\d+\.\d+", lambda number: f"{float(number[0]):.1f}", found[0]).split()).replace('d="', ' d="')
