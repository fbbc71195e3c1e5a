"""Builds the rig that a config describes. Everything random about it comes from the seed."""

from __future__ import annotations

import platform
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib.metadata import version
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from mitl import __version__
from mitl.controllers.faults import parse_fault
from mitl.controllers.simulated import SimulatedController
from mitl.engine.calibration_session import CASE_ID as CALIBRATION
from mitl.errors import UsageError
from mitl.motion.conveyor import Belt
from mitl.motion.oracles import PlannedOracles
from mitl.motion.robot_model import RobotModel, load_robot_model
from mitl.paths import FloatArray
from mitl.poses import pose_of
from mitl.protocols import Rig
from mitl.rig.config import RigConfig, read_rig
from mitl.rig.environment import folder_fingerprint, robot_files, text_fingerprint
from mitl.rig.physical_config import is_physical
from mitl.simulation.arm import kinematic_arm
from mitl.simulation.cell import Cell, load_cell
from mitl.simulation.dynamic_arm import dynamic_arm
from mitl.simulation.process import JointSource
from mitl.simulation.tracker_button import ButtonInput, WiredButton
from mitl.simulation.tracker_model import Session, TrackerModel
from mitl.simulation.tracker_parameters import TrackerParameters, load_preset, load_tracker_parameters
from mitl.simulation.world import HAND, Device, World
from mitl.trackers.simulated import SimulatedTracker, TrackerClock

_CASES_BEGIN = 300.0
"""Seconds after the session's beginning, with the calibration, at which every simulated case begins: the tracker has drifted since."""
_PACKAGES = ("drake", "numpy", "scipy", "ruckig", "mcap", "pytest", "py-opw-kinematics")


def load_rig(name_or_file: str, seed: int, faults: Sequence[str]) -> Rig:
    """Gives the rig `sim` or the one that a rig file describes, its controller broken by `faults` (NAME or NAME=SIZE).

    Raises UsageError for a bad file, robot, tracker preset or fault.
    """
    if is_physical(name_or_file):
        from mitl.rig.physical import load_physical  # noqa: PLC0415 - network and tracker only where they are asked for

        return load_physical(Path(name_or_file), seed, faults)
    config = read_rig(name_or_file)
    broken = [parse_fault(text) for text in faults]
    model = load_robot_model(config.robot)
    presets = {HAND: _preset(config, config.tracker), **{name: _device_preset(config, name) for name in config.devices}}
    cell = cell_of(config)
    belts = {conveyor.name: Belt(conveyor) for conveyor in (cell.conveyors if cell else ())}
    controller = SimulatedController(model, broken, list(belts.values()))
    X_WL, X_FM = placement(seed)
    origin = [0.0]  # when the case began
    models = _tracker_models(presets, seed, Session(seed, 0.0))
    world = World(
        model.urdf,
        UrdfJoints(model, controller),
        models[HAND],
        X_WL=X_WL,
        X_FM=X_FM,
        arm=dynamic_arm(X_FM) if config.fidelity == "dynamic" else kinematic_arm,
        devices=[Device(name, models[name], _way(config, name, lambda: origin[0], belts)) for name in config.devices],
    )
    controller.connect(world)
    world.add(controller)
    clock = TrackerClock.drawn(presets[HAND], seed)  # one computer reads all devices
    trackers = {name: SimulatedTracker(world, clock, device=name) for name in presets}
    _wire(config, trackers[HAND], controller, presets[HAND], seed)

    def begin_case(case_id: str) -> None:
        """Starts the simulation over with noise of its own for this case, so that its numbers do not depend on which cases ran before."""
        begins = 0.0 if case_id == CALIBRATION else _CASES_BEGIN
        world.restart(begins)
        origin[0] = begins
        controller.reset()
        own = int(np.random.SeedSequence([seed, zlib.crc32(case_id.encode())]).generate_state(1)[0])
        for name, fresh in _tracker_models(presets, own, Session(seed, begins)).items():
            trackers[name].begin(fresh)
        _wire(config, trackers[HAND], controller, presets[HAND], own)

    return Rig(
        name=config.name,
        robot=model.name,
        seed=seed,
        controller=controller,
        tracker=trackers[HAND],
        clock=world,
        oracles=PlannedOracles(model, cell.conveyors if cell else ()),
        begin_case=begin_case,
        versions={
            "mitl": __version__,
            "python": platform.python_version(),
            **{name: version(name) for name in _PACKAGES},
            **robot_files(model.folder),
            **_simulated_with(config, presets, cell),
        },
        devices={name: tracker for name, tracker in trackers.items() if name != HAND},
        calibration=config.folder / config.calibration if config.calibration else None,
        calibration_program=_calibration_program(config, model),
        health=config.health,
    )


def _calibration_program(config: RigConfig, model: RobotModel) -> Path | None:
    """Gives the program with the calibration poses: the rig's own, that of its robot, or None for the IRB 140's, which is the default."""
    if config.poses:
        file = config.folder / config.poses
        if not file.is_file():
            raise UsageError(
                f"rig {config.name}: poses = {config.poses!r}: there is no {file}; make one: mitl calibrate --plan --robot ..."
            )
        return file
    file = model.folder / "calibration.mod"
    return file if file.is_file() else None


def _simulated_with(config: RigConfig, presets: Mapping[str, TrackerParameters], cell: Cell | None) -> dict[str, str]:
    """Gives what the simulation was made of: tracker models, cell, fidelity."""
    names = {HAND: config.tracker, **{name: config.devices[name].tracker or config.tracker for name in config.devices}}
    found = {f"tracker model of {name}": text_fingerprint(Path(names[name]).stem, repr(preset)) for name, preset in presets.items()}
    if cell is not None:
        found["cell"] = folder_fingerprint(cell.model.parent)
    return {"fidelity": config.fidelity, **found}


def _preset(config: RigConfig, name: str) -> TrackerParameters:
    """Gives a preset by its name, or from a file beside the rig file."""
    return load_tracker_parameters(config.folder / name) if name.endswith(".toml") else load_preset(name)


def _device_preset(config: RigConfig, name: str) -> TrackerParameters:
    """Gives the preset of a further device. ASSUMPTION A-185: it is a puck on a stand or a belt, which neither sleeps nor creeps."""
    found = _preset(config, config.devices[name].tracker or config.tracker)
    return replace(found, sleep=replace(found.sleep, after_s=0.0), creep=replace(found.creep, rate_m_s=0.0))


def _tracker_models(presets: Mapping[str, TrackerParameters], seed: int, session: Session) -> dict[str, TrackerModel]:
    """Gives sensor models with the seed's noise for all devices; the first, the hand's, leads the frame of all."""
    (hand, first), *others = presets.items()
    leader = TrackerModel(first, seed, session)
    followers = {
        name: TrackerModel(preset, seed, session, device=number, leader=leader) for number, (name, preset) in enumerate(others, start=1)
    }
    return {hand: leader, **followers}


def cell_of(config: RigConfig) -> Cell | None:
    """Gives the rig's cell: one that comes with mitl, or one in a folder beside the rig file."""
    beside = config.folder / config.cell
    return load_cell(str(beside) if (beside / "cell.toml").is_file() else config.cell) if config.cell else None


def _way(config: RigConfig, name: str, begun: Callable[[], float], belts: Mapping[str, Belt]) -> Callable[[float], FloatArray] | FloatArray:
    """Gives where a further device is: X_WM (7,), or a function of the time in s: with its belt, or from `begun()` on at its velocity."""
    device = config.devices[name]
    if device.conveyor:
        if device.conveyor not in belts:
            known = ", ".join(belts) or "none"
            raise UsageError(f"rig {config.name}: [devices.{name}] lies on the conveyor {device.conveyor!r}; its cell has {known}")
        belt = belts[device.conveyor]
        home, direction = np.array([*device.position, 1.0, 0.0, 0.0, 0.0]), np.array([*belt.conveyor.direction, 0.0, 0.0, 0.0, 0.0])
        return lambda time: home + direction * belt.position(time)
    place, velocity = (np.array([*vector, 1.0, 0.0, 0.0, 0.0]) for vector in (device.position, device.velocity))
    velocity[3] = 0.0
    return place if not np.any(velocity) else lambda time: place + velocity * (time - begun())


def _wire(config: RigConfig, tracker: SimulatedTracker, controller: SimulatedController, preset: TrackerParameters, seed: int) -> None:
    """Wires the controller's outputs to the tracker's buttons, with delays from the seed."""
    for signal, button in config.buttons.items():
        line = ButtonInput(preset.button, seed, button)
        tracker.wire(button, WiredButton(partial(controller.output_changes, signal), line, above=config.thresholds.get(signal, 0.0)))


@dataclass(frozen=True)
class UrdfJoints:
    """A joint source that gives the angles between the links, as the URDF has them, for a source of RAPID's joints."""

    model: RobotModel
    source: JointSource

    def joints_at(self, time: float) -> FloatArray:
        """Gives the angles (6,) in rad at `time` s."""
        return self.model.between_links(self.source.joints_at(time))


def placement(seed: int) -> tuple[FloatArray, FloatArray]:
    """Gives X_WL and X_FM (7,): where the tracker's base and the tracked body were put this time; neither is known to a test case.

    The base stands about 2 m away, the body sits on the flange a hand's breadth off its axis, both turned any way.
    """
    random = np.random.default_rng([seed, 0x9C])
    turn_L, turn_M = (Rotation.random(rng=random) for _ in range(2))
    p_WL = np.array([2.0, 0.0, 1.5]) + random.uniform(-0.5, 0.5, 3)
    p_FM = np.array([0.0, 0.0, 0.08]) + random.uniform(-0.04, 0.04, 3)
    return pose_of(RigidTransform.from_components(p_WL, turn_L)), pose_of(RigidTransform.from_components(p_FM, turn_M))
