"""Nothing moves unarmed, un-pre-flown, with another tool or unwatched; and every way out stops the robot."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

from mitl.controllers.faults import parse_fault
from mitl.controllers.rws.controller import RwsController
from mitl.controllers.virtual import start
from mitl.controllers.virtual.server import Pace
from mitl.errors import RigError, UsageError
from mitl.motion.robot_model import load_robot_model
from mitl.protocols import ExecutionState
from mitl.rig.guarded import GuardedController
from mitl.rig.guardian import Guardian
from mitl.rig.monotonic_clock import MonotonicClock
from mitl.rig.physical import await_rig, may_arm
from mitl.rig.physical_config import ControllerConfig, PhysicalConfig, SafetyConfig

from ..controllers.served import Served, transport_to

PROGRAM = """MODULE Guarded
  PERS tooldata tLong := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR num option := 0;
  VAR num angle := 20;
  PROC main()
    MoveAbsJ home, v1000, fine, tool0;
    WHILE TRUE DO
      IF option = 1 THEN
        MoveAbsJ [[angle,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v1000, fine, tool0;
        option := 0;
      ELSEIF option = 2 THEN
        MoveL Offs(CRobT(\\Tool:=tool0),0,-300,0), v100, fine, tool0;
        option := 0;
      ELSEIF option = 3 THEN
        MoveAbsJ [[90,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v100, fine, tool0;
        option := 0;
      ENDIF
      WaitTime 0.02;
    ENDWHILE
  ENDPROC
ENDMODULE
"""


class SwitchedTracker:
    """A tracker that sees, or does not."""

    lost = restarted = False

    def latest(self):
        if self.lost:
            raise RigError("the tracker is lost")


class Bench:
    def __init__(self, folder, *, armed=True, faults=(), patience=15.0, **safety):
        self.folder = folder
        self.cell = start.virtual_cell("irb140", faults=[parse_fault(fault) for fault in faults])
        self.served = Served("1", folder / "disk", pace=Pace.REALTIME, cell=self.cell)
        self.clock = MonotonicClock()
        self.tracker = SwitchedTracker()
        self.config = ControllerConfig(self.served.address)
        config = PhysicalConfig("test", "irb140", self.config, safety=SafetyConfig(**{"first_speed": 100.0, **safety}))
        first, second = (RwsController(transport_to(self.served, patience=patience), self.clock) for _ in range(2))
        self.controller = GuardedController(
            first, second, config, load_robot_model("irb140"), self.tracker, self.clock, armed=armed, guardian=self.guardian
        )
        self.program = folder / "guarded.mod"
        self.program.write_text(PROGRAM, encoding="utf-8")

    def guardian(self):
        return Guardian(self.config)

    def joints(self):
        return np.degrees(self.cell.controller.joints())

    def running(self):
        self.controller.load([self.program])
        self.controller.start()
        return self

    def until(self, condition, seconds=15.0):
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, "it never came about"
            time.sleep(0.02)

    def stands_short_of(self, degrees):
        self.until(lambda: not self.cell.running)
        time.sleep(0.1)
        resting = self.joints()
        time.sleep(0.2)
        np.testing.assert_allclose(self.joints(), resting, atol=1e-9)  # rounding of radians and degrees
        assert 0.5 < resting[0] < degrees - 1.0

    def restart_server(self):
        """As after a power cut: the same address, nothing else is left."""
        self.served.close()
        self.cell = start.virtual_cell("irb140")
        self.served = Served("1", self.folder / "disk", pace=Pace.REALTIME, cell=self.cell, port=self.served.port)

    def close(self):
        try:
            self.controller.close()
        finally:
            self.served.close()


@pytest.fixture
def make(tmp_path, monkeypatch):
    monkeypatch.setenv("MITL_RWS_PASSWORD", "robotics")
    benches = []

    def made(**options):
        benches.append(Bench(tmp_path, **options))
        return benches[-1]

    yield made
    for bench in benches:
        bench.close()


def test_unarmed_it_can_be_asked_but_nothing_moves(make):
    bench = make(armed=False)
    for call in (
        lambda: bench.controller.load([bench.program]),
        bench.controller.start,
        lambda: bench.controller.write("option", "1"),
        lambda: bench.controller.set_motors(True),
    ):
        with pytest.raises(RigError, match="not armed"):
            call()
    assert len(bench.controller.joints()) == 6
    assert bench.controller.state() is ExecutionState.STOPPED
    bench.controller.stop()
    assert bench.joints() == pytest.approx([0, 0, 0, 0, 30, 0])


def test_armed_it_flies_what_was_pre_flown_and_leaves_the_controller_as_found(make):
    bench = make().running()
    bench.controller.write("option", "1")
    bench.until(lambda: bench.controller.read("option") == "0")
    assert bench.joints()[0] == pytest.approx(20.0, abs=0.1)
    bench.controller.close()
    assert not bench.cell.memory.modules()
    assert not bench.cell.running


def test_an_order_that_cannot_be_flown_is_refused_before_anything_moves(make):
    bench = make().running()
    bench.controller.write("angle", "999")
    with pytest.raises(RigError, match=r"pre-flight of order 1.*limit.*nothing was moved"):
        bench.controller.write("option", "1")
    assert bench.joints()[0] == pytest.approx(0.0, abs=1e-6)


def test_an_order_that_leaves_the_workspace_is_refused_before_anything_moves(make):
    bench = make(workspace_mm=((0.0, -50.0, 0.0), (1000.0, 50.0, 1500.0))).running()
    with pytest.raises(RigError, match=r"leave the workspace.*nothing was moved"):
        bench.controller.write("option", "1")
    assert bench.joints()[0] == pytest.approx(0.0, abs=1e-6)


def test_another_tool_on_the_controller_than_in_the_program_is_refused(make):
    bench = make()
    bench.controller.load([bench.program])
    other = RwsController(transport_to(bench.served), bench.clock)
    bench.cell.write("tLong", "[TRUE,[[0,0,150],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]]")
    with pytest.raises(RigError, match=r"tooldata tLong is .*150"):
        bench.controller.start()
    other.leave()


def test_a_lost_tracker_starts_nothing_and_stops_what_moves(make):
    bench = make(tracker_lost_s=0.2)
    bench.controller.load([bench.program])
    bench.tracker.lost = True
    with pytest.raises(RigError, match="lost"):
        bench.controller.start()
    bench.tracker.lost = False
    bench.controller.start()
    bench.controller.write("option", "3")
    bench.until(lambda: bench.joints()[0] > 2.0)
    bench.tracker.lost = True
    bench.stands_short_of(90.0)
    with pytest.raises(RigError, match="tracker is lost for more than"):
        bench.controller.state()


def test_a_sleeping_tracker_is_nudged_awake_and_the_robot_stands_where_it_stood(make):
    bench = make()
    before, seen = bench.joints(), []

    def latest():
        seen.append(bench.joints())
        if np.ptp([joints[5] for joints in seen]) < 2.0:
            raise RigError("the tracker is lost")

    bench.tracker.latest = latest
    await_rig(bench.controller, bench.tracker, bench.clock, 30.0)
    assert bench.joints() == pytest.approx(before, abs=1e-3)
    assert np.ptp(seen, axis=0)[:5] == pytest.approx(0.0, abs=1e-3), "no other axis moved"
    assert not bench.cell.running
    bench.running()
    bench.controller.write("option", "1")
    bench.until(lambda: bench.controller.read("option") == "0")


def test_unarmed_a_sleeping_tracker_is_told_and_nothing_moves(make):
    bench = make(armed=False)
    before, bench.tracker.lost = bench.joints(), True
    with pytest.raises(RigError, match="not there, also after 1 s: the tracker is lost"):
        await_rig(bench.controller, bench.tracker, bench.clock, 1.0)
    assert bench.joints() == pytest.approx(before, abs=1e-9)


def test_one_sample_that_is_not_valid_is_no_lost_tracker(make):
    bench = make().running()
    bench.tracker.lost = True
    threading.Timer(0.2, lambda: setattr(bench.tracker, "lost", False)).start()
    bench.controller.write("option", "1")
    bench.until(lambda: bench.controller.read("option") == "0")


def test_a_robot_that_leaves_its_pre_flown_way_is_stopped(make):
    bench = make(faults=("axis-sign=1",), corridor_mm=30.0).running()
    bench.controller.write("option", "2")
    bench.until(lambda: not bench.cell.running)
    with pytest.raises(RigError, match="off its pre-flown way"):
        bench.controller.read("option")


@pytest.mark.parametrize(
    ("change", "said"), [(lambda cell: cell.set_mode("MANR"), "AUTO"), (lambda cell: cell.set_motors(False), "motors")]
)
def test_it_neither_turns_the_key_nor_switches_the_motors_on(make, change, said):
    bench = make()
    bench.controller.load([bench.program])
    change(bench.cell)
    with pytest.raises(RigError, match=said):
        bench.controller.start()
    assert bench.cell.state == "motoroff" if said == "motors" else True


def test_a_watchdog_stop_gets_through_while_the_first_session_hangs(make):
    bench = make(tracker_lost_s=0.2).running()
    bench.controller.write("option", "3")
    bench.until(lambda: bench.joints()[0] > 2.0)
    held = threading.Event()

    def hang():
        with bench.controller._controller._transport._lock:
            held.wait(20.0)

    thread = threading.Thread(target=hang)
    thread.start()
    bench.tracker.lost = True
    bench.stands_short_of(90.0)
    held.set()
    thread.join()


def test_a_controller_that_dies_in_a_motion_is_told_and_the_next_program_runs_when_it_is_back(make):
    bench = make(patience=0.5).running()
    bench.controller.write("option", "3")
    bench.until(lambda: bench.joints()[0] > 2.0)
    bench.served.close()
    with pytest.raises(RigError, match=r"cannot be reached|cannot see|connection"):
        bench.until(lambda: bench.controller.state() is not ExecutionState.RUNNING)
    with pytest.raises(RigError, match="not there"):
        await_rig(bench.controller, bench.tracker, bench.clock, 0.0)
    bench.restart_server()
    await_rig(bench.controller, bench.tracker, bench.clock, 5.0)
    bench.controller.begin(first=False)
    bench.running()
    bench.controller.write("option", "1")
    bench.until(lambda: bench.controller.read("option") == "0")
    assert bench.joints()[0] == pytest.approx(20.0, abs=0.1)


def test_a_rig_that_another_holds_is_waited_for(make):
    bench = make()
    other = RwsController(transport_to(bench.served), bench.clock)
    other.take_control()
    with pytest.raises(RigError, match=r"not there, also after 0 s: requesting mastership refused .* held by mitl"):
        await_rig(bench.controller, bench.tracker, bench.clock, 0.0)
    threading.Timer(0.5, other.close).start()
    await_rig(bench.controller, bench.tracker, bench.clock, 10.0)
    bench.running()


def test_sigkill_of_the_process_stops_the_robot(make):
    bench = make().running()
    script = (
        "import sys, time\nfrom mitl.rig.guardian import Guardian\nfrom mitl.rig.physical_config import ControllerConfig\n"
        "guardian = Guardian(ControllerConfig(sys.argv[1]))\nprint('up', flush=True)\ntime.sleep(60)"
    )
    child = subprocess.Popen([sys.executable, "-c", script, bench.served.address], stdout=subprocess.PIPE, text=True)
    with child:
        assert child.stdout.readline() == "up\n"
        bench.controller.write("option", "3")
        bench.until(lambda: bench.joints()[0] > 2.0)
        os.kill(child.pid, signal.SIGKILL)
        bench.stands_short_of(90.0)


def test_without_a_heartbeat_the_program_stops_itself_on_the_controller(make):
    bench = make(heartbeat_s=1.0).running()
    bench.controller.write("option", "3")
    bench.until(lambda: bench.joints()[0] > 2.0)
    bench.controller._heart.rest()  # as if mitl, its computer and its guardian were gone
    bench.stands_short_of(90.0)
    assert any("stopped itself at MitlGuard" in event.text for event in bench.controller.event_log())


def test_what_was_stopped_on_its_way_goes_on_along_it_and_what_stopped_itself_does_not(make):
    bench = make(corridor_mm=30.0).running()
    bench.controller.write("option", "3")
    bench.until(lambda: bench.joints()[0] > 2.0)
    bench.controller.stop()
    bench.stands_short_of(90.0)
    bench.controller.start()
    bench.until(lambda: bench.joints()[0] > 20.0)
    assert bench.controller.state() is ExecutionState.RUNNING
    bench.cell.stop()
    with pytest.raises(RigError, match="load it again"):
        bench.controller.start()


def test_the_first_pass_begins_slowly_and_climbs_and_the_way_to_a_new_program_is_slow(make):
    bench = make(first_speed=20.0, speed=60.0)
    bench.controller.begin(first=True)
    told = []
    tell = bench.cell.set_speed_ratio
    bench.cell.set_speed_ratio = lambda text: (told.append(float(text)), tell(text))
    bench.running()
    for _ in range(10):
        bench.controller._climb()
    assert told == [20.0, 20.0, 20.0, 30.0, 40.0, 60.0]
    bench.controller.stop()
    bench.controller.begin(first=False)
    bench.running()
    assert told[-2:] == [20.0, 60.0]
    bench.controller.close()
    assert told[-1] == 100.0


def test_after_the_guardian_had_to_stop_the_robot_the_next_program_gets_another(make):
    bench = make().running()
    first = bench.controller._guardian
    os.kill(first.pid, signal.SIGKILL)
    bench.until(lambda: not first.alive)
    with pytest.raises(RigError, match="guardian"):
        bench.controller.write("option", "1")
    bench.controller.stop()
    await_rig(bench.controller, bench.tracker, bench.clock, 5.0)
    bench.running()
    assert bench.controller._guardian is not first
    bench.controller.write("option", "1")
    bench.until(lambda: bench.controller.read("option") == "0")


def test_arming_needs_a_terminal_unless_the_rig_file_allows_unattended_runs(tmp_path):
    file = tmp_path / "cell.toml"
    text = '[rig]\nkind = "physical"\nrobot = "irb140"\n[controller]\naddress = "http://127.0.0.1"\n[safety]\nunattended = false\n'
    file.write_text(text)
    with pytest.raises(UsageError, match="needs a terminal"):
        may_arm(file, terminal=False)
    may_arm(file, terminal=True)
    file.write_text(text.replace("false", "true"))
    may_arm(file, terminal=False)
