"""The dry run: all that a run does to a physical rig but the start. The programs go onto the controller and are linked there, tools and
work objects are compared, and every order is pre-flown from where the robot stands.

Invariant: nothing is started, no motor is switched, no speed is set; the controller's program is put back as it was found.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mitl.controllers.rws.controller import RwsController
from mitl.controllers.rws.credentials import find_credentials
from mitl.errors import MitlError
from mitl.motion.robot_model import RobotModel, load_robot_model
from mitl.paths import FloatArray
from mitl.protocols import ExecutionState
from mitl.rig.doctor import Finding, State, examine
from mitl.rig.frames import compare_frames
from mitl.rig.heartbeat import with_heartbeat
from mitl.rig.monotonic_clock import MonotonicClock
from mitl.rig.order_spy import Told
from mitl.rig.physical_config import PhysicalConfig
from mitl.rig.remote import transport_to
from mitl.rig.shadow import ORDER, Shadow


def dry_run(config: PhysicalConfig, told: Sequence[Told], out: Path, seconds: float) -> list[Finding]:
    """Gives the doctor's findings, then of each program how it loaded and how its orders flew. told: what a run would."""
    findings = examine(config, out, seconds)
    if findings[0].state is State.BAD:
        return findings  # there is no controller to go on with
    controller = RwsController(transport_to(config.controller, find_credentials), MonotonicClock())
    try:
        if controller.state() is ExecutionState.RUNNING:
            return [*findings, Finding("programs", State.BAD, "RAPID is executing: stop it first")]
        joints = controller.joints()
        for sources in dict.fromkeys(one.sources for one in told if one.started):
            findings.append(_on_controller(config, controller, sources))
            findings.append(_flown(config, load_robot_model(config.robot), joints, [one for one in told if one.sources == sources]))
    finally:
        controller.close()
    return findings


def _on_controller(config: PhysicalConfig, controller: RwsController, sources: Sequence[Path]) -> Finding:
    """Loads a program as a run would and compares its frames."""
    name = _name(sources)
    device = config.egm.device if config.egm is not None else ""
    try:
        with tempfile.TemporaryDirectory(prefix="mitl-program-") as folder:
            controller.load(with_heartbeat(sources, Path(folder), config.safety.heartbeat_s, egm_device=device))
        count = compare_frames(sources, controller.read)
    except MitlError as error:
        return Finding(name, State.BAD, str(error))
    return Finding(name, State.GOOD, f"loaded and linked, {count} tools and work objects agree")


def _flown(config: PhysicalConfig, model: RobotModel, joints: FloatArray, told: Sequence[Told]) -> Finding:
    """Pre-flies all that is told to a program, each time from where the robot stands now."""
    name = f"{_name(told[0].sources)}, orders"
    corners = np.array(config.safety.workspace_mm) / 1000.0
    orders, way, lasts = 0, 0.0, 0.0
    try:
        for one in told:
            if not one.started:
                continue
            shadow = Shadow(one.sources, model, joints, corners if corners.size else None)
            flown = [shadow.begin()]
            for variable, literal in one.writes:
                if variable.lower() == ORDER and literal.strip() != "0":
                    flown.append(shadow.fly(literal))
                    orders += 1
                else:
                    shadow.write(variable, literal)
            lasts += shadow.duration
            way += sum(float(np.linalg.norm(np.diff(part, axis=0), axis=1).sum()) for part in flown)
    except MitlError as error:
        return Finding(name, State.BAD, str(error))
    return Finding(name, State.GOOD, f"{orders} orders pre-flown: {way:.1f} m of the flange, {lasts / 60:.1f} min at full speed")


def _name(sources: Sequence[Path]) -> str:
    return " ".join(source.name for source in sources)
