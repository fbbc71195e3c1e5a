"""The cell of `mitl serve --poses`: the virtual controller's arm with a simulated tracker on it, whose samples go to a PoseFeed.

Invariant: the tracker knows nothing of the controller but the arm's true motion, as in the simulated rig.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from mitl.controllers.faults import Fault
from mitl.controllers.simulated import SimulatedController
from mitl.controllers.virtual.cell import VirtualCell
from mitl.motion.robot_model import load_robot_model
from mitl.rig.config import RigConfig
from mitl.rig.load import UrdfJoints, placement
from mitl.samples import TrackerSamples
from mitl.simulation.tracker_button import ButtonInput, WiredButton
from mitl.simulation.tracker_model import Session, TrackerModel
from mitl.simulation.tracker_parameters import load_preset
from mitl.simulation.world import World
from mitl.trackers.pose_feed import FedDevice, PoseFeed

SERIAL = "LHR-MITL0001"
_FELL_BEHIND = 0.2
"""Seconds by which the cell's time must have fallen behind the wall's for the samples' to follow; below, it is jitter."""


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
    usual = RigConfig("virtual", robot)
    lines = {
        button: WiredButton(
            partial(controller.output_changes, signal),
            ButtonInput(load_preset(preset).button, seed, button),
            above=usual.thresholds.get(signal, 0.0),
        )
        for signal, button in usual.buttons.items()
    }
    offset = [-math.inf]

    def receive(samples: TrackerSamples) -> None:
        """Hands samples over on the wall's clock; where the cell fell behind it, from then on later."""
        ahead = now() - world.now()
        if ahead > offset[0] + _FELL_BEHIND:
            offset[0] = ahead
        bits = np.zeros(len(samples.path), dtype=np.int16)
        for button, line in lines.items():
            bits |= line.states(samples.path.time) << button
        feed.write(0, samples.path.time + offset[0], samples, bits)

    world.subscribe(receive)
    return VirtualCell(controller, world, model, signals), feed
