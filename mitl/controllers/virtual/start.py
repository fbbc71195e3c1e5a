"""Puts a virtual controller together: robot model, simulated controller, cell, disk, services."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from mitl.controllers.faults import Fault
from mitl.controllers.simulated import SimulatedController
from mitl.controllers.virtual.answers import Dialect, Refused
from mitl.controllers.virtual.cell import VirtualCell
from mitl.controllers.virtual.cell_clock import CellClock
from mitl.controllers.virtual.files import FileService
from mitl.controllers.virtual.service import Service
from mitl.errors import UsageError
from mitl.motion.robot_model import load_robot_model

USERS = ("Default User", "Admin", "admin")
PASSWORD = "robotics"  # noqa: S105 - ABB's published default, which every virtual controller has
"""The password of all users unless another is given."""


def virtual_cell(robot: str, *, faults: Sequence[Fault] = (), signals: Mapping[str, str] | None = None) -> VirtualCell:
    """Gives a cell without a tracker in virtual time. Raises UsageError for an unknown robot."""
    model = load_robot_model(robot)
    controller = SimulatedController(model, faults)
    clock = CellClock()
    controller.connect(clock)
    clock.drive(controller)
    return VirtualCell(controller, clock, model, signals)


def service(cell: VirtualCell, dialect: Dialect, disk: Path, *, password: str = PASSWORD, rate: float = 0.0) -> Service:
    """Gives the services of a cell, its disk in a folder."""
    return Service(cell, FileService(disk), dialect, dict.fromkeys(USERS, password), rate=rate)


def load_at_start(cell: VirtualCell, program: Path) -> None:
    """Loads a folder or file and puts the program pointer to main. Raises UsageError with all that is wrong with it."""
    try:
        cell.load_program(program)
        cell.reset_pointer()
    except Refused as refused:
        found = [entry.text for entry in reversed(cell.log.entries()) if entry.level == "error"]
        raise UsageError("\n".join([f"{program} cannot be loaded: {refused.text}", *found])) from refused
