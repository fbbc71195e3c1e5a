"""Outputs of the simulated controller: what one program did to the wires is still known after the next is loaded."""

from __future__ import annotations

import pytest

from mitl.controllers.simulated import SimulatedController
from mitl.motion.robot_model import load_robot_model


class HandClock:
    """A clock that a test sets."""

    def __init__(self):
        self.time = 0.0

    def now(self):
        return self.time

    def wait(self, seconds):
        self.time += seconds


@pytest.fixture
def controller(tmp_path):
    """A controller, its clock, and a function that lets a program of some instructions run until a time."""
    clock, controller = HandClock(), SimulatedController(load_robot_model("irb140"))
    controller.connect(clock)

    def play(until, *lines):
        file = tmp_path / "p.mod"
        file.write_text("\n".join(["MODULE P", "PROC main()", *lines, "ENDPROC", "ENDMODULE"]) + "\n")
        controller.load([file])
        controller.start()
        while (event := controller.next_event()) <= until:
            clock.time = max(event, clock.time)
            controller.run(clock.time)
        clock.time = until

    return controller, play


def test_changes_of_former_programs_stay_in_their_order(controller):
    controller, play = controller
    play(3.0, "WaitTime 1;", "SetDO doA,1;", "WaitTime 1;", "SetDO doA,0;")
    play(6.0, "WaitTime 1;", "SetDO doA,1;")
    assert [value for _, value in controller.output_changes("doA", 0.0, 10.0)] == [1, 0, 1]
    times = [time for time, _ in controller.output_changes("doA", 0.0, 10.0)]
    assert times == pytest.approx([1, 2, 4], abs=0.05)
    assert [value for _, value in controller.output_changes("doA", 1.5, 10.0)] == [0, 1]


def test_what_a_former_program_had_not_yet_done_is_not_told(controller):
    controller, play = controller
    play(1.5, "WaitTime 1;", "SetDO doA,1;", "SetDO\\SDelay:=5,doA,0;")
    play(9.0, "WaitTime 1;")
    assert [value for _, value in controller.output_changes("doA", 0.0, 10.0)] == [1]


def test_a_reset_forgets_them(controller):
    controller, play = controller
    play(3.0, "SetDO doA,1;")
    controller.reset()
    assert controller.output_changes("doA", -1.0, 10.0) == []
