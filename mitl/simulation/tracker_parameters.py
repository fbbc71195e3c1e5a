"""The numbers of a simulated tracker, read from `models/trackers/*.toml`.

Invariant: every key of the file is known, none is missing, and every value has its type and range; nothing has a default.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, get_type_hints

from mitl.errors import UsageError
from mitl.resources import models_folder

Triple = tuple[float, float, float]
MODES = ("Predicted", "OnUpdate")
"""How a pose is polled; the thesis's names (2.1.3, 3.2.3.1)."""


@dataclass(frozen=True)
class Sampling:
    """When the tracker samples: rate, and the sd of the error of its time stamps."""

    rate_hz: float
    time_jitter_s: float


@dataclass(frozen=True)
class ClockSpread:
    """How far the tracker's clock may be from the rig's: uniform offset, normal rate error."""

    offset_min_s: float
    offset_max_s: float
    rate_error_sd_ppm: float


@dataclass(frozen=True)
class PositionNoise:
    """Two Ornstein-Uhlenbeck noises per axis of L, and a third that fades in with speed."""

    fast_sd_m: float
    fast_tau_s: float
    slow_sd_m: float
    slow_tau_s: float
    axis_factors: Triple
    moving_sd_m: float
    moving_tau_s: float
    moving_from_m_s: float
    moving_full_m_s: float


@dataclass(frozen=True)
class OrientationNoise:
    """Two Ornstein-Uhlenbeck rotation vectors."""

    fast_sd_deg: float
    fast_tau_s: float
    slow_sd_deg: float
    slow_tau_s: float


@dataclass(frozen=True)
class Location:
    """Some places are worse than others: lognormal gains of noise and drift that vary smoothly with position."""

    gain_median: float
    gain_sd_log: float
    drift_sd_log: float
    correlation_length_m: float


@dataclass(frozen=True)
class CreepAfterStop:
    """After each stop every axis creeps towards a new value: sd of its initial rate, time constant; in motion it goes back to zero.

    repeatable_share: of the new value's variance, what the same place reached by the same way gives again.
    """

    rate_m_s: float
    repeatable_share: float
    tau_s: float
    still_below_m_s: float


@dataclass(frozen=True)
class Distortion:
    """Scale per axis of L, and the skews (xy, xz, yz): xz is how far the z axis leans towards x."""

    scale: Triple
    skew_deg: Triple


@dataclass(frozen=True)
class Drift:
    """A stationary Ornstein-Uhlenbeck process per axis of L."""

    sd_m: Triple
    tau_s: float


@dataclass(frozen=True)
class Glitch:
    """A short wrong position at some time after a stop, always as large, and in motion, of exponentially distributed size."""

    probability_per_stop: float
    size_m: float
    duration_s: float
    within_s: float
    rate_in_motion_hz: float
    mean_size_in_motion_m: float


@dataclass(frozen=True)
class Loss:
    """Tracking lost: pose zero and not valid for a while."""

    rate_per_s: float
    duration_s: float


@dataclass(frozen=True)
class FrameJump:
    """The tracker's frame may move when tracking is found again."""

    probability_per_reacquisition: float
    translation_sd_m: Triple
    rotation_min_deg: float
    rotation_max_deg: float


@dataclass(frozen=True)
class Sleep:
    """After standing still the device stops to update its pose; motion wakes it after a while. after_s = 0: never."""

    after_s: float
    wake_min_s: float
    wake_max_s: float


@dataclass(frozen=True)
class Occlusion:
    """No base station sees the body: the pose coasts on the IMU, still valid, with an error that grows; then tracking is lost."""

    rate_per_s: float
    duration_min_s: float
    duration_max_s: float
    coast_min_s: float
    coast_max_s: float
    velocity_error_m_s: float
    acceleration_error_m_s2: float


@dataclass(frozen=True)
class OneBase:
    """Places where only one base station sees the body, the one at `station_m` in L: noise grows by `factor` along the ray from it.

    share: of all places, in patches of about patch_length_m.
    """

    share: float
    factor: float
    station_m: Triple
    patch_length_m: float


@dataclass(frozen=True)
class NativeVelocity:
    """Noise of the velocity that the tracker itself reports: Ornstein-Uhlenbeck, its sd growing by per_m_s2 of itself for 1 m/s^2."""

    sd_m_s: float
    tau_s: float
    per_m_s2: float


@dataclass(frozen=True)
class Shock:
    """A hard stop or corner spoils the IMU's data for a while: accelerations from `from_m_s2` on.

    Position errors of position_sd_m and native velocities worse by velocity_factor, both fading out over the duration.
    """

    from_m_s2: float
    duration_min_s: float
    duration_max_s: float
    position_sd_m: float
    velocity_factor: float


@dataclass(frozen=True)
class Button:
    """Latent delay of a button input, uniform; the sample after it shows the state."""

    delay_min_s: float
    delay_max_s: float


@dataclass(frozen=True)
class Output:
    """What a poll gives. mode "Predicted": the pose extrapolated over age_s with the native velocity.

    Mode "OnUpdate": the pose held from the last event of the device, which come at update_rate_hz.
    """

    mode: str
    age_s: float
    update_rate_hz: float


@dataclass(frozen=True)
class TrackerParameters:
    """All parameters of the sensor model; units are in the names."""

    name: str
    description: str
    sampling: Sampling
    clock: ClockSpread
    position_noise: PositionNoise
    orientation_noise: OrientationNoise
    location: Location
    creep: CreepAfterStop
    distortion: Distortion
    drift: Drift
    glitch: Glitch
    loss: Loss
    frame_jump: FrameJump
    sleep: Sleep
    occlusion: Occlusion
    one_base: OneBase
    velocity: NativeVelocity
    shock: Shock
    button: Button
    output: Output

    @property
    def period(self) -> float:
        """Gives the time between samples in s."""
        return 1.0 / self.sampling.rate_hz


def load_preset(name: str) -> TrackerParameters:
    """Gives the parameters of `models/trackers/<name>.toml`. UsageError lists the presets where there is no such one."""
    folder = models_folder() / "trackers"
    file = folder / f"{name}.toml"
    if not file.is_file():
        known = ", ".join(sorted(each.stem for each in folder.glob("*.toml")))
        raise UsageError(f"no tracker preset {name!r}; there are: {known}")
    return load_tracker_parameters(file)


def load_tracker_parameters(file: Path) -> TrackerParameters:
    """Gives the parameters in `file`. UsageError names file and key where one is unknown, missing or out of range."""
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise UsageError(f"{file}: cannot read tracker parameters: {error}") from error
    parameters: TrackerParameters = _record(TrackerParameters, table, file, "")
    return parameters


# Any: which record it is, and hence every field's type, is known only from the class given.
def _record(record: type[Any], table: dict[str, Any], file: Path, prefix: str) -> Any:  # noqa: ANN401 - see above
    hints = get_type_hints(record)
    for key in table:
        if key not in hints:
            raise UsageError(f"{file}: unknown key {prefix + key!r}; expected one of: {', '.join(hints)}")
    values = {}
    for field in fields(record):
        key = prefix + field.name
        if field.name not in table:
            raise UsageError(f"{file}: key {key!r} is missing")
        values[field.name] = _value(hints[field.name], table[field.name], file, key)
    return record(**values)


def _value(kind: Any, value: Any, file: Path, key: str) -> Any:  # noqa: ANN401 - see _record
    if kind is str:
        if not isinstance(value, str):
            raise UsageError(f"{file}: {key} must be text, is {value!r}")
        if key.endswith(".mode") and value not in MODES:
            raise UsageError(f"{file}: {key} must be {' or '.join(MODES)}, is {value!r}")
        return value
    if kind is float:
        return _number(value, file, key)
    if kind == Triple:
        if not isinstance(value, list) or len(value) != 3:
            raise UsageError(f"{file}: {key} must be three numbers, is {value!r}")
        return tuple(_number(each, file, key) for each in value)
    if not isinstance(value, dict):
        raise UsageError(f"{file}: {key} must be a table [{key}], is {value!r}")
    return _record(kind, value, file, f"{key}.")


_POSITIVE = ("rate_hz", "tau_s", "correlation_length_m", "patch_length_m", "gain_median", "scale", "from_m_s2")
_SIGNED = ("skew_deg", "offset_min_s", "offset_max_s", "station_m", "delay_min_s")


def _number(value: Any, file: Path, key: str) -> float:  # noqa: ANN401 - straight from the file
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise UsageError(f"{file}: {key} must be a finite number, is {value!r}")
    if key.endswith(_POSITIVE) and value <= 0:
        raise UsageError(f"{file}: {key} must be positive, is {value!r}")
    if not key.endswith(_SIGNED) and value < 0:
        raise UsageError(f"{file}: {key} must not be negative, is {value!r}")
    if ("probability" in key or key.endswith("share")) and value > 1:
        raise UsageError(f"{file}: {key} must be at most 1, is {value!r}")
    return float(value)
