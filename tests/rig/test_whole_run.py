"""A whole `mitl verify` against `mitl serve` and the stand-in for SteamVR: killed without a word, and with its network cut for ten seconds.

Each is one run of the real command in a process of its own; the robot is watched from a session beside it. They take some twenty seconds
each, nearly all of which is waiting: the network is cut for as long as the rig must survive it.
"""

import base64
import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from mitl.controllers.rws.controller import RwsController
from mitl.controllers.rws.credentials import Credentials
from mitl.controllers.rws.dialects import Rws1
from mitl.controllers.rws.transport import Transport
from mitl.rig.monotonic_clock import MonotonicClock

from ..trackers import steamvr

SECRET = "correct-horse-battery-staple"  # noqa: S105 - of these tests
PROGRAM = """MODULE Orders
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR num option := 0;
  VAR num angle := 5;
  PROC main()
    MoveAbsJ home, v500, fine, tool0;
    WHILE TRUE DO
      IF option = 1 THEN
        MoveAbsJ [[angle,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v100, fine, tool0;
        option := 0;
      ENDIF
      WaitTime 0.02;
    ENDWHILE
  ENDPROC
ENDMODULE
"""
CASES = """import os
from pathlib import Path
from mitl.engine import case
from mitl.errors import RigError
from mitl.protocols import ExecutionState

def turned(rig, check, angle):
    rig.controller.load([Path(__file__).with_name("orders.mod")])
    rig.controller.start()
    rig.controller.write("angle", angle)
    rig.controller.write("option", "1")
    while rig.controller.read("option") != "0":
        if rig.controller.state() is ExecutionState.STOPPED:
            raise RigError("the program stopped on its way")
        rig.clock.wait(0.1)
    check("angle", value=abs(rig.controller.joints()[0] - int(angle) * 0.01745329), limit=0.001, unit="rad", uncertainty=0.0)

@case("own/long", title="Long", purpose="A move that takes a while.")
def test_long(rig, check):
    turned(rig, check, os.environ["MITL_TEST_ANGLE"])

@case("own/short", title="Short", purpose="One that does not.")
def test_short(rig, check):
    turned(rig, check, "5")
"""


class Cable:
    """Passes TCP connections on to a port until it is cut; what goes through a cut cable is lost, and its connection with it."""

    def __init__(self, port):
        self._target = port
        self.whole = threading.Event()
        self.whole.set()
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.port = self._listening.getsockname()[1]
        self._sockets = [self._listening]
        self._threads = []
        self._run(self._accept)

    def _run(self, work, *arguments):
        thread = threading.Thread(target=work, args=arguments, daemon=True)
        self._threads.append(thread)
        thread.start()

    def _accept(self):
        while True:
            try:
                near, _ = self._listening.accept()
            except OSError:
                return
            far = socket.create_connection(("127.0.0.1", self._target))
            self._sockets += [near, far]
            self._run(self._pass_on, near, far)
            self._run(self._pass_on, far, near)

    def _pass_on(self, source, sink):
        with contextlib.suppress(OSError):
            while (content := source.recv(65536)) and self.whole.is_set():
                sink.sendall(content)
        self._end(source, sink)

    @staticmethod
    def _end(*sockets):
        for one in sockets:
            with contextlib.suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)

    def close(self):
        self._end(*self._sockets)
        for thread in self._threads:
            thread.join(5.0)
        for one in self._sockets:
            one.close()


class Cell:
    """A served controller, a rig file that leads to it through a cable, and a session of our own that looks on."""

    def __init__(self, folder, server):
        self.folder = folder
        address = server.stdout.readline().strip()
        port = int(address.rpartition(":")[2])
        self.cable = Cable(port)
        self.file = folder / "cell.toml"
        rig = f'[rig]\nkind = "physical"\nrobot = "irb140"\npatience_s = 30\n[controller]\naddress = "http://127.0.0.1:{self.cable.port}"\n'
        self.file.write_text(f"{rig}[safety]\nunattended = true\nfirst_speed = 100\nheartbeat_s = 1.0\n", encoding="utf-8")
        (folder / "orders.mod").write_text(PROGRAM, encoding="utf-8")
        (folder / "test_own.py").write_text(CASES, encoding="utf-8")
        self.onlooker = RwsController(Transport(address, Rws1(), Credentials("Default User", SECRET)), MonotonicClock())

    def verify(self, angle, *options):
        words = [sys.executable, "-m", "mitl", "--debug", "verify", "--tests", str(self.folder), "--rig", str(self.file), "--arm"]
        words += ["--out", str(self.folder / "run"), *options]
        environment = {**os.environ, "MITL_TEST_ANGLE": str(angle)}
        return subprocess.Popen(words, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def outcomes(self):
        told = json.loads((self.folder / "run" / "results.json").read_text(encoding="utf-8"))
        return {case["id"]: case["outcome"] for case in told["cases"]}

    def axis(self):
        return float(np.degrees(self.onlooker.joints()[0]))

    def moving(self, run):
        end = time.monotonic() + 60.0
        while not 2.0 < self.axis() < 60.0:
            assert run.poll() is None, run.communicate()[0]
            assert time.monotonic() < end, "it never moved"
            time.sleep(0.1)

    def rests_on_its_way(self, within):
        """Waits until the robot stands, which must be short of where it was sent."""
        end, before = time.monotonic() + within, -1.0
        while abs((now := self.axis()) - before) > 1e-6:
            assert time.monotonic() < end, "it still moves"
            before = now
            time.sleep(0.3)
        assert 2.0 < now < 85.0
        return now

    def stopped_itself(self):
        return any("stopped itself at MitlGuard" in event.text for event in self.onlooker.event_log())


@pytest.fixture
def cell(tmp_path, monkeypatch):
    for name, value in {**steamvr.environment(tmp_path / "poses"), "MITL_RWS_PASSWORD": SECRET, "MITL_SERVE_PASSWORD": SECRET}.items():
        monkeypatch.setenv(name, value)
    command = [sys.executable, "-m", "mitl", "serve", "--poses", str(tmp_path / "poses"), "--tracker", "ideal"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        made = Cell(tmp_path, server)
        yield made
        made.onlooker.leave()
        made.cable.close()
        server.terminate()


def killed(cell, *, guardian):
    """Kills a run on its way, with its guardian or without, and waits until the robot stands."""
    run = cell.verify(90)
    cell.moving(run)
    children = Path(f"/proc/{run.pid}/task/{run.pid}/children").read_text(encoding="ascii")
    others = [int(number) for number in children.split()]
    assert others, "there is a guardian"
    for pid in (run.pid, *(others if guardian else ())):
        os.kill(pid, signal.SIGKILL)
    run.communicate()
    cell.rests_on_its_way(within=5.0)


def test_a_run_that_is_killed_leaves_a_robot_that_is_stopped_and_goes_on_where_it_was(cell):
    killed(cell, guardian=False)
    assert not cell.stopped_itself(), "the guardian is sooner"
    again = cell.verify(8, "--resume")
    said, _ = again.communicate(timeout=60)
    assert again.returncode == 0, said
    assert cell.outcomes() == {"own/long": "pass", "own/short": "pass"}, "mastership was not left with the dead"


def test_a_run_that_is_killed_with_its_guardian_leaves_a_robot_that_stops_itself(cell):
    killed(cell, guardian=True)
    assert cell.stopped_itself()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_stops_the_robot_puts_back_what_it_found_and_tells_no_secret(cell, number):
    found = cell.folder / "found.mod"
    found.write_text(PROGRAM.replace("MODULE Orders", "MODULE Found\n  VAR num marker := 42;"), encoding="utf-8")
    cell.onlooker.load([found])
    cell.onlooker.set_speed_ratio(70.0)
    cell.onlooker.leave()
    run = cell.verify(90)
    cell.moving(run)
    run.send_signal(number)
    cell.rests_on_its_way(within=5.0)
    said, _ = run.communicate(timeout=60)
    assert run.returncode not in (0, 1), said
    assert not cell.stopped_itself(), "it was told to stop"
    assert cell.onlooker.speed_ratio() == 70.0
    assert cell.onlooker.read("marker") == "42", "the program that was found is there again"
    kept = [file for file in (cell.folder / "run").rglob("*") if file.is_file()]
    assert {"results.json", "summary.txt"} <= {file.name for file in kept}
    secrets = [SECRET.encode(), base64.b64encode(f"Default User:{SECRET}".encode()), b"ABBCX", b"-http-session-"]
    for content in (said.encode(), *(file.read_bytes() for file in kept)):
        assert [secret for secret in secrets if secret in content] == []


def test_a_network_that_is_cut_for_ten_seconds_costs_the_case_that_ran_and_no_other(cell):
    run = cell.verify(90)
    cell.moving(run)
    cell.cable.whole.clear()
    cut = time.monotonic()
    where = cell.rests_on_its_way(within=5.0)
    assert cell.stopped_itself(), "nobody else could reach it"
    time.sleep(max(0.0, cut + 10.0 - time.monotonic()))
    assert cell.axis() == pytest.approx(where, abs=1e-6)
    cell.cable.whole.set()
    said, _ = run.communicate(timeout=60)
    assert run.returncode == 4, said
    assert cell.outcomes() == {"own/long": "error", "own/short": "pass"}
