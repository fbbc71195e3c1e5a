"""`mitl preflight`: every kind of finding at its line, exit codes, JSON; and the programs of our own cases pass."""

import json
from pathlib import Path

import pytest

from mitl.cli import run

ATC = Path(__file__).resolve().parents[2] / "mitl" / "atc"
NONE = "[9E9,9E9,9E9,9E9,9E9,9E9]"
DOWN = "[0,0,1,0]"
TOOL = "tRod"


def line(x, y, z, rot=DOWN, kind="MoveL", zone="fine", speed="v300"):
    return f"{kind} [[{x},{y},{z}],{rot},[0,0,0,0],{NONE}],{speed},{zone},{TOOL};"


def axes(*degrees):
    return f"MoveAbsJ [[{','.join(map(str, degrees))}],{NONE}],v500,fine,{TOOL};"


@pytest.fixture
def flown(tmp_path, capsys):
    """Writes a program, looks it over and gives exit code and JSON."""

    def fly(*lines, options=()):
        file = tmp_path / "p.mod"
        head = ["MODULE P", f"PERS tooldata {TOOL} := [TRUE,[[0,0,150],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];", "PROC main()"]
        file.write_text("\n".join([*head, "ConfL\\Off; ConfJ\\Off;", *lines, "ENDPROC", "ENDMODULE"]) + "\n")
        code = run(["preflight", str(file), "--format", "json", *options])
        return code, json.loads(capsys.readouterr().out)

    return fly


def found(report):
    """Gives (code, severity, line of the body from 0) of every finding."""
    return [(finding["code"], finding["severity"], finding["line"] - 5) for finding in report["findings"]]


def test_a_good_program_has_no_findings_and_says_what_it_used(flown):
    code, report = flown(line(450, 0, 400, kind="MoveJ"), line(450, 100, 400))
    assert (code, report["findings"]) == (0, [])
    assert report["robot"] == "irb140"
    assert report["samples"] > 100
    assert report["resolution"]["time_s"] == 0.004
    assert 0.5 < report["resolution"]["tool_step_mm"] < 5
    assert report["clearance"]["itself"]["distance_mm"] > 20
    assert report["clearance"]["cell"] is None
    assert [axis["axis"] for axis in report["axes"]] == [1, 2, 3, 4, 5, 6]
    assert all(axis["limit_margin_deg"] > 1 and 0 <= axis["speed_share"] < 1 for axis in report["axes"])
    assert report["singularity"]["axis_5_deg"] > 20


def test_one_bad_target_does_not_hide_the_next(flown):
    code, report = flown(
        line(450, 0, 400, kind="MoveJ"), line(950, 0, 400), line(450, 50, 400), axes(0, 120, 0, 0, 0, 0), line(450, 0, 1500, kind="MoveJ")
    )
    assert code == 1
    assert found(report) == [("reach", "error", 1), ("axis-limit", "error", 3), ("reach", "error", 4)]
    assert all(finding["column"] == 1 for finding in report["findings"])


def test_a_configuration_that_cannot_be_is_found(flown):
    code, report = flown(line(450, 0, 400, kind="MoveJ"), "ConfJ\\On;", line(450, 50, 400, kind="MoveJ").replace("[0,0,0,0]", "[3,0,0,0]"))
    assert code == 1
    assert found(report) == [("configuration", "error", 2)]


def test_an_axis_near_its_limit_is_a_warning(flown):
    code, report = flown(axes(0, 0, 0, 199.5, 30, 0))
    assert code == 0
    assert found(report) == [("axis-limit", "warning", 0)]
    assert report["findings"][0]["value"] == pytest.approx(0.5, abs=0.01)
    assert flown(axes(0, 0, 0, 199.5, 30, 0), options=("--axis-margin", "0.4"))[1]["findings"] == []


def test_a_collision_with_the_cell_is_an_error_where_it_is_deepest(flown):
    code, report = flown(line(550, 0, 300, kind="MoveJ"), line(550, 0, 20), line(550, 0, 300), options=("--cell", "bench"))
    assert code == 1
    assert [place for place in found(report) if place[2] == 1] == [("collision", "error", 1)]
    (first, *_) = [finding for finding in report["findings"] if finding["line"] == 6]
    assert first["message"].startswith("tool runs into table, ")
    assert first["value"] == pytest.approx(20 - 50, abs=3)
    assert report["clearance"]["cell"]["bodies"] == ["tool", "table"]


def test_a_clearance_that_is_asked_for_is_kept_or_told(flown):
    moves = (line(550, 0, 300, kind="MoveJ"), line(550, 0, 80), line(550, 0, 300))
    assert flown(*moves, options=("--cell", "bench", "--clearance", "25"))[0] == 0
    code, report = flown(*moves, options=("--cell", "bench", "--clearance", "40"))
    assert code == 1
    assert {finding["code"] for finding in report["findings"]} == {"clearance"}
    assert report["findings"][0]["value"] == pytest.approx(30, abs=0.5)
    assert report["findings"][0]["limit"] == 40


def test_an_arm_that_folds_into_itself_is_found_on_its_way(flown):
    code, report = flown(axes(0, -60, 50, 0, 100, 0))
    assert code == 1
    assert ("collision", "error", 0) in found(report)


def test_the_tool_must_stay_in_its_box(flown):
    moves = (line(450, 0, 400, kind="MoveJ"), line(450, 100, 400))
    assert flown(*moves, options=("--box", "0,900,-200,200,100,900"))[0] == 0
    code, report = flown(*moves, options=("--box", "0,900,-200,60,100,900"))
    assert code == 1
    assert found(report) == [("workspace", "error", 1)]
    assert report["findings"][0]["value"] == pytest.approx(40, abs=0.1)


def test_a_line_near_the_wrists_singularity_is_told(flown):
    """Axis 5 goes from 6 to 1 deg on a line in the arm's plane."""
    import numpy as np

    from mitl.motion.kinematics import Arm
    from mitl.motion.robot_model import load_robot_model

    X_BF = Arm(load_robot_model("irb140")).flange(np.radians([0, 12, 0, 0, 1, 0]))
    w, x, y, z = X_BF.rotation.as_quat(scalar_first=True)
    place = 1e3 * X_BF.apply([0, 0, 0.15])
    code, report = flown(axes(0, 0, 0, 0, 6, 0), line(*place, rot=f"[{w:.9f},{x:.9f},{y:.9f},{z:.9f}]"))
    assert code == 0
    assert found(report) == [("singularity", "warning", 1)]
    assert report["findings"][0]["value"] == pytest.approx(1, abs=0.01)


def test_a_program_that_never_ends_is_told_unless_it_is_cut_off(flown, monkeypatch):
    from mitl.simulation import preflight

    monkeypatch.setattr(preflight, "_LONGEST", 20.0)
    endless = ("WHILE TRUE DO", line(450, 0, 400, kind="MoveJ"), "WaitTime 10;", "ENDWHILE")
    code, report = flown(*endless)
    assert code == 0
    assert [finding[0] for finding in found(report)] == ["endless"]
    assert flown(*endless, options=("--max-time", "5"))[1]["findings"] == []


def test_an_error_of_the_program_itself_is_a_finding_at_its_line(flown):
    code, report = flown(line(450, 0, 400, kind="MoveJ"), "TPWrite NumToStr(1/0,0);")
    assert code == 1
    assert [(finding["severity"], finding["line"]) for finding in report["findings"]] == [("error", 6)]


def test_errors_of_the_text_are_findings_in_json_too(flown):
    code, report = flown("MoveL absent,v100,fine,tRod;", "x := ;")
    assert code == 1
    assert sorted(finding["line"] for finding in report["findings"]) == [5, 6]
    assert {finding["severity"] for finding in report["findings"]} == {"error"}
    assert report["samples"] == 0


def test_text_names_file_line_and_column(tmp_path, capsys):
    file = tmp_path / "p.mod"
    file.write_text(f"MODULE P\nPROC main()\n  {axes(0, 120, 0, 0, 0, 0).replace(TOOL, 'tool0')}\nENDPROC\nENDMODULE\n")
    assert run(["preflight", str(file)]) == 1
    told = capsys.readouterr().out.splitlines()
    assert told[0] == f"{file}:3:3: error: MoveAbsJ: axis 2 would be at 120.00 deg, its limit is 110 deg [axis-limit]"
    assert told[-1] == "findings      1 error, 0 warnings"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["absent.mod"], "absent.mod"),
        (["--robot", "irb9"], "irb140"),
        (["--cell", "nowhere"], "no cell"),
        (["--box", "1,2,3"], "XMIN"),
        (["--box", "9,2,3,4,5,6"], "XMIN"),
        (["--set", "x"], "VAR=VALUE"),
        (["--routine", "absent"], "absent"),
        (["--tool", "absent.urdf"], "absent.urdf"),
    ],
)
def test_what_cannot_be_read_is_told_with_exit_code_2(tmp_path, capsys, words, said):
    file = tmp_path / "p.mod"
    file.write_text("MODULE P\nPROC main()\nENDPROC\nENDMODULE\n")
    assert run(["preflight", *([] if words == ["absent.mod"] else [str(file)]), *words]) == 2
    streams = capsys.readouterr()
    assert said in streams.err
    assert "Traceback" not in streams.err


MODULES = sorted(path.name for path in ATC.glob("*.mod"))


@pytest.mark.parametrize("robot", ["irb140", "irb1200_7_70"])
@pytest.mark.parametrize("module", MODULES)
def test_every_order_of_our_own_cases_passes_without_findings_in_a_cell(module, robot, capsys):
    cell = "line" if module == "atc_8.mod" else "bench"
    words = ["--robot", robot, "--cell", cell, "--clearance", "20"]
    assert run(["preflight", str(ATC / module), *words, "--format", "json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["findings"] == []
    assert len(report["orders"]) >= 2
    assert all("option" in order for order in report["orders"])
    assert report["samples"] > 50


def test_the_orders_that_a_controller_must_refuse_are_refused_in_advance(capsys):
    assert run(["preflight", str(ATC / "atc_5.mod"), "--format", "json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert [finding["code"] for finding in report["expected"]] == ["configuration", "axis-limit", "axis-speed"]
    words = ["--set", "option=4", "--set", "subOption=2", "--max-time", "3"]
    assert run(["preflight", str(ATC / "atc_5.mod"), *words, "--format", "json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert [finding["code"] for finding in report["expected"]] == ["axis-limit"]
    assert report["orders"] == []


@pytest.fixture
def service(tmp_path, capsys):
    """Writes a program that waits for orders, looks it over and gives exit code and JSON. Its first CASE is at line 9."""

    def fly(*cases, options=(), before=""):
        file = tmp_path / "s.mod"
        tool = f"PERS tooldata {TOOL} := [TRUE,[[0,0,150],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];"
        loop = ["WHILE TRUE DO", "TEST order", *cases, "DEFAULT:", "WaitTime 0.1;", "ENDTEST", "ENDWHILE"]
        head = ["MODULE S", tool, "VAR num order := 0;", "VAR num part := 0;", "PROC main()", f"ConfL\\Off; ConfJ\\Off; {before}"]
        file.write_text("\n".join([*head, *loop, "ENDPROC", "ENDMODULE"]) + "\n")
        code = run(["preflight", str(file), "--format", "json", *options])
        return code, json.loads(capsys.readouterr().out)

    return fly


FAR = line(950, 0, 400)
NEAR = line(450, 0, 400, kind="MoveJ")


def test_every_order_is_flown_and_a_bad_one_is_found_among_good_ones(service):
    code, report = service("CASE 1:", NEAR, "order := 0;", "CASE 2:", FAR, "order := 0;", "CASE 3:", NEAR, "order := 0;")
    assert code == 1
    assert [(finding["code"], finding["line"]) for finding in report["findings"]] == [("reach", 13)]
    assert report["orders"] == [{"order": 1}, {"order": 2}, {"order": 3}]


def test_an_order_that_the_user_gives_is_the_only_one(service):
    cases = ("CASE 1:", NEAR, "order := 0;", "CASE 2:", FAR, "order := 0;")
    code, report = service(*cases, options=("--set", "order=1", "--max-time", "5"))
    assert (code, report["findings"], report["orders"]) == (0, [], [])


def test_data_that_the_user_sets_keep_their_value_in_every_order(service):
    cases = ("CASE 1:", "TEST part", "CASE 1:", NEAR, "CASE 2:", FAR, "ENDTEST", "order := 0;")
    code, report = service(*cases, options=("--set", "part=1"))
    assert (code, report["orders"]) == (0, [{"order": 1, "part": 1}])
    assert service(*cases)[0] == 1


def test_an_order_that_is_never_done_is_told_with_its_values(service, monkeypatch):
    from mitl.simulation import preflight

    monkeypatch.setattr(preflight, "_LONGEST", 20.0)
    code, report = service("CASE 1:", NEAR, "order := 0;", "CASE 2:", "WaitTime 5;", "CASE 3:", FAR, "order := 0;")
    assert code == 0
    assert [finding["code"] for finding in report["findings"]] == ["endless"]
    assert "order = 2" in report["findings"][0]["message"]
    assert report["orders"] == [{"order": 1}]


def test_a_time_cuts_orders_off_without_a_finding(service):
    cases = ("CASE 1:", NEAR, "order := 0;", "CASE 2:", "WaitTime 50;", "order := 0;")
    code, report = service(*cases, options=("--max-time", "20"))
    assert (code, report["findings"], report["orders"]) == (0, [], [{"order": 1}])


def test_an_error_in_an_order_ends_the_flight_at_its_line(service):
    code, report = service("CASE 1:", "TPWrite NumToStr(1/part,0);", "order := 0;", "CASE 2:", FAR, "order := 0;")
    assert code == 1
    assert [finding["line"] for finding in report["findings"]] == [10]
    assert report["orders"] == []


def test_a_program_that_chooses_its_own_way_is_given_no_orders(service, monkeypatch):
    """A state machine: its loop tests what it set itself."""
    from mitl.simulation import preflight

    monkeypatch.setattr(preflight, "_LONGEST", 10.0)
    code, report = service("CASE 1:", NEAR, "WaitTime 3;", "CASE 2:", FAR, before="order := 1;")
    assert code == 0
    assert [finding["code"] for finding in report["findings"]] == ["endless"]
    assert report["orders"] == []


def test_the_example_of_the_documentation_is_real(tmp_path, capsys, monkeypatch):
    page = (ATC.parents[1] / "docs" / "preflight.md").read_text(encoding="utf-8")
    program, console = (page.split(fence, 1)[1].split("```", 1)[0] for fence in ("```rapid\n", "```console\n"))
    monkeypatch.chdir(tmp_path)
    Path("pick.mod").write_text(program)
    command, *printed = console.strip().splitlines()
    assert run(command.split()[2:]) == 1
    told = capsys.readouterr().out.strip().splitlines()
    places = [[line.split(": error:")[0], line.rsplit("[", 1)[-1]] for line in (*told, *printed) if "error:" in line]
    assert places[:3] == places[3:]
    assert [line.split()[0] for line in told] == [line.split()[0] for line in printed]
    assert told[-1] == printed[-1]
