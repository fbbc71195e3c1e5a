"""A layout for Foxglove that shows a recording at once: poses in space, checks, signals and speed over time, the log.

Invariant: it names only topics and fields that the recording has. Format: the JSON that Foxglove's "Import from file" takes.
"""

from __future__ import annotations

from typing import Any

from mitl.recording.mcap_writer import field_names
from mitl.recording.records import LOG, MEASURED, MOVES, ORACLE, SIGNALS, TRACKER, Recording

_MOST_LINES = 12


def foxglove_layout(recording: Recording) -> dict[str, Any]:
    """Gives the layout as JSON values."""
    poses = [topic for topic, track in recording.paths.items() if len(track.path)]
    shown = [topic for topic in poses if topic.endswith((MEASURED, ORACLE))] or poses
    frame = recording.paths[shown[0]].frame if shown else ""
    panels: dict[str, dict[str, Any]] = {
        "3D!space": {
            "followMode": "follow-none",
            "fixedFrame": frame,
            "topics": {topic: {"visible": topic in shown, "type": "axis", "axisScale": 0.05} for topic in poses},
            "scene": {"labelScaleFactor": 0},
        },
        "Plot!position": _plot("position", [f"{topic}.pose.position.{axis}" for topic in shown[:4] for axis in "xyz"]),
    }
    checks = [_fields(recording, topic) for topic in recording.series if topic.startswith("/check/")]
    if checks:
        panels["Plot!checks"] = _plot("checks", [field for fields in checks for field in fields])
    signals = [_fields(recording, topic) for topic in recording.series if topic.endswith((SIGNALS, MOVES))]
    if signals:
        panels["Plot!signals"] = _plot("signals and moves", [field for fields in signals for field in fields])
    if recording.log:
        panels["RosOut!log"] = {"topicToRender": LOG, "searchTerms": [], "minLogLevel": 1}
    raw = next((topic for topic in poses if topic.endswith(TRACKER)), None)
    if raw is not None:
        panels["RawMessages!tracker"] = {"topicPath": raw, "diffEnabled": False}
    first, *others = panels
    return {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": {"first": first, "second": _stacked(others), "direction": "row", "splitPercentage": 50},
    }


def _plot(title: str, paths: list[str]) -> dict[str, Any]:
    lines = [{"value": path, "enabled": True, "timestampMethod": "receiveTime", "label": path} for path in paths[:_MOST_LINES]]
    return {
        "title": title,
        "paths": lines,
        "showXAxisLabels": True,
        "showYAxisLabels": True,
        "showLegend": True,
        "isSynced": True,
        "xAxisVal": "timestamp",
        "foxglovePanelTitle": title,
    }


def _fields(recording: Recording, topic: str) -> list[str]:
    return [f"{topic}.{name}" for name in field_names(recording.series[topic].columns)]


def _stacked(panels: list[str]) -> Any:  # noqa: ANN401 - a panel's name, or a node of two
    first, *others = panels
    if not others:
        return first
    return {"first": first, "second": _stacked(others), "direction": "column", "splitPercentage": 100.0 / len(panels)}
