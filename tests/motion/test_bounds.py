"""The bound of every sample of an oracle: by kind of motion and speed, from the model's provenance."""

import numpy as np
import pytest

import rapid_interp
from mitl.errors import UsageError
from mitl.motion.accuracy import UNKNOWN, Band, Kind, ModelAccuracy, load_accuracy
from mitl.motion.bounds import bounds_at
from mitl.motion.offline import run_until, start_run
from mitl.motion.robot_model import load_robot_model
from mitl.protocols import OracleAccuracy

BANDS = tuple(
    Band(kind, up_to, path=number * factor * 1e-4, turn=number * factor * 1e-5, time=number * 1e-3)
    for number, kind in enumerate(Kind, start=1)
    for up_to, factor in ((0.25, 1), (0.5, 10))
)


def test_a_sample_takes_the_slowest_band_that_covers_it_and_beyond_the_fastest_grows_with_the_square():
    known = ModelAccuracy(OracleAccuracy(9.0, 9.0, 9.0, 9.0), BANDS[2:4])
    found = known.bounds((Kind.LINE,) * 3 + (Kind.ARC,), np.array([0.1, 0.4, 1.0, 0.1]))
    np.testing.assert_allclose(found.path, [2e-4, 2e-3, 8e-3, 9.0])
    np.testing.assert_allclose(found.turn, [2e-5, 2e-4, 8e-4, 9.0])
    np.testing.assert_allclose(found.time, [2e-3, 2e-3, 2e-3, 9.0])


def middle(move, share=0.5):
    return move.begins + share * (move.ends - move.begins)


def test_lines_arcs_joint_moves_corners_and_standstill_have_their_own(rapid):
    text = rapid.program(
        rapid.joint(450, 0, 400),
        "WaitTime 1;",
        rapid.line(450, 200, 400, zone="z50", speed="v200"),
        rapid.line(300, 200, 400),
        "WaitTime 1;",
        rapid.arc((350, 150, 400), (400, 200, 400), speed="v200"),
    )
    run = start_run(rapid_interp.load_text(text, "m.mod").start().run(), load_robot_model("irb140"))
    run_until(run, 60.0)
    first, second, third, fourth = run.record.moves
    times = [
        middle(first, 0.5),
        first.ends + 0.6,
        middle(second, 0.3),
        second.ends,
        middle(third, 0.5),
        third.ends + 0.6,
        middle(fourth, 0.5),
    ]
    known = ModelAccuracy(UNKNOWN, tuple(Band(kind, 9.0, number, 0.0, 0.0) for number, kind in enumerate(Kind, start=1)))
    found = bounds_at(run.record, run.planner.arm, known, np.array(times))
    numbers = {kind: number for number, kind in enumerate(Kind, start=1)}
    assert [
        numbers[kind] for kind in (Kind.JOINT, Kind.STILL, Kind.LINE, Kind.CORNER, Kind.LINE, Kind.STILL, Kind.ARC)
    ] == found.path.tolist()


def test_a_model_with_figures_says_less_at_low_speed_than_one_without_and_more_when_fast():
    log, scaled, none = (load_accuracy(load_robot_model(name).folder) for name in ("irb140", "irb6640_180_255", "irb2400"))
    slow, fast = (tuple(known.bounds((Kind.LINE,), np.array([v])).path[0] for known in (log, scaled, none)) for v in (0.05, 1.5))
    assert max(slow[:2]) < slow[2]
    assert fast[0] > slow[0]
    assert fast[1] > slow[1]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('band = [{ kind = "spin" }]', r"\[\[oracle.band\]\] 1 kind must be one of still, line, arc, joint, corner, is 'spin'"),
        ('band = [{ kind = "arc", up_to_mm_s = -1 }]', r"\[\[oracle.band\]\] 1 up_to_mm_s must be a number of 0 or more, is -1"),
        ("band = 3", r"\[\[oracle.band\]\] must be tables"),
    ],
)
def test_what_a_file_says_wrongly_is_told(tmp_path, text, told):
    (tmp_path / "provenance.toml").write_text(f"[oracle]\npath_mm = 1\ntime_ms = 1\nspeed_per_cent = 1\n{text}\n")
    with pytest.raises(UsageError, match=told):
        load_accuracy(tmp_path)
