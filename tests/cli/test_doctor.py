"""`mitl doctor` finds what would keep a rig from a run, and moves nothing."""

import json
import time

import numpy as np
import pytest

from mitl.cli import run
from mitl.controllers.virtual.resources import panel
from mitl.controllers.virtual.server import Pace
from mitl.paths import PosePath
from mitl.samples import TrackerSamples
from mitl.trackers.pose_feed import FedDevice, PoseFeed

from ..controllers.served import Served
from ..trackers import steamvr


@pytest.fixture
def rig(tmp_path, monkeypatch):
    monkeypatch.setenv("MITL_RWS_PASSWORD", "robotics")
    for name, value in steamvr.environment(tmp_path / "feed").items():
        monkeypatch.setenv(name, value)
    served = Served("1", tmp_path / "disk", pace=Pace.REALTIME)
    feed = PoseFeed(tmp_path / "feed", (FedDevice("LHR-1"), FedDevice("LHB-1", kind=4)), latency=0.0)
    still = PosePath(np.arange(1000) * 0.004, np.tile([1.0, 2.0, 3.0], (1000, 1)), np.tile([1.0, 0, 0, 0], (1000, 1)), np.full(1000, True))
    for device in (0, 1):
        feed.write(device, still.time + time.monotonic(), TrackerSamples.plain(still))
    file = tmp_path / "cell.toml"
    file.write_text(f'[rig]\nkind = "physical"\nrobot = "irb140"\n[controller]\naddress = "{served.address}"\n', encoding="utf-8")
    yield served, file
    feed.close()
    served.close()


def examined(file, capsys):
    code = run(["doctor", "--rig", str(file), "--out", str(file.parent), "--seconds", "0.5", "--format", "json"])
    return code, {finding["what"]: finding for finding in json.loads(capsys.readouterr().out)}


def test_a_fit_rig_is_called_fit_part_by_part(rig, capsys):
    _, file = rig
    code, found = examined(file, capsys)
    bad = [
        finding for finding in found.values() if finding["state"] == "bad" and finding["what"] != "sampling"
    ]  # a loaded machine may be slow
    assert bad == []
    assert code in (0, 4)
    assert "RobotWare 6" in found["controller"]["told"]
    assert "LHR-1" in found["tracker"]["told"]
    assert found["base stations"]["told"].startswith("1 in view")


def test_what_keeps_it_from_a_run_is_told_with_what_to_do(rig, capsys):
    served, file = rig
    served.cell.set_motors(False)
    file.write_text(file.read_text().replace('robot = "irb140"', 'robot = "irb140"\ncalibration = "none.toml"'))
    code, found = examined(file, capsys)
    assert code == 4
    assert found["motors"] == {"what": "motors", "state": "bad", "told": "motoroff, expected motoron: switch them on at the cell"}
    assert "mitl calibrate" in found["calibration"]["told"]
    assert served.cell.state == "motoroff", "it only reads"


@pytest.mark.parametrize(("pin", "state"), [("none", "look"), ("its own", "good"), ("another", "bad")])
def test_the_certificate_of_an_encrypted_controller_is_shown_to_pin_it_by(rig, capsys, tmp_path, pin, state):
    _, file = rig
    served = Served("2", tmp_path / "other", pace=Pace.REALTIME)
    pinned = {"none": "", "its own": served.fingerprint, "another": "00" * 32}[pin]
    section = f'[controller]\naddress = "{served.address}"\ngeneration = "2"\nfingerprint = "{pinned}"\n'
    file.write_text(f'[rig]\nkind = "physical"\nrobot = "irb140"\n{section}', encoding="utf-8")
    _, found = examined(file, capsys)
    assert found["certificate"]["state"] == state
    assert (served.fingerprint in found["certificate"]["told"]) == (pin != "its own")
    assert (found["controller"]["state"] == "good") == (pin == "its own")
    served.close()


def test_options_that_the_rig_file_needs_and_the_age_of_the_calibration_are_looked_at(rig, capsys, monkeypatch):
    _, file = rig
    file.write_text(file.read_text().replace('robot = "irb140"', 'robot = "irb140"\ncalibration = "old.toml"'))
    (file.parent / "old.toml").write_text("schema = 1\n")
    _, found = examined(file, capsys)
    assert found["calibration"]["state"] == "bad"
    assert "old.toml" in found["calibration"]["told"]
    assert found["options"] == {"what": "options", "state": "good", "told": "616-1 PC Interface"}
    monkeypatch.setattr(panel, "_OPTIONS", ("English", "616-1 PC Interface"))
    file.write_text(file.read_text() + '[egm]\nhost = "127.0.0.1"\n')
    _, found = examined(file, capsys)
    assert found["options"]["state"] == "look"
    assert "689-1" in found["options"]["told"]


def test_a_rig_that_cannot_be_reached_is_told_and_the_rest_is_looked_at_all_the_same(rig, capsys):
    served, file = rig
    served.close()
    code, found = examined(file, capsys)
    assert code == 4
    assert "cannot be reached" in found["controller"]["told"]
    assert found["tracker"]["state"] == "good"


def test_a_simulated_rig_needs_no_doctor(tmp_path, capsys):
    (tmp_path / "sim.toml").write_text('[rig]\nkind = "simulation"\n')
    assert run(["doctor", "--rig", str(tmp_path / "sim.toml")]) == 2
    assert "physical" in capsys.readouterr().err
