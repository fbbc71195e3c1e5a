"""The public data set's text formats, and what `mitl characterise` makes of them."""

import json

import numpy as np
import pytest

from mitl.cli import run
from mitl.errors import UsageError
from mitl.recording.read import read_path, read_tracker_recordings
from mitl.recording.vive_text import read_vive_text

POINT = "# x y z w j i k Freq: 250 current Time: 2020-09-18-14:23:25"
MATRIX = "# 3x4 first row second row third row Freq: 5 current Time: 2020-10-02-12:40:51"


def written(folder, *lines):
    file = folder / "point.txt"
    file.write_text("\n".join(lines) + "\n")
    return file


def test_a_still_point_has_nominal_times_and_the_scalar_first(tmp_path):
    path = read_path(written(tmp_path, POINT, "1 2 3 0.6 0.8 0 0", "1 2 4 0.6 0 0.8 0"))
    assert path.time == pytest.approx([0.0, 0.004])
    assert path.position.tolist() == [[1, 2, 3], [1, 2, 4]]
    assert path.quaternion_wxyz[1] == pytest.approx([0.6, 0, 0.8, 0])


def test_a_pose_matrix_goes_row_by_row(tmp_path):
    path = read_vive_text(written(tmp_path, MATRIX, "0 -1 0 7 1 0 0 8 0 0 1 9"))
    assert path.position[0] == pytest.approx([7, 8, 9])
    assert path.quaternion_wxyz[0] == pytest.approx([np.sqrt(0.5), 0, 0, np.sqrt(0.5)])


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ([POINT], "no pose in this file"),
        ([POINT, "1 2 3"], r"point\.txt:2: expected 7 numbers, got 3"),
        ([POINT, "1 2 3 1 0 0 x"], r"point\.txt:2: expected 7 numbers"),
        ([POINT, "1 2 3 1 0 0 0", "1 2 3 5 0 0 0"], r"point\.txt:3: expected a unit quaternion"),
        ([MATRIX, "1 0 0 7 1 0 0 8 0 0 1 9"], r"point\.txt:2: expected a pose matrix"),
        ([POINT.replace("250", "0")], "expected a rate in Hz"),
        (["some words"], "unknown format: expected MCAP, our CSV"),
    ],
)
def test_what_is_wrong_is_named(tmp_path, lines, message):
    with pytest.raises(UsageError, match=message):
        read_path(written(tmp_path, *lines))


def test_characterise_tells_one_and_several_recordings(tmp_path, capsys):
    random = np.random.default_rng(1)
    rows = ["{} {} {} 1 0 0 0".format(*row) for row in random.normal(size=(600, 3)) * 1e-4]
    file = written(tmp_path, POINT, *rows)
    assert read_tracker_recordings(file)[0].nominal
    assert run(["characterise", str(file), str(file), "--format", "json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [each["samples"] for each in told["recordings"]] == [600, 600]
    assert told["recordings"][0]["rate_is_nominal"]
    assert told["together"]["jitter"][0]["window_s"] == 0.1
    assert told["together"]["mean_500ms_sd_m"] < 1e-4
    assert run(["characterise", str(file)]) == 0
    out = capsys.readouterr().out
    assert "nominal: the file has no times" in out
    assert "500 ms: 0." in out
    assert run(["characterise", str(tmp_path / "none.txt")]) == 2
    assert "none.txt: cannot be read" in capsys.readouterr().err
