"""Fits an arm's motion parameters to controller logs: joint angles over time, and the RAPID that ran.

Every parameter is a factor on the base model's value. The log's clock is unknown: each log has an offset of its own, fitted along.
Invariant: what a log does not tell is left as the base model has it and said so; held-out moves never enter the fit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import OptimizeResult, least_squares

from mitl.errors import UsageError
from mitl.motion.effort import AxisLimits, FittedTorques
from mitl.motion.fit_trust import CORRELATED, Misfit, noise_of
from mitl.motion.offline import run_until, start_run
from mitl.motion.program_run import ProgramRun
from mitl.motion.record import TICK, View
from mitl.motion.robot_model import RobotModel
from mitl.paths import BoolArray, FloatArray
from rapid_interp import Program

HELD_OUT = 3
"""Every so manieth move of a kind and speed is held out of the fit."""
KNOWN = 0.2
"""A factor whose standard uncertainty is larger is not told by the logs. ASSUMPTION A-275."""
_NARROWEST, _WIDEST = 0.2, 5.0
_STEP = 0.02
_LONGEST = 600.0
_OFFSET_UNIT = 0.1
_REST_SPEED = 5e-3


@dataclass(frozen=True, eq=False)
class JointLog:
    """What a controller reported: joints (N, 6) rad at times (N,) s of its own clock, and the program that ran."""

    name: str
    time: FloatArray
    joints: FloatArray
    program: Program
    routine: str = "main"


@dataclass(frozen=True)
class Parameter:
    """A factor on some of a model's values. keys: those of motion.toml that it scales; apply: gives the model with them scaled.

    timing: whether moves last longer by it.

    """

    name: str
    keys: tuple[str, ...]
    apply: Callable[[RobotModel, float], RobotModel]
    timing: bool = True


@dataclass(frozen=True)
class FittedParameter:
    """A parameter's factor with its standard uncertainty; told: whether the logs tell it, else the factor is 1."""

    parameter: Parameter
    factor: float
    sigma: float
    told: bool


@dataclass(frozen=True, eq=False)
class MotionFit:
    """A fitted model, its parameters, and each log's offset in s: log time = program time + offset. runs: what the model does, by log.

    misfit: how far to trust the parameters' uncertainties, which it has widened.
    """

    model: RobotModel
    parameters: tuple[FittedParameter, ...]
    offsets: tuple[float, ...]
    runs: tuple[ProgramRun, ...]
    rms: float
    evaluations: int
    misfit: Misfit


def parameters_of(model: RobotModel) -> tuple[Parameter, ...]:
    """Gives what can be fitted of a model: windows, lag, accelerations or torques, pause.

    Not the start latency: where it is longer and the pause as much shorter, all but the log's offset, which is not known, stays the same.
    """
    found: list[Parameter] = []
    if model.elasticity is None:
        groups = {"1": (0,), "2": (1,), "3": (2,), "4-6": (3, 4, 5)}
        found += [
            Parameter(f"report window J{name}", ("executed.controller_windows_s",), _report_window(axes), timing=False)
            for name, axes in groups.items()
        ]
    else:
        found.append(
            Parameter("arm windows", ("executed.arm_windows_s",), lambda m, f: replace(m, arm_windows=f * m.arm_windows), timing=False)
        )
    found.append(Parameter("path lag", ("executed.path_lag_s",), lambda m, f: replace(m, path_lag=f * m.path_lag), timing=False))
    if model.tcp_limited:
        found.append(
            Parameter("acceleration", ("tcp.acceleration_m_s2",), lambda m, f: replace(m, tcp_acceleration=f * m.tcp_acceleration))
        )
        found.append(
            Parameter(
                "corner acceleration",
                ("tcp.corner_acceleration_m_s2",),
                lambda m, f: replace(m, corner_acceleration=f * m.corner_acceleration),
            )
        )
    if isinstance(model.effort, FittedTorques):
        found.append(Parameter("strength of axes 1-3", ("torques.strength",), _strength))
    else:
        found.append(Parameter("joint acceleration J1-3", ("joints.acceleration_deg_s2",), _joint_acceleration((0, 1, 2))))
    found.append(Parameter("joint acceleration J4-6", ("joints.acceleration_deg_s2",), _joint_acceleration((3, 4, 5)), timing=False))
    found.append(Parameter("fine-point pause", ("executed.fine_pause_s",), lambda m, f: replace(m, fine_pause=f * m.fine_pause)))
    return tuple(found)


def _report_window(axes: tuple[int, ...]) -> Callable[[RobotModel, float], RobotModel]:
    """Gives what scales the report's windows of some axes.

    ASSUMPTION A-274: the arm's own windows, which no log shows, grow with their mean.
    """

    def apply(model: RobotModel, factor: float) -> RobotModel:
        windows = model.controller_windows.copy()
        windows[list(axes)] *= factor
        return replace(model, controller_windows=windows, arm_windows=model.arm_windows * windows.mean() / model.controller_windows.mean())

    return apply


def _strength(model: RobotModel, factor: float) -> RobotModel:
    if not isinstance(model.effort, FittedTorques):
        return model
    return replace(model, effort=replace(model.effort, strength=factor * model.effort.strength))


def _joint_acceleration(axes: tuple[int, ...]) -> Callable[[RobotModel, float], RobotModel]:
    def apply(model: RobotModel, factor: float) -> RobotModel:
        limits = model.acceleration.copy()
        limits[list(axes)] *= factor
        effort = replace(model.effort, wrist=limits[3:]) if isinstance(model.effort, FittedTorques) else AxisLimits(limits)
        return replace(model, acceleration=limits, effort=effort)

    return apply


def with_factors(model: RobotModel, parameters: Sequence[Parameter], factors: FloatArray) -> RobotModel:
    """Gives the model with every parameter's values scaled by its factor."""
    for parameter, factor in zip(parameters, factors, strict=True):
        model = parameter.apply(model, float(factor))
    return model


def fit_motion(
    logs: Sequence[JointLog],
    base: RobotModel,
    progress: Callable[[str], None] = lambda _: None,
    *,
    parameters: Sequence[Parameter] = (),
) -> MotionFit:
    """Gives the model that best explains the logs, from `base` on. parameters: those to fit, all where none is named.

    Raises UsageError where a log does not fit its program, MotionError or RapidError where a program cannot run on this arm.
    """
    parameters = tuple(parameters) or parameters_of(base)
    offsets = np.array([_first_offset(log, _ran(log, base)) for log in logs])
    problem = _Problem(logs, base, parameters, progress)
    chosen = [index for index, parameter in enumerate(parameters) if parameter.timing]
    x = _solved(problem, chosen, np.ones(len(chosen) + len(logs)), offsets).x  # what makes moves last longer comes first, then all
    factors = np.ones(len(parameters))
    factors[chosen] = x[: len(chosen)]
    chosen = list(range(len(parameters)))
    x = np.concatenate([factors, x[-len(logs) :]])
    while True:
        solved = _solved(problem, chosen, x, offsets)
        kept = _told(problem, solved, len(chosen))
        if len(kept) == len(chosen):
            break
        x = np.concatenate([solved.x[kept], solved.x[len(chosen) :]])
        chosen = [chosen[place] for place in kept]
    sigma = problem.sigmas(solved.jac, solved.fun)
    factors, sigmas = np.ones(len(parameters)), np.full(len(parameters), np.inf)
    factors[chosen], sigmas[chosen] = solved.x[: len(chosen)], sigma[: len(chosen)]
    model = with_factors(base, parameters, factors)
    found = offsets + _OFFSET_UNIT * (solved.x[len(chosen) :] - 1.0)
    runs = tuple(_ran(log, model) for log in logs)
    misfit = problem.misfit(runs, found)
    return MotionFit(
        model,
        tuple(
            FittedParameter(parameter, float(factor), float(error) * misfit.widening, told=index in chosen)
            for index, (parameter, factor, error) in enumerate(zip(parameters, factors, sigmas, strict=True))
        ),
        tuple(float(offset) for offset in found),
        runs,
        float(np.sqrt(np.mean(solved.fun**2))),
        problem.evaluations,
        misfit,
    )


def _told(problem: _Problem, solved: OptimizeResult, count: int) -> list[int]:
    """Gives which of the first `count` unknowns the logs tell; the worst known is given up first: where two do the same, one stays."""
    kept = list(range(count))
    others = list(range(count, len(solved.x)))
    while kept:
        sigma = problem.sigmas(solved.jac[:, kept + others], solved.fun)[: len(kept)]
        if (sigma < KNOWN).all():
            break
        del kept[int(np.argmax(sigma))]
    return kept


def _solved(problem: _Problem, chosen: Sequence[int], start: FloatArray, offsets: FloatArray) -> OptimizeResult:
    """Gives the solution of least squares for some of the parameters and the offsets, from `start` on."""
    count, logs = len(chosen), len(start) - len(chosen)
    low = np.concatenate([np.full(count, _NARROWEST), np.full(logs, -9.0)])
    high = np.concatenate([np.full(count, _WIDEST), np.full(logs, 11.0)])

    def residuals(x: FloatArray) -> FloatArray:
        return problem.residuals(tuple(chosen), x, offsets)

    return least_squares(
        residuals,
        np.clip(start, low + 1e-3, high - 1e-3),
        bounds=(low, high),
        diff_step=np.full(len(start), _STEP),
        x_scale="jac",
        xtol=1e-4,
        ftol=1e-4,
        max_nfev=12,
    )


def held_out(run: ProgramRun) -> BoolArray:
    """Gives for each executed move (M,) whether it is held out: every HELD_OUT-th of a kind and programmed speed."""
    seen: dict[tuple[type, float], int] = {}
    chosen = []
    for executed in run.record.moves:
        key = (type(executed.move.effect), executed.move.speed.tcp)
        seen[key] = seen.get(key, 0) + 1
        chosen.append(seen[key] % HELD_OUT == 0)
    return np.array(chosen, dtype=bool)


def _ran(log: JointLog, model: RobotModel) -> ProgramRun:
    run = start_run(log.program.start(log.routine).run(), model)
    run_until(run, _LONGEST)
    if not run.finished:
        raise UsageError(f"{log.name}: its program still runs after {_LONGEST:g} s; fit to one that ends")
    if not run.record.moves:
        raise UsageError(f"{log.name}: its program makes no move")
    return run


def _first_offset(log: JointLog, run: ProgramRun) -> float:
    """Gives the offset in s at which the log's joint speeds are most like the model's, to a tick."""
    begins, ends = float(log.time[0]), float(log.time[-1])
    step = TICK
    even: FloatArray = np.arange(begins, ends, step)
    measured = np.stack([np.interp(even, log.time, log.joints[:, axis]) for axis in range(6)], axis=1)
    modelled = run.record.joints(np.arange(0.0, run.record.end, step), View.CONTROLLER)
    fast, like = (np.linalg.norm(np.gradient(values, step, axis=0), axis=1) for values in (measured, modelled))
    if fast.max(initial=0.0) < _REST_SPEED:
        raise UsageError(f"{log.name}: the arm stands still all along; log a program that moves")
    size = 1 << int(np.ceil(np.log2(len(fast) + len(like))))
    match = np.fft.irfft(np.fft.rfft(fast, size) * np.conj(np.fft.rfft(like, size)), size)
    lag = int(np.argmax(match))
    return begins + step * (lag if lag < len(fast) else lag - size)


class _Problem:
    """The residuals of all logs under factors and offsets; remembers the last model's runs."""

    def __init__(
        self, logs: Sequence[JointLog], base: RobotModel, parameters: Sequence[Parameter], progress: Callable[[str], None]
    ) -> None:
        self._logs, self._base, self._parameters, self._progress = logs, base, parameters, progress
        self._known: dict[tuple[float, ...], list[ProgramRun]] = {}
        self._size = 1.0
        self._training = [self._trained(log) for log in logs]
        self.evaluations = 0

    def residuals(self, chosen: tuple[int, ...], x: FloatArray, offsets: FloatArray) -> FloatArray:
        """Gives the residuals in rad of the chosen parameters' factors and the offsets' changes."""
        factors = np.ones(len(self._parameters))
        factors[list(chosen)] = x[: len(chosen)]
        moved = offsets + _OFFSET_UNIT * (x[len(chosen) :] - 1.0)
        runs = self._runs(factors)
        parts = []
        for log, run, offset, used in zip(self._logs, runs, moved, self._training, strict=True):
            parts.append((run.record.joints(log.time - offset, View.CONTROLLER) - log.joints)[used].ravel())
        found = np.concatenate(parts)
        self._progress(f"try {self.evaluations}, rms {np.degrees(np.sqrt(np.mean(found**2))):.4f} deg")
        return found

    def sigmas(self, jacobian: FloatArray, residuals: FloatArray) -> FloatArray:
        """Gives the standard uncertainties of the factors and offsets, residuals within CORRELATED s counted as one."""
        rate = 1.0 / float(np.median(np.concatenate([np.diff(log.time) for log in self._logs])))
        variance = float(np.mean(residuals**2)) * max(rate * CORRELATED, 1.0)
        singular, right = np.linalg.svd(jacobian, full_matrices=False)[1:]
        weak = singular <= 1e-6 * singular.max(initial=0.0)
        found = np.sqrt(variance * np.sum((right[~weak].T / singular[~weak]) ** 2, axis=1))
        blind = np.sum(right[weak] ** 2, axis=0)
        return np.asarray(np.where(blind > 1e-3, 1e3 * (1.0 + blind), found))

    def misfit(self, runs: Sequence[ProgramRun], offsets: FloatArray) -> Misfit:
        """Gives what runs of the fitted model leave unexplained beside the logs' noise."""
        fitted, out, moves, seconds = [], [], 0, 0.0
        for log, run, offset, used in zip(self._logs, runs, offsets, self._training, strict=True):
            time = log.time - offset
            left = run.record.joints(time, View.CONTROLLER) - log.joints
            fitted.append(left[used].ravel())
            out.append(left[~used].ravel())
            moves += int((~held_out(run)).sum())
            seconds += float(used.sum()) * float(np.median(np.diff(log.time)))
        sizes = [float(np.sqrt(np.mean(np.concatenate(parts) ** 2))) if any(map(len, parts)) else 0.0 for parts in (fitted, out)]
        noise = float(np.sqrt(np.mean([noise_of(log.joints) ** 2 for log in self._logs])))
        return Misfit(noise, sizes[0], sizes[1], moves, seconds)

    def _runs(self, factors: FloatArray) -> list[ProgramRun]:
        key = tuple(factors.tolist())
        if key not in self._known:
            model = with_factors(self._base, self._parameters, factors)
            self._known = {key: [_ran(log, model) for log in self._logs]} if len(self._known) > 2 * len(factors) else self._known
            self._known.setdefault(key, [_ran(log, model) for log in self._logs])
            self.evaluations += 1
        return self._known[key]

    def _trained(self, log: JointLog) -> BoolArray:
        """Gives which samples (N,) are fitted to: those of moves that are not held out, by the base model's times."""
        run = _ran(log, self._base)
        offset = _first_offset(log, run)
        out = held_out(run)
        return np.asarray(~out[run.record.move_at(log.time - offset)])
