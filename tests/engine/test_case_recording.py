"""What a case's recording keeps of its runs comes back, also the moves, outputs and frames that the oracle expects."""

import numpy as np
import pytest

from mitl.engine.case_recording import RecordedRun, moves_of, recording_of, runs_of, signals_of, write
from mitl.paths import PosePath
from mitl.protocols import Oracle, ProgrammedMove
from mitl.recording.mcap_reader import read_recording

POSE = np.array([0.5, 0.0, 0.4, 1.0, 0.0, 0.0, 0.0])
TIME = np.linspace(0.0, 2.0, 50)
PATH = PosePath(TIME, np.zeros((50, 3)), np.tile(POSE[3:], (50, 1)), np.ones(50, dtype=bool))


def move(line, begins):
    return ProgrammedMove("MoveL", POSE, None, POSE, 0.1, 0.0, "M", line, begins, begins + 1.0)


ORACLE = Oracle(
    PATH,
    POSE,
    POSE,
    (move(7, -0.1), move(9, 1.0), move(12, 1.0)),
    {"doA": (np.array([0.0, 1.5]), np.array([0.0, 1.0])), "doB": (np.array([0.0, 0.5, 1.5]), np.array([1.0, 0.0, 1.0]))},
)


def recorded(tmp_path, *names):
    runs = [
        RecordedRun(name, PATH, PATH, PATH, 10.0, moves_of(ORACLE), signals_of(ORACLE), 3.5 + number, POSE, 2 * POSE)
        for number, name in enumerate(names)
    ]
    write(tmp_path / "a.mcap", recording_of(runs, paths={}, series={}, log=[], metadata={}, attachments={}))
    return runs_of(read_recording(tmp_path / "a.mcap"))


@pytest.mark.parametrize("names", [("only one",), ("turning", "not turning")])
def test_moves_outputs_and_frames_come_back_at_the_recorded_time(tmp_path, names):
    for number, run in enumerate(recorded(tmp_path, *names)):
        assert run.shift == 10.0
        assert run.began == 3.5 + number
        assert run.moves.columns == ("move", "line")
        assert run.moves.time.tolist() == [10.0, 11.0]
        assert run.moves.column("line").tolist() == [7.0, 12.0]
        assert run.signals.time.tolist() == [10.0, 10.5, 11.5]
        assert run.signals.column("doA").tolist() == [0.0, 0.0, 1.0]
        assert run.signals.column("doB").tolist() == [1.0, 0.0, 1.0]
        assert run.X_FT.tolist() == POSE.tolist()
        assert run.X_BO.tolist() == (2 * POSE).tolist()


def test_a_program_without_motion_or_outputs_has_none():
    empty = Oracle(PATH, POSE, POSE, ())
    assert (moves_of(empty), signals_of(empty)) == (None, None)


def test_facts_that_are_no_json_count_as_missing(tmp_path):
    metadata = {"oracle shift x": "rubbish", "tool x": "[1,2]", "order given x": "true"}
    write(
        tmp_path / "a.mcap",
        recording_of([RecordedRun("x", PATH, None, None)], paths={}, series={}, log=[], metadata=metadata, attachments={}),
    )
    (run,) = runs_of(read_recording(tmp_path / "a.mcap"))
    assert (run.shift, run.began, run.X_FT, run.moves) == (0.0, None, None, None)
