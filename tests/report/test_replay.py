"""The replay: the robot's tool is where the path is, files of every kind are shown, and the page works in a real Chromium."""

import json
import re

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from mitl.cli import run
from mitl.engine import case_recording
from mitl.engine.case_recording import RecordedRun, recording_of, runs_of
from mitl.engine.record import CaseRecord, CheckRecord, RunRecord
from mitl.engine.results import text_of
from mitl.errors import UsageError
from mitl.motion.kinematics import Arm
from mitl.motion.robot_model import load_robot_model, robot_names
from mitl.outcome import Outcome
from mitl.paths import PosePath
from mitl.poses import transform_of
from mitl.recording.mcap_reader import read_recording
from mitl.recording.records import LogMessage, Series
from mitl.report import write_report
from mitl.report.columns import unpacked
from mitl.report.replay import Take, replay_page
from mitl.report.robot_shape import robot_shape
from mitl.report.takes import takes_of_file, with_oracle

PROGRAM = """MODULE Square
  PERS tooldata pen := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  CONST robtarget corner := [[500,0,400],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PROC main()
    ConfL \\Off;
    ConfJ \\Off;
    MoveJ corner, v500, fine, pen;
    SetDO doPen, 1;
    MoveL Offs(corner,80,0,0), v500, z20, pen;
    MoveL Offs(corner,80,80,0), v500, fine, pen;
  ENDPROC
ENDMODULE
"""
X_BO = np.array([0.5, 0.0, 0.4, 1.0, 0.0, 0.0, 0.0])
X_FT = np.array([0.0, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0])
TIME = np.linspace(0.0, 3.0, 400)


def line(offset=0.0):
    position = np.stack([0.0 * TIME, 0.1 * np.sin(TIME), 0.1 + 0.0 * TIME + offset], axis=1)
    return PosePath(TIME, position, np.tile([0.0, 0.0, 1.0, 0.0], (400, 1)), np.full(400, True))


def recorded(file, *names, text=PROGRAM, **more):
    moves = Series(np.array([0.0, 1.0]), np.array([[0.0, 7.0], [1.0, 9.0]]), ("move", "line"))
    runs = [RecordedRun(name, None, line(0.002).shifted(20.0), line(), 20.0, moves, None, 1.0, X_FT, X_BO) for name in names]
    log = [LogMessage(1.5, "info", "<b>told</b>", "controller")]
    metadata = {"robot": "irb140", **more}
    case_recording.write(file, recording_of(runs, paths={}, series={}, log=log, metadata=metadata, attachments={"a.mod": text.encode()}))
    return file


def data_of(page):
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', page, flags=re.DOTALL)[1])


def tool_tip(shape, joints, tool):
    """Forward kinematics as replay.js does it: from the links' origins and axes."""
    X = RigidTransform.identity()
    angles = iter(joints)
    for link in shape:
        origin = np.array(link["origin"])
        X *= RigidTransform.from_components(origin[:3], Rotation.from_quat(origin[3:]))
        if link["axis"] is not None:
            X *= RigidTransform.from_rotation(Rotation.from_rotvec(next(angles) * np.array(link["axis"])))
    return X.apply(tool)


@pytest.mark.parametrize("name", robot_names())
def test_the_shape_has_the_flange_where_the_model_has_it(name):
    model = load_robot_model(name)
    q = np.random.default_rng(1).uniform(-0.5, 0.5, 6)
    tip = tool_tip(robot_shape(model.urdf), model.between_links(q), X_FT[:3])
    assert np.allclose(tip, (Arm(model).flange(q) * transform_of(X_FT)).translation, atol=1e-9)


def test_the_tool_of_the_drawn_robot_is_where_the_recording_is(tmp_path):
    page = replay_page(takes_of_file(recorded(tmp_path / "a.mcap", "1")))
    data = data_of(page)
    (take,) = data["takes"]
    columns = {name: unpacked(column) for name, column in take["columns"].items()}
    for index in (0, len(columns["t"]) // 2):
        joints = [columns[f"j{axis}"][index] for axis in range(1, 7)]
        tip = tool_tip(data["robots"]["irb140"], joints, take["tool"])
        assert np.allclose(tip, [columns[f"m{axis}"][index] for axis in "xyz"], atol=1e-4)
    assert np.allclose(columns["d"], 2.0, atol=1e-3)
    assert take["moves"] == [[0.0, 7.0], [1.0, 9.0]]
    assert take["events"] == [[0.5, "info", "<b>told</b>", "controller"]]


@pytest.mark.parametrize("frame", ["world", "wobj"])
@pytest.mark.parametrize("suffix", [".csv", ".mcap"])
def test_an_oracle_is_shown_with_the_robot_that_its_joints_move(tmp_path, monkeypatch, frame, suffix):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "square.mod").write_text(PROGRAM)
    output = tmp_path / f"square{suffix}"
    assert run(["oracle", "square.mod", "--frame", frame, "--output", str(output), "--rate", "100"]) == 0
    (take,) = takes_of_file(output)
    # without a work object of its own both frames are the base's; MCAP says wobj and not where that is
    assert (take.robot is not None) == (frame == "world" or suffix == ".csv")
    assert "doPen" in [signal["name"] for signal in data_of(replay_page([take]))["takes"][0]["signals"]]


def test_a_plain_path_is_shown_without_a_robot_and_beside_an_oracle_with_one(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "path.txt").write_text("".join(f"{100 + t} {0.5} {0.1 * t} 0.5 0 1 0 0\n" for t in np.linspace(0.0, 2.0, 50)))
    (tmp_path / "square.mod").write_text(PROGRAM)
    assert run(["oracle", "square.mod", "--output", "square.csv"]) == 0
    (plain,) = takes_of_file(tmp_path / "path.txt")
    assert data_of(replay_page([plain]))["takes"][0]["robot"] is None
    (expected,) = takes_of_file(tmp_path / "square.csv")
    both = data_of(replay_page([with_oracle(plain, expected)]))["takes"][0]
    assert both["robot"] == "irb140"
    assert unpacked(both["columns"]["t"])[0] == pytest.approx(0.0)
    assert run(["view", "path.txt", "--oracle", "square.csv", "--html", "out.html"]) == 0
    assert (tmp_path / "out.html").stat().st_size < 1e6


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["view", "nothing.mcap", "--html", "o.html"], "nothing.mcap: cannot be read: No such file"),
        (["view", "a.mcap", "--run", "c", "--html", "o.html"], "no run 'c'; there are a: one, a: two"),
        (["view", "a.mcap", "--robot", "kuka", "--html", "o.html"], "no robot model 'kuka'"),
        (["view", "a.mcap", "--oracle", "a.mcap", "--html", "o.html"], "expected one path, found 2 runs"),
        (["view", "a.mcap", "--html", "missing/o.html"], "missing/o.html: cannot be written"),
    ],
)
def test_what_cannot_be_shown_is_told(tmp_path, monkeypatch, capsys, words, told):
    monkeypatch.chdir(tmp_path)
    recorded(tmp_path / "a.mcap", "one", "two")
    assert run(words) == 2
    assert told in capsys.readouterr().err


def test_no_pose_is_an_error_and_a_robot_that_is_unknown_here_costs_only_the_robot(tmp_path):
    with pytest.raises(UsageError, match="no pose to replay"):
        replay_page([Take("x", RecordedRun("x", None, None, None))])
    (run_,) = runs_of(read_recording(recorded(tmp_path / "a.mcap", "1")))
    assert data_of(replay_page([Take("x", run_, "somebody-elses")]))["takes"][0]["robot"] is None


def test_a_run_has_one_replay_that_its_report_links_to(tmp_path):
    recorded(tmp_path / "a.mcap", "1")
    check = CheckRecord("d", 2.0, "mm", 5.0, 0.1, Outcome.PASS)
    cases = (CaseRecord("a", "A", Outcome.PASS, 1.0, (check,), recording="a.mcap"), CaseRecord("b", "B", Outcome.PASS, 1.0, (check,)))
    (tmp_path / "results.json").write_text(text_of(RunRecord("sim", "irb140", 1, cases, {})))
    text = write_report(tmp_path).read_text()
    assert text.count("replay.html#case-0") == 1
    assert "replay.html#case-1" not in text
    (take,) = data_of((tmp_path / "replay.html").read_text())["takes"]
    assert (take["key"], take["limit"]) == ("case-0", 5.0)


def test_the_slider_moves_robot_line_and_readouts(page, tmp_path):
    hostile = "</script><script>document.title='hacked'</script>"
    file = recorded(tmp_path / "a.mcap", f"one {hostile}", "two", text=PROGRAM + f"! {hostile}\n")
    target = tmp_path / "replay.html"
    target.write_text(replay_page(takes_of_file(file, limit=5.0)))
    page.goto(target.as_uri())
    slider = page.locator("#slider")
    for share, expected in ((0.1, "MoveJ corner"), (0.9, "MoveL Offs(corner,80,0,0)")):
        slider.evaluate("(e, share) => { e.value = 4000 * share; e.dispatchEvent(new Event('input')); }", share)
        assert f"{3.0 * share:.3f} s" == page.locator("#time").inner_text()
        assert page.locator("#rapid .now").inner_text().strip().startswith(expected)
        assert page.locator("#distance").inner_text() == "2.00 mm"
    page.locator("#take").select_option(index=1)
    page.locator("[data-view=top]").click()
    page.locator("#stage").focus()
    for key in ("ArrowLeft", "ArrowUp", "+"):
        page.keyboard.press(key)
    page.locator("#play").click()
    page.wait_for_function("() => Number(document.getElementById('slider').value) > 100")
    assert "hacked" not in page.title()
    assert page.locator("#stage > *").count() == 1


def test_meshcat_has_the_paths_and_the_robot(tmp_path, capfd):
    """`mitl view` serves until Ctrl-C, so this asks the functions that it is made of."""
    from mitl.report.replay import animation_of
    from mitl.simulation.meshcat_replay import open_meshcat, publish

    (take,) = takes_of_file(recorded(tmp_path / "a.mcap", "1"), limit=5.0)
    meshcat = open_meshcat(None)
    publish(meshcat, animation_of(take))
    assert all(meshcat.HasPath(path) for path in ("/drake/paths/oracle", "/drake/paths/recorded/0", "/drake/markers/recorded"))
    assert meshcat.HasPath("/drake/visualizer/irb140/link_1") or meshcat.HasPath("/drake/visualizer/irb140")
    port = int(meshcat.web_url().rpartition(":")[2])
    with pytest.raises(UsageError, match=f"cannot listen on port {port}"):
        open_meshcat(port)
