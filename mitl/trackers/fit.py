"""Makes a tracker preset from a fit to recordings: what they tell replaces the numbers of a base preset, each with its source.

Invariant: the preset made predicts, simulated, the jitter that the recordings have.
"""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from mitl.metrics.tracker_fit import JITTER_WINDOW, TrackerFit, place_jitter
from mitl.paths import FloatArray, PosePath
from mitl.resources import models_folder
from mitl.simulation.tracker_model import TrackerModel
from mitl.simulation.tracker_parameters import TrackerParameters, load_preset

# ASSUMPTION A-79: recordings of seconds tell the slope of the slow noise, not where it ends: it is bounded as that of the public
# recordings, 8 s (facts/tracker.md, preset lighthouse2).
_SLOW_TAU = 8.0
_SIMULATED = 24  # recordings that are simulated to know a preset's jitter
_SECONDS = 4.0


def fitted_preset(fit: TrackerFit, name: str, base: str = "lighthouse2") -> TrackerParameters:
    """Gives the preset: noise, its gain by place and the rate from the fit, a mount that does not creep, the rest from `base`."""
    known = load_preset(base)
    noise = replace(
        known.position_noise,
        fast_sd_m=fit.position.fast_sd,
        fast_tau_s=fit.position.fast_tau,
        slow_sd_m=fit.position.walk * float(np.sqrt(_SLOW_TAU / 2.0)),
        slow_tau_s=_SLOW_TAU,
        axis_factors=(float(fit.axis_factors[0]), float(fit.axis_factors[1]), float(fit.axis_factors[2])),
    )
    turn = replace(
        known.orientation_noise,
        fast_sd_deg=float(np.degrees(fit.turn.fast_sd)),
        fast_tau_s=fit.turn.fast_tau,
        slow_sd_deg=float(np.degrees(fit.turn.walk)) * float(np.sqrt(_SLOW_TAU / 2.0)),
        slow_tau_s=_SLOW_TAU,
    )
    plain = replace(
        known,
        name=name,
        description=f"Fitted to {len(fit.jitter)} still recordings, the rest as preset {base}",
        sampling=replace(known.sampling, rate_hz=round(fit.rate, 6)),
        position_noise=noise,
        orientation_noise=turn,
        location=replace(known.location, gain_median=1.0, gain_sd_log=fit.gain_sd_log),
        creep=replace(known.creep, rate_m_s=0.0),
    )
    unscaled = predicted_jitter(replace(plain, location=replace(plain.location, gain_sd_log=0.0)))
    median = fit.typical_jitter / float(np.exp(np.mean(np.log(unscaled))))
    return replace(plain, location=replace(plain.location, gain_median=median))


def predicted_jitter(parameters: TrackerParameters, window: float = JITTER_WINDOW, places: int = _SIMULATED) -> FloatArray:
    """Gives the mean jitter (places,) in m of simulated still recordings of 4 s at places of their own."""
    count = round(_SECONDS / parameters.period)
    times: FloatArray = np.arange(count) * np.float64(parameters.period)
    random = np.random.default_rng(1)
    found = []
    for seed in range(places):
        position = np.tile(random.uniform(-2.0, 2.0, 3), (count, 1))
        path = TrackerModel(parameters, seed).measure(times, position, np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)))
        found.append(place_jitter(PosePath(path.time, path.position, path.quaternion_wxyz, path.valid), window))
    return np.array(found)


def preset_text(parameters: TrackerParameters, base: str, source: str) -> str:
    """Gives the preset's file: the base preset's text, with the numbers that differ replaced and `source` as their source."""
    section = ""
    lines = [f"# Fitted by `mitl fit-tracker`: {source}. What was not fitted is as in preset {base}."]
    for line in (models_folder() / "trackers" / f"{base}.toml").read_text(encoding="utf-8").splitlines():
        heading, entry = re.match(r"\[(\w+)\]", line), re.match(r"(\w+) = ", line)
        if line.startswith("#"):
            continue
        if heading:
            section = heading[1]
        if entry:
            record = getattr(parameters, section) if section else parameters
            line = _entry(line, entry[1], getattr(record, entry[1]), source)  # noqa: PLW2901 - the line is what is rewritten
        lines.append(line)
    return "\n".join(lines) + "\n"


def _entry(line: str, key: str, value: object, source: str) -> str:
    """Gives a line of the file with a new value and source, or as it was where the value is the same."""
    text, _, comment = line.partition(" # ") if " # " in line else (line, "", "")
    written = json.dumps(value) if isinstance(value, str) else _numbers(value)
    old = text.partition(" = ")[2].strip()
    same = old == written or (not isinstance(value, str) and _as_floats(old) == _as_floats(written))
    if isinstance(value, str):
        return f"{key} = {written}"
    return f"{key} = {old if same else written} # {comment if same else 'source: ' + source}"


def _numbers(value: object) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(f"{each:.6g}" for each in value) + "]"
    return f"{value:.6g}"


def _as_floats(text: str) -> list[float]:
    return [float(each) for each in re.findall(r"[-+.\deE]+", text)]


def write_preset(path: Path, text: str) -> None:
    """Writes a preset whole or not at all."""
    from mitl.recording.atomic import replacing  # noqa: PLC0415 - loads the MCAP writer

    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8")
