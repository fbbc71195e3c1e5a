"""Export: what is written comes back the same, and a layout names only what the recording has."""

import json

import numpy as np
import pytest
from google.protobuf import descriptor_pb2
from mcap.reader import make_reader

from mitl.cli import run
from mitl.paths import PosePath
from mitl.recording.csv_file import read_csv
from mitl.recording.mcap_writer import write_recording
from mitl.recording.read import read_path
from mitl.recording.records import LogMessage, PoseTrack, Recording, Series
from mitl.recording.thesis_xml import read_thesis_xml

TIME = np.arange(50) / 25.0
PATH = PosePath(TIME, np.stack([0.1 * TIME, 0.0 * TIME, 0.2 + 0.0 * TIME], axis=1), np.tile([0.6, 0.0, 0.8, 0.0], (50, 1)), TIME != 1.0)
STATE = np.column_stack([np.full(50, 200.0), TIME > 1.5, np.tile([0.1, 0.0, 0.0], (50, 1))])
RECORDING = Recording(
    {"/tracker/pose": PoseTrack(PATH, "tracker", "body"), "/tool/measured": PoseTrack(PATH, "wobj", "tool")},
    {
        "/tracker/state": Series(TIME, STATE, ("result", "buttons", "vx", "vy", "vz")),
        "/rapid/move": Series(np.array([0.0, 1.0]), np.array([[0.0, 7.0], [1.0, 9.0]]), ("move", "line")),
        "/signals": Series(np.array([0.5]), np.array([[1.0]]), ("doPen",)),
        "/check/line-deviation": Series(TIME, TIME[:, None], ("line deviation, fixed mm",)),
    },
    (LogMessage(0.1, "info", "told"),),
)


@pytest.fixture(autouse=True)
def recorded(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_recording(tmp_path / "a.mcap", RECORDING)


@pytest.mark.parametrize("output", ["o.tum", "o.txt", "o.xml"])
def test_the_valid_poses_come_back(tmp_path, output):
    assert run(["export", "a.mcap", "--output", output]) == 0
    back = read_path(tmp_path / output)
    assert np.allclose(back.position, PATH.only_valid().position, atol=1e-9)
    assert np.allclose(back.quaternion_wxyz, PATH.only_valid().quaternion_wxyz, atol=1e-9)
    assert np.allclose(back.time, PATH.only_valid().time, atol=1e-8)


def test_csv_has_moves_outputs_and_speed(tmp_path):
    assert run(["export", "a.mcap", "--output", "o.csv"]) == 0
    table = read_csv(tmp_path / "o.csv")
    assert table.line.tolist() == [7] * 25 + [9] * 24
    assert np.allclose(table.speed, 0.1)
    assert table.signals["doPen"].tolist() == [1.0] * 49


def test_xml_has_the_trackers_buttons_and_velocities(tmp_path):
    assert run(["export", "a.mcap", "--topic", "/tracker/pose", "--output", "o.xml"]) == 0
    samples = read_thesis_xml(tmp_path / "o.xml")
    assert samples.buttons.tolist() == [int(time > 1.5) for time in TIME if time != 1.0]
    assert np.allclose(samples.velocity, [0.1, 0.0, 0.0])


def test_a_series_is_written_with_its_own_columns(tmp_path):
    assert run(["export", "a.mcap", "--topic", "/check/line-deviation", "--output", "o.csv"]) == 0
    lines = (tmp_path / "o.csv").read_text().splitlines()
    assert lines[0] == 't_s,"line deviation, fixed mm"'
    assert len(lines) == 51


def test_without_a_target_it_lists_what_there_is(capsys):
    assert run(["export", "a.mcap"]) == 0
    told = capsys.readouterr().out
    assert "/tool/measured: 50 poses of tool in wobj" in told
    assert "/signals: 1 rows of doPen" in told


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--topic", "/nothing", "--output", "o.csv"], "nothing on topic /nothing; there is /tracker/pose"),
        (["--output", "o.json"], "expected an ending of .csv, .tum, .txt, .xml, not .json"),
        (["--topic", "/signals", "--output", "o.tum"], "numbers over time are written as .csv only"),
        (["--output", "missing/o.csv"], "cannot be written"),
    ],
)
def test_what_cannot_be_written_is_told(capsys, words, told):
    assert run(["export", "a.mcap", *words]) == 2
    assert told in capsys.readouterr().err


def test_a_layout_names_only_topics_and_fields_of_the_recording(tmp_path):
    assert run(["export", "a.mcap", "--foxglove", "layout.json"]) == 0
    layout = json.loads((tmp_path / "layout.json").read_text())
    fields = {}
    with (tmp_path / "a.mcap").open("rb") as file:
        summary = make_reader(file).get_summary()
        for channel in summary.channels.values():
            schema = summary.schemas[channel.schema_id]
            if schema.encoding == "protobuf":
                files = descriptor_pb2.FileDescriptorSet.FromString(schema.data).file
                names = {f"{each.package}.{kind.name}".strip("."): kind for each in files for kind in each.message_type}
                fields[channel.topic] = {field.name for field in names[schema.name].field}
    plotted = [line["value"] for panel in layout["configById"].values() for line in panel.get("paths", [])]
    assert {path.split(".")[0] for path in plotted} == {"/tool/measured", "/check/line-deviation", "/signals", "/rapid/move"}
    assert all(path.split(".")[1] in fields[path.split(".")[0]] for path in plotted)
    assert set(layout["configById"]["3D!space"]["topics"]) == set(RECORDING.paths)

    def leaves(node):
        return [node] if isinstance(node, str) else leaves(node["first"]) + leaves(node["second"])

    assert sorted(leaves(layout["layout"])) == sorted(layout["configById"])
