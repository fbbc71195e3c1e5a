"""Builds the physical rig that a rig file describes: RWS and OpenVR, guarded."""

from __future__ import annotations

import os
import platform
import socket
import sys
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from urllib.parse import urlsplit

from mitl import __version__
from mitl.controllers.egm.receiver import EgmReceiver
from mitl.controllers.rws.controller import RwsController
from mitl.controllers.rws.credentials import find_credentials
from mitl.engine.calibration_session import CASE_ID as CALIBRATION
from mitl.errors import RigError, UsageError
from mitl.motion.oracles import PlannedOracles
from mitl.motion.robot_model import load_robot_model
from mitl.protocols import Rig
from mitl.rig.environment import robot_files
from mitl.rig.guarded import GuardedController
from mitl.rig.guardian import Guardian
from mitl.rig.monotonic_clock import MonotonicClock
from mitl.rig.nudge import WAKES
from mitl.rig.physical_config import PhysicalConfig, read_physical
from mitl.rig.remote import transport_to
from mitl.trackers.openvr_runtime import OpenVrRuntime, PoseSource, Universe
from mitl.trackers.openvr_tracker import OpenVrTracker

_LOOK_AGAIN = 1.0
_NUDGE_EVERY = 60.0
"""Seconds between two nudges of a tracker that did not wake of the first: it may be hidden instead, or out of power."""
_PACKAGES = ("drake", "numpy", "scipy", "ruckig", "openvr", "httpx")


def load_physical(file: Path, seed: int, faults: Sequence[str], *, armed: bool = False) -> Rig:
    """Gives a physical rig. Unarmed it can be asked anything and moves nothing. Raises UsageError and RigError.

    faults are refused: a physical controller is broken at its own place, a virtual one by `mitl serve --fault`.
    """
    if faults:
        raise UsageError("--fault breaks the simulated controller; a virtual one behind a rig file takes it at mitl serve --fault")
    config = read_physical(file)
    model = load_robot_model(config.robot)
    clock = MonotonicClock()
    ours = transport_to(config.controller, find_credentials)
    first, second = (RwsController(transport, clock) for transport in (ours, transport_to(config.controller, find_credentials)))
    tracker = open_tracker(config, clock)

    def guardian() -> Guardian:
        return Guardian(config.controller, lambda: ours.session)

    controller = GuardedController(first, second, config, model, tracker, clock, armed=armed, guardian=guardian)
    robotware, _ = first.system()
    feedback = open_feedback(config)

    def frame() -> int:
        """Gives the tracker's frame once the rig is there: each case asks before it begins."""
        await_rig(controller, tracker, clock, config.patience_s)
        return tracker.frame

    def begin_case(case_id: str) -> None:
        """Waits for the rig and sets the speed of what follows."""
        await_rig(controller, tracker, clock, config.patience_s)
        controller.begin(first=case_id == CALIBRATION)

    def close() -> None:
        """Puts everything back, also where one of the steps fails."""
        try:
            controller.close()
        finally:
            tracker.close()
            if feedback is not None:
                feedback.close()

    return Rig(
        name=config.name,
        robot=model.name,
        seed=seed,
        controller=controller,
        tracker=tracker,
        clock=clock,
        oracles=PlannedOracles(model),
        begin_case=begin_case,
        frame=frame,
        versions={
            "mitl": __version__,
            "python": platform.python_version(),
            "RobotWare": robotware,
            "controller serial": first.identity(),
            "tracker serial": tracker.device.serial,
            **robot_files(model.folder),
            **_installed(),
        },
        calibration=config.folder / config.calibration if config.calibration else None,
        feedback=feedback,
        close=close,
        health=config.health,
    )


def await_rig(controller: GuardedController, tracker: OpenVrTracker, clock: MonotonicClock, patience: float) -> None:
    """Waits until the controller answers and the tracker sees. Raises RigError with what is missing after `patience` s.

    A SteamVR that was started again is taken on with its new frame, for which `Rig.frame` then gives another number. A tracker that shows
    nothing may be asleep: the robot, if it is armed, nudges it.
    """
    until = clock.now() + patience
    nudge_at = clock.now()
    while True:
        try:
            controller.look()
            if tracker.restarted:
                tracker.accept_frame()
            try:
                tracker.latest()
            except RigError:
                if not controller.armed or clock.now() < nudge_at or clock.now() >= until:
                    raise
                nudge_at = clock.now() + _NUDGE_EVERY
                controller.nudge()
                clock.wait(WAKES)
                tracker.latest()
        except RigError as error:
            if clock.now() >= until:
                raise RigError(f"the rig is not there, also after {patience:g} s: {error}") from error
            clock.wait(_LOOK_AGAIN)
        else:
            return


def open_feedback(config: PhysicalConfig) -> EgmReceiver | None:
    """Gives the receiver of the controller's own view, listening, or None where the rig file names none."""
    if config.egm is None:
        return None
    host = urlsplit(config.controller.address).hostname or ""
    try:
        controller = socket.getaddrinfo(host, None, type=socket.SOCK_DGRAM)[0][4][0]
    except OSError as error:
        raise RigError(f"EGM: {host}: {error.strerror or error}") from error
    return EgmReceiver(config.egm.host, int(config.egm.port), controller=str(controller))


def open_tracker(config: PhysicalConfig, clock: MonotonicClock) -> OpenVrTracker:
    """Gives the rig file's tracker, sampling."""
    wanted = config.tracker
    universe, source = Universe(wanted.universe), PoseSource(wanted.source)
    return OpenVrTracker(lambda: OpenVrRuntime(universe, source), clock, serial=wanted.serial, rate=wanted.rate_hz)


def may_arm(file: Path, *, terminal: bool | None = None) -> None:
    """Raises UsageError where --arm was given without a terminal and the rig file does not allow unattended runs."""
    attended = (sys.stdin.isatty() and sys.stderr.isatty()) if terminal is None else terminal
    if not attended and not read_physical(file).safety.unattended:
        raise UsageError(f"--arm needs a terminal, because somebody must look at the cell; {file} may allow it: [safety] unattended = true")


def _installed() -> dict[str, str]:
    found = {"os": os.uname().sysname}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found
