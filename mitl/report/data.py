"""What report and replay both take from a recorded run, as JSON values on the run's own time: 0 where the order was given."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
from markupsafe import Markup

from mitl.engine.case_recording import RecordedRun
from mitl.paths import FloatArray, PosePath
from mitl.recording.records import LogMessage, Series

MOST_TEXT = 500
_MOST_EVENTS = 200
_MOST_CHANGES = 4000


def json_in_page(value: Any) -> Markup:  # noqa: ANN401 - whatever JSON can say
    """Gives JSON that is safe inside a script element: it can neither end it nor begin a comment."""
    text = json.dumps(value, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return Markup(text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026"))  # noqa: S704 - no markup is left in it


def finite(path: PosePath) -> PosePath | None:
    """Gives the valid samples that are numbers, None where they make no path."""
    chosen = path.select(path.valid & np.isfinite(path.position).all(axis=1))
    return chosen if len(chosen) > 1 else None


def positions_at(path: PosePath, time: FloatArray) -> FloatArray:
    """Gives positions (N, 3) in m at times (N,): at rest before the path begins and after it ends."""
    return np.column_stack([np.interp(time, path.time, column) for column in path.position.T])


def moves_of(run: RecordedRun) -> list[list[float]]:
    """Gives [time, source line] wherever another line of the program moves the robot."""
    return _changes(run.moves, "line", run.shift)


def signals_of(run: RecordedRun) -> list[dict[str, Any]]:
    """Gives for every output its name and its changes as [time, value]."""
    if run.signals is None:
        return []
    return [{"name": name[:MOST_TEXT], "at": _changes(run.signals, name, run.shift)} for name in run.signals.columns]


def events_of(run: RecordedRun, log: Sequence[LogMessage]) -> list[list[Any]]:
    """Gives [time, level, text, source] of what was said from a second before the order to a second after the run."""
    if run.began is None:
        return []
    ends = max((float(path.time[-1]) - run.shift for path in (run.tool, run.oracle) if path is not None and len(path)), default=0.0)
    found = [event for event in log if -1.0 <= event.time - run.began <= ends + 1.0][:_MOST_EVENTS]
    return [[round(event.time - run.began, 3), event.level[:20], event.text[:MOST_TEXT], event.source[:60]] for event in found]


def _changes(series: Series | None, column: str, shift: float) -> list[list[float]]:
    if series is None or column not in series.columns or not len(series.time):
        return []
    values = series.column(column)
    first = np.flatnonzero(np.concatenate([[True], np.diff(values) != 0.0]))[:_MOST_CHANGES]
    return [[round(float(time), 4), float(value)] for time, value in zip(series.time[first] - shift, values[first], strict=True)]
