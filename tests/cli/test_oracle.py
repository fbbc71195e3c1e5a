"""`mitl oracle` from the outside: the path against closed forms, the files, the refusals."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest

from mitl.cli import run
from mitl.motion.robot_model import load_robot_model
from mitl.recording import read_recording

EXACT = 1e-6  # m; the issue's own figure
PROGRAM = r"""MODULE Figure
  PERS tooldata pen := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  PERS wobjdata table := [FALSE,TRUE,"",[[500,0,400],[0.923879533,0,0,0.382683432]],[[0,0,0],[1,0,0,0]]];
  CONST robtarget p0 := [[0,0,0],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR num deep := 0;
  PROC main()
    ConfL \Off; ConfJ \Off;
    MoveJ p0, v300, fine, pen \WObj:=table;
    MoveL Offs(p0,100,0,deep), v200, z50, pen \WObj:=table;
    SetDO doEarly, 1;
    MoveL Offs(p0,100,100,deep), v200, fine, pen \WObj:=table;
    SetDO doThere, 1;
    MoveC Offs(p0,50,150,deep), Offs(p0,0,100,deep), v100, z10, pen \WObj:=table;
    MoveC Offs(p0,50,50,deep), Offs(p0,100,100,deep), v100, fine, pen \WObj:=table;
    MoveJ Offs(p0,0,0,50), v300, z20, pen \WObj:=table;
    MoveL Offs(p0,0,100,50), v150, z20, pen \WObj:=table;
    MoveAbsJ [[10,10,10,0,60,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v500, fine, pen \WObj:=table;
    TPWrite "all done " \Num:=deep;
  ENDPROC
ENDMODULE
"""
LINE = {text.strip(): number for number, text in enumerate(PROGRAM.splitlines(), 1)}


@pytest.fixture
def program(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("figure.mod").write_text(PROGRAM, encoding="utf-8")
    return "figure.mod"


def table(name="out.csv"):
    with Path(name).open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    columns = {
        key: np.array([row[key] for row in rows]) if key == "module" else np.array([float(row[key]) for row in rows]) for key in rows[0]
    }
    position = 1e-3 * np.stack([columns[f"{axis}_mm"] for axis in "xyz"], axis=1)
    joints = np.radians(np.stack([columns[f"j{axis}_deg"] for axis in range(1, 7)], axis=1))
    return columns, position, joints


def oracle(program, *words, out="out.csv"):
    assert run(["oracle", program, "--frame", "wobj", "--output", out, *words]) == 0
    return table(out)


def test_the_columns_are_those_of_the_contract(program):
    columns, _, _ = oracle(program)
    pose = ["t_s", "x_mm", "y_mm", "z_mm", "qw", "qx", "qy", "qz", "speed_mm_s"]
    assert list(columns) == [*pose, *(f"j{axis}_deg" for axis in range(1, 7)), "move", "module", "line", "doEarly", "doThere"]


@pytest.mark.parametrize("rate", ["250", "240", "7", "1000"])
def test_the_rate_is_exact(program, rate):
    columns, _, _ = oracle(program, "--rate", rate)
    assert columns["t_s"] == pytest.approx(np.arange(len(columns["t_s"])) / float(rate), abs=1e-9)


def test_lines_and_circles_are_exact_and_zones_begin_at_the_programmed_radius(program):
    columns, position, _ = oracle(program, "--view", "planned", "--rate", "2000")
    lines = columns["line"]
    first = lines == LINE["MoveL Offs(p0,100,0,deep), v200, z50, pen \\WObj:=table;"]
    second = lines == LINE["MoveL Offs(p0,100,100,deep), v200, fine, pen \\WObj:=table;"]
    x, y, z = position.T
    assert np.abs(z[first | second]).max() < EXACT
    on_first, in_zone = first & (x <= 0.050), first & (x > 0.0502)
    assert np.abs(y[on_first]).max() < EXACT
    assert (y[in_zone] > 0).all(), "the path has left the line where the zone begins"
    assert np.abs(x[second & (y >= 0.050)] - 0.1).max() < EXACT
    # mid-corner cut of facts/motion.md: .2166 d |u2 - u1|
    closest = np.linalg.norm(position[first | second] - [0.1, 0, 0], axis=1).min()
    assert closest == pytest.approx(0.2166 * 0.05 * np.sqrt(2), rel=0.01)
    circle = (lines > LINE["SetDO doThere, 1;"]) & (lines < LINE["MoveJ Offs(p0,0,0,50), v300, z20, pen \\WObj:=table;"])
    radius = np.linalg.norm(position[circle] - [0.05, 0.1, 0], axis=1)
    # where the instruction changes is the middle of a fine point, so the whole run belongs to the circle
    assert np.abs(radius - 0.05).max() < EXACT


def test_the_speed_is_never_above_the_programmed_one_and_reaches_it(program):
    columns, _, _ = oracle(program, "--view", "planned", "--rate", "1000")
    for line, text in enumerate(PROGRAM.splitlines(), 1):
        found = re.search(r"Move[LCJ].*\bv(\d+),", text)
        if found is None:
            continue
        speed = columns["speed_mm_s"][columns["line"] == line]
        assert speed.max() <= float(found[1]) * 1.001, text
        assert speed.max() >= float(found[1]) * 0.9, text


@pytest.mark.parametrize("view", ["planned", "tool", "controller"])
def test_no_joint_limit_is_exceeded_and_acceleration_and_jerk_are_bounded(program, view):
    model = load_robot_model("irb140")
    _, _, joints = oracle(program, "--view", view, "--rate", "250")
    assert (joints >= model.lower).all()
    assert (joints <= model.upper).all()
    speed = np.diff(joints, axis=0) * 250
    acceleration = np.diff(speed, axis=0) * 250
    jerk = np.diff(acceleration, axis=0) * 250
    assert (np.abs(speed).max(axis=0) <= model.speed).all()
    assert (np.abs(acceleration).max(axis=0) <= model.acceleration).all()
    if view != "planned":  # a zone's curvature jumps at its edge, as measured (facts/motion.md); what moves is smoothed
        # the acceleration changes over the window of the plan at the soonest; twice, for a change of sign
        assert (np.abs(jerk).max(axis=0) <= 2 * model.acceleration / model.acceleration_window).all()


def test_outputs_fire_early_after_a_zone_and_in_place_after_a_stop_point(program, capsys):
    columns, position, _ = oracle(program, "--view", "planned", "--rate", "1000")
    capsys.readouterr()
    corner = columns["t_s"][np.argmin(np.linalg.norm(position - [0.1, 0, 0], axis=1))]
    arrived = columns["t_s"][np.argmax(np.linalg.norm(position - [0.1, 0.1, 0], axis=1) < EXACT)]
    assert columns["t_s"][np.argmax(columns["doEarly"] == 1)] < corner - 0.2
    assert columns["t_s"][np.argmax(columns["doThere"] == 1)] >= arrived - 0.001


def test_the_three_frames_are_the_same_motion(program):
    _, in_wobj, joints = oracle(program)
    for frame in ("world", "base"):
        assert run(["oracle", program, "--frame", frame, "--output", f"{frame}.csv"]) == 0
        _, in_frame, same = table(f"{frame}.csv")
        assert np.array_equal(joints, same)
        turned = np.array([[np.sqrt(0.5), -np.sqrt(0.5), 0], [np.sqrt(0.5), np.sqrt(0.5), 0], [0, 0, 1]])
        moving = slice(50, None)  # before the first move the tool is not yet that of the program
        assert in_frame[moving] == pytest.approx(in_wobj[moving] @ turned.T + [0.5, 0, 0.4], abs=2e-6)


def test_set_presets_a_variable_and_the_summary_tells_what_happened(program, capsys):
    assert run(["oracle", program, "--set", "deep=20"]) == 0
    told = capsys.readouterr().out
    for expected in ("duration", "path length", "moves         8", "joint speed", "doEarly: 1 at", "all done 20"):
        assert expected in told


def test_inputs_take_their_values_at_their_times(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("wait.mod").write_text(
        'MODULE W\n  PROC main()\n    WHILE diGo = 0 DO\n      WaitTime 0.01;\n    ENDWHILE\n    TPWrite "gone";\n  ENDPROC\nENDMODULE\n',
        encoding="utf-8",
    )
    assert run(["oracle", "wait.mod", "--input", "diGo=1@1.5"]) == 0
    time = float(re.search(r"TPWrite\s+([\d.]+) s: gone", capsys.readouterr().out)[1])
    assert time == pytest.approx(1.5, abs=0.011)


def test_an_mcap_holds_the_same_path(program):
    _, position, joints = oracle(program)
    assert run(["oracle", program, "--frame", "wobj", "--output", "out.mcap"]) == 0
    recording = read_recording(Path("out.mcap"))
    assert recording.paths["/tool/oracle"].path.position == pytest.approx(position, abs=1e-9)
    assert recording.series["/robot/joints"].values == pytest.approx(joints, abs=1e-9)
    assert recording.metadata["robot"] == "irb140"
    bound = recording.series["/tool/oracle/bound"]
    assert bound.columns == ("position", "orientation", "time")
    assert len(bound.time) == len(position)
    assert 0.2e-3 == bound.values[:, 0].min() < bound.values[:, 0].max() < 1e-3  # slow lines, faster joint moves


def test_bounds_come_as_last_columns_of_the_csv_where_asked_for(program):
    before, _, _ = oracle(program)
    columns, _, _ = oracle(program, "--bounds")
    assert list(columns)[: len(before)] == list(before)
    assert list(columns)[len(before) :] == ["bound_mm", "bound_deg", "bound_ms"]
    assert min(columns["bound_mm"]) == pytest.approx(0.2)


def test_max_time_cuts_an_endless_program_off(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    endless = PROGRAM.replace('    TPWrite "all done " \\Num:=deep;\n', "    main;\n")
    Path("endless.mod").write_text(endless, encoding="utf-8")
    assert run(["oracle", "endless.mod", "--max-time", "9", "--output", "out.csv"]) == 0
    columns, _, _ = table()
    assert columns["t_s"][-1] == pytest.approx(9.0)
    assert "cut off" in capsys.readouterr().err


def test_an_endless_loop_of_moves_is_told_without_waiting_for_its_time(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    loop = "MODULE L\n  PROC main()\n    WHILE TRUE DO\n      MoveAbsJ [[{},0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v1000, z10, tool0;\n"
    loop += "      MoveAbsJ [[2,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v1000, fine, tool0;\n    ENDWHILE\n  ENDPROC\nENDMODULE\n"
    Path("loop.mod").write_text(loop.replace("{}", "5"), encoding="utf-8")
    assert run(["oracle", "loop.mod"]) == 1
    said = capsys.readouterr().err
    assert "loop.mod:4:" in said
    assert "--max-time" in said
    assert run(["oracle", "loop.mod", "--max-time", "5"]) == 0


def test_stop_is_told_and_the_operator_answers(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    lines = ["MODULE S", "  VAR num k;", "  PROC main()", '    TPReadNum k, "how many";', r'    TPWrite "k " \Num:=k;', "    Stop;"]
    Path("stop.mod").write_text("\n".join([*lines, '    TPWrite "after";', "  ENDPROC", "ENDMODULE", ""]), encoding="utf-8")
    assert run(["oracle", "stop.mod", "--answer", "4"]) == 0
    told = capsys.readouterr()
    assert "k 4" in told.out
    assert "after" not in told.out
    assert "stop.mod:6: Stop ended the run here" in told.err
    assert run(["oracle", "stop.mod"]) == 1
    assert "--answer" in capsys.readouterr().err


BAD = {
    "out of reach": ("Offs(p0,100,0,deep), v200, z50", "Offs(p0,900,0,deep), v200, z50", 9),
    "axis 2": ("[[10,10,10,0,60,0]", "[[10,120,10,0,60,0]", 17),
    "lie on a line": ("MoveC Offs(p0,50,150,deep)", "MoveC Offs(p0,50,100,deep)", 13),
    "endless loop": ("    ConfL \\Off; ConfJ \\Off;", "    ConfL \\Off; ConfJ \\Off; WHILE TRUE DO deep := 1; ENDWHILE", 7),
    "configuration": (
        "    ConfL \\Off; ConfJ \\Off;\n    MoveJ p0",
        "\n    MoveJ [[0,0,0],[0,0,1,0],[2,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]",
        8,
    ),
    "speed must be positive": ("v100, z10", "[0,500,5000,1000], z10", 13),
    "expected": ("MoveJ p0, v300, fine", "MoveJ p0 v300, fine", 8),
}


@pytest.mark.parametrize("reason", BAD)
def test_a_program_that_cannot_be_run_ends_with_line_and_reason_and_leaves_nothing(tmp_path, monkeypatch, capsys, reason):
    monkeypatch.chdir(tmp_path)
    good, bad, line = BAD[reason]
    assert good in PROGRAM
    Path("bad.mod").write_text(PROGRAM.replace(good, bad), encoding="utf-8")
    Path("out.csv").write_text("an older path\n", encoding="utf-8")
    assert run(["oracle", "bad.mod", "--output", "out.csv"]) == 1
    said = capsys.readouterr().err
    assert f"bad.mod:{line}:" in said
    assert reason in said
    assert "Traceback" not in said
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bad.mod"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["none.mod"], "none.mod"),
        (["figure.mod", "--robot", "irb9"], "irb140"),
        (["figure.mod", "--output", "out.txt"], ".csv or .mcap"),
        (["figure.mod", "--output", "nowhere/out.csv"], "nowhere"),
        (["figure.mod", "--set", "deep"], "VAR=VALUE"),
        (["figure.mod", "--input", "di1=1"], "SIGNAL=VALUE@SECONDS"),
        (["figure.mod", "--rate", "0"], "--rate"),
        (["figure.mod", "--view", "sideways"], "--view"),
    ],
)
def test_wrong_usage_is_told_apart(program, capsys, words, said):
    assert run(["oracle", *words]) == 2
    assert said in capsys.readouterr().err


def test_lenient_leaves_out_what_moves_nothing_and_says_so(tmp_path, capsys):
    path = tmp_path / "spy.mod"
    path.write_text('MODULE m\nPROC main()\nSpyStart "x";\nBlink 3;\nTPWrite "on";\nENDPROC\nENDMODULE\n')
    assert run(["oracle", str(path)]) == 1
    assert "unknown procedure or instruction 'Blink'" in capsys.readouterr().err
    assert run(["oracle", str(path), "--lenient"]) == 0
    shown = capsys.readouterr()
    assert "left out: SpyStart" in shown.err
    assert "left out: unknown procedure or instruction 'Blink'" in shown.err
    assert "0.000 s: on" in shown.out
