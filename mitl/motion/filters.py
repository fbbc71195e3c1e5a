"""Moving averages of joint angles over time: the step from the plan to what the arm, or the controller's report, does.

The averages are centred (zero phase): they begin half their width before the plan and end half their width after it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import CubicSpline

from mitl.motion.robot_model import RobotModel
from mitl.paths import FloatArray


def moving_average(values: FloatArray, tick: float, widths: Sequence[float] | FloatArray) -> FloatArray:
    """Gives values (N, k), sampled every `tick` s, averaged column by column over widths (k,) s; both ends are held.

    The average is the difference of a cubic spline's integral, so widths need not be multiples of the tick.
    """
    widths = np.broadcast_to(np.asarray(widths, dtype=np.float64), (values.shape[1],))
    pad = int(np.ceil(widths.max() / 2 / tick)) + 2
    padded = np.concatenate([np.repeat(values[:1], pad, axis=0), values, np.repeat(values[-1:], pad, axis=0)])
    time = tick * np.arange(len(padded))
    middle = time[pad : pad + len(values)]
    integral = CubicSpline(time, padded - values[0], bc_type="natural").antiderivative()
    filtered = np.empty_like(values)
    for width in np.unique(widths):
        columns = widths == width
        change = integral(middle + width / 2) - integral(middle - width / 2)
        filtered[:, columns] = change[:, columns] / width + values[0, columns]
    return filtered


def motor_side(model: RobotModel, arm: FloatArray, tick: float) -> FloatArray:
    """Gives the angles (N, 6) on the motors' side of a motion's joints (N, 6) every `tick` s: ahead by elasticity times effort.

    Gravity's share is left out: at rest the controller reports what was programmed.
    """
    if model.elasticity is None or len(arm) < 2:
        return arm
    spline = CubicSpline(tick * np.arange(len(arm)), arm, bc_type="natural")
    time = tick * np.arange(len(arm))
    return np.asarray(arm + model.effort.efforts(arm, spline(time, 1), spline(time, 2)).across @ model.elasticity.T)
