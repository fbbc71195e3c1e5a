"""RobotModel: what the planner knows of an arm, read strictly from `models/<robot>/motion.toml`.

Invariant: SI throughout (m, rad, s); degrees and millimetres end at this file's reader.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mitl.errors import UsageError
from mitl.motion.effort import AxisLimits, EffortModel, FittedTorques
from mitl.paths import FloatArray
from mitl.resources import models_folder

_JOINTS = 6


@dataclass(frozen=True, eq=False)
class OpwParameters:
    """Ortho-parallel basis with spherical wrist, m; offsets (6,) rad, signs (6,) +-1; the convention is py-opw-kinematics'."""

    a1: float
    a2: float
    b: float
    c1: float
    c2: float
    c3: float
    c4: float
    offsets: FloatArray
    signs: FloatArray


@dataclass(frozen=True, eq=False)
class RobotModel:
    """Geometry, limits and dynamics of one arm.

    lower, upper (6,) rad; speed (6,) rad/s; acceleration (6,) rad/s^2. parallel_rod: axis 3 is the forearm's angle to the horizontal,
    which a rod keeps as axis 2 turns, not its angle to the upper arm. ASSUMPTION A-152.
    tcp_acceleration m/s^2 along the path, smoothed over acceleration_window s where a motion is stopped; corner_acceleration m/s^2
    across the path; tcp_limited: plans of lines and arcs keep both; without, only the drives limit them. vmax m/s. arm_windows: widths in s
    of the two moving averages
    between plan and tool; controller_windows (6,) s: the same between plan and what the controller reports. start_latency s from a
    command to the start of the plan. fine_pause (K,) s at peak leg speeds fine_pause_speed (K,) m/s. zone_factor: how much faster than the
    rest of a zone allows it is entered. path_lag: time constant in s with which the path coordinate lags. effort: what the drives can do.
    elasticity (6, 6): rad that the motor side of each axis (row) is ahead of the arm per unit of each axis' effort; None where unknown,
    then controller_windows stand for it.
    """

    name: str
    description: str
    folder: Path
    opw: OpwParameters
    lower: FloatArray
    upper: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    parallel_rod: bool
    tcp_acceleration: float
    acceleration_window: float
    corner_acceleration: float
    tcp_limited: bool
    vmax: float
    arm_windows: FloatArray
    controller_windows: FloatArray
    start_latency: float
    fine_pause_speed: FloatArray
    fine_pause: FloatArray
    zone_factor: float
    path_lag: float
    effort: EffortModel
    elasticity: FloatArray | None

    @property
    def urdf(self) -> Path:
        """Gives the robot's URDF file."""
        return self.folder / "robot.urdf"

    def between_links(self, q: FloatArray) -> FloatArray:
        """Gives the angles (..., 6) in rad between the links, which the URDF and closed forms speak of, for RAPID's joints (..., 6)."""
        return _sheared(q, -1.0) if self.parallel_rod else q

    def from_links(self, q: FloatArray) -> FloatArray:
        """Gives RAPID's joints (..., 6) in rad for angles (..., 6) between the links."""
        return _sheared(q, 1.0) if self.parallel_rod else q

    def pause_after(self, peak_speed: float) -> float:
        """Gives the standstill in s that the plan has at a fine point after a leg with this peak speed in m/s."""
        return float(np.interp(peak_speed, self.fine_pause_speed, self.fine_pause))


def robot_names() -> list[str]:
    """Gives the names of the robots that mitl has a model of."""
    return sorted(folder.parent.name for folder in models_folder().glob("*/motion.toml"))


def load_robot_model(name: str) -> RobotModel:
    """Gives the model of the robot `name`, a folder in models/ or a path to such a folder.

    Raises UsageError naming the file and the key where something is missing or of the wrong kind.
    """
    folder = Path(name) if "/" in name else models_folder() / name
    file = folder / "motion.toml"
    if not file.is_file():
        raise UsageError(f"no robot model {name!r}: known are {', '.join(robot_names())}")
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise UsageError(f"{file}: not valid TOML: {error}") from error
    reader = _Reader(file, table)
    return RobotModel(
        name=reader.text("robot", "name"),
        description=reader.text("robot", "description"),
        folder=folder,
        opw=OpwParameters(
            **{key: reader.number("opw", key) for key in ("a1", "a2", "b", "c1", "c2", "c3", "c4")},
            offsets=np.radians(reader.array("opw", "offsets_deg", _JOINTS)),
            signs=reader.array("opw", "signs", _JOINTS),
        ),
        lower=np.radians(reader.array("joints", "lower_deg", _JOINTS)),
        upper=np.radians(reader.array("joints", "upper_deg", _JOINTS)),
        speed=np.radians(reader.array("joints", "speed_deg_s", _JOINTS)),
        acceleration=np.radians(reader.array("joints", "acceleration_deg_s2", _JOINTS)),
        parallel_rod=reader.flag("joints", "parallel_rod"),
        tcp_acceleration=reader.number("tcp", "acceleration_m_s2"),
        acceleration_window=reader.number("tcp", "acceleration_window_s"),
        corner_acceleration=reader.number("tcp", "corner_acceleration_m_s2"),
        tcp_limited=reader.flag("tcp", "limited"),
        vmax=reader.number("tcp", "vmax_m_s"),
        arm_windows=reader.array("executed", "arm_windows_s", 2),
        controller_windows=reader.array("executed", "controller_windows_s", _JOINTS),
        start_latency=reader.number("executed", "start_latency_s"),
        fine_pause_speed=reader.array("executed", "fine_pause_speed_m_s"),
        fine_pause=reader.array("executed", "fine_pause_s"),
        zone_factor=reader.number("tcp", "zone_speed_factor"),
        path_lag=reader.number("executed", "path_lag_s"),
        effort=_effort(reader),
        elasticity=_elasticity(reader),
    )


def _effort(reader: _Reader) -> EffortModel:
    """Gives the fitted torques where there is a section of them, else the acceleration limits."""
    if "torques" not in reader.table:
        return AxisLimits(np.radians(reader.array("joints", "acceleration_deg_s2", _JOINTS)))
    numbers = {key: reader.number("torques", key) for key in ("swing_least", "shoulder", "elbow", "coupling", "own", "fling")}
    return FittedTorques(
        **numbers,
        swing=reader.array("torques", "swing", 7),
        gravity=reader.array("torques", "gravity", 2),
        fold=reader.number("torques", "fold_rad"),
        lean=reader.number("torques", "lean_rad"),
        wrist=np.radians(reader.array("joints", "acceleration_deg_s2", _JOINTS))[3:],
        strength=reader.number("torques", "strength"),
        weakens=reader.array("torques", "weakens_between", 2),
        weakest=reader.number("torques", "weakest"),
    )


def _elasticity(reader: _Reader) -> FloatArray | None:
    """Gives the elasticity's matrix, of axes 1 to 3."""
    if "elasticity" not in reader.table:
        return None
    matrix = np.zeros((_JOINTS, _JOINTS))
    for row in range(3):
        matrix[row, :3] = reader.array("elasticity", f"axis_{row + 1}_rad", 3)
    return matrix


def _sheared(q: FloatArray, sign: float) -> FloatArray:
    turned = np.array(q, dtype=np.float64)
    turned[..., 2] += sign * turned[..., 1]
    return turned


@dataclass(frozen=True)
class _Reader:
    """Takes typed values out of a parsed TOML table; its errors name file and key."""

    file: Path
    table: dict[str, Any]  # tomllib's own result type

    def _value(self, section: str, key: str) -> Any:  # noqa: ANN401 - tomllib's own result type
        try:
            return self.table[section][key]
        except (KeyError, TypeError):
            raise UsageError(f"{self.file}: missing [{section}] {key}") from None

    def text(self, section: str, key: str) -> str:
        value = self._value(section, key)
        if not isinstance(value, str):
            raise UsageError(f"{self.file}: [{section}] {key} must be a string, is {value!r}")
        return value

    def flag(self, section: str, key: str) -> bool:
        """Gives a truth value, false where the key is missing."""
        value = self.table.get(section, {}).get(key, False)
        if not isinstance(value, bool):
            raise UsageError(f"{self.file}: [{section}] {key} must be true or false, is {value!r}")
        return value

    def number(self, section: str, key: str) -> float:
        value = self._value(section, key)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise UsageError(f"{self.file}: [{section}] {key} must be a number, is {value!r}")
        return float(value)

    def array(self, section: str, key: str, length: int | None = None) -> FloatArray:
        value = self._value(section, key)
        good = isinstance(value, list) and value and all(isinstance(v, int | float) and not isinstance(v, bool) for v in value)
        if not good or (length is not None and len(value) != length):
            wanted = "numbers" if length is None else f"{length} numbers"
            raise UsageError(f"{self.file}: [{section}] {key} must be a list of {wanted}, is {value!r}")
        return np.array(value, dtype=np.float64)
