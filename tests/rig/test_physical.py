"""The whole physical path on the virtual rig: `mitl serve` in a process of its own, RWS over HTTP, OpenVR through the real package."""

import json
import socket
import subprocess
import sys

import numpy as np
import pytest

from mitl.cli import run
from mitl.rig.physical import load_physical

from ..trackers import steamvr

PROGRAM = """MODULE Orders
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR num option := 0;
  PROC main()
    MoveAbsJ home, v500, fine, tool0;
    WHILE TRUE DO
      IF option = 1 THEN
        MoveAbsJ [[20,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v500, fine, tool0;
        option := 0;
      ENDIF
      WaitTime 0.02;
    ENDWHILE
  ENDPROC
ENDMODULE
"""


@pytest.fixture
def rig_file(tmp_path, monkeypatch):
    for name, value in {**steamvr.environment(tmp_path / "poses"), "MITL_RWS_PASSWORD": "robotics"}.items():
        monkeypatch.setenv(name, value)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    egm = ["--egm", f"127.0.0.1:{port}"]
    command = [sys.executable, "-m", "mitl", "serve", "--poses", str(tmp_path / "poses"), "--tracker", "ideal", *egm]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        address = server.stdout.readline().strip()
        file = tmp_path / "cell.toml"
        rig = f'[rig]\nkind = "physical"\nrobot = "irb140"\n[controller]\naddress = "{address}"\n'
        stream = f'[egm]\nhost = "127.0.0.1"\nport = {port}\n'
        file.write_text(f"{rig}[safety]\nunattended = true\nfirst_speed = 100\n{stream}", encoding="utf-8")
        yield file
        server.terminate()


def test_the_tracker_sees_the_way_that_the_controller_tells(rig_file, tmp_path):
    (tmp_path / "orders.mod").write_text(PROGRAM, encoding="utf-8")
    rig = load_physical(rig_file, 1, (), armed=True)
    try:
        rig.controller.load([tmp_path / "orders.mod"])
        rig.controller.start()
        before, began = rig.controller.flange(), rig.tracker.average(0.2)
        rig.tracker.start()
        rig.feedback.start()
        rig.controller.write("option", "1")
        while rig.controller.read("option") != "0":
            rig.clock.wait(0.05)
        after, ended = rig.controller.flange(), rig.tracker.average(0.2)
        assert np.degrees(rig.controller.joints()[0]) == pytest.approx(20.0, abs=0.05)
        streamed, tracked = rig.feedback.stop(), rig.tracker.stop()
    finally:
        rig.close()
    turn = 2 * np.arccos(np.clip(abs(before[3:] @ after[3:]), 0, 1))
    seen = 2 * np.arccos(np.clip(abs(began.quaternion_wxyz @ ended.quaternion_wxyz), 0, 1))
    assert np.degrees(turn) == pytest.approx(20.0, abs=0.05)
    assert np.degrees(seen) == pytest.approx(20.0, abs=0.1), "an ideal tracker turns as the flange does"
    assert streamed.lost == 0
    halfway = np.interp(np.radians(10.0), streamed.joints[:, 0], streamed.time)
    turned = 2 * np.arccos(np.clip(np.abs(tracked.quaternion_wxyz @ began.quaternion_wxyz), 0, 1))
    moving = turned > np.radians(0.5)
    assert np.interp(np.radians(10.0), turned[moving], tracked.time[moving]) == pytest.approx(halfway, abs=0.4), (
        "one clock for both, but for the feed's start"
    )


def test_unarmed_a_run_ends_with_an_error_in_every_case_and_nothing_moved(rig_file, tmp_path):
    assert run(["verify", "--rig", str(rig_file), "--out", str(tmp_path / "run"), "atc-1/linear"]) == 4
    (case,) = json.loads((tmp_path / "run" / "results.json").read_text())["cases"]
    assert case["outcome"] == "error"
    assert any("not armed" in message["text"] for message in case["messages"])


def test_a_simulated_rig_cannot_be_armed(tmp_path, capsys):
    assert run(["verify", "--arm", "--out", str(tmp_path / "run"), "atc-1/linear"]) == 2
    assert "--arm" in capsys.readouterr().err
