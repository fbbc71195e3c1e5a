"""Writes a fitted robot model as a folder: the base model's files with the fitted values, their provenance and residuals.

Invariant: a value that was not fitted stands as in the base model, with its comment and its source.
"""

from __future__ import annotations

import json
import re
import shutil
import tomllib
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mitl.errors import UsageError
from mitl.motion.accuracy import ModelAccuracy
from mitl.motion.fit import MotionFit
from mitl.motion.robot_model import RobotModel, load_robot_model

_MOTION, _PROVENANCE = "motion.toml", "provenance.toml"


def write_model(folder: Path, base: RobotModel, fit: MotionFit, accuracy: ModelAccuracy, source: str) -> None:
    """Writes the model. Raises UsageError where the folder cannot be made or is in the way."""
    if folder.exists() and (not folder.is_dir() or (any(folder.iterdir()) and not (folder / _MOTION).is_file())):
        raise UsageError(f"{folder}: is there already and is no robot model")
    told = {key for fitted in fit.parameters if fitted.told for key in fitted.parameter.keys}
    if "executed.controller_windows_s" in told:
        told.add("executed.arm_windows_s")
    text = (base.folder / _MOTION).read_text(encoding="utf-8")
    for key in sorted(told):
        text = _with_value(text, key, _value(fit.model, key))
    entries = tomllib.loads((base.folder / _PROVENANCE).read_text(encoding="utf-8")).get("entry", [])
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for other in sorted(base.folder.iterdir()):
            if other.is_file() and other.name not in (_MOTION, _PROVENANCE) and other.resolve() != (folder / other.name).resolve():
                shutil.copyfile(other, folder / other.name)
        (folder / _MOTION).write_text(text, encoding="utf-8")
        (folder / _PROVENANCE).write_text(_provenance(entries, told, fit, accuracy, source), encoding="utf-8")
    except OSError as error:
        raise UsageError(f"{folder}: cannot be written: {error.strerror or error}") from error
    load_robot_model(f"{folder}/.")  # what was written can be read


def _value(model: RobotModel, key: str) -> str:
    strength = getattr(model.effort, "strength", 0.0)
    values: dict[str, object] = {
        "executed.controller_windows_s": model.controller_windows,
        "executed.arm_windows_s": model.arm_windows,
        "executed.path_lag_s": model.path_lag,
        "executed.fine_pause_s": model.fine_pause,
        "tcp.acceleration_m_s2": model.tcp_acceleration,
        "tcp.corner_acceleration_m_s2": model.corner_acceleration,
        "torques.strength": strength,
        "joints.acceleration_deg_s2": np.degrees(model.acceleration),
    }
    value = values[key]
    if isinstance(value, np.ndarray):
        return "[" + ", ".join(f"{float(part):.6g}" for part in value) + "]"
    return f"{value:.6g}" if "." in f"{value:.6g}" else f"{value:.1f}"


def _with_value(text: str, key: str, value: str) -> str:
    """Gives the TOML with one value replaced; what its comment said was of the former one."""
    section, name = key.split(".")
    head = re.search(rf"^\[{section}\].*$", text, re.MULTILINE)
    line = re.compile(rf"^{name} = .*$", re.MULTILINE).search(text, head.end()) if head else None
    if line is None:
        raise UsageError(f"{_MOTION}: [{section}] {name} is missing")
    return f"{text[: line.start()]}{name} = {value} # fitted{text[line.end() :]}"


def _provenance(entries: Sequence[dict[str, object]], told: set[str], fit: MotionFit, accuracy: ModelAccuracy, source: str) -> str:
    overall = accuracy.overall
    rows = [
        "# Where the numbers of motion.toml and robot.urdf come from, and how sure they are. Written by mitl fit-motion.",
        "",
        "[oracle]",
        f"path_mm = {1e3 * overall.path:.4g}",
        f"time_ms = {1e3 * overall.time:.4g}",
        f"speed_per_cent = {1e2 * overall.speed:.4g}",
        f"turn_deg = {np.degrees(overall.turn):.4g}",
        f"source = {json.dumps(source)}",
        "band = [ # residuals on moves held out of the fit, then the base model's for other kinds of motion",
    ]
    rows += [
        f'  {{ kind = "{band.kind.value}", up_to_mm_s = {1e3 * band.up_to:.4g}, path_mm = {1e3 * band.path:.4g}, '
        f"turn_deg = {np.degrees(band.turn):.4g}, time_ms = {1e3 * band.time:.4g} }},"
        for band in accuracy.bands
    ]
    rows.append("]")
    figures = "; ".join(f"{p.parameter.name} {p.factor:.4g} +- {p.sigma:.2g}" for p in fit.parameters if p.told)
    if told:
        rows += _entry(sorted(told), "fitted", source, f"Factors on the base model: {figures}.")
    for entry in entries:
        covers = entry["covers"]
        kept = [key for key in covers if key not in told] if isinstance(covers, list) else []
        if kept:
            rows += _entry(kept, str(entry["status"]), str(entry["source"]), str(entry["note"]))
    return "\n".join(rows) + "\n"


def _entry(covers: Sequence[str], status: str, source: str, note: str) -> list[str]:
    names = ", ".join(json.dumps(key) for key in covers)
    return ["", "[[entry]]", f"covers = [{names}]", f'status = "{status}"', f"source = {json.dumps(source)}", f"note = {json.dumps(note)}"]
