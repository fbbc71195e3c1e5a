"""The cell of `mitl serve --poses`: the virtual controller's arm with a simulated tracker on it, whose samples go to a PoseFeed.

Invariant: the tracker knows nothing of the controller but the arm's true motion, as in the simulated rig.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from mitl.controllers.faults import Fault
from mitl.controllers.simulated import SimulatedController
from mitl.controllers.virtual.cell import VirtualCell
from mitl.motion.robot_model import load_robot_model
from mitl.rig.load import UrdfJoints, placement
from mitl.samples import TrackerSamples
from mitl.simulation.tracker_model import Session, TrackerModel
from mitl.simulation.tracker_parameters import load_preset
from mitl.simulation.world import World
from mitl.trackers.pose_feed import FedDevice, PoseFeed

SERIAL = "LHR-MITL0001"


def tracked_cell(
    robot: str,
    preset: str,
    seed: int,
    file: Path,
    *,
    faults: Sequence[Fault] = (),
    signals: Mapping[str, str] | None = None,
    now: Callable[[], float] = time.monotonic,
) -> tuple[VirtualCell, PoseFeed]:
    """Gives a cell and its feed into `file`. Virtual time must pass with the wall's from now on, because the feed's times are its.

    Raises UsageError for an unknown robot or preset.
    """
    model = load_robot_model(robot)
    controller = SimulatedController(model, faults)
    X_WL, X_FM = placement(seed)
    sensor = TrackerModel(load_preset(preset), seed, Session(seed, 0.0))
    world = World(model.urdf, UrdfJoints(model, controller), sensor, X_WL=X_WL, X_FM=X_FM)
    controller.connect(world)
    world.add(controller)
    feed = PoseFeed(file, (FedDevice(SERIAL),))
    begins: list[float] = []

    def receive(samples: TrackerSamples) -> None:
        if not begins:
            begins.append(now() - world.now())
        feed.write(0, samples.path.time + begins[0], samples)

    world.subscribe(receive)
    return VirtualCell(controller, world, model, signals), feed
