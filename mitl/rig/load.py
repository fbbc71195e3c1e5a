"""Builds the rig that a config describes. Everything random about it comes from the seed."""

from __future__ import annotations

import platform
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from mitl import __version__
from mitl.controllers.faults import parse_fault
from mitl.controllers.simulated import SimulatedController
from mitl.engine.calibration_session import CASE_ID as CALIBRATION
from mitl.motion.oracles import PlannedOracles
from mitl.motion.robot_model import RobotModel, load_robot_model
from mitl.paths import FloatArray
from mitl.poses import pose_of
from mitl.protocols import Rig
from mitl.rig.config import read_rig
from mitl.simulation.arm import kinematic_arm
from mitl.simulation.dynamic_arm import dynamic_arm
from mitl.simulation.process import JointSource
from mitl.simulation.tracker_model import Session, TrackerModel
from mitl.simulation.tracker_parameters import load_preset
from mitl.simulation.world import World
from mitl.trackers.simulated import SimulatedTracker, TrackerClock

_CASES_BEGIN = 300.0
"""Seconds after the session's beginning, with the calibration, at which every simulated case begins: the tracker has drifted since."""
_PACKAGES = ("drake", "numpy", "scipy", "ruckig", "mcap", "pytest", "py-opw-kinematics")


def load_rig(name_or_file: str, seed: int, faults: Sequence[str]) -> Rig:
    """Gives the rig `sim` or the one that a rig file describes, its controller broken by `faults` (NAME or NAME=SIZE).

    Raises UsageError for a bad file, robot, tracker preset or fault.
    """
    config = read_rig(name_or_file)
    broken = [parse_fault(text) for text in faults]
    model = load_robot_model(config.robot)
    parameters = load_preset(config.tracker)
    controller = SimulatedController(model, broken)
    X_WL, X_FM = _placement(seed)
    arm = dynamic_arm(X_FM) if config.fidelity == "dynamic" else kinematic_arm
    world = World(model.urdf, _UrdfJoints(model, controller), TrackerModel(parameters, seed), X_WL=X_WL, X_FM=X_FM, arm=arm)
    controller.connect(world)
    world.add(controller)
    tracker = SimulatedTracker(world, TrackerClock.drawn(parameters, seed))

    def begin_case(case_id: str) -> None:
        """Starts the simulation over with noise of its own for this case, so that its numbers do not depend on which cases ran before."""
        begins = 0.0 if case_id == CALIBRATION else _CASES_BEGIN
        world.restart(begins)
        controller.reset()
        own = int(np.random.SeedSequence([seed, zlib.crc32(case_id.encode())]).generate_state(1)[0])
        tracker.reseed(parameters, own, Session(seed, begins))

    return Rig(
        name=config.name,
        robot=model.name,
        seed=seed,
        controller=controller,
        tracker=tracker,
        clock=world,
        oracles=PlannedOracles(model),
        begin_case=begin_case,
        versions={"mitl": __version__, "python": platform.python_version(), **{name: version(name) for name in _PACKAGES}},
    )


@dataclass(frozen=True)
class _UrdfJoints:
    """A joint source that gives the angles between the links, as the URDF has them, for a source of RAPID's joints."""

    model: RobotModel
    source: JointSource

    def joints_at(self, time: float) -> FloatArray:
        return self.model.between_links(self.source.joints_at(time))


def _placement(seed: int) -> tuple[FloatArray, FloatArray]:
    """Gives X_WL and X_FM (7,): where the tracker's base and the tracked body were put this time; neither is known to a test case.

    The base stands about 2 m away, the body sits on the flange a hand's breadth off its axis, both turned any way.
    """
    random = np.random.default_rng([seed, 0x9C])
    turn_L, turn_M = (Rotation.random(rng=random) for _ in range(2))
    p_WL = np.array([2.0, 0.0, 1.5]) + random.uniform(-0.5, 0.5, 3)
    p_FM = np.array([0.0, 0.0, 0.08]) + random.uniform(-0.04, 0.04, 3)
    return pose_of(RigidTransform.from_components(p_WL, turn_L)), pose_of(RigidTransform.from_components(p_FM, turn_M))
