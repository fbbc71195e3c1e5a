"""The rig of a run that is judged again: recorded tapes, and oracles that are computed anew.

Invariant: neither a controller nor a tracker is reached, so that nothing can move.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from mitl.engine.record import RunRecord
from mitl.engine.replaying import ReplayedRig, replayed_rig
from mitl.engine.results import read_run
from mitl.engine.run import installed_versions
from mitl.engine.tape import ATTACHMENT, Tape, decoded
from mitl.errors import RigError, UsageError
from mitl.motion.oracles import PlannedOracles
from mitl.motion.robot_model import RobotModel, load_robot_model
from mitl.protocols import OracleSource
from mitl.recording import read_recording
from mitl.rig.config import read_rig
from mitl.rig.environment import robot_files
from mitl.rig.load import cell_of
from mitl.rig.physical_config import is_physical, read_physical


@dataclass(frozen=True)
class RecordedRig:
    """A run's folder, as a rig to judge by."""

    folder: Path
    run: RunRecord

    def tape_of(self, case_id: str) -> Tape:
        """Gives a case's tape. Raises RigError where the run has no recording of the case, or one without a tape."""
        case = next((case for case in self.run.cases if case.id == case_id), None)
        if case is None or case.recording is None:
            raise RigError(f"{self.folder} has no recording of {case_id}")
        file = self.folder / case.recording
        content = read_recording(file).attachments.get(ATTACHMENT)
        if content is None:
            raise RigError(f"{file} does not hold what the rig told the case: it was recorded before mitl kept that, or by another program")
        return decoded(content, str(file))

    def first_tape(self) -> Tape:
        """Gives any tape of the run. Raises UsageError where there is none."""
        for case in self.run.cases:
            try:
                return self.tape_of(case.id)
            except RigError:
                continue
        raise UsageError(f"{self.folder}: no case has a recording that can be judged again")

    def rig(self, oracles: OracleSource, facts: dict[str, str], model: RobotModel) -> ReplayedRig:
        """Gives the rig. Its versions are the recorded ones of what is not here; of what judges, the record has today's."""
        return replayed_rig(
            self.tape_of,
            oracles,
            facts=facts,
            name=self.run.rig,
            robot=model.name,
            seed=self.run.seed,
            versions={
                **{name: told for name, told in self.run.versions.items() if name not in installed_versions()},
                **robot_files(model.folder),
            },
        )


def recorded_rig(folder: Path) -> RecordedRig:
    """Gives the run in a folder. Raises UsageError where there is none."""
    return RecordedRig(folder, read_run(folder))


def oracles_for(run: RunRecord, rig: str | None, robot: str | None) -> tuple[OracleSource, RobotModel]:
    """Gives the source of oracles, and its robot model: that of a rig file or built-in rig, or else of the run.

    robot: another robot model. Raises UsageError where there is no such rig or robot.
    """
    if rig is not None and is_physical(rig):
        model = load_robot_model(robot or read_physical(Path(rig)).robot)
        return PlannedOracles(model), model
    named = rig or run.rig
    if rig is None and named != "sim":
        model = load_robot_model(robot or run.robot)
        return PlannedOracles(model), model
    config = read_rig(named)
    model = load_robot_model(robot or (config.robot if rig is not None else run.robot))
    cell = cell_of(config)
    return PlannedOracles(model, cell.conveyors if cell else ()), model
